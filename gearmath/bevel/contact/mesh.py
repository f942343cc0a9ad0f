"""How a pair runs: the contact of one pair of teeth over three pitches, and the first contact among neighboring pairs.

The error of tooth pair k is that of pair 0 k pitches earlier. The gear follows whichever pair pushes it furthest:

    lead(φ_1) = max over k and kinds of sense · (φ_2 + i φ_1)(φ_1 - k p),   p = 2π/z_1
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from gearmath.bevel.contact.changes import changes_of_kind
from gearmath.bevel.contact.leads import Gap, Leads, gaps_in_the_path, leads_over_a_pitch
from gearmath.bevel.contact.local import LocalContact, local
from gearmath.bevel.contact.places import Places, Seed, contact_line, fillet_seeds, places, seeds
from gearmath.bevel.contact.system import Assembly, System, TouchPoint
from gearmath.bevel.contact.thread import Segment, Thread, follow, zero

OUTCOMES = (
    "interior contact",
    "edge contact",
    "corner contact",
    "reversed parabola",
    "fillet contact",
    "gap in the path",
    "contact lost",
    "line contact",
)
#: Pitches to either side over which a pair of teeth is followed, and positions of a pitch at which contacts are sought.
REACH = 1.5
_SOUGHT = 4
#: Ease-off [mm] below which a pair counts as conjugate.
_CONJUGATE = 1e-6
_MOSTLY = 0.7
#: Lead [rad] of the gear half a pitch from the mean contact from which a parabola counts as reversed: 0.001 arcsec.
_REVERSED = 5e-9
_SAME_PLACE = 1e-6
#: Start values nearer than this to a thread, in u [mm], β, θ [rad] of both flanks, lead to it.
_NEAR = np.array([0.5, 0.02, 0.02] * 2)


@dataclass(frozen=True)
class MeshRow:
    """A position of a pair of teeth: rotation [rad], kind, error φ_2 + i φ_1 [rad], place on the gear [mm].

    ``x`` (7,) of the contact; None where the flanks touch along a line.
    """

    rotation: float
    kind: str
    error: float
    cone_distance: float
    height: float
    x: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class Mesh:
    """A pair of flanks in contact, at an assembly."""

    system: System
    assembly: np.ndarray
    places: Places
    threads: tuple[Thread, ...]
    reach: float = REACH

    @cached_property
    def gaps(self) -> list[Gap]:
        """Where a contact ends that is ahead of all others, the largest step first: what goes on there is not known."""
        return gaps_in_the_path(self)

    @property
    def carries_at_its_ends(self) -> bool:
        """Whether a pair of teeth is still ahead of all others where it was no longer followed."""
        limit = self.reach * self.system.pitch
        return any(abs(gap.rotation) >= limit - 1e-9 for gap in self.gaps)

    @cached_property
    def is_line(self) -> bool:
        """Whether the flanks touch along lines: no ease-off over most of the common flank, and only gaps elsewhere."""
        found = self.places
        if not found.common.any():
            return False
        ahead = self.system.sense * (found.error - np.median(found.error[found.common])) * np.abs(found.lever)
        ahead = ahead[found.common]
        return float(ahead.max()) < _CONJUGATE and float(np.mean(np.abs(ahead) < _CONJUGATE)) > _MOSTLY

    def lead(self, touch: TouchPoint) -> float:
        """sense · (φ_2 + i φ_1) [rad]."""
        return self.system.sense * self.system.transmission_error(touch)

    def rows(self, rotations: np.ndarray) -> list[MeshRow]:
        """The positions of pair 0 at rotations (n,) [rad], without those at which it has no contact."""
        if self.is_line:
            return [
                row
                for rotation in rotations
                if (row := _line_row(self.places, self.system.sense, rotation)) is not None
            ]
        best: dict[int, MeshRow] = {}
        for thread in self.threads:
            x, kinds = thread.sample(self.system, rotations)
            at = self.system.gear_places(x)
            for k in np.flatnonzero(np.isfinite(x).all(axis=1)).tolist():
                rotation = float(rotations[k])
                error = float(x[k, 6] + self.system.ratio * rotation)
                if k not in best or self.system.sense * (error - best[k].error) > 0:
                    best[k] = MeshRow(rotation, kinds[k], error, float(at[k, 0]), float(at[k, 1]), x[k])
        return [best[k] for k in sorted(best)]

    def followed(self, rotations: np.ndarray) -> np.ndarray:
        """φ_2 + i φ_1 (n,) [rad] that the gear has at rotations (n,): of all pairs of teeth the one that is ahead."""
        pairs, lead = math.ceil(self.reach + REACH), np.full(len(rotations), -np.inf)
        for k in range(-pairs, pairs + 1):
            own = rotations - k * self.system.pitch
            which = {float(rotation): j for j, rotation in enumerate(own)}
            for row in self.rows(own):
                j = which[row.rotation]
                lead[j] = max(lead[j], self.system.sense * row.error)
        return self.system.sense * np.where(np.isfinite(lead), lead, np.nan)

    def path(self, step: float) -> list[MeshRow]:
        """Positions of pair 0 at whole multiples of ``step`` [rad], and at every change of kind."""
        limit = REACH * self.system.pitch
        count = math.floor(limit / step * (1 + 1e-12))
        rotations = np.arange(-count, count + 1) * step
        changes = changes_of_kind(self.system, self.threads, limit)
        others = [at for at in changes if np.abs(rotations - at).min() > 1e-9]
        return self.rows(np.sort(np.concatenate([rotations, others])))

    @cached_property
    def reference(self) -> float | None:
        """φ_2 + i φ_1 [rad] of pair 0 at rotation zero, which errors are counted from; None without a contact there."""
        rows = self.rows(np.zeros(1))
        return rows[0].error if rows else None

    @cached_property
    def leads(self) -> Leads:
        """Which contacts the pair runs on, over a pitch."""
        return leads_over_a_pitch(self)

    @property
    def interior(self) -> list[tuple[Thread, Segment]]:
        """Where pair 0 touches within both flanks."""
        return [(thread, part) for thread in self.threads for part in thread.segments if part.kind == "interior"]

    @property
    def contact_ratio(self) -> float:
        """Rotation over which one pair of teeth touches within both flanks, over the pitch."""
        if self.is_line:
            return float(np.ptp(self.places.rotation[self.places.common])) / self.system.pitch
        return sum(part.ends[1] - part.ends[0] for _, part in self.interior) / self.system.pitch

    @cached_property
    def at_mean(self) -> tuple[TouchPoint, LocalContact] | None:
        """The contact within both flanks that is nearest to the mean point of the gear's pitch cone, if any."""
        mean = self.system.gear.blank.mean_cone_distance

        def away(touch: TouchPoint) -> float:
            distance, height = self.system.gear_place(touch.x)
            return math.hypot(distance - mean, height)

        def departing(touch: TouchPoint) -> float:
            distance, height = self.system.gear_place(touch.x)
            along, up = self.system.place_rates(touch.x) @ touch.tangent
            return float((distance - mean) * along + height * up)

        found: list[TouchPoint] = []
        for thread, segment in self.interior:
            touches = segment.touches
            k = int(np.argmin([away(touch) for touch in touches]))
            ends = touches[max(k - 1, 0)].rotation, touches[min(k + 1, len(touches) - 1)].rotation
            nearest = zero(partial(thread.at, self.system), departing, *ends)
            found += [touches[k]] if nearest is None else [touches[k], nearest]
        if not found:
            return None
        best = min(found, key=away)
        return best, local(self.system, best, self.assembly)

    @property
    def outcome(self) -> str:
        """One of ``OUTCOMES``."""
        if self.is_line:
            return "line contact"
        if self.leads.peak_to_peak is None:
            return "contact lost"
        if self.gaps:
            return "gap in the path"
        if "fillet" in self.leads.kinds:
            return "fillet contact"
        if self.at_mean is not None:
            half_pitch = self.system.pitch / 2
            if self.system.sense * self.at_mean[1].second_derivative * half_pitch**2 / 2 > _REVERSED:
                return "reversed parabola"
        return next((f"{kind} contact" for kind in ("corner", "edge") if kind in self.leads.kinds), "interior contact")


def mesh(system: System, assembly: Assembly | None = None) -> Mesh:
    """The contact of a pair of flanks at an assembly: every thread that a search along its contact lines finds.

    A pair of teeth is followed over three pitches, further where it still carries there.
    """
    vector = (assembly or Assembly()).vector
    found = places(system, vector)
    run = Mesh(system, vector, found, ())
    if run.is_line:
        return run
    for reach in (REACH, REACH + 1, REACH + 2):
        run = Mesh(system, vector, found, tuple(_threads(system, found, vector, reach)), reach)
        if not run.carries_at_its_ends:
            break
    return run


def _threads(system: System, found: Places, assembly: np.ndarray, reach: float) -> list[Thread]:
    limit = reach * system.pitch
    rotations = np.linspace(-limit, limit, round(2 * reach * _SOUGHT) + 1)
    sought = [seed for rotation in sorted(rotations, key=abs) for seed in seeds(found, float(rotation), system.sense)]
    threads: list[Thread] = []
    for seed in (*sought, *fillet_seeds(system, found)):
        if abs(seed.rotation) > limit or _near(threads, seed):
            continue
        touch = system.solve(seed.x, seed.rotation, seed.active, assembly, 12)
        if touch is None or (touch.margins < -1e-9).any() or _known(system, threads, touch):
            continue
        if not touch.active and not local(system, touch, assembly).definite:
            continue
        threads.append(follow(system, touch, assembly, -limit, limit))
    return threads


def _near(threads: list[Thread], seed: Seed) -> bool:
    """Whether one of the threads runs so near to a start value, on the same borders, that it would lead there."""
    for thread in threads:
        for segment in thread.segments:
            if segment.active == seed.active and segment.ends[0] <= seed.rotation <= segment.ends[1]:
                off = segment.between(np.array([seed.rotation]))[0] - seed.x
                if (np.abs(off[:6]) < _NEAR).all():
                    return True
    return False


def _known(system: System, threads: list[Thread], touch: TouchPoint) -> bool:
    """Whether one of the threads runs through a contact."""
    for thread in threads:
        other = thread.at(system, touch.rotation)
        if other is not None and np.abs(other.x - touch.x).max() < _SAME_PLACE:
            return True
    return False


def _line_row(found: Places, sense: float, rotation: float) -> MeshRow | None:
    """The middle of a contact line, where the whole line touches."""
    error, _, distance, along, height = contact_line(found, rotation)
    inside = np.flatnonzero((distance > -_SAME_PLACE).all(axis=1))
    if not len(inside):
        return None
    touching = inside[sense * error[inside] > (sense * error[inside]).max() - _CONJUGATE / 100.0]
    k = touching[len(touching) // 2]
    return MeshRow(rotation, "interior", float(error[k]), float(along[k]), float(height[k]))
