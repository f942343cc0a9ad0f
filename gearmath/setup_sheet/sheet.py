"""The set-up sheet of a cutting program, from what is unconfirmed to the sections by which it is started again."""

from __future__ import annotations

import math
from collections.abc import Iterator

from gearmath.machine.bodies.cutter import Cutter, cutter_of
from gearmath.machine.bodies.profiles import head_radius, work_profiles
from gearmath.machine.judging.timing import Timing
from gearmath.machine.planning.chip_load import Bite
from gearmath.machine.planning.cut_plan import DRY_LIFT
from gearmath.machine.planning.path import Cut
from gearmath.machine.planning.setup_facts import R_D, SetupFacts
from gearmath.machine.planning.tooling import Tool
from gearmath.machine.writing.sheet_words import SINUMERIK_WORDS, PathWords, SheetWords
from gearmath.page import Page
from gearmath.setup_sheet.machine_drawing import CUTTER_TIP, DrawnRing, machine_drawing
from gearmath.setup_sheet.point_drawing import point_drawing
from gearmath.setup_sheet.references import chosen_parts, references
from gearmath.setup_sheet.work_drawing import work_drawing
from gearmath.specs.bevel_set import settings_sha256
from gearmath.specs.milling_machine import MillingMachine
from gearmath.version import __version__

_SIDES = {"concave": "outer", "convex": "inner"}


def setup_sheet(facts: SetupFacts, program: str, timing: Timing, words: SheetWords = SINUMERIK_WORDS) -> str:
    """The page of one cutting program as HTML, in the ``words`` of its control.

    ``program`` is its file name, ``timing`` that of its text.
    """
    plan = facts.plan
    member = plan.member
    page = Page(f"Set-up sheet: {member.name}")
    page.paragraph(plan.title)
    method = (member.process, member.generation, member.cutting)
    page.head(
        [member.name],
        [
            ("Program", [program]),
            (
                "Member",
                [
                    f"{member.name}, {member.teeth} teeth, {member.hand} hand, "
                    + ", ".join(word.replace("_", " ") for word in method)
                ],
            ),
            ("Settings", [f"sha256 {settings_sha256(member)[:16]}"]),
            ("Machine", [plan.machine.name]),
            ("Made by", [f"gearmath {__version__}"]),
            ("Set up by, date", [""]),
        ],
    )
    if plan.job.dry_run:
        page.first("Dry run", [f"Z is raised by {DRY_LIFT:g} mm, coolant is off: the program cuts air."])
    page.first("Unconfirmed", [f"{text}." for text in words.unconfirmed(facts)])
    page.first("Not stated by the files, or to be watched", [f"{text}." for text in facts.not_stated])
    page.heading("Machine and references")
    page.paragraph(f"{R_D}. C_t is the length of the tool from there to its tips; Z counts up.")
    page.drawings(list(_drawings(facts)), tall=True)
    page.heading("Before the start", new_sheet=True)
    more = f"and where {words.chosen} name no section"
    references(page, plan.machine, words, CUTTER_TIP, plan.machine.tool_length, "C_t, tool_length", more)
    _restart(page, facts, words)
    with page.columns():
        _tools(page, facts, words.numbers(plan))
        _work(page, facts)
        _cut(page, facts, timing)
        _tolerances(page, facts, words.path(plan))
    return page.html


def _drawings(facts: SetupFacts) -> Iterator[tuple[str, str]]:
    """Machine, work, and the point of every cutter."""
    plan = facts.plan
    machine, axes = plan.machine, plan.passes[0].axes[0]
    cutters = {cut.tool: cutter_of(plan.member, cut.flanks, plan.space) for cut in Cut.of(plan.member)}
    profiles, (first, *_) = work_profiles(plan.member, machine.fixture), cutters.values()
    x, b = float(axes[0]), float(axes[4])
    yield (
        machine_drawing(machine, profiles, _rings(first, machine), machine.tool_length, CUTTER_TIP, x, b),
        f"Machine from the front: X {x:.1f}, Z at its home, B {math.degrees(b):.2f}°; mm",
    )
    yield work_drawing(facts.sizes, profiles, machine.fixture), "Blank on its fixture, from the pitch apex; mm"
    for name, cutter in cutters.items():
        yield point_drawing(cutter), f"Point of {name}, mm"


def _rings(cutter: Cutter, machine: MillingMachine) -> list[DrawnRing]:
    """Blades, head and spindle as the collision check has them."""
    outer, head, radius = cutter.bodies[0].outer, machine.cutter_head, head_radius(cutter, machine.cutter_head)
    reach = outer.point_radius + cutter.height * math.tan(outer.pressure_angle)
    top = cutter.height + head.height
    return [
        DrawnRing("tool", cutter.height, top, radius, radius),
        DrawnRing("blade", 0.0, cutter.height, outer.point_radius, reach),
        DrawnRing("holder", top, max(machine.tool_length, top + 1.0), head.spindle_radius, head.spindle_radius),
    ]


def _tools(page: Page, facts: SetupFacts, numbers: dict[str, int]) -> None:
    page.subheading("Tools")
    if any(len(tool.blades) == 1 for tool in facts.tools):
        page.paragraph(
            "A cutter for one flank is drawn with another side: it cuts nothing, and is taken for the check of "
            "collisions at the point width, with the angle of the other flank's blade."
        )
    blades = [(tool, flank) for tool in facts.tools for flank in tool.blades]
    groups = facts.plan.member.blade_groups
    columns = [dict(_blade(tool, flank, groups, numbers)) for tool, flank in blades]
    keys = list(dict.fromkeys(key for column in columns for key in column))
    page.table(
        "Cutters; mm and degrees",
        ["", *(tool.name for tool, _ in blades)],
        [[key, *(column.get(key, "") for column in columns)] for key in keys],
    )
    if any(tool.point.least is not None for tool in facts.tools):
        page.paragraph(
            "Below its least point width a cutter for one flank may leave a ridge between the two cuts, above the most "
            "its other side cuts the other flank."
        )
    machine, plan = facts.plan.machine, facts.plan
    head = machine.cutter_head
    page.paragraph(
        f"The cutter turns {facts.turning}, at {plan.job.spindle_rpm:g} 1/min. Collisions are checked with a head "
        f"{head.height:g} mm high above the blades, {head.beyond_tip:g} mm beyond them, and a spindle of radius "
        f"{head.spindle_radius:g} mm above it."
    )


def _blade(tool: Tool, flank: str, groups: int | None, numbers: dict[str, int]) -> Iterator[tuple[str, str]]:
    spec, point = tool.blades[flank], tool.point
    if tool.name in numbers:
        yield "number in the tool table", f"T{numbers[tool.name]}"
    yield "blade", _SIDES[flank]
    yield "cuts flank", flank
    yield "point radius", f"{spec.blade_point_radius:.4f}"
    yield "pressure angle", f"{spec.blade_pressure_angle:.4f}"
    yield "edge radius", f"{spec.blade_edge_radius:g}" if spec.blade_edge_radius else "not stated"
    yield "blade height", f"{tool.height:g}"
    if spec.toprem_angle is not None:
        yield "Toprem angle", f"{spec.toprem_angle:g}"
        yield "Toprem height", f"{spec.toprem_height:g}"
    if spec.blade_spheric_radius is not None:
        yield "spheric radius", f"{spec.blade_spheric_radius:g}"
    if spec.blade_offset_angle:
        yield "offset angle", f"{spec.blade_offset_angle:g}"
    yield "blades", str(groups or spec.blade_count or "not stated")
    yield "point width", f"{point.width:.3f}" + ("" if point.stated else ", taken here")
    if point.least is not None and point.most is not None:
        yield "least, most", f"{point.least:.3f}, {point.most:.3f}"


def _work(page: Page, facts: SetupFacts) -> None:
    sizes, fixture, blank = facts.sizes, facts.plan.machine.fixture, facts.plan.member.blank
    shank = float(work_profiles(facts.plan.member, fixture)["shank"][0, 1])
    page.subheading("Blank and clamping")
    page.table(
        "To be measured on the blank, and the room that its fixture may take",
        ["", "", "unit"],
        [
            ["outside diameter", f"{sizes.outside_diameter:.3f}", "mm"],
            ["face angle", f"{sizes.face_angle:.4f}", "°"],
            ["root angle", f"{sizes.root_angle:.4f}", "°"],
            ["pitch angle", f"{sizes.pitch_angle:.4f}", "°"],
            ["face width along the pitch cone", f"{blank.face_width:.3f}", "mm"],
            ["pitch apex to crown", f"{sizes.to_crown:.3f}", "mm"],
            ["crossing point to crown", f"{sizes.crossing_to_crown:.3f}", "mm"],
            ["pitch apex to tip at the toe", f"{sizes.to_front_crown:.3f}", "mm"],
            ["pitch apex to back face, as checked", f"{sizes.back:.3f}", "mm"],
            ["radius of the shank behind it", f"{shank:.3f}", "mm"],
            ["length of the shank", f"{fixture.shank_length:g}", "mm"],
            ["radius of the fixture behind that", f"{fixture.radius:g}", "mm"],
            ["length of the fixture", f"{fixture.length:g}", "mm"],
        ],
    )
    page.paragraph(
        "All along the axis. Clamp the blank so that its pitch apex is where the references say: the set does not have "
        "the back face, measure from it to the crown."
    )


def _cut(page: Page, facts: SetupFacts, timing: Timing) -> None:
    plan = facts.plan
    total = timing.feed_seconds + timing.rapid_seconds
    page.subheading("Cut")
    page.table(
        "Speeds and times",
        ["", "", "unit"],
        [
            ["feed past the tooth, at most", f"{plan.job.feed:g}", "mm/min"],
            ["spindle", f"{plan.job.spindle_rpm:g}", "1/min"],
            ["cutting speed at the tips", f"{_cutting_speed(facts):.0f}", "m/min"],
            ["coolant", "off, dry run" if plan.job.dry_run else "on, M8, from the approach on", ""],
            ["tooth spaces", f"{len(plan.job.spaces)} of {plan.member.teeth}", ""],
            *([f"stock left, {stage}", f"{stock:g}", "mm"] for stage, stock, _ in plan.job.stages),
            ["in feed, with approaches", f"{timing.feed_seconds:.0f}", "s"],
            ["in rapid motion", f"{timing.rapid_seconds:.0f}", "s"],
            ["a space, all tools", f"{total / len(plan.job.spaces):.1f}", "s"],
            ["program, without tool changes", f"{total / 60:.1f}", "min"],
        ],
    )
    rows = [
        [load.flank, words, *_bite(bite)]
        for load in facts.chips
        for words, bite in (("plunge", load.plunge), ("roll", load.roll))
        if bite is not None
    ]
    page.table(
        "Chip load of a blade, mm: advance to the next blade, chip square to the flank, at most",
        ["flank", "", "advance", "chip"],
        rows,
    )
    page.paragraph(_chip_words(facts))
    if len(plan.job.stages) == 1:
        page.paragraph("There is no roughing: every space is cut to its full depth in one go.")


def _cutting_speed(facts: SetupFacts) -> float:
    """Of the farthest blade tip [m/min]."""
    radius = max(spec.blade_point_radius for tool in facts.tools for spec in tool.blades.values())
    return 2 * math.pi * radius / 1000 * facts.plan.job.spindle_rpm


def _chip_words(facts: SetupFacts) -> str:
    if facts.plan.member.process == "face_hobbing":
        per = "A blade cuts a space once in a turn of the work."
    elif any(load.blades is None for load in facts.chips):
        per = "The number of blades is not stated: for a whole turn, to be divided by the blades that cut the flank."
    else:
        counts = ", ".join(f"{load.flank} {load.blades}" for load in facts.chips)
        per = f"Blades that cut the flank: {counts}."
    return (
        f"{per} Under the tips the chip of a plunge is as thick as the advance; a roll is taken at the mean point, "
        "over its whole way."
    )


def _bite(bite: Bite) -> tuple[str, str]:
    return f"{bite.advance:.3f}", f"{bite.chip:.3f}"


def _tolerances(page: Page, facts: SetupFacts, path: PathWords) -> None:
    plan = facts.plan
    share = plan.share
    rows = [
        ["straight blocks and rounding", f"{plan.job.tolerance * 1000:g}"],
        ["of which rounding", f"{share.rounding * 1000:.4f}"],
        [f"path mode {path.mode}, besides", f"{path.adds * 1000:.4f}"],
    ]
    page.subheading("Tolerance of the flanks")
    page.table("Along the tooth normal, µm, at most", ["", "µm"], rows)
    if path.figures:
        page.paragraph(path.figures)


def _restart(page: Page, facts: SetupFacts, words: SheetWords) -> None:
    hobbed = facts.plan.member.process == "face_hobbing"
    page.subheading("Start, and start again" + ("" if hobbed else " at a space"))
    page.paragraph(
        f"Each section is {'all tooth spaces' if hobbed else 'one tooth space'} with one tool, and stands by itself. "
        + chosen_parts(words, "section", "cut", "the section that was cut when it stopped")
    )
    page.table(
        "Sections, and seconds in the cut of each",
        ["section", "tool", "cuts", "s"],
        [[one.numbers.split(" ", 1)[1], one.tool, one.span, f"{one.seconds:.1f}"] for one in facts.sections],
    )
