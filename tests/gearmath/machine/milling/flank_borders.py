"""What a hobbing program leaves at the borders of flanks, where most is left: at face cone, Toprem and fillet."""

import math

import numpy as np

from gearmath.bevel.tooth import SHARP_EDGE, tooth_space
from gearmath.bevel.turning import turned
from gearmath.machine.milling.mill import expose
from gearmath.machine.milling.run import runs_of
from gearmath.specs.bevel_set import FLANKS

#: Rows of the main section of a flank, as a tooth space has them.
_MAIN = 17
#: About so many teeth are looked at.
_TEETH = 20


def left_at_borders(path, spec, machine):
    """Distances (n,) [mm] of the flanks from the nominal ones."""
    (run,) = runs_of(path, spec, machine, None, None, SHARP_EDGE)
    angles = 2 * math.pi * np.arange(0, spec.teeth, 1 + spec.teeth // _TEETH) / spec.teeth
    left, space = [], tooth_space(spec, 9)
    for part in (getattr(space, flank) for flank in FLANKS):
        rows = [0, _MAIN - 1, part.section.index("edge") - 1]
        lines = (part.point[rows].reshape(-1, 3), part.normal[rows].reshape(-1, 3))
        point, normal = (np.concatenate([turned(values, angle) for angle in angles]) for values in lines)
        left.append(expose([run], machine, None, point, normal, np.full(len(point), -1.0)).distance)
    return np.concatenate(left)
