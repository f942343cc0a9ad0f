"""Places on a flank as a list: one z_w and r_w a line [mm], with blanks, commas, semicolons or tabs between them."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np

from gearmath.errors import InputError, counted
from gearmath.files import read_text

#: More than anybody measures on one flank.
MOST_PLACES = 1_000_000


def read_places(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """z_w (n,) and r_w (n,) [mm] of a list; lines before the first number, empty lines and comments (#) are skipped.

    Raises InputError naming file, line and what is wrong there.
    """
    places: list[tuple[float, float]] = []
    for number, line in enumerate(read_text(path).splitlines(), 1):
        cells = [cell for cell in re.split(r"[,;\s]+", line.partition("#")[0]) if cell]
        if not cells or (not places and not any(_is_number(cell) for cell in cells)):
            continue
        if len(cells) != 2 or not all(_is_number(cell) for cell in cells):
            raise InputError(f"{path}, line {number}: {line.strip()!r}: must be z_w and r_w, two numbers in mm")
        z, radius = (float(cell) for cell in cells)
        if not (math.isfinite(z) and math.isfinite(radius) and radius > 0):
            raise InputError(f"{path}, line {number}: {line.strip()!r}: must be finite, with a radius above 0")
        places.append((z, radius))
    if not 0 < len(places) <= MOST_PLACES:
        raise InputError(f"{path}: holds {counted(len(places), 'place')}, must hold 1 to {MOST_PLACES}")
    axial, radial = np.array(places).T
    return axial, radial


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
