"""What somebody who sets up the machine has to know and to check, for the head of a program and for its sheet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gearmath.bevel.blank import evaluate
from gearmath.bevel.ridge import RIDGE, ridge, ridge_words
from gearmath.machine.bodies.profiles import work_profiles
from gearmath.machine.planning.chip_load import Bite, ChipLoad, chip_loads
from gearmath.machine.planning.tooling import PointWidth, Tool, tools_of
from gearmath.specs.bevel_set import Flank, Member
from gearmath.specs.milling_machine import MillingMachine

if TYPE_CHECKING:
    from gearmath.machine.planning.cut_plan import CuttingPlan

#: The sentence for R_d, wherever it is explained.
R_D = (
    "R_d is the reading of Z at which the gauge line of the spindle is level with the B axis; "
    "it is -650 where the gauge line is 650 mm above it at Z = 0"
)
_TURNS = {
    "M3": "M3: clockwise, seen along the spindle towards the work (a right-hand cutter)",
    "M4": "M4: counter-clockwise, seen along the spindle towards the work (a left-hand cutter)",
}
#: What Z of a program says.
_Z_REFERENCE = {
    "gauge_line": "of the gauge line, length 1 in the tool table 0",
    "tip": "of the blade tips, length 1 in the tool table",
}
NOT_ON_METAL = "no program of this version has run on metal"
VARIABLES = (
    "names of the system variables in the start checks ($P_ACTFRAME, $TC_TP2, $P_TOOLL, $MN_INT_INCR_PER_MM and _DEG)"
)
PATH = "names of the path tolerances CTOL and OTOL"
PROBING = (
    "return codes of DELETE and WRITE, the memory that the table of points takes, and that MEAS stops A on its way"
)
CALIBRATING = "return codes of DELETE and WRITE, and that MEAS stops an axis on its way"
_C_AXIS = "whether C needs M70 after SPOS=0, and whether its sense is that of M3"


@dataclass(frozen=True)
class BlankSizes:
    """What a machinist checks on a blank [mm, degree], along the axis from the pitch apex.

    ``back`` is where the back face is taken to be for collisions: the set does not have it.
    """

    outside_diameter: float
    toe_diameter: float
    face_angle: float
    root_angle: float
    pitch_angle: float
    delta: float
    to_crown: float
    to_front_crown: float
    back: float
    crossing_to_crown: float

    @staticmethod
    def of(member: Member, machine: MillingMachine) -> BlankSizes:
        ends = evaluate("blank_ends", {"blank": member.blank.vector})
        blank, shank = member.blank, work_profiles(member, machine.fixture)["shank"]
        return BlankSizes(
            ends["outer_tip_diameter"],
            ends["inner_tip_diameter"],
            blank.face_angle,
            blank.root_angle,
            blank.pitch_angle,
            blank.delta,
            ends["crossing_point_to_crown"],
            ends["crossing_point_to_front_crown"],
            float(shank[0, 0]),
            ends["crossing_point_to_crown"] - blank.pitch_apex_beyond_crossing_point,
        )


@dataclass(frozen=True)
class Sections:
    """Sections ``first`` to ``last`` of a program: one tool through neighbouring spaces, seconds in the cut of each."""

    tool: str
    first: int
    last: int
    span: str
    seconds: float

    @property
    def numbers(self) -> str:
        """Their numbers, for R90 and R91."""
        return f"section {self.first}" if self.first == self.last else f"sections {self.first} to {self.last}"


@dataclass(frozen=True)
class SetupFacts:
    """All of it for one planned program; ``ridge`` [mm] is what stays in the root between the cuts of both flanks."""

    plan: CuttingPlan
    sizes: BlankSizes
    tools: tuple[Tool, ...]
    chips: tuple[ChipLoad, ...]
    sections: tuple[Sections, ...]
    ridge: float

    @staticmethod
    def of(plan: CuttingPlan, plunge_feed: float) -> SetupFacts:
        """``plunge_feed`` [mm/min] is that down to the first point of a roll."""
        member, machine = plan.member, plan.machine
        chips = chip_loads(member, machine, plan.passes, plan.job.spindle_rpm, plunge_feed)
        tools = tools_of(member, plan.space)
        left = ridge(member, plan.space)
        return SetupFacts(plan, BlankSizes.of(member, machine), tools, chips, tuple(_sections(plan)), left)

    @property
    def turning(self) -> str:
        """The sense of the cutter, and from where it is seen."""
        return _TURNS[self.plan.machine.cutter_direction]

    @property
    def unconfirmed(self) -> tuple[str, ...]:
        """What nobody has confirmed."""
        turned = (_C_AXIS,) if self.plan.member.process == "face_hobbing" else ()
        path = () if self.plan.machine.control.path_mode == "G60" else (PATH,)
        return NOT_ON_METAL, VARIABLES, *path, *turned

    @property
    def not_stated(self) -> tuple[str, ...]:
        """What the files do not say, and what is done about it."""
        said: dict[str, list[str]] = {}  # what is said, of which tools
        for tool in self.tools:
            for flank, spec in tool.blades.items():
                if spec.blade_edge_radius == 0.0:
                    said.setdefault("no blade_edge_radius, taken as sharp", []).append(f"{tool.name} {flank}")
            if not tool.point.stated:
                taken = f"no blade_point_width, {tool.point.width:.3f} mm is taken"
                said.setdefault(taken, []).append(tool.name)
            if tool.point.fault is not None:
                said.setdefault(tool.point.fault, []).append(tool.name)
        for load in self.chips:
            if load.blades is None:
                unknown = "no blade_count, the chip is for a whole turn: divide by the blades"
                said.setdefault(unknown, []).append(load.flank)
        others = [] if self.ridge <= RIDGE else [f"the root: {ridge_words(self.ridge)}"]
        if self.plan.machine.fixture.shank_radius == 0.0:
            others.append("the fixture has no shank_radius, 60 % of the root radius at the heel is taken")
        others.append("the set does not have the back face of the blank, the collision check takes its own")
        return (*(f"{', '.join(names)}: {words}" for words, names in said.items()), *others)


def _sections(plan: CuttingPlan) -> Iterator[Sections]:
    first = 0
    for k, one in enumerate(plan.passes):
        after = plan.passes[k + 1] if k + 1 < len(plan.passes) else None
        ahead = f"space {one.tooth + 1} {one.label.removeprefix(f'space {one.tooth} ')}"  # of the same stage
        if after is not None and after.tool == one.tool and after.label == ahead:
            continue
        span = " to ".join(dict.fromkeys((plan.passes[first].label, one.label)))
        yield Sections(one.tool, first + 1, k + 1, span, float(one.seconds.sum() + one.dwell))
        first = k + 1


def setup_notes(facts: SetupFacts) -> Iterator[str]:
    """The facts in short, as comment lines of a program."""
    for tool in facts.tools:
        for flank, spec in tool.blades.items():
            yield f"tool {tool.name}, {flank}: {blade_words(spec)}"
        yield f"tool {tool.name}: {point_words(tool.point)}, blade height {tool.height:g} mm"
    yield from work_notes(facts.sizes, facts.plan.machine)
    for load in facts.chips:
        yield f"chip, {load.flank}: {'; '.join(chip_words(load))}"
    for one in facts.sections:
        yield f"cut by {one.numbers}: {one.tool}, {one.span}"
    for sentence in facts.not_stated:
        yield f"note: {sentence}"
    for sentence in facts.unconfirmed:
        yield f"unconfirmed: {sentence}"


def member_note(member: Member) -> str:
    """Which member a program is for."""
    return f"member: {member.name}, {member.teeth} teeth, {member.hand} hand, {member.cutting.replace('_', ' ')}"


def z_note(machine: MillingMachine) -> str:
    """What Z of a cutting program counts."""
    return (
        f"Z: {_Z_REFERENCE[machine.z_reference]}; R_d {machine.gauge_line_height:g} is its reading with the gauge line "
        f"level with the B axis, C_t {machine.tool_length:g} the length of the tool"
    )


def work_notes(sizes: BlankSizes, machine: MillingMachine) -> Iterator[str]:
    """Sense of the cutter, sizes of the blank and what holds it."""
    fixture = machine.fixture
    yield f"cutter turns {_TURNS[machine.cutter_direction]}"
    yield (
        f"blank: outside diameter {sizes.outside_diameter:.3f} mm, face angle {sizes.face_angle:.4f} deg, root angle "
        f"{sizes.root_angle:.4f} deg, pitch apex to crown {sizes.to_crown:.3f} mm"
    )
    yield (
        f"clamping, checked for: back face {sizes.back:.3f} mm from the pitch apex, shank {fixture.shank_length:g} mm "
        f"long, then fixture of radius {fixture.radius:g} mm, {fixture.length:g} mm long"
    )
    e = ", ".join(f"{value:g}" for value in machine.pivot_offset)
    yield f"pitch apex: at ({e}) mm from the B axis along x, y, z of the work at A = 0"


def blade_words(spec: Flank) -> str:
    """A blade as a presetter measures it."""
    parts = [f"point radius {spec.blade_point_radius:.4f} mm", f"pressure angle {spec.blade_pressure_angle:.4f} deg"]
    parts.append(f"edge radius {spec.blade_edge_radius:g} mm" if spec.blade_edge_radius else "edge radius not stated")
    if spec.blade_spheric_radius is not None:
        parts.append(f"arc of radius {spec.blade_spheric_radius:g} mm")
    if spec.toprem_angle is not None:
        parts.append(f"Toprem {spec.toprem_angle:g} deg up to {spec.toprem_height:g} mm")
    if spec.blade_offset_angle:
        parts.append(f"offset angle {spec.blade_offset_angle:g} deg")
    return ", ".join(parts)


def point_words(point: PointWidth) -> str:
    """Point width, with its limits where it has some."""
    if point.least is None:
        return f"point width {point.width:.3f} mm"
    stated = "" if point.stated else "taken here, not stated; "
    return f"point width {point.width:.3f} mm ({stated}{point.least:.3f} to {point.most:.3f} mm)"


def chip_words(load: ChipLoad) -> Iterator[str]:
    """Plunge and roll of a flank."""
    per = "a turn, blades not stated" if load.blades is None else "a blade"
    yield f"plunge {_bite(load.plunge)} {per}"
    if load.roll is not None:
        yield f"roll at most {_bite(load.roll)} {per}"


def _bite(bite: Bite) -> str:
    return f"{bite.advance:.3f} mm, chip {bite.chip:.3f} mm"
