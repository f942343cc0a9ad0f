"""One pass of one tool, as positions and times: what is planned here is written there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Pass:
    """One tool roll through one tooth space: plunge, cut along ``axes``, dwell, retract."""

    tool: str
    label: str
    tooth: int
    axes: np.ndarray
    """Positions X Y Z A B at the block ends, (n, 5) mm and rad; A counts on, not modulo."""
    seconds: np.ndarray
    """Duration of each block, (n-1,) s."""
    dwell: float = 0.0
    """Time that the cutter turns at the last position, s."""
