"""Plain point files, ``x y z i j k`` a row, as measuring machines take them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gearmath.files import write_text


def write_points(path: Path, member: str, flank: str, point: np.ndarray, normal: np.ndarray) -> None:
    """Points (n,3) [mm] of the work frame and outward unit normals, below lines of comment that say what they are."""
    head = [f"# member {member}", f"# flank {flank}", "# unit mm", "# x y z i j k"]
    # 1e-9 mm and 1e-12 in the normals, as in flank files
    rows = [
        " ".join([*(f"{value:.9f}" for value in at), *(f"{value:.12f}" for value in along)])
        for at, along in zip(point, normal, strict=True)
    ]
    write_text(path, "\n".join([*head, *rows]) + "\n")
