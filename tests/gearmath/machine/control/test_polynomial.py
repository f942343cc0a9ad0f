"""Blocks of POLY as the control drives them: by hand-made polynomials, in every form in which they are read."""

import math

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.machine.control.executor import MachinePath, execute
from gearmath.machine.control.polynomial import CHORD
from gearmath.machine.judging.motion import speeds
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled

HEAD = """G17 G40 G90 G94 G710 G54 G60 SOFT FFWON
TRAFOOF
COMPOF
DIAMOF
TRANS
FGROUP(X,Y,Z,A,B)
FGREF[A]=57.29578 FGREF[B]=57.29578
OVR=100 OVRRAP=100
ACC[X]=100 ACC[Y]=100 ACC[Z]=100 ACC[A]=100 ACC[B]=100
D0
G0 SUPA Z900
T="TOOL" D1
M6
D1
G0 SUPA Z900
S100 M3
G0 X1 Y2 Z0 A=DC(350) B0
"""
#: x = 1 + 2 u + 4 u² - u³, y = 2 + u - 3 u²
CURVE = "PO[X]=(6,4,-1) PO[Y]=(0,-3)"


def cut(block: str, head: str = HEAD) -> tuple[MachinePath, np.ndarray]:
    """The path of one block, and which of its rows are its own."""
    path = execute(f"{head}{block}\nG0 Z900\nM30\n", "P")
    line = head.count("\n") + 1
    return path, np.flatnonzero(path.line == line)


def on_curve(rows: np.ndarray) -> float:
    """How far positions (n,5) are from the curve at their nearest of many places. [mm]"""
    u = np.linspace(0, 1, 200_001)
    x, y = 1 + 2 * u + 4 * u**2 - u**3, 2 + u - 3 * u**2
    # x rises all the way
    return float(np.abs(np.interp(rows[:, 0], x, y) - rows[:, 1]).max())


@pytest.mark.parametrize(
    "block",
    [
        f"G93 POLY {CURVE} F6",
        "G93 POLY X=PO(6,4,-1) Y=PO(0,-3) F6",
        "G93 POLY PO[X]=(6,1,-0.125) PO[Y]=(0,-0.75) PL=2 F6",
        "G93 POLY PO[X] = ( 6 , 8/2 , -1 ) Y=PO(0,-3,0,0,0) F6",
        "g93 poly po[x]=(6,4,-1) po[y]=(0,-3) f6",
    ],
)
def test_a_block_follows_its_polynomials_and_takes_its_time(block):
    path, rows = cut(block)
    assert len(rows) > 100
    assert on_curve(path.axes[rows]) < 1e-9
    np.testing.assert_allclose(path.axes[rows[-1]], [6.0, 0.0, 0.0, math.radians(350), 0.0], atol=1e-12)
    assert path.seconds[rows].sum() == pytest.approx(10.0)
    assert path.inner[rows[:-1]].all()
    assert not path.inner[rows[-1]]
    middle = (path.axes[rows[1:]] + path.axes[rows[:-1]]) / 2
    assert on_curve(middle) < CHORD


@pytest.mark.parametrize("word", ["G1", "G0"])
def test_without_poly_the_way_is_straight_and_no_alarm_is_given(word):
    path, rows = cut(f"G93 {word} {CURVE}" + (" F6" if word == "G1" else ""))
    assert len(rows) == 1
    assert not path.inner.any()
    np.testing.assert_allclose(path.axes[rows[0], :2], [6.0, 0.0])


def test_the_time_is_shared_out_by_the_length_of_the_path_and_feed_is_along_it():
    timed, rows = cut(f"G93 POLY {CURVE} F6")
    way = np.linalg.norm(np.diff(timed.axes[np.r_[rows[0] - 1, rows]], axis=0), axis=1)
    np.testing.assert_allclose(timed.seconds[rows] / way, 10.0 / way.sum(), rtol=1e-6)
    fed, rows = cut(f"G94 POLY {CURVE} F60")
    u = np.linspace(0, 1, 20001)
    length = np.hypot(np.diff(1 + 2 * u + 4 * u**2 - u**3), np.diff(2 + u - 3 * u**2)).sum()
    assert fed.seconds[rows].sum() == pytest.approx(length, rel=1e-5)  # 60 mm/min is 1 mm/s


def test_a_counts_on_through_360_from_where_dc_has_put_it():
    path, rows = cut("G93 POLY PO[A]=(372,5) PO[X]=(2) F6")
    assert np.degrees(path.axes[rows[-1], 3] - path.axes[rows[0] - 1, 3]) == pytest.approx(22.0)
    back, rows = cut("G93 POLY PO[A]=(-5,5) PO[X]=(2) F6")
    assert np.degrees(back.axes[rows[-1], 3] - back.axes[rows[0] - 1, 3]) == pytest.approx(-355.0)


def test_axes_without_coefficients_are_linear_in_the_parameter():
    path, rows = cut("G93 POLY PO[X]=(4,0.5) B3 Z=PO(-1) F6")
    u = -np.degrees(path.axes[rows, 4]) / -3.0
    np.testing.assert_allclose(path.axes[rows, 2], -u, atol=1e-12)
    np.testing.assert_allclose(path.axes[rows, 0], 1 + 2.5 * u + 0.5 * u**2, atol=1e-12)


@pytest.mark.parametrize(
    ("block", "why"),
    [
        (f"G93 POLY {CURVE} PL=0 F6", "PL=0: must lie between 0.0001 and 99999.9999"),
        ("G93 POLY PO[X]=(6,4,-1) X2 F6", "X2 is a second value for X in one block"),
        (f"G93 POLY {CURVE}", "F is missing: every G93 block needs its own"),
        (f"POLY MEAS=1 {CURVE} F6", "MEAS=1 needs G1"),
        ("G93 POLY PO[C]=(6,4) F6", "C is an axis only after SPOS"),
        ("BSPLINE", "BSPLINE is not understood: the path is read as G1 and POLY blocks"),
        ("EGON(A)", "EGON is not understood: write G1 blocks"),
    ],
)
def test_what_is_wrong_with_a_block_is_said(block, why):
    with pytest.raises(InputError, match=rf"^P, line {HEAD.count(chr(10)) + 1}, column \d+: ") as caught:
        cut(block)
    assert why in str(caught.value)


def test_acceleration_and_jerk_within_a_block_are_judged():
    """A parabola over 10 mm, with a radius of 2.5 mm at its top: 67 mm/s there are 1900 mm/s²."""
    machine = load_milling_machine(bundled("vertical_5axis.toml"))
    block = "G93 POLY PO[X]=(11,0) PO[Y]=(2,20,-20) F{:.6f}"
    for seconds, unit in ((2.0, None), (0.18, "/s3"), (0.05, "/s2")):
        path, _ = cut(block.format(60 / seconds))
        found = [str(one) for one in speeds(path, machine)]
        if unit is None:
            assert found == []
        else:
            assert any(unit in one for one in found), found
