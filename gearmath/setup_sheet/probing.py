"""The set-up sheet of a probing program: the machine with the probe in it, the work, and what the probe must clear."""

from __future__ import annotations

from dataclasses import dataclass

from gearmath.machine.bodies.profiles import work_profiles
from gearmath.machine.planning.setup_facts import R_D, BlankSizes
from gearmath.machine.planning.targets import APPROACH, APPROACH_FEED, MEASURING_FEED
from gearmath.machine.writing.sheet_words import SINUMERIK_WORDS, SheetWords
from gearmath.page import Page
from gearmath.setup_sheet.machine_drawing import DrawnRing, machine_drawing
from gearmath.setup_sheet.references import chosen_parts, references
from gearmath.setup_sheet.work_drawing import work_drawing
from gearmath.specs.bevel_set import Member, design_sha256
from gearmath.specs.calibration import Calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.obstacles import Fixture
from gearmath.version import __version__


@dataclass(frozen=True)
class ProbingJob:
    """What a probing program does: number of touches, and the least clearances of its way in words."""

    title: str
    member: Member
    machine: MillingMachine
    probe: Calibration
    fixture: Fixture
    spindle_radius: float
    touches: int
    clearances: str


def probing_sheet(job: ProbingJob, program: str, words: SheetWords = SINUMERIK_WORDS) -> str:
    """The page of one probing program as HTML, in the ``words`` of its control; ``program`` is its file name."""
    member, machine, probe = job.member, job.machine, job.probe
    page = Page(f"Set-up sheet for probing: {member.name}")
    page.paragraph(job.title)
    page.head(
        [member.name],
        [
            ("Program", [program]),
            ("Member", [f"{member.name}, {member.teeth} teeth, {member.hand} hand"]),
            ("Nominal settings", [f"sha256 {design_sha256(member)[:16]}"]),
            ("Machine", [machine.name]),
            ("Probe", [probe.name]),
            ("Made by", [f"gearmath {__version__}"]),
            ("Set up by, date", [""]),
        ],
    )
    page.first("Unconfirmed", [f"{text}." for text in words.probing_unconfirmed])
    page.first(
        "To be watched",
        [
            "A run from the first point on deletes the result file of the run before: fetch it first.",
            "The back face and the shank of the work are assumed for the check of collisions: see the drawing.",
        ],
    )
    page.heading("Machine and references")
    page.paragraph(f"{R_D}. Z counts up.")
    profiles, b = work_profiles(member, job.fixture), member.blank.delta_f
    stylus = [
        DrawnRing("tool", probe.stylus_length, probe.length, 0.5 * job.spindle_radius, 0.5 * job.spindle_radius),
        DrawnRing("blade", 0.0, probe.stylus_length, probe.tip_radius, probe.tip_radius),
    ]
    page.drawings(
        [
            (
                machine_drawing(machine, profiles, stylus, probe.length, "tip", 0.0, b),
                f"Machine from the front: X 0, Z at its home, B {member.blank.root_angle:.2f}°; mm",
            ),
            (work_drawing(BlankSizes.of(member, machine), profiles, job.fixture), "Work on its fixture; mm"),
        ],
        tall=True,
    )
    page.heading("Before the start", new_sheet=True)
    references(page, machine, words, "center of the tip", probe.length, "length of the probe", STOPS)
    page.table(
        "Probe and touches",
        ["what", "value", "unit"],
        [
            *touch_rows(probe, job.touches, "a touch starts from the flank at most"),
            ["radius of the fixture, of the spindle", f"{job.fixture.radius:g}, {job.spindle_radius:g}", "mm"],
        ],
    )
    page.paragraph(
        f"The program was run on the machine model: {job.clearances}. The spindle must stand still, oriented."
    )
    page.subheading("Start, start again, and the result")
    page.paragraph(
        f"{words.probe(machine)} {chosen_parts(words, 'point', 'touched', 'the point of the alarm')} "
        + words.host.format(part="point")
    )
    result = words.result(program.rsplit(".", 1)[0])
    page.paragraph(
        f"The touches are in the file {result}, {words.result_place}: fetch it, and give it to "
        f"'gearmath touches {result} --set SET.toml -o measured.csv'."
    )
    return page.html


def touch_rows(probe: Calibration, touches: int, start: str) -> list[list[str]]:
    """Rows of a table: the probe, how often it touches, from where and how fast; ``start`` says what APPROACH is."""
    return [
        ["effective radius of the tip", f"{probe.tip_radius:.5f}", "mm"],
        ["offset of the tip in X, Y, Z", ", ".join(f"{value:.5f}" for value in probe.offset), "mm"],
        ["radius of the stylus", f"{probe.stylus_radius:g}", "mm"],
        ["free length of the stylus", f"{probe.stylus_length:g}", "mm"],
        ["touches", str(touches), ""],
        [start, f"{APPROACH:g}", "mm"],
        ["and is searched beyond it for", f"{probe.overtravel:g}", "mm"],
        ["feed of a touch, of an approach", f"{MEASURING_FEED:g}, {APPROACH_FEED:g}", "mm/min"],
    ]


#: What a probing program stops for beside its references.
STOPS = "and where the probe is deflected before its first touch or on its way, or touches nothing"
