"""The words of LinuxCNC on a set-up sheet."""

from __future__ import annotations

from gearmath.machine.planning.cut_plan import CuttingPlan
from gearmath.machine.planning.setup_facts import NOT_ON_METAL, SetupFacts
from gearmath.machine.writing.linuxcnc.configuration import HOST
from gearmath.machine.writing.linuxcnc.cutting import C_SENSE, path_share_of, tool_numbers
from gearmath.machine.writing.linuxcnc.dialect import FIRST, LAST
from gearmath.machine.writing.linuxcnc.probe_words import RESULT, probe_number
from gearmath.machine.writing.sheet_words import PathWords, SheetWords
from gearmath.specs.milling_machine import MillingMachine


def _path(plan: CuttingPlan) -> PathWords:
    control = plan.machine.control
    if control.path_mode == "G60":
        return PathWords("G61", 0.0, "")
    figures = (
        f"P {control.contour_tolerance_um:g} µm in X, Y, Z; LinuxCNC has no tolerance for A and B, which give way "
        "together with them. Blocks are not merged (Q0)."
    )
    return PathWords("G64", path_share_of(plan), figures)


def _decimals(machine: MillingMachine) -> list[str]:
    mm, degrees = machine.control.decimals
    return ["decimals of positions in mm, in degrees", f"{mm}, {degrees}", "", ""]


def _unconfirmed(facts: SetupFacts) -> tuple[str, ...]:
    turned = (C_SENSE,) if facts.plan.member.process == "face_hobbing" else ()
    return NOT_ON_METAL, *turned


LINUXCNC_WORDS = SheetWords(
    chosen=f"the parameters {FIRST} and {LAST}",
    first=FIRST,
    last=LAST,
    how_set=f"They are set by MDI, such as {FIRST}=3.",
    goes_on="resume",
    ends="abort",
    length="Z",
    active="G43",
    stops=lambda machine: f"{machine.work_offset} is not as above or turns, where A or B is a WRAPPED_ROTARY axis",
    other_tool="the number of the {tool} or its Z in the tool table is another one",
    increments=_decimals,
    path=_path,
    numbers=lambda plan: tool_numbers(plan.machine, plan.passes),
    probe=lambda machine: f"The probe is tool T{probe_number(machine)}, and is read at the pin motion.probe-input.",
    host=f"{HOST['gearmath-host']}, on before the start, lets a host acknowledge every {{part}}.",
    result=lambda name: f"{name}_T{RESULT}",
    result_place="in the folder of the INI file",
    unconfirmed=_unconfirmed,
    probing_unconfirmed=(NOT_ON_METAL,),
    calibrating_unconfirmed=(NOT_ON_METAL,),
)
