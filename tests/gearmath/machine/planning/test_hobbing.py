"""Face hobbing from the program text: the six axes, the blades one by one, and what they leave on the flanks."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import fsolve

from gearmath.bevel.design.route import design
from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.generation_kernels import generation_point
from gearmath.bevel.method import generation_of
from gearmath.bevel.tooth import SHARP_EDGE, tooth_space
from gearmath.bevel.turning import turned
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.lowering import lower
from gearmath.machine.bodies.blades import blades_of
from gearmath.machine.control.executor import execute
from gearmath.machine.judging.collision import collisions
from gearmath.machine.judging.timing import timing
from gearmath.machine.milling.axis_errors import index_errors
from gearmath.machine.milling.blade_removal import removal_by_blades
from gearmath.machine.milling.mill import expose, mill_member
from gearmath.machine.milling.run import runs_of
from gearmath.machine.milling.surfaces import nominal_surfaces, surface_states
from gearmath.machine.planning.clear_space import Room
from gearmath.machine.planning.cut_plan import CuttingJob, tooth_in_roll
from gearmath.machine.planning.hobbing import hobbing_motion
from gearmath.machine.planning.passes import Pass
from gearmath.machine.planning.path import Cut, axis_positions, below_the_flank, flank_points
from gearmath.machine.writing.cutting import cutting_program
from gearmath.machine.writing.program import write_program
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SETTINGS, SIDES, Motion, Settings, load_bevel_set
from gearmath.specs.design import DesignData
from gearmath.specs.simulated_machine import AxisErrors, Harmonic, Mounting, SimulatedMachine, WorkAxis
from gearmath.specs.toml import bundled, checked
from tests.gearmath.machine.milling.flank_borders import left_at_borders

COARSE = 5e-4  # mm
MOTION = Motion(sliding_base=(0.9, -0.5), modified_roll=(0.04, -0.2), radial_distance=(0.3,))


@pytest.fixture(scope="module")
def hobbed():
    return load_bevel_set(bundled("crown_gear_hobbed_14x39.toml"))


@pytest.fixture(scope="module")
def written(hobbed, vertical):
    """``written(member, **job)``: the text of the program of all spaces, coarse unless the job says otherwise."""
    texts = {}

    def text(member, machine=vertical, gear_set=hobbed, **job):
        job = {"tolerance": COARSE, **job}
        key = (member, repr(machine), id(gear_set), *sorted(job.items()))
        if key not in texts:
            spaces = range(gear_set.member(member).teeth)
            texts[key] = cutting_program(gear_set, member, machine, "HOB", CuttingJob(spaces, **job))
        return texts[key]

    return text


@pytest.fixture(scope="module")
def cut(written, hobbed, vertical):
    """``cut(member, errors, **job)``: what the program leaves."""

    files = {}

    def run(member, errors=None, gear_set=hobbed, **job):
        key = (member, errors and errors.model_dump_json(), id(gear_set), *sorted(job.items()))
        if key not in files:
            path = execute(written(member, gear_set=gear_set, **job), "HOB.MPF")
            files[key] = mill_member(path, gear_set.member(member), vertical, errors)
        return files[key]

    return run


def changed(gear_set, name, **update):
    return gear_set.model_copy(update={name: gear_set.member(name).model_copy(update=update)})


def both(member, **update):
    """Both flanks of a member with the same change."""
    return {flank: member.flank(flank).model_copy(update=update) for flank in FLANKS}


def into_work(position, place):
    """Points (n,3) from the cutter centre, in the axes of the machine, in the work: typed from the conventions."""
    A, B = position[:, 3], position[:, 4]
    x, y, z = place.T
    turned = (-np.sin(B) * x + np.cos(B) * z, y, -np.cos(B) * x - np.sin(B) * z)
    c, s = np.cos(A), np.sin(A)
    return np.stack([c * turned[0] - s * turned[1], s * turned[0] + c * turned[1], turned[2]], axis=1)


def main_edge(spec, side):
    """Height and radius of both ends of the straight edge of a blade."""
    top, r = spec.blade_profile_height, spec.blade_point_radius
    return ((0.0, r), (top, r + side * top * math.tan(math.radians(spec.blade_pressure_angle))))


def edge_ends(position, group_angle, spec, edge, pivot_height):
    """The ends (n,3) of a straight edge of a blade in the work, for positions (n,6)."""
    eta, r = math.radians(spec.blade_offset_angle), spec.blade_point_radius
    ends = []
    for h, rho in edge:
        along = rho - r
        x, y = r + along * math.cos(eta), along * math.sin(eta)
        angle, radius = position[:, 5] + group_angle + math.atan2(y, x), math.hypot(x, y)
        where = position[:, :3] + np.column_stack([-radius * np.cos(angle), radius * np.sin(angle), 0 * angle + h])
        ends.append(into_work(position, where - [0, 0, pivot_height]))
    return ends


def brute_force(path, spec, edge, groups, pivot_height, point, normal, start):
    """The smallest distance, from ``start`` on, at which any edge crosses a line: every sign change on fine steps.

    The triple product of edge, line, and what is between them changes its sign there; bisection does the rest.
    """
    every = np.column_stack([path.axes, path.cutter])
    rows = np.flatnonzero(~path.rapid[1:] & np.isfinite(path.cutter[:-1])) + 1
    parts = 2 + int(np.abs(np.diff(path.cutter[rows])).max() / 0.02)
    s = np.tile(np.linspace(0, 1, parts), len(rows))
    first, last = np.repeat(every[rows - 1], parts, axis=0), np.repeat(every[rows], parts, axis=0)
    smallest = np.inf
    for group in range(groups):
        angle = 2 * np.pi * group / groups

        def volume(at, first, last, angle=angle):
            low, high = edge_ends(first + at[:, None] * (last - first), angle, spec, edge, pivot_height)
            return np.sum((high - low) * np.cross(normal, point - low), axis=1)

        values = volume(s, first, last)
        k = np.flatnonzero((values[:-1] * values[1:] <= 0) & (s[1:] > s[:-1]))
        a, b, block = s[k].copy(), s[k + 1].copy(), (first[k], last[k])
        for _ in range(45):
            middle = (a + b) / 2
            same = volume(middle, *block) * values[k] > 0
            a, b = np.where(same, middle, a), np.where(same, b, middle)
        low, high = edge_ends(block[0] + a[:, None] * (block[1] - block[0]), angle, spec, edge, pivot_height)
        for one, other in zip(low, high, strict=True):
            fraction, t = np.linalg.lstsq(np.column_stack([other - one, -normal]), point - one, rcond=None)[0]
            if 0 <= fraction <= 1 and t >= start:
                smallest = min(smallest, t)
    return smallest


@pytest.mark.slow
@pytest.mark.parametrize("member", MEMBERS)
def test_deviation_is_that_of_a_brute_force_sweep_of_every_blade(hobbed, written, cut, vertical, member):
    """A point of the first space and one of another, on each flank: to a tenth of a nanometre."""
    spec, path = hobbed.member(member), execute(written(member), "HOB.MPF")
    file = cut(member)
    for flank in FLANKS:
        chosen = [file.select(flank, 0), file.select(flank, spec.teeth // 3)]
        edge = main_edge(spec.flank(flank), SIDES[flank])
        picks = [(chosen[0], 40), (chosen[1], 0)]
        for part, k in picks:
            point = part.point[k] - part.deviation[k] * part.normal[k]
            found = brute_force(
                path,
                spec.flank(flank),
                edge,
                spec.blade_groups,
                vertical.pivot_height,
                point,
                part.normal[k],
                -1.0,
            )
            assert found == pytest.approx(part.deviation[k], abs=1e-7)


@pytest.mark.parametrize("member", MEMBERS)
def test_all_spaces_are_cut_in_one_roll_within_the_tolerance(cut, hobbed, member):
    file = cut(member)
    assert np.abs(file.deviation).max() <= COARSE
    assert file.deviation.min() > -2e-5  # straight blocks and printed decimals gouge, scallops do not
    for flank in FLANKS:
        assert sorted(set(file.select(flank).tooth.tolist())) == list(range(hobbed.member(member).teeth))


def test_mill_says_where_hobbed_flanks_keep_more_than_the_program_states(command, written, tmp_path):
    """It is made for 0.5 um: the grid within the flanks keeps half of that, their borders most of it."""
    text = written("pinion", tolerance=COARSE)
    (tmp_path / "HOB.MPF").write_text(text.replace("; flank tolerance: 0.5 um", "; flank tolerance: 0.3 um"))
    given = ("crown_gear_hobbed_14x39.toml", "--program", tmp_path / "HOB.MPF", "-o", tmp_path / "left.csv")
    status, out, err = command("mill", *given)
    assert status == 1
    assert float(re.search(r"largest deviation ([0-9.]+) um", out)[1]) < 0.3
    most = re.search(r"the flanks keep up to \+([0-9.]+) um where they end, the program states 0\.3 um: refused", err)
    assert 0.3 < float(most[1]) <= 0.5


DESIGNED = {
    "title": "15 x 41",
    "pinion_teeth": 15,
    "wheel_teeth": 41,
    "outer_transverse_module": 5.0,
    "face_width": 30.0,
    "cutter": {"cutter_radius": 88.0, "process": "face_hobbing", "blade_groups": 13},
    "pinion": {"cutting": "completing"},
}


@pytest.mark.parametrize(
    ("kind", "member", "tolerance"),
    [
        ("bundled", "pinion", 1e-4),
        ("bundled", "gear", COARSE),
        ("bundled", "pinion", 5e-3),
        ("toprem", "gear", 1e-4),
        ("designed", "gear", 1e-3),
    ],
)
def test_border_of_the_flank_to_the_fillet_keeps_the_tolerance_and_needs_it(
    hobbed, written, vertical, host_compiler, kind, member, tolerance
):
    """A blade comes near to it from one side only, so that most is left there; or at the face cone. In some space it is
    nearly all that is allowed.
    """
    gear_set = hobbed if kind != "designed" else design(checked(DESIGNED, DesignData, "a test")).pair
    if kind == "toprem":
        gear_set = changed(hobbed, member, **both(hobbed.member(member), toprem_angle=14.0, toprem_height=1.0))
    spec = gear_set.member(member)
    path = execute(written(member, gear_set=gear_set, tolerance=tolerance), "HOB.MPF")
    highest = left_at_borders(path, spec, vertical).max()
    assert 0.7 * tolerance <= highest <= tolerance


def border_of(flank):
    """The points of a flank where its fillet begins."""
    last = flank.section.index("edge") - 1
    return replace(flank, point=flank.point[last], normal=flank.normal[last])


def turns(text):
    return float(re.search(r"([\d.]+) turns of the work in the roll", text)[1])


def test_scallops_are_parabolas_of_the_approach_of_the_blade(hobbed, written, cut):
    """Of chapter 10 by another solver: t at ±0.005 rad gives c, and the spaces lie anywhere between two passes.

    So they range over the full height c Δθ²/8, with √(4/45) of it as their standard deviation; straight blocks take the
    same from all of them.
    """
    member, path = hobbed.gear, execute(written("gear"), "HOB.MPF")
    for flank in FLANKS:
        file = cut("gear").select(flank)
        middle = (file.row == 2) & (file.col == 4)
        first = np.flatnonzero(middle)[0]
        point = file.point[first] - file.deviation[first] * file.normal[first]
        normal = file.normal[first]
        c = approach(member, flank, point, normal)
        cutting = ~path.rapid & (path.axes[:, 2] == path.axes[~path.rapid, 2].min())
        rolled = np.hypot(*np.ptp(path.axes[cutting, :2], axis=0))  # a chord of the cradle's circle
        roll = 2 * math.asin(rolled / 2 / member.concave.radial_distance)
        height = c * (roll / turns(written("gear"))) ** 2 / 8
        assert file.deviation[middle].std() == pytest.approx(height * math.sqrt(4 / 45), rel=0.1)
        assert np.ptp(file.deviation[middle]) == pytest.approx(height, rel=0.15)


def approach(member, flank, point, normal):
    """Second derivative by θ of the distance at which the family of chapter 10 crosses a line, by SciPy's solver."""
    from derivations.generation import straight_generation

    how, family = generation_of(member, flank), lower(straight_generation())
    given = (how.settings, how.motion, how.index_ratio, how.blade_offset_angle, how.side)
    conditions = np.zeros((1, 2, 4))
    conditions[0, 0, 1], conditions[0, 0, 3] = 1.0, point[2]
    conditions[0, 1, 2], conditions[0, 1, 3] = 1.0, np.hypot(point[0], point[1])
    (start,) = kernel("contact_start")(how.settings, how.side, point[2:3], np.hypot(point[:1], point[1:2]))
    contact, found, *_ = generation_point(False)(start, *given, True, conditions)
    np.testing.assert_allclose(found[0], point, atol=1e-7)
    u, beta, theta = contact[0]

    def distance(at):
        def off(w):
            return family(w[0], w[1], at, *given)[0] - point - w[2] * normal

        return fsolve(off, (u, beta, 0.0), xtol=1e-13)[2]

    step = 5e-3
    return (distance(theta + step) - 2 * distance(theta) + distance(theta - step)) / step**2


def test_wrong_sign_of_indexing_is_seen(hobbed, vertical, written):
    """The work turning the wrong way past the blades destroys the teeth, by millimetres."""
    wrong = changed(hobbed, "gear", indexing_sign=-hobbed.gear.indexing_sign)
    path = execute(written("gear", gear_set=wrong), "HOB.MPF")
    assert np.abs(mill_member(path, hobbed.gear, vertical).deviation).max() > 1.0


def test_apex_off_the_b_axis_changes_the_axes_and_not_the_flanks(vertical, hobbed, written):
    shifted = vertical.model_copy(update={"pivot_offset": (12.0, -7.0, 30.0)})
    path = execute(written("gear", shifted), "HOB.MPF")
    assert np.abs(mill_member(path, hobbed.gear, shifted).deviation).max() <= COARSE


def test_cutter_that_turns_the_other_way_cuts_the_same_flanks(vertical, hobbed, written):
    other = vertical.model_copy(update={"cutter_direction": "M4"})
    text = written("gear", other)
    path = execute(text, "HOB.MPF")
    assert np.nanmin(np.diff(path.cutter[~path.rapid])) < -1 < 1 < np.max(np.diff(path.axes[~path.rapid, 3])) + 2
    assert np.abs(mill_member(path, hobbed.gear, other).deviation).max() <= COARSE


@pytest.mark.parametrize("member", MEMBERS)
def test_cutter_and_work_turn_in_their_ratio_on_the_whole_way(hobbed, written, member):
    """13 groups: the work turns by 13/z of the cutter, against it as the sign of A wants; the roll adds a little."""
    path, spec = execute(written(member), "HOB.MPF"), hobbed.member(member)
    cutting = ~path.rapid & ~np.roll(path.rapid, 1)
    dA, dC = (np.diff(values)[cutting[1:]] for values in (path.axes[:, 3], path.cutter))
    down = np.ptp(path.axes[cutting][:5, 0]) == 0
    assert down
    still = np.diff(path.axes[:, 0])[cutting[1:]] == 0  # the plunge: no roll at all
    assert still.sum() >= 10
    ratio = -spec.indexing_sign * spec.blade_groups / spec.teeth
    np.testing.assert_allclose(dA[still], ratio * dC[still], atol=np.radians(1e-6))
    assert (np.abs(dC) < np.pi).all()
    assert (np.abs(dA) < np.pi).all()


@pytest.mark.parametrize("member", MEMBERS)
def test_axes_keep_their_speeds_and_accelerations(vertical, written, member):
    path = execute(written(member), "HOB.MPF")
    cutting = ~path.rapid & ~np.roll(path.rapid, 1)
    limits = vertical.limits(6)
    steps = np.diff(np.column_stack([path.axes, path.cutter]), axis=0)[cutting[1:]]
    seconds = path.seconds[cutting]
    speeds = np.abs(steps) / seconds[:, None]
    assert (speeds <= limits.max_speed * (1 + 1e-5)).all()
    assert speeds[:, 3].max() > 0.99 * limits.max_speed[3]  # 20 rpm of the work is what limits it
    padded = np.vstack([np.zeros(6), steps / seconds[:, None], np.zeros(6)])
    times = np.concatenate([[0], seconds, [0]])
    changes = np.abs(np.diff(padded, axis=0)) / ((times[1:] + times[:-1]) / 2)[:, None]
    assert (changes <= limits.max_acceleration * (1 + 1e-3) + 1e-3).all()


def test_lint(written):
    text = written("pinion", roughing_stock=0.2)
    words = re.compile(
        r"N\d+|G(?:0|1|17|40|54|90|710|93|94)|M(?:5|6|8|9|30)|[XYZ]-?\d+\.\d{5}|B-?\d+\.\d{6}|[AC]=DC\(\d+\.\d{6}\)|"
        r'F\d+\.\d+|T="[A-Z_0-9]+"|D[01]|SPOS=0|G4|G642|SOFT|FFWON|SUPA|TRAFOOF|COMPOF|DIAMOF|TRANS|STOPRE|'
        r"FGROUP\(X,Y,Z\)|SECTION_\d+:|R9[01]=0|(?:OVR|OVRRAP|ACC\[[XYZAB]\])=100|[CO]TOL=0\.\d+"
    )
    assert text.isascii()
    for line in text.splitlines():
        assert len(line) < 250
        if line.startswith(";"):
            continue
        if re.match(r"N\d+ (?:IF |ENDIF$|MSG\(|SETAL\(650\d\d\)$|M0$)", line):
            continue
        tokens = line.split(" ")
        assert all(words.fullmatch(token) for token in tokens), line
        assert not re.search(r"-0\.0+\b", line)
        assert all(0 <= float(value) < 360 for value in re.findall(r"DC\(([^)]*)\)", line))
        if "G93" in tokens:
            assert [token[0] for token in tokens[3:]] == list("XYZABCF"), line
    assert text.index("SPOS=0") < text.index("C=DC(")


def test_writer_reader_writer_gives_the_same_text(hobbed, vertical, written):
    """Positions and times that the reader finds, written again, are the same blocks."""
    text = written("gear")
    path = execute(text, "HOB.MPF")
    rows = np.flatnonzero(~path.rapid)
    axes = np.column_stack([path.axes, path.cutter])[rows]
    label = re.search(r"; section 1: (all spaces.*), tooth 0", text)[1]
    again = write_program(
        "HOB", ["again"], [Pass("GEAR", label, 0, axes, path.seconds[rows][1:])], vertical, 120.0, 40.0, ROOM, 0.0
    )

    def blocks(program):
        return [
            re.sub(r" F[\d.]+$", "", line)
            for line in program.splitlines()
            if not (line.startswith(";") or "$AA_IM[Z]" in line or "raise Z by hand" in line)
        ]

    assert blocks(again) == blocks(text)


@pytest.mark.parametrize(
    ("job", "sentence"),
    [
        ({"spaces": (0,)}, r"^gear: spaces = \[0\]: face hobbing cuts all spaces in one roll: it must be all 39$"),
        ({"tolerance": 0.0}, r"^tolerance = 0 um: must lie between 0\.01 and 100 um"),
        (
            {"tolerance": 1e-5},
            r"^tolerance = 0\.01 um: must lie between 0\.015 and 100 um; .* alone may take 0\.013 um$",
        ),
        ({"spindle_rpm": 1.0}, r"^HOB: spindle speed = 1\.0 rpm"),
        ({"spindle_rpm": 0.0}, r"^gear: spindle speed = 0\.0 rpm: must be greater than 0$"),
        ({"spindle_rpm": math.nan}, r"^gear: spindle speed = nan rpm: must be greater than 0$"),
        ({"feed": 0.0}, r"^feed = 0\.0 mm/min: must be greater than 0, and finite$"),
        ({"feed": 0.99}, r"^feed = 0\.99 mm/min: must be at least 1 mm/min$"),
    ],
)
def test_faulty_jobs_are_refused(hobbed, vertical, job, sentence):
    with pytest.raises(InputError, match=sentence):
        cutting_program(hobbed, "gear", vertical, "HOB", CuttingJob(**{"spaces": range(39), **job}))


def test_a_roll_of_more_turns_than_a_program_may_have_is_refused(hobbed, vertical):
    """Slower than any job may be: what a long roll of a large gear would need."""
    (cut,) = Cut.of(hobbed.gear)
    tooth = tooth_in_roll(hobbed.gear, cut)
    with pytest.raises(
        InputError, match=r"^gear: feed = 0\.0001 mm/min: .* turns of the work in the roll, 20000 at most$"
    ):
        hobbing_motion(hobbed.gear, cut, vertical, 1e-4, 1e-4, 120.0, 0.0, 200.0, tooth)


def with_axes(machine, **axes):
    return machine.model_copy(update={"axes": machine.axes.model_copy(update=axes)})


def test_machine_without_c_is_refused(hobbed, vertical):
    with pytest.raises(
        InputError, match=r"^gear: is face hobbed, which turns the cutter as the sixth axis C: .*\[axes.C\]"
    ):
        cutting_program(hobbed, "gear", with_axes(vertical, C=None), "HOB", CuttingJob(range(39)))


def test_counting_axis_that_cannot_turn_on_is_refused_with_axis_value_and_limit(hobbed, vertical):
    short = vertical.axes.C.model_copy(update={"modulo": False, "travel": (-360.0, 7200.0)})
    with pytest.raises(InputError, match=r"^gear, all spaces.*: axis C = .* degrees at cradle angle .* -360 to 7200"):
        cutting_program(hobbed, "gear", with_axes(vertical, C=short), "HOB", CuttingJob(range(39), COARSE))


def test_counting_c_is_written_as_it_counts(hobbed, vertical, written):
    long = vertical.axes.C.model_copy(update={"modulo": False, "travel": (-360.0, 720_000.0)})
    text = written("gear", with_axes(vertical, C=long))
    assert "C=DC" not in text
    path = execute(text, "HOB.MPF")
    same = execute(written("gear"), "HOB.MPF")
    assert np.nanmax(path.cutter) - np.nanmin(path.cutter) > 100
    assert np.abs(mill_member(path, hobbed.gear, vertical).deviation).max() <= COARSE
    assert len(path.axes) <= len(same.axes)


def test_program_of_the_other_method_is_refused(hobbed, gear_set, vertical, written):
    milled = execute(cutting_program(gear_set, "gear", vertical, "GEAR", CuttingJob((0,), COARSE)), "GEAR.MPF")
    with pytest.raises(InputError, match=r"line \d+ cuts while the spindle is no axis C; the gear is face hobbed"):
        mill_member(milled, hobbed.gear, vertical)
    path = execute(written("gear"), "HOB.MPF")
    with pytest.raises(InputError, match=r"turns the cutter as axis C; the gear is face milled"):
        mill_member(path, gear_set.gear, vertical)


ROOM = Room(0.0, 0.0, 0.0)
HEAD = 'G17 G40 G90 G710 G94 G54\nT="GEAR" D1\nM6\n'


@pytest.mark.parametrize(
    ("lines", "sentence"),
    [
        ("G0 Z5 C=DC(3)", r"P, line 4, column 7: C=DC\(3\): C is an axis only after SPOS"),
        ("S100 M3\nG0 C3", r"P, line 5, column 4: C3: C is an axis only after SPOS"),
        ("SPOS=0\nG0 C=DC(360)", r"line 5, column 4: C=DC\(360\) is out of range"),
        ("SPOS=0\nG0 C=DC(3)\nG0 C5", r"line 6, column 4: C5: C is counted on in one block and modulo in another"),
        (
            "SPOS=0\nG0 X0 Y0 Z0 A0 B0\nG93 G1 C=DC(3) F1",
            r"line 6, column 8: cutting move from an unknown position of C",
        ),
        ("SPOS=0\nG0 X0 Y0 Z0 A0 B0 C=DC(0)\nG94 G1 C=DC(3) F1", r"line 6, column 8: G94 with C turning"),
        ("SPOS=0\nG0 X0 Y0 Z0 A0 B0 C=DC(0)\nG93 G1 C=DC(180) F1", r"line 6, column 8: C turns by exactly 180"),
    ],
)
def test_reader_refuses_what_c_must_not_do(lines, sentence):
    with pytest.raises(InputError, match=sentence):
        execute(f"{HEAD}{lines}\nM30\n", "P")


def test_reader_counts_c_on_and_forgets_it_when_the_spindle_turns_free():
    lines = "SPOS=0\nG0 X0 Y0 Z0 A=DC(0) B0 C=DC(350)\nG93 G1 C=DC(100) F1\nG93 G1 C=DC(210) A=DC(10) F1\n"
    path = execute(f"{HEAD}{lines}S100 M3\nG0 Z9\nM5\nM30\n", "P")
    np.testing.assert_allclose(np.degrees(path.cutter[:3]), [350, 460, 570])
    assert np.isnan(path.cutter[3])


def test_roughing_leaves_its_stock_and_finishing_takes_it(hobbed, vertical, written):
    text = written("gear", roughing_stock=0.2)
    path = execute(text, "HOB.MPF")
    number = np.cumsum(path.rapid & np.roll(~path.rapid, 1))  # a retract ends a stage
    rough = replace(
        path,
        **{
            key: getattr(path, key)[number == 0] if key != "tools" else path.tools
            for key in ("axes", "rapid", "tool", "tools", "line", "seconds", "rpm", "measuring", "cutter")
        },
    )
    left = mill_member(rough, hobbed.gear, vertical).deviation
    assert left.min() == pytest.approx(0.2, abs=1e-3)
    assert left.max() < 0.2 + 0.02  # coarse: a part of the stock
    assert np.abs(mill_member(path, hobbed.gear, vertical).deviation).max() <= COARSE


def test_dry_run_cuts_air(hobbed, vertical, written):
    path = execute(written("gear", dry_run=True), "HOB.MPF")
    with pytest.raises(InputError, match="uncut"):
        mill_member(path, hobbed.gear, vertical)


def shop(**errors):
    return SimulatedMachine(title="test", seed=1, **errors)


def test_offset_of_z_leaves_the_cone_that_far_off_everywhere(cut):
    """Withdrawn along its axis by d, a straight blade leaves d sin α: both flanks, whatever the scallops."""
    low, high = cut("gear"), cut("gear", shop(axes=AxisErrors(Z=0.05)))
    np.testing.assert_allclose(high.deviation - low.deviation, 0.05 * math.sin(math.radians(20)), atol=2e-4)


def test_offset_of_a_turns_every_tooth_alike(cut):
    """By ε about z_w: ε (z_w × p) · n."""
    turn = 0.01
    low, high = cut("gear"), cut("gear", shop(axes=AxisErrors(A=turn)))
    nominal = low.point - low.deviation[:, None] * low.normal
    expected = math.radians(turn) * np.cross([0, 0, 1], nominal)
    np.testing.assert_allclose(high.deviation - low.deviation, np.sum(expected * low.normal, axis=1), atol=2e-4)


def test_eccentric_work_shows_its_first_harmonic_in_the_pitch(cut, hobbed):
    low, high = cut("gear"), cut("gear", shop(mounting=Mounting(eccentricity=0.03, eccentricity_direction=40.0)))
    off = (high.deviation - low.deviation)[(low.row == 2) & (low.col == 4) & (low.flank == "concave")]
    normal = low.normal[(low.row == 2) & (low.col == 4) & (low.flank == "concave")]
    direction = np.array([np.cos(np.radians(40.0)), np.sin(np.radians(40.0)), 0.0])
    np.testing.assert_allclose(off, -0.03 * normal @ direction, atol=3e-4)
    assert np.ptp(off) > 0.03


def test_uneven_division_of_a_is_seen(cut):
    error = shop(axes=AxisErrors(A_harmonics=(Harmonic(order=1, amplitude_arcsec=60.0),)))
    low, high = cut("gear"), cut("gear", error)
    off = (high.deviation - low.deviation)[(low.row == 2) & (low.col == 4)]
    assert 0.5 < np.ptp(off) / (2 * 60 / 3600 * math.pi / 180 * 76.5 * math.cos(math.radians(20))) < 1.1


def test_index_errors_of_the_work_axis_become_pitch(cut, hobbed):
    """Space k is cut where the work stands k pitches on, less those that the cutter turns it by up to the contact."""
    axis = WorkAxis(first_harmonic_arcsec=45.0, first_harmonic_phase=30.0, random_arcsec=6.0)
    low, high = cut("gear"), cut("gear", shop(work_axis=axis))
    table = index_errors(axis, 39, 1)
    for flank in FLANKS:
        middle = (low.row == 2) & (low.col == 4) & (low.flank == flank)
        beta = solve_flank(hobbed.gear, flank, blank_grid(hobbed.gear)).contact[2 * 9 + 4, 1]
        pitches = (low.tooth[middle] - hobbed.gear.indexing_sign * 13 * beta / (2 * math.pi)) % 39
        error = np.interp(pitches, np.arange(40), np.append(table, table[0]))
        nominal = low.point[middle] - low.deviation[middle, None] * low.normal[middle]
        lever = np.sum(np.cross([0, 0, 1], nominal) * low.normal[middle], axis=1)
        assert np.ptp(error * lever) > 0.02  # mm
        np.testing.assert_allclose((high.deviation - low.deviation)[middle], error * lever, atol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["formate", "motion", "tilt"])
def test_other_kinds_of_face_hobbing_are_cut_to_tolerance(hobbed, cut, kind):
    """Formate; settings that move with the cradle; a tilted cutter: each against its own flanks of chapter 10."""
    member = hobbed.gear if kind == "formate" else hobbed.pinion
    update = {
        "formate": {"generation": "formate"},
        "motion": both(member, motion=MOTION),
        "tilt": both(member, cutter_tilt=2.0, cutter_swivel=60.0),
    }[kind]
    name = "gear" if kind == "formate" else "pinion"
    file = cut(name, gear_set=changed(hobbed, name, **update), tolerance=1e-4)
    assert np.abs(file.deviation).max() <= 1e-4


SETTING_ERRORS = {"radial_distance": 0.02, "sliding_base": -0.01, "machine_root_angle": 0.01, "cutter_tilt": 0.05}


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["hobbed, moving", "moving", "formate"])
def test_setting_errors_act_like_cutting_with_those_settings(hobbed, gear_set, vertical, kind):
    """Both from program texts: a right program on a wrong machine, and a program of wrong settings on a right one.

    Ratio of roll and work rotation offset have to show in A, swivel and tilt in C.
    """
    given = hobbed if kind.startswith("hobbed") else gear_set
    wrong = {**SETTING_ERRORS, "cutter_swivel": 0.1, "ratio_of_roll": 1e-4, "work_rotation_offset": 0.02}
    update = both(given.gear, motion=MOTION) if "moving" in kind else {}
    if kind == "formate":
        update, wrong = {"generation": "formate"}, {**wrong, "ratio_of_roll": 0.0}
    right = changed(given, "gear", **update)
    gear = right.gear
    off = {
        flank: gear.flank(flank).model_copy(
            update={
                **{key: getattr(gear.flank(flank), key) + value for key, value in wrong.items()},
                "design": Settings(**{key: getattr(gear.flank(flank), key) for key in SETTINGS}),
            }
        )
        for flank in FLANKS
    }
    spaces = range(39) if kind.startswith("hobbed") else (0,)
    errors = shop(gear=wrong)
    sets, job = (right, changed(right, "gear", **off)), CuttingJob(spaces, 3e-4)
    paths = [execute(cutting_program(one, "gear", vertical, "CUT", job), "CUT.MPF") for one in sets]
    injected = mill_member(paths[0], gear, vertical, errors)
    meant = mill_member(paths[1], gear, vertical)
    assert np.abs(meant.deviation).max() > 5e-3
    np.testing.assert_allclose(injected.deviation, meant.deviation, rtol=0, atol=6e-4)


@pytest.mark.slow
@pytest.mark.parametrize("member", MEMBERS)
def test_report_finds_no_fault_in_a_right_program_and_times_c(hobbed, written, vertical, host_compiler, member):
    """Flanks down to their fillets within 0.1 µm, no gouge anywhere; a fillet of 0.02 mm keeps scallops of some µm."""
    path = execute(written(member, tolerance=1e-4), "HOB.MPF")
    spec = hobbed.member(member)
    space = tooth_space(spec, 5)
    states = surface_states(path, spec, vertical, spaces=(0, spec.teeth - 1), columns=5, space=space)
    assert len(states) == 10
    for state in states:
        assert state.lowest > -1e-5, state
        assert state.highest < (5e-3 if "fillet" in state.surface else 1e-4), state
        assert state.line > 0
    runs = runs_of(path, spec, vertical, None, space, SHARP_EDGE)
    assert collisions(path, runs, spec, vertical) == []
    C = timing(path, vertical).axes[-1]
    assert C.axis == "C"
    assert C.speed_per_min == pytest.approx(7200.0 * spec.teeth / 13, rel=0.01)  # A is at its limit


def test_tip_that_is_too_deep_is_seen_in_fillet_and_root(hobbed, written, vertical, host_compiler):
    """A blade 0.05 mm longer than the member's: its Z lies that much lower, and so does the root."""
    path = execute(written("gear"), "HOB.MPF")
    deeper = replace(path, axes=path.axes - np.array([0, 0, 0.05, 0, 0]))
    states = surface_states(deeper, hobbed.gear, vertical, spaces=(3,), columns=5)
    found = {state.surface: state for state in states}
    assert found["root"].lowest == pytest.approx(-0.05, abs=2e-3)
    assert found["concave flank"].lowest == pytest.approx(-0.05 * math.sin(math.radians(20)), abs=1e-3)
    assert found["convex fillet"].lowest < -0.02


def test_rounded_edges_are_cut_without_gouge(hobbed, written, vertical, host_compiler):
    """With an edge radius of 0.4 mm the fillets keep lower scallops than sharp ones."""
    other = changed(hobbed, "gear", **both(hobbed.gear, blade_edge_radius=0.4))
    highest = []
    for gear_set in (hobbed, other):
        path = execute(written("gear", gear_set=gear_set, tolerance=3e-4), "HOB.MPF")
        states = surface_states(path, gear_set.gear, vertical, spaces=(1,), columns=5)
        assert min(state.lowest for state in states) > -2e-5
        highest.append(max(state.highest for state in states if "fillet" in state.surface))
    assert highest[1] < highest[0] / 2


def test_toprem_takes_away_what_its_own_edge_sweeps(hobbed, written, vertical, host_compiler):
    """A protuberance undercuts the flank above it; at the deepest place as the brute-force sweep of its edge says."""
    other = changed(hobbed, "gear", **both(hobbed.gear, toprem_angle=14.0, toprem_height=1.0))
    spec, path = other.gear.concave, execute(written("gear", gear_set=other), "HOB.MPF")
    space = tooth_space(other.gear, 5)
    flank = nominal_surfaces(other.gear, space)[0]
    (run,) = runs_of(path, other.gear, vertical, None, space, SHARP_EDGE)
    left = expose([run], vertical, None, flank.point, flank.normal, flank.start).distance
    deepest = int(np.argmin(left))
    assert left[deepest] < -0.01
    radius = spec.blade_point_radius + math.tan(math.radians(20)) - math.tan(math.radians(14))
    edge = ((0.0, radius), (1.0, radius + math.tan(math.radians(14))))
    found = brute_force(path, spec, edge, 13, vertical.pivot_height, flank.point[deepest], flank.normal[deepest], -1.0)
    assert left[deepest] == pytest.approx(found, abs=1e-7)


def test_arc_blades_are_cut_to_tolerance(hobbed, cut):
    update = both(hobbed.gear, blade_spheric_radius=800.0, blade_reference_height=4.0)
    file = cut("gear", gear_set=changed(hobbed, "gear", **update), tolerance=2e-4)
    assert np.abs(file.deviation).max() <= 2e-4


def test_program_of_the_mate_is_refused(hobbed, written, vertical):
    path = execute(written("gear"), "HOB.MPF")
    with pytest.raises(InputError, match=r'the program cuts with T="GEAR"; the pinion is cut with PINION'):
        mill_member(path, hobbed.pinion, vertical)


def test_slow_cutter_spindle_makes_the_program_slower_and_a_faster_pass_is_refused(hobbed, vertical, written):
    slow = with_axes(vertical, C=vertical.axes.C.model_copy(update={"max_speed_per_min": 3600.0}))
    path = execute(written("gear", slow), "HOB.MPF")
    speeds = np.abs(np.diff(path.cutter))[~path.rapid[1:]] / path.seconds[1:][~path.rapid[1:]]
    assert np.nanmax(speeds) <= math.radians(60.0) * (1 + 1e-5)  # 10 rpm
    quick = np.zeros((2, 6))
    quick[1, 5] = 2.0
    one = Pass("GEAR", "quick", 0, quick, np.array([1.0]))
    with pytest.raises(InputError, match=r"axis C = 6875\.5 degrees/min in block 0: .* allows 3600 degrees/min"):
        write_program("HOB", [], [one], slow, 120.0, 40.0, ROOM, 0.0)
    quick[1, 5] = 4.0
    with pytest.raises(InputError, match=r"axis C turns 229\.183118 degrees in block 0: must be less than 180"):
        write_program("HOB", [], [replace(one, seconds=np.array([100.0]))], slow, 120.0, 40.0, ROOM, 0.0)
    with pytest.raises(InputError, match=r"axis C: .* has none"):
        write_program("HOB", [], [one], with_axes(vertical, C=None), 120.0, 40.0, ROOM, 0.0)


def test_command_line_writes_and_mills(tmp_path, command):
    program, flanks = tmp_path / "HOB.MPF", tmp_path / "hob.csv"
    given = ("crown_gear_hobbed_14x39.toml", "--member", "gear")
    status, out, err = command("nc", "cut", *given, "--tolerance-um", "2", "-o", program)
    assert (status, err) == (0, "")
    assert "39 of 39 spaces" in out
    status, out, err = command("mill", *given, "--program", program, "-o", flanks)
    assert (status, err) == (0, ""), err
    assert float(re.search(r"largest deviation ([\d.]+) um", out)[1]) <= 2.0
    status, out, err = command(
        "mill", *given, "--program", program, "--errors", "simulated_shop.toml", "-o", tmp_path / "shop.csv"
    )
    assert (status, err) == (0, ""), err
    assert float(re.search(r"largest deviation ([\d.]+) um", out)[1]) > 20.0
    status, _, err = command("nc", "cut", *given, "--spaces", "0,1", "-o", tmp_path / "NO.MPF")
    assert status == 2
    assert "face hobbing cuts all spaces in one roll" in err
    assert not (tmp_path / "NO.MPF").exists()


def part_of_roll(text, blocks, x, y):
    """Some blocks of a program, with head and end, and the index of the line in their middle, which ends near x, y."""
    lines = text.split("\n")
    head = ["G17 G40 G90 G94 G710 G54", 'T="GEAR" D1', "M6", "SPOS=0", "M8"]
    cut_lines = [line for line in lines if " G93 " in line]
    ends = np.array([[float(value) for value in re.findall(r" [XY](-?[0-9.]+)", line)] for line in cut_lines])
    nearest = int(np.hypot(*(ends - [x, y]).T).argmin())
    chosen = cut_lines[nearest - blocks // 2 :][: blocks + 1]
    start = re.sub(r"^N\d+ G93 G1 (.*) F\S+$", r"G0 \1", chosen[0])
    return [*head, start, *chosen[1:], "M5 M9", "M30"], len(head) + 1 + blocks // 2


def mutations(line):
    """The line with one digit of one axis word changed, for every digit and every other value."""
    for word in re.finditer(r"(?:[XYZB]|[AC]=DC\()(-?[0-9.]+)", line):
        for at in range(word.start(1), word.end(1)):
            for digit in "0123456789" if line[at].isdecimal() else "":
                if digit != line[at]:
                    yield line[:at] + digit + line[at + 1 :]


@pytest.mark.slow
def test_a_wrong_digit_is_refused_or_seen_on_the_flanks_of_all_spaces(hobbed, written, vertical, host_compiler):
    """Every digit of the six axis words of one block, with every other value.

    What counts is a digit by which an edge, where it finishes a flank in the two blocks that end and begin there, moves
    by more than 1 µm along the normal, or does not come there at all. Seen is what leaves the tolerance of 0.1 µm.
    """
    member = hobbed.gear
    # the border of the convex flank at the heel is what the roll is so slow for: it can spare no turn of the work
    border = next(row for part, row, _ in below_the_flank(member, "convex", np.ones(1)) if part == "main")
    x, y = axis_positions(member.convex, border.contact[:, 2], vertical.pivot_height, vertical.pivot)[0, :2]
    text, changed_line = part_of_roll(written("gear", tolerance=1e-4), 30, x, y)
    path = execute("\n".join(text), "P")
    parts: list = [solve_flank(member, flank, blank_grid(member, 9, 21, 0.05)) for flank in FLANKS]
    space = tooth_space(member, 21)
    parts += [border_of(getattr(space, flank)) for flank in FLANKS]  # most is left there where a visit is missing
    angles = [2 * math.pi * space / 39 for space in range(39)]
    point, normal = (
        np.concatenate([turned(getattr(part, key), angle) for part in parts for angle in angles])
        for key in ("point", "normal")
    )
    blades, pose = blades_of(member, SHARP_EDGE), (vertical.pivot_height, vertical.pivot)

    def left(which, axes, cutter, cutting):
        start = np.full(len(point[which]), -1.0)
        return removal_by_blades(axes, cutter, cutting, blades, pose, point[which], normal[which], start)

    cutting = ~path.rapid
    whole = left(slice(None), path.axes, path.cutter, cutting)
    end = changed_line - 5  # row of the path that the changed line ends at
    assert path.line[end] == changed_line + 1
    touching = np.flatnonzero(np.isin(whole.block, (end, end + 1)) & (whole.distance < 1e-4))
    assert len(touching) > 30
    others = cutting.copy()
    others[[end, end + 1]] = False
    rest = np.nan_to_num(left(touching, path.axes, path.cutter, others).distance, nan=np.inf)
    assert np.isfinite(rest).all()  # other passes come near, so that what is left is no more than their scallops
    three = slice(end - 1, end + 2)
    refusals = demanded = 0
    for line in mutations(text[changed_line]):
        try:
            wrong = execute("\n".join([*text[:changed_line], line, *text[changed_line + 1 :]]), "P")
        except InputError:
            refusals += 1
            continue
        again = left(touching, wrong.axes[three], wrong.cutter[three], np.array([False, True, True])).distance
        moved = again - whole.distance[touching]
        if not (np.isnan(moved) | (np.abs(moved) > 1e-3)).any():
            continue
        demanded += 1
        assert np.abs(np.fmin(rest, again)).max() > 1e-4, line
    assert demanded > 200
    assert refusals > 0


@pytest.mark.parametrize("member", MEMBERS)
def test_place_of_the_tooth_that_the_feed_counts_at_is_on_the_blade_when_it_is_met(hobbed, vertical, member):
    """Seen from the cutter's axis it lies on the cone of the blade, up to the offset of the blade."""
    spec = hobbed.member(member)
    (cut,) = Cut.of(spec)
    flank = spec.flank(cut.flanks[0])
    u, _, theta = flank_points(spec, cut.flanks[0], blank_grid(spec, 1, 1)).contact[0]
    axes = axis_positions(flank, np.array([theta]), vertical.pivot_height, vertical.pivot)
    (seen,) = kernel("seen_from_tool")(axes, tooth_in_roll(spec, cut), vertical.pivot_height, vertical.pivot)
    radius = flank.blade_point_radius + SIDES[cut.flanks[0]] * u * math.tan(math.radians(flank.blade_pressure_angle))
    assert float(np.hypot(*seen[0, :2])) == pytest.approx(radius, abs=0.5)
    assert float(seen[0, 2]) == pytest.approx(u, abs=1e-9)  # the height over the tips at which it is met
