"""gearmath: gear cutting from first principles to metal.

``import gearmath as gm`` loads nothing: each name below is loaded when it is used, every chapter is derived when it is.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from derivations import Expression as Expression
    from derivations import Quantity as Quantity
    from gearmath.control.store import MeasurementStore as MeasurementStore
    from gearmath.control.store_evaluation import evaluate_run as evaluate_run
    from gearmath.demo import run_demo as run_demo
    from gearmath.engine.kernel import Kernel as Kernel
    from gearmath.errors import ComputationError as ComputationError
    from gearmath.errors import InputError as InputError
    from gearmath.front.contact import Contact as Contact
    from gearmath.front.contact import contact as contact
    from gearmath.front.corrected import Correction as Correction
    from gearmath.front.design import Blank as Blank
    from gearmath.front.design import PairDesign as PairDesign
    from gearmath.front.design import design as design
    from gearmath.front.design import load_blank as load_blank
    from gearmath.front.design import load_rexs as load_rexs
    from gearmath.front.design import settings_of as settings_of
    from gearmath.front.exports import export_c as export_c
    from gearmath.front.exports import export_cnc as export_cnc
    from gearmath.front.exports import export_teensy as export_teensy
    from gearmath.front.flanks import FlankSurface as FlankSurface
    from gearmath.front.flanks import Tooth as Tooth
    from gearmath.front.gearbox import HobbedGear as HobbedGear
    from gearmath.front.gearbox import Job as Job
    from gearmath.front.gearbox import choose as choose
    from gearmath.front.gearbox import hob as hob
    from gearmath.front.gearbox import plan as plan
    from gearmath.front.judged import Uncertainty as Uncertainty
    from gearmath.front.judged import load_points as load_points
    from gearmath.front.machines import Machine as Machine
    from gearmath.front.machines import load_hobber as load_hobber
    from gearmath.front.machines import load_machine as load_machine
    from gearmath.front.machines import load_probe as load_probe
    from gearmath.front.machines import load_shop as load_shop
    from gearmath.front.measured import Evaluation as Evaluation
    from gearmath.front.measured import Measurement as Measurement
    from gearmath.front.measured import load_measurement as load_measurement
    from gearmath.front.probing import ProbingProgram as ProbingProgram
    from gearmath.front.probing import calibrate as calibrate
    from gearmath.front.probing import calibrating as calibrating
    from gearmath.front.probing import load_touches as load_touches
    from gearmath.front.probing import probing as probing
    from gearmath.front.programs import Program as Program
    from gearmath.front.sets import GearSet as GearSet
    from gearmath.front.sets import Member as Member
    from gearmath.front.sets import load_set as load_set
    from gearmath.kernels import kernel as kernel
    from gearmath.lowering import lower as lower
    from gearmath.version import __version__ as __version__

#: The names of the front door, and the modules that have them.
_HOMES = {
    "gearmath.front.sets": ("load_set", "GearSet", "Member"),
    "gearmath.front.flanks": ("FlankSurface", "Tooth"),
    "gearmath.front.machines": ("load_machine", "load_shop", "load_probe", "load_hobber", "Machine"),
    "gearmath.front.programs": ("Program",),
    "gearmath.front.measured": ("load_measurement", "Measurement", "Evaluation"),
    "gearmath.front.corrected": ("Correction",),
    "gearmath.front.judged": ("load_points", "Uncertainty"),
    "gearmath.front.probing": ("probing", "calibrating", "ProbingProgram", "load_touches", "calibrate"),
    "gearmath.front.design": ("design", "PairDesign", "settings_of", "load_blank", "Blank", "load_rexs"),
    "gearmath.front.gearbox": ("plan", "Job", "hob", "HobbedGear", "choose"),
    "gearmath.front.contact": ("contact", "Contact"),
    "gearmath.front.exports": ("export_c", "export_teensy", "export_cnc"),
    "gearmath.control.store": ("MeasurementStore",),
    "gearmath.control.store_evaluation": ("evaluate_run",),
    "gearmath.demo": ("run_demo",),
    "gearmath.kernels": ("kernel",),
    "gearmath.engine.kernel": ("Kernel",),
    "gearmath.lowering": ("lower",),
    "gearmath.errors": ("InputError", "ComputationError"),
    "gearmath.version": ("__version__",),
    "derivations": ("Expression", "Quantity"),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> Any:
    """A name of the front door on first use."""
    if name in _HOME:
        return getattr(importlib.import_module(_HOME[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
