"""What the samples of a servo thread tell."""

from __future__ import annotations

import numpy as np


def farthest(samples: np.ndarray, ends: np.ndarray) -> float:
    """How far samples (n,5) are from the straight blocks between positions (m,5) at most, a degree counted as a mm."""
    start, way = ends[:-1], np.diff(ends, axis=0)
    from_start = samples[:, None] - start
    share = np.clip((from_start * way).sum(axis=2) / (way**2).sum(axis=1), 0.0, 1.0)
    return float(np.linalg.norm(from_start - share[..., None] * way, axis=2).min(axis=1).max())
