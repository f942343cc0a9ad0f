"""The program that touches a carried sphere: clear of sphere and stem on its whole way, and within the travel."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.machine.control.executor import run_program
from gearmath.machine.writing.axis_cycle import axis_program
from gearmath.specs.calibration import load_calibration
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
OFF_AXIS = MACHINE.model_copy(update={"pivot_offset": (1.5, -2.25, 30.0)})
COUNTING = MACHINE.model_copy(
    update={
        "axes": MACHINE.axes.model_copy(
            update={"A": MACHINE.axes.A.model_copy(update={"modulo": False, "travel": (-10.0, 700.0)})}
        )
    }
)
PROBE = load_calibration(bundled("probe.toml"))
#: How far the stem is looked at.
STEM = 60.0


def from_machine(point, axes, machine):
    """Places (n,3) of the machine, from the B axis, in the work: p_m = M(B) (Rz(-A) p_w + e) backwards."""
    A, B = axes[:, 3], axes[:, 4]
    s, c, o = np.sin(B), np.cos(B), np.zeros(len(B))
    back = np.array([[-s, o, c], [o, o + 1, o], [-c, o, -s]])
    turned = np.einsum("ijn,nj->ni", back, point) - machine.pivot_offset
    s, c = np.sin(A), np.cos(A)
    return np.stack([c * turned[:, 0] - s * turned[:, 1], s * turned[:, 0] + c * turned[:, 1], turned[:, 2]], axis=1)


class Sphere:
    """Stops the tip where it is one radius from the sphere of the file."""

    def __init__(self, machine):
        self.machine = machine

    def __call__(self, start, end):
        first, last = (tips(axes[None], self.machine)[0] - PROBE.work_sphere.place for axes in (start, end))
        way = last - first
        a, b, c = way @ way, first @ way, first @ first - (PROBE.work_sphere.diameter / 2 + PROBE.tip_radius) ** 2
        share = (-b - math.sqrt(b * b - a * c)) / a if b * b > a * c else math.nan
        return start + share * (end - start) if 0 <= share <= 1 else None


def tips(axes, machine, above=0.0):
    """Places (n,3) in the work of what is ``above`` the centre of the tip, on the stylus."""
    return from_machine(axes[:, :3] - [0, 0, machine.gauge_line_height + PROBE.length - above], axes, machine)


@pytest.mark.parametrize("machine", [MACHINE, OFF_AXIS, COUNTING], ids=["plain", "offset", "counting"])
def test_tip_and_stylus_stay_clear_of_sphere_and_stem(machine):
    """Every block in steps of 0.25 mm and 1 degree, A and B turning too."""
    done = run_program(axis_program(machine, PROBE, "AXES"), "AXES.MPF", Sphere(machine))
    assert done.alarm is None
    assert done.files["AXES_T"].count("work_sphere") == 81
    sphere, path = PROBE.work_sphere, done.path
    touching, moving = [], []
    # a touch is a measuring block from which the next one goes back to where it began
    touch = path.measuring.copy()
    touch[1:-1] &= np.isclose(path.axes[2:], path.axes[:-2], rtol=0.0, atol=1e-9).all(axis=1)
    assert touch.sum() == 81
    for k in range(1, len(path.axes)):
        change = path.axes[k] - path.axes[k - 1]
        steps = 2 + int(max(np.linalg.norm(change[:3]) / 0.25, np.degrees(np.abs(change[3:])).max()))
        axes = path.axes[k - 1] + np.linspace(0, 1, steps)[:, None] * change
        for above in (0.0, 2.0, 5.0, 10.0, 20.0, PROBE.stylus_length):
            off = tips(axes, machine, above) - sphere.place
            own = PROBE.tip_radius if above == 0.0 else PROBE.stylus_radius
            from_sphere = np.linalg.norm(off, axis=1) - sphere.diameter / 2 - own
            on_stem = off - np.clip(off[:, 2], 0.0, STEM)[:, None] * [0.0, 0.0, 1.0]
            from_stem = np.linalg.norm(on_stem, axis=1) - sphere.stem_diameter / 2 - own
            assert from_stem.min() > 0.9
            ends = (touch[k] or touch[k - 1]) and above == 0.0
            (touching if ends else moving).append(from_sphere.min())
    assert min(touching) > -1e-6
    assert min(moving) > 0.2


def test_axes_turn_only_above_everything():
    done = run_program(axis_program(MACHINE, PROBE, "AXES"), "AXES.MPF", Sphere(MACHINE))
    turning = np.abs(np.diff(done.path.axes[:, 3:], axis=0)).max(axis=1) > 1e-9
    assert turning.sum() == 9 - 1
    reach = np.linalg.norm(PROBE.work_sphere.place) + 10.0
    lowest = done.path.axes[1:, 2][turning] - MACHINE.gauge_line_height - PROBE.length - PROBE.tip_radius
    assert (lowest > reach).all()


@pytest.mark.parametrize(
    ("machine", "sphere", "sentence"),
    [
        ({}, {"radius": 340.0}, r"work_sphere: axis Z = .* mm: Vertical 5-axis machine travels -100 to 900 mm"),
        ({"pivot_offset": (0.0, 330.0, 0.0)}, {}, r"work_sphere: axis Y = .* to 411\.532 mm: .* travels -400 to 400"),
    ],
)
def test_sphere_out_of_travel_is_refused(machine, sphere, sentence):
    probe = PROBE.model_copy(update={"work_sphere": PROBE.work_sphere.model_copy(update=sphere)})
    with pytest.raises(InputError, match=sentence):
        axis_program(MACHINE.model_copy(update=machine), probe, "AXES")
