"""Work and fixture as closed outlines, out of the profiles that collisions are looked for with."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

#: How each outline is drawn, from the back to the front.
KINDS = {"fixture": "holder", "shank": "holder", "body": "work", "teeth": "teeth", "lower teeth": "teeth"}


def silhouettes(profiles: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Closed outlines (n,2) of z_w and radius, on both sides of the axis; the teeth are a band on each side."""
    hub, face = profiles["hub"], profiles["teeth"]
    gap = int(np.linalg.norm(np.diff(hub, axis=0), axis=1).argmax()) + 1  # the hub has an end at the toe and one behind
    toe, heel = hub[:gap], hub[gap:]
    band = np.vstack([face, heel[:1], toe[:1]])
    body = np.vstack([toe[::-1], face, heel])
    return {
        "fixture": _both(profiles["fixture"]),
        "shank": _both(profiles["shank"]),
        "body": _both(body),
        "teeth": band,
        "lower teeth": band * [1.0, -1.0],
    }


def _both(half: np.ndarray) -> np.ndarray:
    return np.vstack([half, (half * [1.0, -1.0])[::-1]])
