"""Probing programs: where they touch, what they stay clear of, and the rules of the control that their text keeps.

The machine is typed here again, from p_m = M(B) (Rz(-A) p_w + e), and the member is a cloud of its own flank points.
"""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from scipy.spatial import cKDTree

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.tooth import tooth_space
from gearmath.errors import InputError
from gearmath.machine.control.executor import run_program
from gearmath.machine.measuring.collision_check import approaches
from gearmath.machine.measuring.probe import ProbeMachine
from gearmath.machine.planning.targets import probe_targets
from gearmath.machine.writing.axis_cycle import axis_program
from gearmath.machine.writing.calibrating import calibration_program
from gearmath.machine.writing.probe_words import NOTHING_TOUCHED, TOUCHED_TOO_EARLY
from gearmath.machine.writing.probing import probing_program
from gearmath.specs.bevel_set import FLANKS, MEMBERS
from gearmath.specs.calibration import load_calibration
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
PROBE = load_calibration(bundled("probe.toml"))
BENT = PROBE.model_copy(update={"offset": (0.4, -0.3, 0.2), "tip_radius": 0.9})
OFF_AXIS = MACHINE.model_copy(update={"pivot_offset": (1.5, -2.25, 30.0)})
COUNTING = MACHINE.model_copy(
    update={
        "axes": MACHINE.axes.model_copy(
            update={"A": MACHINE.axes.A.model_copy(update={"modulo": False, "travel": (-10.0, 700.0)})}
        )
    }
)
SET_UPS = pytest.mark.parametrize(
    ("machine", "probe"), [(MACHINE, PROBE), (OFF_AXIS, BENT), (COUNTING, PROBE)], ids=["plain", "offsets", "counting"]
)


def tip_in_work(axes, machine, probe):
    """Centre of the tip and direction to the spindle, for positions (n,5), by plain rotations."""
    tips, stylus = [], []
    for X, Y, Z, A, B in axes:
        at = np.array([X, Y, Z - machine.gauge_line_height - probe.length]) + probe.offset
        columns = np.array([[-math.sin(B), 0, math.cos(B)], [0, 1, 0], [-math.cos(B), 0, -math.sin(B)]]).T
        turn = np.array([[math.cos(A), -math.sin(A), 0], [math.sin(A), math.cos(A), 0], [0, 0, 1]])
        tips.append(turn @ (np.linalg.inv(columns) @ at - machine.pivot_offset))
        stylus.append(turn @ np.linalg.inv(columns) @ [0, 0, 1])
    return np.array(tips), np.array(stylus)


def probed(gear_set, member, machine=MACHINE, probe=PROBE, stock=None, host=None, parameters=None, **options):
    text = probing_program(gear_set, member, machine, probe, "PROBE", **options)
    there = ProbeMachine(gear_set.member(member), machine, probe, *([stock] if stock else []))
    return run_program(text, "PROBE.MPF", there, host, parameters), there


def touches_of(path):
    """Rows of a path that end at a touch: a measuring block along a normal, neither straight down nor sideways."""
    moved = np.abs(np.diff(path.axes, axis=0, prepend=path.axes[:1])) > 1e-7
    return path.measuring & (moved[:, 0] | moved[:, 1]) & moved[:, 2] & ~moved[:, 3]


@pytest.mark.parametrize("member", MEMBERS)
@SET_UPS
def test_every_touch_is_within_a_micrometre_of_where_it_should_be(gear_set, member, machine, probe):
    """One tip radius above the flank point, along its normal, in the order of the program."""
    spec = gear_set.member(member)
    done, _ = probed(gear_set, member, machine, probe)
    touched = done.path.axes[touches_of(done.path)]
    rows = [line.split(",") for line in done.files["PROBE_T"].splitlines()[2:]]
    assert len(touched) == len(rows) == 2 * (45 + spec.teeth - 1 + 5)
    tips, _ = tip_in_work(touched, machine, probe)
    nominal = {flank: solve_flank(spec, flank, blank_grid(spec)) for flank in FLANKS}
    for tip, (_, _, _, flank, tooth, row, col, *_) in zip(tips, rows, strict=True):
        k = int(row) * 9 + int(col)
        turn = 2 * math.pi * int(tooth) / spec.teeth
        c, s = math.cos(turn), math.sin(turn)
        expected = nominal[flank].point[k] + probe.tip_radius * nominal[flank].normal[k]
        assert np.linalg.norm(tip - np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ expected) <= 1e-3


def test_tooth_0_is_touched_again_at_the_end_where_it_was_touched_first(gear_set):
    """Both flanks, at the same positions, A of a counting axis too; without pitch there is no second time."""
    for machine in (MACHINE, COUNTING):
        targets = probe_targets(gear_set.gear, machine, PROBE)
        assert (targets.tooth == 36).sum() == 10
        assert (targets.tooth[-10:] == 36).all()
        assert targets.flank[-10:].tolist() == ["concave"] * 5 + ["convex"] * 5
        assert list(zip(targets.row[-5:], targets.col[-5:], strict=True)) == [(0, 0), (0, 8), (2, 4), (4, 0), (4, 8)]
        for k in range(-10, 0):
            first = (targets.tooth == 0) & (targets.flank == targets.flank[k])
            first &= (targets.row == targets.row[k]) & (targets.col == targets.col[k])
            for positions in (targets.start, targets.touch, targets.end):
                np.testing.assert_array_equal(positions[k], positions[first][0])
    assert probe_targets(gear_set.gear, MACHINE, PROBE, pitch=False).tooth.max() == 0
    alone = probe_targets(gear_set.gear, MACHINE, PROBE, topography=())
    assert (alone.tooth == 36).sum() == 2


def test_repeated_touches_follow_each_other_without_leaving_the_space(gear_set):
    """Three touches a point, each from its start; between them the tip moves along the way of the touch only."""
    done, _ = probed(gear_set, "pinion", topography=(), repeat=3)
    rows = [line.split(",") for line in done.files["PROBE_T"].splitlines()[2:]]
    assert [row[1] for row in rows] == [str(k) for k in range(1, 3 * 26 + 1)]
    assert all(rows[3 * k][3:7] == rows[3 * k + j][3:7] for k in range(26) for j in (1, 2))
    once, _ = probed(gear_set, "pinion", topography=())
    single = [line.split(",") for line in once.files["PROBE_T"].splitlines()[2:]]
    assert [row[2:] for row in rows[::3]] == [row[2:] for row in single]
    measuring = np.flatnonzero(done.path.measuring)
    between = [k for k in measuring if k + 2 in measuring and k + 1 not in measuring]
    assert len(between) == 2 * 26
    assert not done.path.rapid[[k + 1 for k in between]].any()


@pytest.mark.parametrize("member", MEMBERS)
def test_touch_is_square_to_the_flank_and_starts_outside_of_it(gear_set, member):
    spec = gear_set.member(member)
    targets = probe_targets(spec, MACHINE, PROBE)
    first, _ = tip_in_work(targets.start, MACHINE, PROBE)
    last, _ = tip_in_work(targets.end, MACHINE, PROBE)
    for flank in FLANKS:
        nominal = solve_flank(spec, flank, blank_grid(spec))
        here = (targets.flank == flank) & (targets.tooth == 0)
        way = last[here] - first[here]
        along = (way * nominal.normal).sum(axis=1)
        np.testing.assert_allclose(along, -np.linalg.norm(way, axis=1), rtol=1e-12)
        gap = ((first[here] - nominal.point) * nominal.normal).sum(axis=1) - PROBE.tip_radius
        assert (gap >= 0.1).all()
        assert (gap <= 1.5 + 1e-9).all()


def cloud(spec):
    """Points of the space, fine enough that a ball of tip size finds them, and the same of both neighbours' lands."""
    space = tooth_space(spec, 97)
    parts = [space.concave.point.reshape(-1, 3), space.convex.point.reshape(-1, 3)]
    low, high = space.ordered
    for share in np.linspace(0, 1, 25)[1:-1]:
        parts.append((1 - share) * low.point[-1] + share * high.point[-1])
    for sign in (-1, 1):
        turn = sign * space.pitch
        about = np.array([[math.cos(turn), -math.sin(turn), 0], [math.sin(turn), math.cos(turn), 0], [0, 0, 1]])
        near, far = (low, high) if sign < 0 else (high, low)
        for share in np.linspace(0, 1, 12)[1:-1]:
            parts.append((1 - share) * near.point[0] + share * far.point[0] @ about.T)
    return np.concatenate(parts)


@pytest.mark.parametrize("member", MEMBERS)
def test_neither_tip_nor_stylus_ever_collides(gear_set, member):
    """All blocks of the topography in steps of 0.25 mm, A turning too, against a cloud of points of the space."""
    spec = gear_set.member(member)
    done, _ = probed(gear_set, member, pitch=False)
    points, path = cKDTree(cloud(spec)), done.path
    nearest_tip, nearest_touch, nearest_stylus = [], [], []
    for k in range(1, len(path.axes)):
        steps = 2 + int(np.linalg.norm(path.axes[k, :3] - path.axes[k - 1, :3]) / 0.25)
        axes = path.axes[k - 1] + np.linspace(0, 1, steps)[:, None] * (path.axes[k] - path.axes[k - 1])
        tips, stylus = tip_in_work(axes, MACHINE, PROBE)
        stem = (tips[::3, None] + np.arange(1.0, PROBE.stylus_length, 2.0)[:, None] * stylus[::3, None]).reshape(-1, 3)
        away = points.query(tips)[0]
        if path.measuring[k]:
            nearest_touch.append(away[-1])
        else:
            nearest_tip.append(away[1:].min())
        nearest_stylus.append(points.query(stem)[0].min())
    assert min(nearest_tip) > PROBE.tip_radius + 0.15  # a retract is 0.25 mm on its way at its first step
    assert min(nearest_touch) > PROBE.tip_radius - 1e-3
    assert min(nearest_stylus) > PROBE.stylus_radius + 0.3
    # the check of the command says the same
    text = probing_program(gear_set, member, MACHINE, PROBE, "PROBE", pitch=False)
    near = {(one.probe, one.work): one.distance for one in approaches(text, "P", spec, MACHINE, PROBE)}
    assert near["tip", "teeth"] > 0.2
    assert near["stylus", "teeth"] > 0.3


@pytest.mark.parametrize("member", MEMBERS)
def test_sideways_motion_is_above_the_whole_member(gear_set, member):
    """Wherever X, Y, A or B move outside of a touch, the tip is above the highest point of the blank there."""
    spec = gear_set.member(member)
    done, _ = probed(gear_set, member)
    path = done.path
    blank = solve_flank(spec, "concave", blank_grid(spec, 2, 2, 0.02)).point
    reach = np.hypot(blank[:, 0], blank[:, 1]) * 1.02
    for k in range(1, len(path.axes)):
        moved = np.abs(path.axes[k] - path.axes[k - 1])
        if path.rapid[k] and moved[[0, 1, 3, 4]].max() > 1e-9:
            Z = min(path.axes[k, 2], path.axes[k - 1, 2]) - MACHINE.gauge_line_height - PROBE.length - PROBE.tip_radius
            B = np.linspace(path.axes[k - 1, 4], path.axes[k, 4], 20)[:, None]
            assert (reach * np.cos(B) - blank[:, 2] * np.sin(B) < Z - 1.0).all()


def test_host_gets_every_point_once_and_in_order(gear_set):
    """cnc.md 2.6: the host sees R102, R101 and R200 to R205, and only its R103 = R101 lets the program go on."""
    seen, waits = [], 0

    def host(parameters):
        nonlocal waits
        waits += 1
        if waits % 3:  # the host takes its time
            return {}
        assert parameters[102] == 5
        seen.append([parameters[101], *(parameters[k] for k in range(200, 206))])
        return {103: parameters[101]}

    done, _ = probed(gear_set, "pinion", host=host, parameters={102: 4, 104: 1}, topography=())
    assert [row[0] for row in seen] == list(range(1, 27))
    rows = [line.split(",") for line in done.files["PROBE_T"].splitlines()[2:]]
    assert [row[0] for row in rows] == ["5"] * 26
    expected = [[float(row[1]), *map(float, row[7:])] for row in rows]
    np.testing.assert_allclose(seen, expected, rtol=0, atol=1e-9)


def test_program_waits_for_a_host_that_does_not_answer(gear_set):
    text = probing_program(gear_set, "pinion", MACHINE, PROBE, "PROBE", topography=())
    there = ProbeMachine(gear_set.member("pinion"), MACHINE, PROBE)
    for host in (lambda parameters: {}, lambda parameters: {103: parameters[101] - 1}):
        with pytest.raises(InputError, match=r"the program is not at its end after 5000 steps"):
            run_program(text, "P", there, host, {104: 1}, step_limit=5000)


def test_missing_metal_and_metal_in_the_way_stop_the_program_after_a_retract(gear_set):
    """1 mm too little is beyond the overtravel; 5 mm too much is met on the way in."""
    for amount, alarm, message in (
        (-1.0, NOTHING_TOUCHED, "touched nothing"),
        (5.0, TOUCHED_TOO_EARLY, "touched something on the way in"),
    ):
        there = ProbeMachine(gear_set.member("gear"), MACHINE, PROBE, lambda flank, tooth, place, a=amount: a)
        text = probing_program(gear_set, "gear", MACHINE, PROBE, "PROBE", topography=())
        there.body.point = there.body.point + amount * there.body.normal
        done = run_program(text, "P", there)
        assert done.alarm is not None
        assert done.alarm[0] == alarm
        assert done.messages[-1] == f"point 1: {message}"
        assert done.path.rapid[-1]
        lowered = int(np.argmax(done.path.measuring))
        assert done.path.axes[-1, 2] == done.path.axes[lowered, 2]  # back at the height of sideways motion
        assert done.files["PROBE_T"].count("\n") == 2  # the plan and the column line only


PROGRAMS = {
    "pinion": lambda s: probing_program(s, "pinion", MACHINE, PROBE, "PROBE_PINION"),
    "gear": lambda s: probing_program(s, "gear", OFF_AXIS, BENT, "PROBE_GEAR", topography=range(3)),
    "repeated": lambda s: probing_program(s, "pinion", MACHINE, PROBE, "PROBE_PINION", repeat=4),
    "counting": lambda s: probing_program(s, "gear", COUNTING, PROBE, "_P", topography=()),
    "calibration": lambda s: calibration_program(MACHINE, PROBE, "CALIBRATE"),
    "axes": lambda s: axis_program(MACHINE, PROBE, "CALIBRATE_AXES"),
}


@pytest.mark.parametrize("which", PROGRAMS)
def test_lint(gear_set, which):
    """Every rule of the control that a text can be compared with, for every kind of program."""
    text = PROGRAMS[which](gear_set)
    assert text.isascii()
    assert text.endswith("M30\n")
    assert not re.search(r"[\r\t]", text)
    number = r"-?\d+\.\d+"
    table = r"U(?:WAY\[(?:UPLACE|\d+),\d\]|WHERE\[(?:UPLACE|\d+),\d\]|TURN\[(?:UTOOTH|\d+)\]|KIND\[(?:UTOOTH|\d+)\])"
    variable = r"U(?:FROM|TO|POINT|ANGLE|BEFORE|ENDS\[\d+\])"
    word = re.compile(
        rf"G(?:0|1|4|17|40|54|90|94|710|642)|M(?:0|5|6|9|30)|[XYZ]-?\d+\.\d{{5}}|B-?\d+\.\d{{6}}|F{number}|D[01]|SPOS=0|MEAS=1"
        rf'|T="PROBE"|A=DC\(\d+\.\d{{6}}\)|A-?\d+\.\d{{6}}|[XYZAB]=IC\(0\)|[XY]=R1[01](?:[-+]\d+\.\d{{5}})?|STOPRE'
        rf"|A=(?:DC\(UANGLE\)|UANGLE)|[XYZ]=UWAY\[UPLACE,[0-5]\]|{table}=(?:-?\d+\.\d{{5}}|-?\d+\.\d{{8}}|\d+)|POINTS:|SECTION_\d:"
        rf"|{variable}=(?:{variable}|{table}|TRUNC|ROUND|R9[01]|[-+*/()]|\d+)+|FGREF\[[AB]\]=57\.29578"
        r"|SOFT|FFWON|SUPA|TRAFOOF|COMPOF|DIAMOF|TRANS|FGROUP\(X,Y,Z(?:,A,B)?\)|[CO]TOL=0\.\d+|(?:OVR|OVRRAP|ACC\[[XYZAB]\])=100"
        rf"|R\d+=(?:R\d+(?:\+1)?|0|\(R12\+R13\)/2|\$A[AC]_ME?[AM]\[[XYZAB1]\]|\(?-?\d+\.\d{{5}}\)?|UENDS\[(?:UFROM-1|\d)\]|\(UFROM-1\)\*\d+)"
    )
    whole = re.compile(
        r"DEF (?:INT|REAL) U[A-Z0-9,\[\]]+|FOR UTOUCH=1 TO \d+|FOR U(?:TOOTH|PLACE)=0 TO \d+|ENDFOR|ELSE"
        r"|IF [^R$]*\$(?:MN|P_ACTFRAME|P_TOOLL|AA_IM|TC_TP2)[ -~]*"
        r"|IF (?:\$A_PROBE\[1\]<>0|\$AC_MEA\[1\]<>0|R205==0|UERR<>0|R104==1)|ENDIF|ENDWHILE"
        r"|IF (?:[()]|R9[01]|U[A-Z]+(?:\[(?:UTOOTH|UPLACE,[03])\])?|[<>=]+|\d+| AND | OR )+"
        r"|WHILE R103<>R101|SETAL\(650(?:0[0-4]|1[0-6])\)"
        r'|MSG\((?:"[A-Za-z0-9_., :()\x27-]+"|<<|R9[01]|UPOINT|UTOOTH|UWHERE\[UPLACE,[12]\])+\)'
        r'|DELETE\(UERR,"[A-Z_]{1,24}"\)|WRITE\(UERR,"[A-Z_]{1,24}",[A-Za-z0-9_,"<#: +*()\[\]]+\)'
    )
    modulo = which != "counting"
    blocks = [line for line in text.split("\n")[:-1] if not line.startswith(";")]
    assert max(len(line) + 1 for line in text.split("\n")) <= 250
    for count, line in enumerate(blocks, 1):
        label, _, rest = line.partition(" ")
        assert label == f"N{10 * count}"
        assert whole.fullmatch(rest) or all(word.fullmatch(token) for token in rest.split(" ")), line
        assert not re.search(r"-0\.0+\b|\d[eE][-+]?\d", rest), line
        assert not re.search(r" A=DC" if not modulo else r" A-?\d", f" {rest}") or "MSG(" in rest, line
        if "MEAS=1" in rest:
            assert [token[0] for token in rest.split(" ")[2:]] == list("XYZABF"), line
            assert blocks[count].endswith("STOPRE")
        for angle in re.findall(rf"DC\(({number})\)", rest):
            assert 0 <= float(angle) < 360
    opened = len(re.findall(r" IF ", text)), text.count(" WHILE "), text.count(" FOR ")
    assert opened == (text.count("ENDIF"), text.count("ENDWHILE"), text.count("ENDFOR"))
    assert text == PROGRAMS[which](gear_set)


@pytest.mark.parametrize(
    ("machine", "probe", "options", "sentence"),
    [
        ({}, {"tip_radius": 4.0}, {}, r"gear concave flank, row 0, col 0: tip_radius = 4\.0 mm: leaves -.* to the opp"),
        ({}, {"length": 540.0}, {}, r"the height above of the touch: axis Z = .* mm: .* travels -100 to 900 mm"),
        ({}, {}, {"topography": range(200)}, r"^gear: tooth 36 for topography: must be a number from 0 to 35$"),
        ({}, {}, {"topography": (), "pitch": False}, r"gear: there is nothing to probe"),
        ({"pivot_offset": (0.0, 450.0, 0.0)}, {}, {}, r"axis Y = .* mm: .* travels -400 to 400 mm"),
    ],
)
def test_what_cannot_be_probed_is_refused(gear_set, machine, probe, options, sentence):
    with pytest.raises(InputError, match=sentence):
        probing_program(
            gear_set, "gear", MACHINE.model_copy(update=machine), PROBE.model_copy(update=probe), "PROBE", **options
        )


@pytest.mark.parametrize(
    ("name", "sentence"), [("A" * 23, "22 are allowed"), ("1A", "must be letters"), ("CON", "reserved")]
)
def test_names_that_the_control_does_not_take(gear_set, name, sentence):
    with pytest.raises(InputError, match=sentence):
        probing_program(gear_set, "gear", MACHINE, PROBE, name, topography=())


def test_artefacts_out_of_travel_are_refused():
    far = PROBE.sphere.model_copy(update={"center": (-395.0, 150.0, 400.0)})
    with pytest.raises(InputError, match=r"sphere: axis X = -407\.250 to -382\.750 mm: .* travels -400 to 400 mm"):
        calibration_program(MACHINE, PROBE.model_copy(update={"sphere": far}), "CAL")
