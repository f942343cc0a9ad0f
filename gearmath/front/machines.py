"""Machines, simulated shops and probes from their files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from gearmath.arguments.call import checked_call
from gearmath.arguments.kinds import Record
from gearmath.shown import Shown, Shows
from gearmath.specs.calibration import Calibration, load_calibration
from gearmath.specs.hobbing import HobbingMachine, load_hobbing_machine
from gearmath.specs.milling_machine import MillingMachine, load_milling_machine
from gearmath.specs.simulated_machine import SimulatedMachine, load_simulated_machine
from gearmath.specs.toml import find, rechecked

if TYPE_CHECKING:
    from gearmath.front.probing import ProbingProgram
    from gearmath.quality.calibration.axes import AxisCalibration
    from gearmath.quality.calibration.tip import Tip


@checked_call(spec=Record("gearmath.specs.milling_machine", "MillingMachine", "the checked content of a machine file"))
@dataclass(frozen=True, repr=False)
class Machine(Shown):
    """A vertical 5-axis milling machine; ``spec`` is the checked content of its file (docs/machine_files.md)."""

    spec: MillingMachine

    def __post_init__(self) -> None:
        object.__setattr__(self, "spec", rechecked(self.spec, str(self.spec.name)))

    def to_dict(self) -> dict[str, Any]:
        """The machine with the keys of its file, mm and degrees."""
        return self.spec.model_dump(exclude_defaults=True)

    def calibrating(
        self, cycle: Literal["tip", "axes"] = "tip", name: str = "CALIBRATE", **options: Any
    ) -> ProbingProgram:
        """The program that touches ring and sphere on the table for the tip of the probe, or with "axes" the sphere on
        the work side for the rotary axes.

        ``options``: probe, as of :func:`gearmath.load_probe`; control, "sinumerik" or "linuxcnc", by default that of
        the machine. Raises InputError naming what the machine cannot do.
        """
        from gearmath.front.probing import calibrating

        return calibrating(self, cycle=cycle, name=name, **options)

    @checked_call
    def calibrate(
        self,
        path: str | Path,
        probe: Calibration | str | Path | None = None,
        lobing: bool = False,
        run: int | None = None,
    ) -> Tip | AxisCalibration:
        """The tip of the probe from touches on sphere or ring, or the rotary axes from those on the work side's sphere.

        Returns of the tip ``radius``, ``offset`` (3,) [mm] and ``lobes`` (amplitude [mm], azimuth [rad]), of the axes
        ``pivot_offset`` (3,), ``gauge_line_height``, ``x_zero`` [mm] and ``b_zero`` [rad], both with standard
        uncertainties [mm, rad] and residuals in ``fit``. By default those of the last run, which must be whole;
        ``lobing`` finds what the tip's radius does around, too. Raises InputError naming file and touch.
        """
        from gearmath.front.probing import calibrate

        return calibrate(path, self, probe, lobing, run)

    def _shown(self) -> tuple[str, list[Shows]]:
        spec = self.spec
        figures: list[Shows] = [
            ("control", spec.control.kind or "sinumerik", ""),
            ("tool length", spec.tool_length, "mm"),
        ]
        return spec.name, figures


@checked_call
def load_machine(path: str | Path = "vertical_5axis.toml") -> Machine:
    """Read a milling machine: a TOML file, or a bundled one. Raises InputError naming key, value and limit.

    >>> import gearmath as gm
    >>> gm.load_machine().spec.name
    'Vertical 5-axis machine'
    """
    return Machine(load_milling_machine(find(str(path))))


@checked_call
def load_shop(path: str | Path = "simulated_shop.toml") -> SimulatedMachine:
    """Read what is wrong with a simulated machine, its clamping and its probe. Raises InputError.

    Returns the checked content of the file, with its keys as attributes (docs/machine_files.md): what ``shop=`` of
    :meth:`Program.mill` and others takes.
    """
    return load_simulated_machine(find(str(path)))


@checked_call
def load_probe(path: str | Path = "probe.toml") -> Calibration:
    """Read a calibrated probe. Raises InputError.

    Returns the checked content of the file, with its keys as attributes, mm and degrees (docs/machine_files.md): what
    ``probe=`` of :meth:`Member.probing` and others takes.
    """
    return load_calibration(find(str(path)))


@checked_call
def load_hobber(path: str | Path = "hobbing_plewes.toml") -> HobbingMachine:
    """Read a hobbing machine or lathe with an electronic gearbox. Raises InputError."""
    return load_hobbing_machine(find(str(path)))


def machine_of(given: Machine | str | Path | None) -> Machine:
    """A machine, or that of a file; the bundled one where nothing is given."""
    return given if isinstance(given, Machine) else load_machine() if given is None else load_machine(given)


def probe_of(given: Calibration | str | Path | None) -> Calibration:
    """A probe, or that of a file; the bundled one where nothing is given."""
    if isinstance(given, Calibration):
        return rechecked(given, "probe")
    return load_probe() if given is None else load_probe(given)


def shop_of(given: SimulatedMachine | str | Path | None) -> SimulatedMachine | None:
    """What is wrong with a simulated machine, or what a file says of it; nothing where nothing is given."""
    if isinstance(given, str | Path):
        return load_shop(given)
    return None if given is None else rechecked(given, "shop")


def hobber_of(given: HobbingMachine | str | Path) -> HobbingMachine:
    """A hobbing machine or lathe, or that of a file."""
    return rechecked(given, "machine") if isinstance(given, HobbingMachine) else load_hobber(given)
