"""Why one pair of teeth does not take over from the next within the flanks, and what would let it."""

from __future__ import annotations

import math
from typing import get_args

from gearmath.bevel.contact.mesh import Mesh
from gearmath.bevel.contact.report import on_fillets
from gearmath.bevel.design.request import Request
from gearmath.specs.design import ContactRequest, Free

FILLET = "fillet contact"
#: Settings that leave more than this of the wanted ease-off [um RMS] are what keeps the pair on its edges.
_LEFT = 2.5


def reason(run: Mesh, vertex: float | None) -> str:
    """How far a pair of teeth touches within the flanks about its vertex [rad], in pitches."""
    pitch, over = run.system.pitch, f"a pair of teeth touches within both flanks over {run.contact_ratio:.3g} pitches"
    if run.outcome == "reversed parabola":
        return f"{over}, but the gear runs ahead at both ends of its path"
    on = f"{' and '.join(on_fillets(run))}: " if run.outcome == FILLET else ""
    ends = [part.ends for _, part in run.interior if vertex is not None and part.ends[0] <= vertex <= part.ends[1]]
    if vertex is None or not ends:
        return f"{on}{over}, but has no vertex of its parabola there"
    before, after = (vertex - ends[0][0]) / pitch, (ends[0][1] - vertex) / pitch
    where = f"from {before:.2f} pitches before the vertex of its parabola to {after:.2f} after it"
    if min(before, after) > 0.5:
        return f"{on}a pair of teeth touches within both flanks {where}, but on an edge it is ahead of the next pair"
    return (
        f"{on}a pair of teeth touches within both flanks {where}, and must do so half a pitch to either side to take "
        "over from the one before"
    )


def advice(
    outcome: str, asked: ContactRequest, wanted: Request, rms: float, free: tuple[str, ...], stepped: bool
) -> str:
    """What helps, what helps most first: ``rms`` [um] is what the ``free`` settings leave of the wanted ease-off."""
    changes = ["finer steps in [shop]"] * stepped
    more = [f"more settings in pinion.free ({rms:.3g} um RMS of the wanted ease-off are left)"]
    more *= rms > _LEFT and set(free) < set(get_args(Free))
    at_once = outcome in ("reversed parabola", FILLET)  # neither is near to the wanted ease-off
    if at_once:
        changes += more
    if asked.lengthwise_crowning is not None:
        if asked.bias:
            changes.append(f"a bias nearer to 0 (now {asked.bias:g} um)")
        changes.append(f"a smaller profile_crowning (now {asked.profile_crowning:g} um)")
    else:
        way = "smaller" if wanted.side == "drive" else "larger"
        changes.append(f"a {way} path_angle (now {math.degrees(wanted.path_angle):.4g} degrees)")
    if asked.position is not None:
        changes.append(f"a position nearer to the middle (now {asked.position[0]:g}, {asked.position[1]:g})")
    if not at_once:
        changes += more
    return f"{', '.join(changes[:-1])} or {changes[-1]}" if changes[1:] else changes[0]
