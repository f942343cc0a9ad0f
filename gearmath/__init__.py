"""gearmath: gear cutting from first principles to metal.

    import gearmath as gm

    pair = gm.load_set("nasa_tp3096_12x36.toml")  # a bundled set, or a file
    off = pair.pinion.with_settings(concave={"radial_distance": +0.05})  # mm
    measured = off.deviations()
    measured.plot()
    measured.compensate()

What a call returns tells its figures where it is printed, and shows them as a table in Jupyter. docs/api.md has all
names. Importing loads nothing: each name is loaded when it is used, every chapter is derived when it is.
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
    from gearmath.front import hobbing as hobbing
    from gearmath.front import results as results
    from gearmath.front.design import design as design
    from gearmath.front.design import load_blank as load_blank
    from gearmath.front.design import settings_of as settings_of
    from gearmath.front.exports import export_c as export_c
    from gearmath.front.exports import export_cnc as export_cnc
    from gearmath.front.kernels import kernel as kernel
    from gearmath.front.machines import Machine as Machine
    from gearmath.front.machines import load_machine as load_machine
    from gearmath.front.machines import load_probe as load_probe
    from gearmath.front.machines import load_shop as load_shop
    from gearmath.front.measured import Measurement as Measurement
    from gearmath.front.measured import load_measurement as load_measurement
    from gearmath.front.member import Member as Member
    from gearmath.front.programs import Program as Program
    from gearmath.front.sets import GearSet as GearSet
    from gearmath.front.sets import load_set as load_set
    from gearmath.lowering import lower as lower
    from gearmath.version import __version__ as __version__

#: The names of the front door, and the modules that have them.
_HOMES = {
    "gearmath.front.sets": ("load_set", "GearSet"),
    "gearmath.front.member": ("Member",),
    "gearmath.front.machines": ("load_machine", "load_shop", "load_probe", "Machine"),
    "gearmath.front.programs": ("Program",),
    "gearmath.front.measured": ("load_measurement", "Measurement"),
    "gearmath.front.design": ("design", "settings_of", "load_blank"),
    "gearmath.front.exports": ("export_c", "export_cnc"),
    "gearmath.control.store": ("MeasurementStore",),
    "gearmath.control.store_evaluation": ("evaluate_run",),
    "gearmath.demo": ("run_demo",),
    "gearmath.front.kernels": ("kernel",),
    "gearmath.engine.kernel": ("Kernel",),
    "gearmath.lowering": ("lower",),
    "gearmath.errors": ("InputError", "ComputationError"),
    "gearmath.version": ("__version__",),
    "derivations": ("Expression", "Quantity"),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}
#: Those that are modules of names: the electronic gearbox, and the records that calls return.
_MODULES = {name: f"gearmath.front.{name}" for name in ("hobbing", "results")}

__all__ = sorted({**_HOME, **_MODULES})


def __getattr__(name: str) -> Any:
    """A name of the front door on first use."""
    if name in _MODULES:
        return importlib.import_module(_MODULES[name])
    if name in _HOME:
        return getattr(importlib.import_module(_HOME[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
