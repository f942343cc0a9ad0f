"""The set-up sheet of a cutting program, from what is unconfirmed to the sections by which it is started again."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from gearmath import __version__
from gearmath.machine.bodies import head_radius, work_profiles
from gearmath.machine.cutter import cutter_of
from gearmath.machine.path import Cut
from gearmath.machine.setup_facts import R_D, Bite, SetupFacts
from gearmath.machine.timing import Timing
from gearmath.machine.tooling import Tool
from gearmath.page import Page
from gearmath.setup_sheet.machine_drawing import Ring, machine_drawing
from gearmath.setup_sheet.work_drawing import work_drawing
from gearmath.specs.bevel_set import settings_sha256
from gearmath.specs.milling_machine import AXES, UNITS, MillingMachine

_Z_MODES = {
    "gauge_line": "The program states Z of the gauge line. Length 1 of every tool in the tool table must be 0.",
    "tip": "The program states Z of the blade tips, with D1 active. Length 1 in the tool table must be C_t.",
}
#: Labels of the sections are listed up to so many of a tool.
_LISTED = 12


def setup_sheet(facts: SetupFacts, program: str, timing: Timing) -> str:
    """The page of one cutting program as HTML; ``program`` is its file name, ``timing`` that of its text."""
    plan = facts.plan
    member, machine = plan.member, plan.machine
    page = Page(f"Set-up sheet: {plan.name}")
    page.paragraph(plan.title)
    page.head([plan.name], [
        ("Program", [program]),
        ("Member", [f"{plan.name}, {member.teeth} teeth, {member.hand} hand, {member.process.replace('_', ' ')}, "
                    f"{member.generation}, {member.cutting.replace('_', ' ')}"]),
        ("Settings", [f"sha256 {settings_sha256(member)[:16]}"]),
        ("Made by", [f"gearmath {__version__}"]),
        ("Machine", [machine.name]), ("Set up by, date", [""]),
    ])  # fmt: skip
    page.first("Unconfirmed", [_sentence(text) for text in facts.unconfirmed])
    page.first("Not stated by the files, or to be watched", [_sentence(text) for text in facts.not_stated])
    _references(page, facts)
    _tools(page, facts)
    _work(page, facts)
    _cut(page, facts, timing)
    _tolerances(page, facts)
    _restart(page, facts)
    return page.html


def _references(page: Page, facts: SetupFacts) -> None:
    plan = facts.plan
    machine, one = plan.machine, plan.passes[0]
    page.heading("Machine and references")
    page.paragraph(
        f"{R_D}. C_t is the length of the tool from there to its tips. Z counts up. {_Z_MODES[machine.z_reference]}"
    )
    cut = Cut.of(plan.member, plan.name)[0]
    cutter = cutter_of(plan.member, cut.flanks, plan.space)
    body = cutter.bodies[0]
    head, radius = machine.cutter_head, head_radius(cutter, machine.cutter_head)
    reach = body.outer.point_radius + cutter.height * math.tan(body.outer.pressure_angle)
    rings = [
        Ring("tool", cutter.height, cutter.height + head.height, radius, radius),
        Ring("blade", 0.0, cutter.height, body.outer.point_radius, reach),
        Ring("holder", cutter.height + head.height, max(machine.tool_length, cutter.height + head.height + 1.0),
             head.spindle_radius, head.spindle_radius),
    ]  # fmt: skip
    profiles = work_profiles(plan.member, machine.fixture)
    drawing = machine_drawing(
        machine, profiles, rings, machine.tool_length, "blade tips", float(one.axes[0, 0]), float(one.axes[0, 4])
    )
    work = work_drawing(facts.sizes, profiles, machine.fixture)
    page.drawings([
        (drawing, f"Machine from the front, mm: Z at its home, X {one.axes[0, 0]:.1f}, B {math.degrees(one.axes[0, 4]):.2f}°"),
        (work, "Blank on its fixture, mm: counted from the pitch apex"),
    ])  # fmt: skip
    gauge = machine.home - machine.gauge_line_height
    offsets = " ".join(f"{axis}{value:g}" for axis, value in zip(AXES, machine.work_offset_values, strict=True))
    page.table("References; what the program reads and stops for is marked", ["what", "value", "unit", "checked"], [
        ["R_d, gauge_line_height", f"{machine.gauge_line_height:g}", "mm", ""],
        ["C_t, tool_length", f"{machine.tool_length:g}", "mm", _length_check(machine)],
        ["gauge line above the B axis at the home of Z", f"{gauge:g}", "mm", "by hand"],
        ["blade tips above the B axis there", f"{gauge - machine.tool_length:g}", "mm", "by hand"],
        ["pitch apex from the B axis along x, y, z of the work, A = 0",
         ", ".join(f"{value:g}" for value in machine.pivot_offset), "mm", "by hand"],
        [f"{machine.work_offset}: machine coordinates of the zero", offsets, "mm, degrees", "by the program"],
        ["home of Z", f"{machine.home:g}", "mm", ""],
        ["increments", f"{machine.control.increments_per_mm} per mm, {machine.control.increments_per_degree} per degree",
         "", "by the program"],
        *([f"travel of {axis}", _travel(machine, axis), unit, ""] for axis, unit in zip(AXES, UNITS, strict=True)),
    ])  # fmt: skip
    page.paragraph(
        f"The zero of {machine.work_offset} is on the B axis in X and Y; its Z is 0 where the gauge line reads 0. A turns "
        "the work clockwise, seen from its back towards the pitch apex; B lowers the back, and at B = 0 the work axis is "
        "level with the pitch apex towards X+."
    )
    page.paragraph(
        "The program stops with a message before its first motion unless: the basic system is metric; the increments are "
        f"at least as above; {machine.work_offset} with all frames is as above and does not turn, mirror or scale; the "
        "tool cannot be under the work when Z goes up; R90 and R91 name sections that there are. After each tool change "
        "it compares the name of the tool and its length 1."
    )


def _length_check(machine: MillingMachine) -> str:
    wanted = f"{machine.tool_length:g}" if machine.z_reference == "tip" else "0"
    return f"table, by the program: length 1 is {wanted}"


def _travel(machine: MillingMachine, axis: str) -> str:
    travel = getattr(machine.axes, axis).travel
    return "without end" if travel is None else f"{travel[0]:g} to {travel[1]:g}"


def _tools(page: Page, facts: SetupFacts) -> None:
    page.heading("Tools")
    rows = [row for tool in facts.tools for row in _blade_rows(tool)]
    page.table(
        "Blades; lengths in mm, angles in degrees",
        ["tool", "cuts", "point radius", "pressure angle", "edge radius", "blade height", "blades", "further"], rows,
    )  # fmt: skip
    widths = [
        [tool.name, f"{tool.point.width:.3f}", "as stated" if tool.point.stated else "taken here",
         *("" if limit is None else f"{limit:.3f}" for limit in (tool.point.least, tool.point.most))]
        for tool in facts.tools
    ]  # fmt: skip
    page.table(
        "Point width, mm. A cutter for one flank: below the least a ridge may stay between the two cuts, above the most "
        "its other side cuts the other flank",
        ["tool", "point width", "", "least", "most"], widths,
    )  # fmt: skip
    machine = facts.plan.machine
    head = machine.cutter_head
    page.paragraph(
        f"Cutter: {facts.turning}; {facts.plan.job.spindle_rpm:g} 1/min. Length C_t {machine.tool_length:g} mm. Checked "
        f"for collisions with a head {head.height:g} mm high above the blades, {head.beyond_tip:g} mm beyond them, and a "
        f"spindle of radius {head.spindle_radius:g} mm above it."
    )


def _blade_rows(tool: Tool) -> Iterator[list[str]]:
    for flank, spec in tool.blades.items():
        further = []
        if spec.toprem_angle is not None:
            further.append(f"Toprem {spec.toprem_angle:g}° up to {spec.toprem_height:g}")
        if spec.blade_spheric_radius is not None:
            further.append(f"arc of radius {spec.blade_spheric_radius:g}")
        if spec.blade_offset_angle:
            further.append(f"offset angle {spec.blade_offset_angle:g}°")
        edge = f"{spec.blade_edge_radius:g}" if spec.blade_edge_radius else "not stated"
        count = "not stated" if spec.blade_count is None else str(spec.blade_count)
        side = {"concave": "concave, outer blade", "convex": "convex, inner blade"}[flank]
        yield [tool.name, side, f"{spec.blade_point_radius:.4f}", f"{spec.blade_pressure_angle:.4f}", edge,
               f"{tool.height:g}", count, "; ".join(further)]  # fmt: skip


def _work(page: Page, facts: SetupFacts) -> None:
    sizes, fixture, blank = facts.sizes, facts.plan.machine.fixture, facts.plan.member.blank
    page.heading("Blank and clamping")
    shank = fixture.shank_radius or float(work_profiles(facts.plan.member, fixture)["shank"][0, 1])
    rows = [
        ["outside diameter", f"{sizes.outside_diameter:.3f}", "mm"],
        ["face angle", f"{sizes.face_angle:.4f}", "°"],
        ["root angle", f"{sizes.root_angle:.4f}", "°"],
        ["pitch angle; end faces are square to it", f"{sizes.pitch_angle:.4f}", "°"],
        ["face width along the pitch cone", f"{blank.face_width:.3f}", "mm"],
        ["pitch apex to crown, along the axis", f"{sizes.to_crown:.3f}", "mm"],
        ["crossing point to crown", f"{sizes.crossing_to_crown:.3f}", "mm"],
        ["pitch apex to the tip at the toe", f"{sizes.to_front_crown:.3f}", "mm"],
        ["pitch apex to the back face, as collisions are checked", f"{sizes.back:.1f}", "mm"],
        ["shank behind it: radius, length", f"{shank:.1f}, {fixture.shank_length:g}", "mm"],
        ["fixture behind that: radius, length", f"{fixture.radius:g}, {fixture.length:g}", "mm"],
    ]
    page.table("To be measured on the blank, and the room that the fixture may take", ["what", "value", "unit"], rows)
    page.paragraph(
        "Clamp the blank so that its pitch apex is where the references say. The set does not have the back face: measure "
        "from it to the crown, and add the distance to the apex."
    )


def _cut(page: Page, facts: SetupFacts, timing: Timing) -> None:
    plan = facts.plan
    page.heading("Cut")
    seconds = np.array([second for one in facts.sections for second in one.seconds])
    stocks = "; ".join(f"{stage}: {stock:g} mm of stock left along the normal" for stage, stock, _ in plan.job.stages)
    total = timing.feed_seconds + timing.rapid_seconds
    page.table("Speeds and times", ["what", "value", "unit"], [
        ["feed of the cutter past the tooth, at most", f"{plan.job.feed:g}", "mm/min"],
        ["spindle speed", f"{plan.job.spindle_rpm:g}", "1/min"],
        ["tooth spaces", f"{len(plan.job.spaces)} of {plan.member.teeth}", ""],
        ["cut of one section, mean", f"{seconds.mean():.1f}", "s"],
        ["in feed, approaches included", f"{timing.feed_seconds:.0f}", "s"],
        ["in rapid motion", f"{timing.rapid_seconds:.0f}", "s"],
        ["program without tool changes", f"{total / 60:.1f}", "min"],
    ])  # fmt: skip
    page.paragraph(f"Stages: {stocks}.")
    page.table(
        "Chip load: advance of the work from blade to blade, and the chip square to the flank, mm, at most",
        ["flank", "for", "plunge, advance", "plunge, chip", "roll, advance", "roll, chip"],
        [[load.flank, _per(load.blades, plan.member.process), *_bite(load.plunge), *_bite(load.roll)]
         for load in facts.chips],
    )  # fmt: skip
    page.paragraph(
        "Under the tips the chip of a plunge is as thick as the advance. The roll is taken at the mean point of the "
        "flank, over the whole roll; where a blade touches the finished flank its chip is 0."
    )


def _per(blades: int | None, process: str) -> str:
    if process == "face_hobbing":
        return "a blade, once a turn of the work"
    return "a turn: divide by the blades" if blades is None else f"a blade, of {blades}"


def _bite(bite: Bite | None) -> Sequence[str]:
    return ("", "") if bite is None else (f"{bite.advance:.3f}", f"{bite.chip:.3f}")


def _tolerances(page: Page, facts: SetupFacts) -> None:
    plan = facts.plan
    control, share = plan.machine.control, plan.share
    mode = f"{control.path_mode}" + (
        f", CTOL {control.contour_tolerance_um:g} µm, OTOL {control.orientation_tolerance_arcsec:g} arcsec"
        if control.path_mode == "G642" else ", exact stop"
    )  # fmt: skip
    page.heading("Tolerance of the flanks")
    page.table("What may deviate along the tooth normal, µm", ["what", "µm", "by"], [
        ["asked for", f"{plan.job.tolerance * 1000:g}", "straight blocks and rounding"],
        ["of which rounding", f"{share.rounding * 1000:.4f}",
         f"{control.increments_per_mm} increments per mm, {control.increments_per_degree} per degree"],
        ["path mode, besides", f"{share.path_mode * 1000:.4f}", mode],
    ])  # fmt: skip


def _restart(page: Page, facts: SetupFacts) -> None:
    page.heading("Start, and start again")
    page.paragraph(
        "Each section is one tooth space with one tool, and stands by itself. R90 and R91 are the first and the last that "
        "are cut, 0 for all; the program shows them, waits for NC start, and sets both to 0 at its end. To go on after a "
        "stop: RESET, R90 = the section that was cut when it stopped, start the program from its beginning."
    )
    for one in facts.sections:
        rows = [
            [str(one.first + k), label, f"{second:.1f}"]
            for k, (label, second) in enumerate(zip(one.labels, one.seconds, strict=True))
        ]
        short = (
            rows
            if len(rows) <= _LISTED
            else [*rows[: _LISTED - 2], ["...", "and so on, one after the other", ""], rows[-1]]
        )
        page.table(f"{one.tool}: {one.numbers}", ["section", "cuts", "s"], short)


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."
