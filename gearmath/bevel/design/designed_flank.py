"""One flank of a pinion as it was designed, whatever the way of cutting."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmath.bevel.design.request import Request


@dataclass(frozen=True)
class FlankFit:
    """The ease-off less what was wanted at places of the gear's flank (n,) [mm], and the bounds that were reached."""

    off: np.ndarray
    active: tuple[str, ...]

    @property
    def rms(self) -> float:
        return float(np.sqrt(np.mean(self.off**2)))


@dataclass(frozen=True)
class DesignedFlank:
    """What was asked of a flank, its vector ``x`` of ``local_settings.NAMES``, and how well it fits.

    ``share`` is the part of the gear's places that the blade reaches: there it was fitted.
    """

    name: str
    request: Request
    x: np.ndarray
    fitted: FlankFit
    share: float
