"""The set-up sheet of a calibration program: ring, face and sphere, where they stand, and how they are touched."""

from __future__ import annotations

import math
from collections.abc import Iterator

from gearmath.machine.planning.artefact_targets import axis_sections, sphere_directions, sphere_positions, tip_sections
from gearmath.machine.planning.setup_facts import R_D
from gearmath.machine.planning.targets import POSITIONING_FEED
from gearmath.machine.writing.axis_cycle import above_all
from gearmath.machine.writing.calibrating import sideways_level
from gearmath.machine.writing.sheet_words import SINUMERIK_WORDS, SheetWords
from gearmath.page import Page
from gearmath.setup_sheet.artefact_drawing import plan_drawing, section_drawing, work_sphere_drawing
from gearmath.setup_sheet.probing import STOPS, touch_rows
from gearmath.setup_sheet.references import chosen_parts, references
from gearmath.specs.calibration import Calibration, WorkSphere
from gearmath.specs.milling_machine import MillingMachine
from gearmath.version import __version__

_FROM = "a touch starts from the surface, in the bore from its middle, at"
_NOT_KNOWN = "The program knows no table, seat, stem or work: the ways of probe and spindle must be clear of them."


def calibration_sheet(
    machine: MillingMachine, probe: Calibration, axes: bool, program: str, words: SheetWords = SINUMERIK_WORDS
) -> str:
    """The page of one calibration program as HTML, in the ``words`` of its control; ``program`` is its file name.

    ``axes`` says that it touches the sphere on the work side, to find the rotary axes; else ring and sphere on the
    table. The artefacts have to be in the calibration file.
    """
    sphere = probe.work_sphere if axes else None
    what = "rotary axes" if axes else "tip of the probe"
    page = Page(f"Set-up sheet for calibration: {what}")
    page.head(
        [what],
        [
            ("Program", [program]),
            ("Machine", [machine.name]),
            ("Probe", [probe.name]),
            ("Made by", [f"gearmath {__version__}"]),
            ("Set up by, date", [""]),
        ],
    )
    page.first("Unconfirmed", [f"{text}." for text in words.calibrating_unconfirmed])
    page.first("To be watched", _watched(machine, probe, sphere))
    page.heading("What is touched")
    if sphere is None:
        _on_table(page, machine, probe)
        sections, places = tip_sections(probe), None
    else:
        _on_work(page, machine, probe, sphere)
        sections, places = axis_sections(machine, probe, sphere), sphere_positions(machine, probe, sphere)
    page.heading("Before the start", new_sheet=True)
    page.paragraph(f"{R_D}. Z counts up.")
    references(page, machine, words, "center of the tip", probe.length, "length of the probe", STOPS, more_before="")
    touches = sum(one.touches for one in sections)
    page.table(
        "Probe and touches",
        ["what", "value", "unit"],
        [
            *touch_rows(probe, touches, "a touch starts from the surface at" if axes else _FROM),
            ["feed sideways and down from home", f"{POSITIONING_FEED:g}", "mm/min"],
        ],
    )
    page.paragraph(
        "The program was run on the machine model, with the surfaces where the calibration file has them. The spindle "
        "must stand still, oriented."
    )
    page.subheading("Start, start again, and the result")
    page.paragraph(
        f"{words.probe(machine)} {chosen_parts(words, 'section', 'touched', 'the section of the last message')} "
        + words.host.format(part="touch")
    )
    rows = [[str(number), one.what, str(one.touches)] for number, one in enumerate(sections, 1)]
    columns = ["section", "what is touched", "touches"]
    if places is not None:
        columns += ["X", "Y", "Z with the center of the tip in that of the sphere"]
        rows = [
            [*row, *(f"{value + 0.0:.3f}" for value in at[:3].round(3))] for row, at in zip(rows, places, strict=True)
        ]
    page.table("Sections", columns, rows)
    result = words.result(program.rsplit(".", 1)[0])
    made = "--calibration PROBE.toml --machine MACHINE.toml -o NEW_" + ("MACHINE.toml" if axes else "PROBE.toml")
    page.paragraph(
        f"The touches are in the file {result}, {words.result_place}: fetch it, and give it to "
        f"'gearmath calibrate {result} {made}'."
    )
    return page.html


def _watched(machine: MillingMachine, probe: Calibration, sphere: WorkSphere | None) -> list[str]:
    within = f"within {probe.overtravel:g} mm, or a touch finds nothing and the program stops"
    found = [
        "A run from the first section on deletes the result file of the run before: fetch it first.",
        _NOT_KNOWN,
    ]
    if sphere is None:
        return [
            *found,
            f"Ring and sphere must stand where this sheet says, {within}.",
            "A and B go to 0 with Z at the top of its travel: what is in the work spindle must be free to turn.",
        ]
    return [
        *found,
        f"The sphere must be where this sheet says, {within}; its distance along the work axis goes into the result "
        "and has to be known.",
        "A and B turn with the tip above all that the sphere can reach: an arbor that reaches farther than the sphere "
        "must not meet the probe.",
    ]


def _on_table(page: Page, machine: MillingMachine, probe: Calibration) -> None:
    page.drawings(
        [(plan_drawing(probe), "From above, as the tip sees them; mm"), (section_drawing(probe), "In section; mm")]
    )
    ring, sphere = probe.ring, probe.sphere
    rows = []
    if ring is not None:
        rows += [["diameter of the bore", f"{ring.diameter:g}"], _place("center of the ring", ring.center)]
        rows.append(_height("touches in the bore", ring.center[2], machine, probe))
        if ring.face is not None:
            rows += [
                _height("seat of the ring", ring.face.seat, machine, probe),
                ["height of the ring above its seat", f"{ring.face.height:g}"],
                ["width of the wall", f"{ring.face.width:g}"],
            ]
    if sphere is not None:
        rows += [["diameter of the sphere", f"{sphere.diameter:g}"], _place("center of the sphere", sphere.center)]
        rows.append(_height("center of the sphere, height", sphere.center[2], machine, probe))
    rows.append(["Z of the ways over ring and sphere", f"{sideways_level(machine, probe):g}"])
    page.table("Ring and sphere on the table", ["what", "mm"], rows)
    page.paragraph(
        f"X and Y are readings in {machine.work_offset} with the tip's center at that place, Z is that of the gauge "
        f"line there, with a probe of {probe.length:g} mm: another length needs other Z in the calibration file. "
        + " ".join(_touched(probe))
    )


def _touched(probe: Calibration) -> Iterator[str]:
    """How each artefact is touched, and what it tells."""
    if probe.ring is not None:
        yield "The ring is touched along X, along Y through the middle that was found, and along X once more."
        yield "It tells the radius of the tip and its offset in X and Y."
        if probe.ring.face is not None:
            yield "Its face is touched from above, in the middle of the wall, at four sides: it tells the offset in Z."
    if probe.sphere is not None:
        lowest = math.degrees(math.asin(sphere_directions()[:, 2].min()))
        yield f"The sphere is touched along its normals, from its pole to {lowest:.0f}° above its equator."
        yield "It tells radius and offset."
    if probe.ring is not None and probe.sphere is not None:
        yield "Where both were touched, the sphere is taken."


def _on_work(page: Page, machine: MillingMachine, probe: Calibration, sphere: WorkSphere) -> None:
    caption = "Machine from the front, the sphere turned to the top; mm from the B axis"
    page.drawings([(work_sphere_drawing(machine, probe, sphere), caption)])
    page.table(
        "Sphere on the work side",
        ["what", "value", "unit"],
        [
            ["diameter of the sphere", f"{sphere.diameter:g}", "mm"],
            ["from the pitch apex along the work axis", f"{sphere.axial:g}", "mm"],
            ["off the work axis", f"{sphere.radius:g}", "mm"],
            ["azimuth in the work, at A = 0", f"{sphere.azimuth:g}", "°"],
            ["diameter of the stem", f"{sphere.stem_diameter:g}", "mm"],
            ["Z from which A and B turn", f"{above_all(machine, probe, sphere):.3f}", "mm"],
        ],
    )
    page.paragraph(
        "The stem leads away from the pitch apex, along the work axis. A turns the sphere to the top and to both sides "
        "of it; touches that would come near the stem are left out."
    )


def _place(name: str, center: tuple[float, float, float]) -> list[str]:
    return [f"{name}, X Y Z", ", ".join(f"{value:g}" for value in center)]


def _height(name: str, z: float, machine: MillingMachine, probe: Calibration) -> list[str]:
    above = z - machine.gauge_line_height - probe.length
    return [f"{name}: Z, and above the B axis", f"{z:g}, {above:g}"]
