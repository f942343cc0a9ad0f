"""Where the uncertainty of measured points comes from: a number, the file, or a model of how the machine measures."""

from __future__ import annotations

from gearmath.quality.uncertainty.corrected import point_covariance
from gearmath.quality.uncertainty.covariance import Covariance
from gearmath.quality.uncertainty.touch_model import touch_covariance
from gearmath.specs.bevel_set import Member
from gearmath.specs.calibration import load_calibration
from gearmath.specs.flank_csv import FlankFile
from gearmath.specs.measurement import load_measurement
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import find

#: The model that is taken where nothing is said.
_BUNDLED = "measurement.toml"


def covariance_of(
    file: FlankFile, member: Member, sigma_um: float | None, model: str | None, machine: str, calibration: str
) -> tuple[Covariance, str]:
    """The covariance of the deviations, and in words where it comes from.

    ``sigma_um`` is that of every point, ``model`` the file of a :class:`~gearmath.specs.measurement.MeasuringModel` for
    the files of ``machine`` and ``calibration``. Raises InputError for a file that is none.
    """
    known = point_covariance(file, sigma_um)
    if known is not None and model is None:
        return known, "u_um of the file" if sigma_um is None else f"{sigma_um:g} um at every point"
    how = load_measurement(find(model or _BUNDLED))
    spindle, probe = load_milling_machine(find(machine)), load_calibration(find(calibration))
    assumed = "" if model else " (assumed: the file has no u_um; give --sigma-um or --model)"
    return touch_covariance(file, member, how, spindle, probe), f"{model or _BUNDLED}: {how.title}{assumed}"
