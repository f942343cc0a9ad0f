"""What a set-up sheet says in the words of one control: parameters, buttons, tool table, path mode, the probe."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from gearmath.machine.planning.cut_plan import CuttingPlan
from gearmath.machine.planning.setup_facts import CALIBRATING, NOT_ON_METAL, PROBING, VARIABLES, SetupFacts
from gearmath.machine.writing.chosen import FIRST, LAST
from gearmath.specs.milling_machine import MillingMachine


@dataclass(frozen=True)
class PathWords:
    """A path mode: its name, what it adds to the flanks at most [mm], and its figures in a sentence."""

    mode: str
    adds: float
    figures: str


@dataclass(frozen=True)
class SheetWords:
    """The words of a control on a set-up sheet, of a program of its dialect."""

    chosen: str
    """What chooses the parts of a program; ``first`` and ``last`` are their names in a setting."""
    first: str
    last: str
    how_set: str
    """A sentence that says how they are set, or nothing."""
    goes_on: str
    ends: str
    """What the operator presses to go on after a stop of the program, and to end it."""
    length: str
    """The length of a tool in the table of tools."""
    active: str
    """What makes the control take it into account."""
    stops: Callable[[MillingMachine], str]
    """For what a program stops before its first motion, after 'where'."""
    other_tool: str
    """For what it stops after a tool change."""
    increments: Callable[[MillingMachine], list[str]]
    """The row of increments in the table of references."""
    path: Callable[[CuttingPlan], PathWords]
    numbers: Callable[[CuttingPlan], dict[str, int]]
    """Numbers of the cutters by name, where the control wants numbers."""
    probe: Callable[[MillingMachine], str]
    """Sentences: which tool the probe is, and where it is read."""
    host: str
    """A sentence with {part}: how a host acknowledges touches."""
    result: Callable[[str], str]
    """Name of the result file of a program."""
    result_place: str
    unconfirmed: Callable[[SetupFacts], tuple[str, ...]]
    """What nobody has confirmed of a cutting program."""
    probing_unconfirmed: tuple[str, ...]
    calibrating_unconfirmed: tuple[str, ...]


def _stops(machine: MillingMachine) -> str:
    return (
        f"the basic system is not metric, where the increments are fewer or {machine.work_offset}, with all frames, is "
        "not as above, where a frame turns, mirrors or scales"
    )


def _increments(machine: MillingMachine) -> list[str]:
    control = machine.control
    values = f"{control.increments_per_mm}, {control.increments_per_degree}"
    return ["increments per mm, per degree", values, "", "by the program, at least"]


def _path(plan: CuttingPlan) -> PathWords:
    control, figures = plan.machine.control, ""
    if control.path_mode == "G642":
        figures = (
            f"CTOL {control.contour_tolerance_um:g} µm, OTOL {control.orientation_tolerance_arcsec:g} arcsec; "
            f"{control.increments_per_mm} increments per mm, {control.increments_per_degree} per degree."
        )
    return PathWords(control.path_mode, plan.share.path_mode, figures)


SINUMERIK_WORDS = SheetWords(
    chosen=f"{FIRST} and {LAST}",
    first=FIRST,
    last=LAST,
    how_set="",
    goes_on="NC start",
    ends="RESET",
    length="length 1",
    active="D1",
    stops=_stops,
    other_tool="the name of the {tool} or its length 1 is another one",
    increments=_increments,
    path=_path,
    numbers=lambda plan: {},
    probe=lambda machine: "The probe is read at input 1 ($A_PROBE[1], MEAS=1).",
    host="R104 = 1, set before the start, lets a host acknowledge every {part}.",
    result=lambda name: f"{name}_T",
    result_place="where the control keeps what WRITE makes",
    unconfirmed=lambda facts: facts.unconfirmed,
    probing_unconfirmed=(NOT_ON_METAL, VARIABLES, PROBING),
    calibrating_unconfirmed=(NOT_ON_METAL, VARIABLES, CALIBRATING),
)
