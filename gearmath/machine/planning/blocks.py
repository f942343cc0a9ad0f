"""G1 blocks for a pass: as few as the flank allows.

G1 moves all axes linearly from node to node, and the nodes lie on the exact path. Between them the cutter leaves it.
What counts is what that does to the flank, measured along the tooth normal: at every flank point, the distance at
which the normal enters the swept blade has one smallest value within the block, and that value is the deviation which
the block leaves there. A part of a block deviates less than the block, so that the longest feasible block, again and
again, gives the fewest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Self

import casadi as ca
import numpy as np

from derivations import Quantity, notation
from gearmath.engine.kernel import Kernel
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.machine.planning.lines import GeneratedLines, flank_rows, foot_curves, joined
from gearmath.machine.planning.path import DEFAULT_TOLERANCE, Cut, axis_positions, roll_range
from gearmath.specs.bevel_set import Flank, Member

#: What five printed decimals of X Y Z [mm] and six of A B [deg], at 100 mm from either axis, may do to the flank.
ROUNDING = 0.5e-5 * math.sqrt(3) + 2 * math.radians(0.5e-6) * 100.0
#: Tolerances that can be asked for. [mm]
TOLERANCES = (1e-5, 0.1)
#: Where along a block each row of flank points is looked at: its middle, where most is left, among them.
_FRACTIONS = np.array([-0.3, -0.07, *np.linspace(0.0, 1.0, 9), 1.07, 1.3])
#: Blocks from this roll on [rad] are compared with one in so many points of the flanks, at these parts of the block.
_LONG, _SOME, _INNER = math.radians(0.7), 15, np.linspace(0.1, 0.9, 9)
#: A point that the exact path comes this near to, or nearer, is still one of the flank. [mm]
_UNTOUCHED = 1e-5
#: So many of the lowest and of the highest points of a block are refined.
_REFINED = 40
#: Safety factor between samples: what lies between them may be more than what they show.
_BETWEEN = 0.975
#: A block is long enough when it uses this part of the tolerance; no block rolls further than this [rad].
_USED, _LONGEST = 0.96, math.radians(3.0)


@cache
def entry_within_block(degree: int = 1) -> Kernel:
    """Kernel: distance of entry at a fraction of a block, with its first and second derivative by the fraction.

    A straight block is given by its ends, one of a higher ``degree`` by the coefficients of all powers of the fraction.
    """
    shapes = {"axes_first": "axis positions at the start of the block", "axes_last": "at its end"}
    if degree > 1:
        shapes = {f"axes_{power}": f"coefficients of power {power} of the fraction" for power in range(degree + 1)}
    ends = tuple(
        Quantity(name, text, "mixed", name, shape=(5,), components=notation.axes.components)
        for name, text in shapes.items()
    )
    fraction = Quantity("fraction", "0 at the start of the block, 1 at its end", "1", "s", (0.0, 1.0))
    slope = Quantity("slope", "derivative of the distance by the fraction", "mm", "t'")
    curvature = Quantity("curvature", "second derivative of the distance by the fraction", "mm", "t''")
    rest = kernel("line_entry").inputs[1:]
    symbols = [ca.SX.sym(q.name, max(q.size, 1)) for q in (*ends, fraction, *rest)]
    powers, s, others = symbols[: len(ends)], symbols[len(ends)], symbols[len(ends) + 1 :]
    where = powers[0] + s * (powers[1] - powers[0]) if degree == 1 else horner(powers, s)
    distance = kernel("line_entry").function(where, *others)
    second, gradient = ca.hessian(distance, s)
    function = ca.Function(
        "entry_within_block" if degree == 1 else f"entry_within_block_of_degree_{degree}",
        symbols,
        [distance, gradient, second],
        [*shapes, "fraction", *(q.name for q in rest)],
        ["line_distance", "slope", "curvature"],
    )
    return Kernel(
        function,
        f"Entry of a line into the swept blade along {'a straight block' if degree == 1 else 'a polynomial block'}.",
        (*ends, fraction, *rest),
        (notation.line_distance, slope, curvature),
        f"line_entry (6.4) along a {'G1' if degree == 1 else 'POLY'} block",
    )


def horner(powers: list[ca.SX], s: ca.SX) -> ca.SX:
    """A polynomial of s from the coefficients of its powers, the lowest first."""
    value = powers[-1]
    for coefficient in reversed(powers[:-1]):
        value = coefficient + s * value
    return value


@dataclass(frozen=True)
class ExactPass:
    """The exact path of one pass, and rows of flank points that it generates.

    ``lines`` holds all rows, one behind the other, their cradle rotations rising within each; ``rows`` holds where
    each begins, and the rotations halfway between its points.
    """

    flank: Flank
    pivot_height: float
    pivot_offset: np.ndarray
    lines: GeneratedLines
    rows: tuple[tuple[int, np.ndarray], ...]

    @property
    def degree(self) -> int:
        """Of the blocks that follow the path."""
        return 1

    @classmethod
    def of(cls, member: Member, cut: Cut, pivot_height: float, pivot_offset: np.ndarray) -> Self:
        """Points over the whole flanks of a pass, down to the root."""
        found = [row for flank in cut.flanks for row in (*flank_rows(member, flank), *foot_curves(member, flank))]
        begin = np.cumsum([0, *map(len, found)]).tolist()
        halfway = ((row.theta[1:] + row.theta[:-1]) / 2 for row in found)
        rows = tuple((k, between) for k, between, row in zip(begin, halfway, found, strict=False) if len(row))
        return cls(member.flank(cut.flanks[0]), pivot_height, pivot_offset, joined(found), rows)

    def block(self, start: float, end: float) -> np.ndarray:
        """The block that follows a part of the path, as ``entry_within_block`` takes it: (k,5), here its ends."""
        return axis_positions(self.flank, np.array([start, end]), self.pivot_height, self.pivot_offset)

    def along(self, block: np.ndarray, fractions: np.ndarray) -> np.ndarray:
        """Positions (n,5) at fractions (n,) of a block."""
        return block[0] + fractions[:, None] * (block[-1] - block[0])

    def deviation(self, start: float, end: float) -> float:
        """The largest deviation [mm] that a block leaves: on points within its roll, and as gouges beside it."""
        wanted = start + _FRACTIONS * (end - start)
        chosen = np.concatenate([first + np.searchsorted(halfway, wanted) for first, halfway in self.rows])
        block = self.block(start, end)
        left = self._smallest(block, start, end, chosen)
        # what the exact path takes away at an end of the block, beyond the ends of the flank, is not the block's doing
        low = np.flatnonzero(left < -_UNTOUCHED)
        ends = self.along(block, np.array([0.0, 1.0]))
        left[low[self._at(ends, chosen[low]).min(axis=1) < -_UNTOUCHED]] = 0.0
        inside = (self.lines.theta[chosen] >= start) & (self.lines.theta[chosen] <= end)
        lowest = (
            float(left.min()) if end - start < _LONG else min(float(left.min()), self._elsewhere(block, start, end))
        )
        return max(-lowest, float(left[inside].max(initial=0.0)))

    def _elsewhere(self, block: np.ndarray, start: float, end: float) -> float:
        """Smallest distance [mm] that a long block has from points all over the flanks, its ends left out.

        The tool may come near to a point twice, and Newton's steps from its contact see one of these times. Points that
        the exact path takes away there, beyond the ends of the flank, do not count.
        """
        last = [*(first for first, _ in self.rows[1:]), len(self.lines)]
        some = np.union1d(np.arange(0, len(self.lines), _SOME), np.array(last) - 1)
        theta = np.concatenate([[start], start + _INNER * (end - start), [end]])
        exact = axis_positions(self.flank, theta, self.pivot_height, self.pivot_offset)
        left, path = (self._at(axes, some) for axes in (self.along(block, _INNER), exact[1:-1]))
        kept = path.min(axis=1) > -_UNTOUCHED
        return float(left[kept].min(initial=math.inf))

    def _at(self, axes: np.ndarray, chosen: np.ndarray) -> np.ndarray:
        """Distances (n, k) of entry of n points at k positions of the axes."""
        lines, every = self.lines.at(np.repeat(chosen, len(axes))), np.tile(axes, (len(chosen), 1))
        (distance,) = kernel("line_entry")(every, self.pivot_height, *lines.on_blade, self.pivot_offset)
        return distance.reshape(len(chosen), len(axes))

    def _smallest(self, block: np.ndarray, start: float, end: float, chosen: np.ndarray) -> np.ndarray:
        """Smallest distance of entry (n,) within a block: Newton from the contact on the exact path.

        What is left of the slope after a step is taken off as if the curvature held: t - t'²/(2 t''). The second step
        is made only where the first one shows the extremes, until these are among those that were refined.
        """
        s = np.clip((self.lines.theta[chosen] - start) / (end - start), 0.0, 1.0)
        at_contact, smallest, change = self._step(block, s, chosen)
        once = np.ones(len(chosen), dtype=bool)
        while once[(order := np.argsort(smallest))[[0, -1]]].any():
            again = np.union1d(order[:_REFINED], order[-_REFINED:])
            again = again[once[again]]
            there, found, _ = self._step(block, (s + change)[again], chosen[again])
            # a line at the foot of the flank that has left the blade by its tip tells nothing of the flank any more
            smallest[again] = np.where(there <= at_contact[again], found, at_contact[again])
            once[again] = False
        return smallest

    def _step(self, block: np.ndarray, s: np.ndarray, chosen: np.ndarray) -> tuple[np.ndarray, ...]:
        """Distance (n,) at fractions ``s`` (n,) of the block, the smallest as seen from there, the way there."""
        given = (*block, s, self.pivot_height, *self.lines.at(chosen).on_blade, self.pivot_offset)
        distance, slope, curvature = entry_within_block(self.degree)(*given)
        curved = np.where(curvature > 0, curvature, math.inf)
        change = np.clip(s - slope / curved, 0.0, 1.0) - s
        return distance, np.minimum(distance, distance + (slope + curvature * change / 2) * change), change


def check_tolerance(tolerance: float, decimals: float = ROUNDING, low: float = TOLERANCES[0]) -> None:
    """Raises InputError for a tolerance [mm] out of range; ``decimals`` [mm] is what printed ones may take of it."""
    high = TOLERANCES[1]
    if not low <= round(tolerance, 12) <= high:  # 0.015 um in mm is a last digit less than 1.5e-5
        raise InputError(
            f"tolerance = {tolerance * 1000:g} um: must lie between {low * 1000:g} and {high * 1000:g} um; the printed "
            f"decimals alone may take {decimals * 1000:.3f} um"
        )


def roll_nodes(
    member: Member,
    cut: Cut,
    tolerance: float = DEFAULT_TOLERANCE,
    pivot_height: float = 0.0,
    pivot_offset: np.ndarray | None = None,
    rounding: float = ROUNDING,
) -> np.ndarray:
    """Cradle rotations (n,) [rad] of the block ends: the fewest blocks that keep the flanks within the tolerance [mm].

    Of that, ``rounding`` [mm] is left for the increments of the control, but never more than half.
    Raises InputError for a tolerance out of range.
    """
    offset = (0.0, 0.0, 0.0) if pivot_offset is None else tuple(map(float, pivot_offset))
    return _roll_nodes(member, cut, tolerance, pivot_height, offset, rounding).copy()


@lru_cache(maxsize=64)
def _roll_nodes(
    member: Member, cut: Cut, tolerance: float, pivot_height: float, pivot_offset: tuple[float, ...], rounding: float
) -> np.ndarray:
    """They are asked for again by whatever plans the same pass again: another space, a sheet, a settings file."""
    member = on_one_machine(member, cut)
    exact = ExactPass.of(member, cut, pivot_height, np.array(pivot_offset))
    return fewest_nodes(exact, roll_range(member, cut), tolerance, rounding, _LONGEST)


def fewest_nodes(
    exact: ExactPass, roll: tuple[float, float], tolerance: float, rounding: float, longest: float
) -> np.ndarray:
    """Ends (n,) [rad] of the longest feasible blocks, one behind the other, through a roll; none rolls ``longest``."""
    check_tolerance(tolerance)
    start, end = roll
    budget = _BETWEEN * (tolerance - min(rounding, tolerance / 2))
    nodes, width = [start], longest / 10
    while nodes[-1] < end:
        width = _longest(exact, nodes[-1], width, budget, longest)
        nodes.append(min(nodes[-1] + width, end))
    return np.array(nodes)


def on_one_machine(member: Member, cut: Cut) -> Member:
    """The member with all flanks of a pass at the machine settings of its first, which are what the pass runs at."""
    first = member.flank(cut.flanks[0])
    shared = {name: getattr(first, name) for name in member.shared_settings}
    return member.model_copy(update={name: member.flank(name).model_copy(update=shared) for name in cut.flanks})


def _longest(exact: ExactPass, start: float, guess: float, budget: float, longest: float) -> float:
    """Roll [rad] of the longest block from ``start``: deviations grow with a power of the block, then bisection.

    The power is the square of straight blocks, and one more than the degree of polynomials that meet the path smoothly.
    """
    feasible, infeasible, width = 0.0, math.inf, min(guess, longest)
    for _ in range(40):
        used = exact.deviation(start, start + width) / budget
        if used <= 1.0:
            feasible = width
            if used >= _USED or width >= longest or infeasible - width < 1e-3 * width:
                break
        else:
            infeasible = width
        grown = (1 + _USED) / 2 / max(used, 0.05 if exact.degree == 1 else 1e-4)
        wanted = width * (math.sqrt(grown) if exact.degree == 1 else grown ** (1 / (exact.degree + 1)))
        if not feasible < wanted < infeasible:
            wanted = (feasible + infeasible) / 2
        width = min(wanted, longest)
    if feasible == 0.0:
        raise InputError(
            f"at cradle angle {math.degrees(start):.3f} deg no block keeps the flank within {budget * 1000:g} um"
        )
    return feasible
