"""From wherever the axes stand, and whatever the control has active: up to its first cut no program touches anything.

Work and tool are typed here afresh, from the blank and the machine file: the work as points on what its face cone, its
back and its fixture sweep about the work axis, the tool as a column of its widest radius from its tip upwards. Every
motion is followed in steps of 3 mm and 1 degree.
"""

from __future__ import annotations

import itertools
import math
import re
from functools import cache

import numpy as np
import pytest

from gearmath.machine.control.executor import run_program
from gearmath.machine.control.state import Setup
from gearmath.machine.planning.cut_plan import CuttingJob, cutting_plan
from gearmath.machine.writing.axis_cycle import axis_program
from gearmath.machine.writing.calibrating import calibration_program
from gearmath.machine.writing.cutting import cutting_program
from gearmath.machine.writing.linuxcnc.cutting import program_of as linuxcnc_program
from gearmath.machine.writing.linuxcnc.probe_words import LinuxCncBlocks
from gearmath.machine.writing.linuxcnc.probing import LINUXCNC
from gearmath.machine.writing.probe_words import Blocks
from gearmath.machine.writing.probing import SINUMERIK, probing_program
from gearmath.specs.bevel_set import MEMBERS, load_bevel_set
from gearmath.specs.calibration import load_calibration
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
COUNTING = MACHINE.model_copy(
    update={
        "axes": MACHINE.axes.model_copy(
            update={"A": MACHINE.axes.A.model_copy(update={"modulo": False, "travel": (-720.0, 7200.0)})}
        )
    }
)
SHIFTED = MACHINE.model_copy(update={"z_reference": "tip", "work_offset_values": (-250.0, 12.5, -900.0, 5.0, 0.25)})
PROBE = load_calibration(bundled("probe.toml"))
SETS = (
    "nasa_tp3096_12x36",
    "spiral_7x43",
    "crown_gear_universal_14x39",
    "crown_gear_formate_14x39",
    "crown_gear_hobbed_14x39",
)
#: Programs that touch a work, and all that have a probe.
PROBING = ("probing", "again", "linuxcnc probing")
TOUCHING = (*PROBING, "calibration", "axes", "linuxcnc calibration", "linuxcnc axes")
#: Starts of a program; a program that differs from others of the list by its pattern or its blocks alone has the few.
STARTS, FEW_STARTS = 32, 12
_STEP_MM, _STEP_DEG = 3.0, 1.0


@cache
def gear_set(name):
    return load_bevel_set(bundled(f"{name}.toml"))


@cache
def text_of(name, member, kind):
    one, machine = gear_set(name), {"counting": COUNTING, "shifted": SHIFTED}.get(kind, MACHINE)
    spaces = range(one.member(member).teeth) if one.member(member).process == "face_hobbing" else (0, 1)
    if kind in PROBING:
        writer = LINUXCNC if kind == "linuxcnc probing" else SINUMERIK
        return machine, probing_program(one, member, machine, PROBE, "START", topography=(), writer=writer)
    if kind == "linuxcnc":
        return machine, linuxcnc_program(cutting_plan(one, member, machine, CuttingJob(spaces, 1e-2)), "START")
    if "calibration" in kind:
        return machine, calibration_program(machine, PROBE, "START", LinuxCncBlocks if "linuxcnc" in kind else Blocks)
    if "axes" in kind:
        return machine, axis_program(machine, PROBE, "START", LinuxCncBlocks if "linuxcnc" in kind else Blocks)
    blocks = "poly" if kind == "poly" else CuttingJob.blocks
    return machine, cutting_program(one, member, machine, "START", CuttingJob(spaces, 1e-2, blocks=blocks))


def work_points(member):
    """Points (n,3) all around the work axis: face cone with its ends, back, shank and fixture."""
    blank, delta = member.blank, math.radians(member.blank.pitch_angle)
    face = math.radians(blank.face_angle)
    middle, width = blank.mean_cone_distance, blank.face_width
    outer = middle + width / 2
    corners = []
    for distance in (outer - width, outer):
        up = blank.mean_addendum + (distance - middle) * math.tan(face - delta)
        z, r = distance * math.cos(delta) - up * math.sin(delta), distance * math.sin(delta) + up * math.cos(delta)
        corners.append((z, r))
    depth = blank.mean_addendum + blank.mean_dedendum
    root = np.add(corners[1], 2 * depth * np.array([math.sin(delta), -math.cos(delta)]))
    fixture = MACHINE.fixture
    shank = 0.5 * root[1]
    end = root[0] + fixture.shank_length
    profile = [
        (corners[0][0], 0.0),
        *corners,
        tuple(root),
        (root[0], shank),
        (end, shank),
        (end, fixture.radius),
        (end + fixture.length, fixture.radius),
    ]
    dense = np.concatenate([np.linspace(a, b, 2 + int(math.dist(a, b) / 4.0)) for a, b in itertools.pairwise(profile)])
    angle = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    z, r = (np.repeat(column, len(angle)) for column in dense.T)
    return np.column_stack([r * np.cos(np.tile(angle, len(dense))), r * np.sin(np.tile(angle, len(dense))), z])


def sphere_points(sphere):
    """Points (n,3) on what the sphere on the work side sweeps about the work axis, with 40 mm of its stem."""
    around, angle = np.meshgrid(*(np.linspace(0, 2 * np.pi, n, endpoint=False) for n in (24, 72)))
    z, r = sphere.diameter / 2 * np.cos(around), sphere.diameter / 2 * np.sin(around)
    stem = np.linspace(0, 40, 24)[None].repeat(len(angle), axis=0)
    axial = sphere.axial + np.concatenate([z, stem])
    radius = sphere.radius + np.concatenate([r, np.full_like(stem, sphere.stem_diameter / 2)])
    turned = np.concatenate([angle, angle])
    return np.stack([radius * np.cos(turned), radius * np.sin(turned), axial], axis=-1).reshape(-1, 3)


def meets(points, positions, columns):
    """Whether any of the work is in the columns of the tool at positions X Y Z A B (n,5) in mm and rad.

    Each column has a length below the gauge line and a radius, and goes up from there without end.
    """
    longest, widest = np.max(columns, axis=0)
    across = points[:, 1]
    for b in np.unique(positions[:, 4]):
        level = points[:, 0] * math.cos(b) - points[:, 2] * math.sin(b)
        forward = -points[:, 0] * math.sin(b) - points[:, 2] * math.cos(b)
        x, y, z = positions[positions[:, 4] == b, :3].T
        # the columns reach no point where all of the work is below them, or to one side
        beside = np.maximum(
            np.abs(x - x.clip(forward.min(), forward.max())), np.abs(y - y.clip(across.min(), across.max()))
        )
        near = (level.max() - (z - MACHINE.gauge_line_height) > -longest) & (beside < widest)
        for at_x, at_y, at_z in zip(x[near], y[near], z[near], strict=True):
            aside, above = np.hypot(forward - at_x, across - at_y), level - (at_z - MACHINE.gauge_line_height)
            if any(((aside < radius) & (above > -length)).any() for length, radius in columns):
                return True
    return False


def followed(first, last):
    steps = 2 + int(max(np.abs(last - first)[:3].max() / _STEP_MM, np.degrees(np.abs(last - first)[4]) / _STEP_DEG))
    return first + np.linspace(0, 1, steps)[:, None] * (last - first)


def columns_of(member, kind, table_length):
    """The tool: a stylus with the spindle over it, or a cutter as wide as its 60 mm long blades spread.

    It is as long as it should be, or as the tool table says if that is more.
    """
    spindle = MACHINE.cutter_head.spindle_radius
    if kind in TOUCHING:
        more = max(table_length - PROBE.length, 0.0)
        return [(PROBE.length + PROBE.tip_radius + more, PROBE.tip_radius), (more, spindle)]
    flanks = (member.concave, member.convex)
    reach = max(one.blade_point_radius + 60.0 * math.tan(math.radians(one.blade_pressure_angle)) for one in flanks)
    return [(max(MACHINE.tool_length, table_length), max(reach + 2.0, spindle))]


def random_setup(random, machine, tool_names):
    """A position within the travel, some tool of some length, tables that are right or wrong."""
    low, high = machine.travel.T
    low, high = np.where(np.isfinite(low), low, 0.0), np.where(np.isfinite(high), high, 2 * np.pi)
    place = random.uniform(low, high)
    place[3:] = np.degrees(place[3:])
    zero = np.array(machine.work_offset_values)
    change = np.array([*random.uniform(-300, 300, 2), random.uniform(800, 900), 0.0, random.uniform(-10, 100)])
    right = Setup.of(machine, PROBE.length)
    tool_length = random.choice([right.tool_length] * 3 + [0.0, 150.0, 300.0])
    raised = tuple((zero + np.eye(5)[2] * 150.0).tolist())
    return Setup(
        zero=right.zero,
        offset=right.offset if random.random() < 0.8 else raised,
        tool_length=float(tool_length),
        probe_length=right.probe_length,
        position=tuple((place + zero).tolist()),
        turned=(0.0, 0.0, 0.0) if random.random() < 0.9 else (0.0, 0.0, 3.0),
        tool=str(random.choice([*tool_names, "DRILL"])),
        changed_at=tuple((change + zero).tolist()),
    )


CASES = [
    *((name, member, "cutting") for name in SETS for member in MEMBERS),
    *((name, member, "probing") for name in SETS for member in MEMBERS),
    *((name, member, "linuxcnc") for name in SETS for member in MEMBERS),
    *(("nasa_tp3096_12x36", member, "linuxcnc probing") for member in MEMBERS),
    ("nasa_tp3096_12x36", "pinion", "counting"),
    ("nasa_tp3096_12x36", "gear", "shifted"),
    ("nasa_tp3096_12x36", "pinion", "calibration"),
    ("nasa_tp3096_12x36", "gear", "again"),
    ("nasa_tp3096_12x36", "pinion", "axes"),
]
#: Where a few starts are enough.
FEW = [
    ("nasa_tp3096_12x36", "pinion", "linuxcnc calibration"),
    ("nasa_tp3096_12x36", "pinion", "linuxcnc axes"),
    *((name, member, "linuxcnc probing") for name in SETS[1:] for member in MEMBERS),
    *((name, member, "poly") for name in SETS[:3] for member in MEMBERS),
    ("crown_gear_formate_14x39", "pinion", "poly"),
]


@pytest.mark.slow
@pytest.mark.parametrize("number", range(len(CASES + FEW)), ids=lambda k: "-".join((CASES + FEW)[k]))
def test_nothing_is_touched_before_the_first_cut_or_the_program_stops(number):
    name, member, kind = (CASES + FEW)[number]
    starts = STARTS if number < len(CASES) else FEW_STARTS
    spec = gear_set(name).member(member)
    machine, text = text_of(name, member, kind)
    points = sphere_points(PROBE.work_sphere) if "axes" in kind else work_points(spec)
    random, stopped, clear, tried = np.random.default_rng(number), 0, 0, 0
    names = re.findall(r'T="(\w+)"|^; tool T\d+: (\w+)', text, re.MULTILINE)
    names = [one or other for one, other in names]
    while stopped + clear < starts:
        setup = random_setup(random, machine, names)
        start = (np.array(setup.position) - setup.zero) * [1, 1, 1, np.pi / 180, np.pi / 180]
        tried += 1
        columns = columns_of(spec, kind, setup.tool_length)
        if meets(points, start[None], columns):
            continue  # no program can begin in the metal
        begun = {90: int(random.integers(2, 14))} if kind == "again" else {}  # a program that is continued
        run = run_program(text, "START", lambda a, b: None, setup=setup, parameters=begun)
        rows = run.path.axes
        missed = kind in TOUCHING and run.alarm is not None and "touched nothing" in run.messages[-1]
        if run.alarm is not None and not missed:
            assert len(rows) <= 3, run.messages  # at most Z has gone home
            stopped += 1
        else:
            clear += 1
        # a probe comes down from home and goes sideways in measuring blocks, then into a space
        cutting = np.flatnonzero(~run.path.rapid)[2 if kind in PROBING else 0 :]
        first_cut = int(cutting[0]) if len(cutting) else len(rows)
        before = start
        for k in range(first_cut):
            here = rows[k]
            if k == 2 and kind in TOUCHING:
                # the probe has been fetched, and its length compared: what was in the spindle before is not there now
                columns = columns_of(spec, kind, 0.0)
            if k > 0 and run.path.tool[k] != run.path.tool[k - 1]:
                before = None  # the change itself is the machine's
            if before is not None:
                assert not meets(points, followed(before, here), columns), (k, before, here)
            before = here
            if k == 0:
                assert here[2] >= start[2] - 1e-9  # never down first
                assert here[[0, 1, 3, 4]] == pytest.approx(start[[0, 1, 3, 4]])
    print(f"{name} {member} {kind}: {clear} run, {stopped} stopped of {tried} positions tried")
    assert clear >= starts / 8
    assert stopped > 0
