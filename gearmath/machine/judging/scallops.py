"""Where two blocks leave a ridge between them, and no line stands on it: there another line is wanted.

A cutter that goes straight past a flank that bends the other way takes most at the ends of its blocks. Each end leaves
a parabola, and where two of them meet stands a ridge. An end that is off moves the ridge aside, to between the lines.
"""

from __future__ import annotations

import numpy as np

#: Lines of a block from its start to its end, as parts of it, and how far a line may stand from there.
_SHARES, _NEAR = np.array([0.0, 0.3, 0.5, 0.7, 1.0]), 0.2
#: Parabolas of the same block are alike by this part; a block that leaves most in its middle has others.
_ALIKE = 0.35
#: How often the parabolas are worked out from what they leave at the ends, and that from them.
_TIMES = 4
#: A ridge so near to the middle of a block has a line already.
_MIDDLE = 0.02


def ridges(theta: np.ndarray, left: np.ndarray, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What blocks seem to leave at most (b,) between lines of one curve, -inf where that is unknown, and where (b,).

    The lines are generated at cradle rotations ``theta`` (n,), rising, and keep ``left`` (n,); ``ends`` (b+1,) are the
    cradle rotations of the ends of the blocks.
    """
    rolls = np.diff(ends)
    wanted = ends[:-1, None] + rolls[:, None] * _SHARES
    after = np.clip(np.searchsorted(theta, wanted), 1, len(theta) - 1)
    line = np.where(wanted - theta[after - 1] < theta[after] - wanted, after - 1, after)
    high = left[line]
    with np.errstate(all="ignore"):  # of blocks that roll on by nothing, and of lines that nothing cuts
        share = (theta[line] - ends[:-1, None]) / rolls[:, None]
        known = (np.abs(share - _SHARES) < _NEAR).all(axis=1) & np.isfinite(high).all(axis=1)
        start, end, bend = high[:, 0], high[:, 4], np.zeros(len(rolls))
        for _ in range(_TIMES):
            first = (high - start[:, None]) / share**2  # what the parabola of either end would have to be
            last = (high - end[:, None]) / (1.0 - share) ** 2
            bend = (first[:, 1] + last[:, 3]) / 2
            # the lines nearest to the ends stand beside them
            start, end = high[:, 0] - bend * share[:, 0] ** 2, high[:, 4] - bend * (1.0 - share[:, 4]) ** 2
        middle = np.maximum(first[:, 2], last[:, 2])
        known &= (bend > 0.0) & (np.abs(first[:, 1] - last[:, 3]) < _ALIKE * bend)
        known &= np.abs(middle - bend) < _ALIKE * bend
        at = (1.0 + (end - start) / bend) / 2
        peak = start + bend * at**2
        known &= (at > 0.0) & (at < 1.0) & (np.abs(at - 0.5) > _MIDDLE)
    return np.where(known, peak, -np.inf), np.where(known, ends[:-1] + at * rolls, 0.0)
