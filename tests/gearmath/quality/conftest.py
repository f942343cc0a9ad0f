"""Small flank files made by hand."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest

from gearmath.specs.flank_csv import FlankFile, flank_file, join

HEADER = {
    "member": "pinion", "member_teeth": "4", "frame": "w", "unit": "mm", "grid": "5x9", "margins": "0.1,0.1",
    "reference_point": "2,4", "phase_zeroed": "false", "tip_radius_mm": "0", "settings_sha256": "0" * 64,
}  # fmt: skip


@pytest.fixture
def teeth() -> Callable[..., FlankFile]:
    """``teeth(deviations, radius, slope)``: the reference point of every tooth, at ``radius`` on the x axis of tooth 0.

    The normal makes the angle ``slope`` with the direction of rotation. Teeth may be given in any order.
    """

    def make(
        deviations: Sequence[float], radius: float = 50.0, slope: float = 0.0, flank: str = "concave",
        order: Sequence[int] | None = None, place: tuple[int, int] = (2, 4),
    ) -> FlankFile:  # fmt: skip
        files = []
        for tooth in order if order is not None else range(len(deviations)):
            turn = 2 * math.pi * tooth / 4
            c, s = math.cos(turn), math.sin(turn)
            about = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
            point, normal = [[radius, 0, 20.0]] @ about.T, [[0, math.cos(slope), math.sin(slope)]] @ about.T
            files.append(flank_file(
                HEADER, "pinion", flank, tooth, np.array([place[0]]), np.array([place[1]]), point, normal,
                np.array([deviations[tooth]]),
            ))  # fmt: skip
        return join(files)

    return make


@pytest.fixture
def plane() -> Callable[..., FlankFile]:
    """``plane(deviation, rows, columns)``: a flat flank, tilted in space; ``deviation`` is a function of X and Y.

    X runs along the tooth and Y up the profile from the reference point, in mm; points come in a mixed order.
    """

    def make(deviation: Callable[[np.ndarray, np.ndarray], np.ndarray], rows: int = 5, columns: int = 9) -> FlankFile:
        row, col = (index.ravel() for index in np.indices((rows, columns)))
        along, up = (col - columns // 2) * 2.5, (row - rows // 2) * 1.25
        a, b = 0.4, -0.7  # the plane's own directions, orthonormal
        e1 = np.array([math.cos(a), math.sin(a) * math.cos(b), math.sin(a) * math.sin(b)])
        e2 = np.array([-math.sin(a), math.cos(a) * math.cos(b), math.cos(a) * math.sin(b)])
        point = np.array([10.0, 20.0, 60.0]) + along[:, None] * e1 + up[:, None] * e2
        normal = np.tile(np.cross(e1, e2), (len(point), 1))
        mixed = np.random.default_rng(2).permutation(len(point))
        header = HEADER | {"grid": f"{rows}x{columns}", "reference_point": f"{rows // 2},{columns // 2}"}
        return flank_file(
            header, "pinion", "concave", 0, row[mixed], col[mixed], point[mixed], normal[mixed],
            np.broadcast_to(deviation(along, up), along.shape)[mixed],
        )  # fmt: skip

    return make
