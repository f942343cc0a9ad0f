"""How a measurement closes: tooth 0 measured again at the end, and whether work or machine drifted or slipped between.

What both measurements of tooth 0 differ by is the return value. Where it exceeds its uncertainty on both flanks, or at
several points of one, the work or the machine has moved: such points are no misses. How it moved in between, the teeth
tell where they are even enough (module ``courses``). A steady drift is taken out evenly. After a step or an uneven
drift, or where none is told and pitch or runout depends on it by more than a grade, the pitch is not known. A step
inside the tooth that was measured in full, on one of its flanks (module ``slips``) or between them, or beside it,
leaves neither thickness nor topography; nor does an uneven drift, or a motion of which it is not told when it was.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.quality.evaluation.courses import LEAST_TEETH, Told, by_flank, references, slip_patterns, tell_course
from gearmath.quality.evaluation.drift import evenly, measured_twice, moved_by
from gearmath.quality.evaluation.pitch import reference_point
from gearmath.quality.evaluation.registration import stated_noise
from gearmath.quality.evaluation.slips import Slip, find_slip, slip_between
from gearmath.quality.evaluation.tooth_shifts import CONFIRMS, LEAST_BETWEEN_TEETH
from gearmath.quality.evaluation.topography import evaluate_topography, teeth_in_full
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile

#: A return value counts from so many standard uncertainties; those of a point whose uncertainty is not known. [mm]
_SIGNIFICANT, _UNKNOWN = 3.0, 1e-3
#: A flank does not feel a motion that changes it by less than this part of what it changes the other.
_UNFELT = 0.15
#: A slip between the flanks of a tooth counts from so many standard uncertainties of the width of a space; those are
#: told by the median of the distances of the others from theirs.
_BETWEEN, _MAD = 4.0, 1.4826
#: A drift that grows with the square of the time is farthest from an even one at half of it, by this part. Over one
#: turn of the work nine tenths of that are a first harmonic, which eccentricity has too.
_CURVED = 0.25
Kind = Literal["not measured", "still"] | Told


@dataclass(frozen=True)
class Closing:
    """What tooth 0, measured again, says.

    ``kind`` is "still" where it does not differ beyond its uncertainty, or by single points that missed; "small" where
    it does, but the pitch depends on how it moved by less than a grade. ``course``
    (n,) is the part of the return value that every row of the file has, ``taken`` (n,) [mm] what it makes of its
    deviation. ``arcs`` [mm] are those by which each flank of tooth 0 is turned at the end, right-handed about z_w, with
    the standard ``uncertainty`` [mm] of one. ``teeth`` are those before and after a step.
    ``doubt`` (n,q) [mm] is how the deviations would differ by the likeliest step and the likeliest uneven drift,
    or by a slip.
    ``slip`` is one inside a tooth that was measured in full; ``beside`` says that a step was beside such a tooth.
    """

    kind: Kind
    course: np.ndarray
    taken: np.ndarray
    arcs: dict[str, float]
    uncertainty: float
    teeth: tuple[int, int] | None = None
    doubt: np.ndarray | None = None
    slip: Slip | None = None
    beside: bool = False

    def straightened(self, file: FlankFile) -> FlankFile:
        """The file in which single points that missed are to be looked for: without the motion, where there was one."""
        moved = self.taken if self.moved else np.zeros(len(file))
        return replace(file, deviation=file.deviation - moved, point=file.point - moved[:, None] * file.normal)

    @property
    def moved(self) -> bool:
        """Whether the work or the machine moved for certain."""
        return self.kind in ("steady", "step", "uneven", "not told")

    @property
    def arc(self) -> float:
        """The largest of the arcs [mm], without its sign."""
        return max(map(abs, self.arcs.values()), default=0.0)

    @property
    def curved(self) -> float:
        """What a drift taken out as even may have left in F_p [mm] if it slowed down or sped up; zero without one."""
        return _CURVED * self.arc if self.kind in ("steady", "small") else 0.0

    @property
    def withheld(self) -> str | None:
        """Why pitch is not known; None where it is."""
        if self.slip is not None:
            return f"the work or the machine slipped by {self._size} {self.slip.where}"
        if self.kind == "step":
            return f"the work or the machine slipped by {self._size} while it was measured"
        if self.kind == "uneven":
            return f"work or machine drifted by {self._size} while it was measured, and not steadily"
        if self.kind == "not told":
            return f"work or machine moved by {self._size} while it was measured, and it is not told when"
        return None

    @property
    def spaces_withheld(self) -> str | None:
        """Why runout and range of the thickness are not known; None where they are."""
        return self.topography_withheld

    @property
    def topography_withheld(self) -> str | None:
        """Why thickness, topography and corrections are not known; None where they are."""
        if self.slip is None and self.kind == "step" and self.beside:
            return f"the work or the machine slipped by {self._size} {self._between}, beside a tooth measured in full"
        return self.withheld if self.slip is not None or self.kind in ("uneven", "not told") else None

    def check_topography(self) -> None:
        """Raises InputError where the topography is not known, and so no correction: what to measure again."""
        why = self.topography_withheld
        if why is None:
            return
        which = ""
        if self.slip is not None:
            which = f"; point {self.slip.row + 1} of the file and all after it do not go with those before"
        raise InputError(f"{why}: no settings can be corrected from it{which}; clamp the work and measure it again")

    @property
    def said(self) -> tuple[str, ...]:
        """One sentence on a motion; empty where there was none."""
        if self.slip is not None:
            u = self.slip.uncertainty * 1000
            return (f"{self.withheld}, u {u:.1f} um; pitch, thickness and topography are withheld",)
        if self.kind in ("not measured", "still"):
            return ()
        flanks = " and ".join(f"{arc * 1000:+.1f} um ({flank})" for flank, arc in self.arcs.items())
        measured = (
            f"tooth 0 measured again at the end is turned by arcs of {flanks}, u {self.uncertainty * 1000:.1f} um"
        )
        how = {
            "small": f"the work or the machine moved by {self._size}: {measured}; taken out as an even drift",
            "steady": f"the work or the machine drifted by {self._size}: {measured}; it neither stepped nor began "
            "late nor ended early, taken out as an even drift; one that slowed down or sped up looks like "
            f"eccentricity, and may have left up to {self.curved * 1000:.1f} um in F_p",
            "step": f"the work or the machine slipped by {self._size} {self._between}: {measured}; pitch is withheld",
            "uneven": f"the work or the machine drifted by {self._size}: {measured}; not steady over the teeth; "
            "pitch and runout are withheld",
            "not told": f"the work or the machine moved by {self._size}: {measured}; the teeth do not tell whether it "
            "drifted or slipped; pitch is withheld",
        }
        return (how[self.kind],)

    @property
    def _size(self) -> str:
        return f"{(self.arc if self.slip is None else abs(self.slip.size)) * 1000:.1f} um"

    @property
    def _between(self) -> str:
        if self.teeth is None:
            return ""
        before, after = self.teeth
        if before == after:
            return f"inside tooth {before}"
        return f"between tooth {before} and tooth {after}" if after else f"after tooth {before}, the last one"

    def as_dict(self) -> dict[str, Any]:
        """For people and programs: µm."""
        return {
            "kind": self.kind,
            "arc_um": {flank: arc * 1000 for flank, arc in self.arcs.items()},
            "u_arc_um": self.uncertainty * 1000 if self.arcs else None,
            "between_teeth": list(self.teeth) if self.teeth else None,
            "slip": self.slip.as_dict() if self.slip else None,
        }


def close_run(file: FlankFile, teeth: int) -> Closing:
    """Whether work or machine moved during a measurement, and how."""
    closing = _closed(file, teeth)
    slip = find_slip(file, teeth)
    if slip is None and closing.kind in ("still", "step", "small", "uneven", "not told"):
        slip = _between_flanks(file, teeth, closing)
    if slip is not None:
        course = (np.arange(len(file)) >= slip.row).astype(float)
        taken = moved_by(file, *measured_twice(file, teeth), course) if closing.arcs else np.zeros(len(file))
        doubt = slip_patterns(file, course)
        return replace(closing, kind="step", course=course, taken=taken, teeth=None, slip=slip, doubt=doubt)
    full = {tooth for flank in FLANKS for tooth in teeth_in_full(file, flank)}
    before, after = closing.teeth or (-1, -1)
    return replace(closing, beside=before in full or (after > 0 and after in full))


def _between_flanks(file: FlankFile, teeth: int, closing: Closing) -> Slip | None:
    """A slip between the two flanks of tooth 0: only the first of them has changed at the end, and its space with it.

    A motion that only one flank feels would be by chance along the other. Where the width of space 0 is that of the
    other spaces, tooth 0 was measured well.
    """
    rows = [np.flatnonzero((file.flank == flank) & (file.tooth == 0) & np.isfinite(file.deviation)) for flank in FLANKS]
    if closing.teeth not in (None, (0, 0), (0, 1)) or set(closing.arcs) != set(FLANKS) or not all(map(len, rows)):
        return None
    early, late = (0, 1) if rows[0].max() < rows[1].min() else (1, 0)
    arc, other = (closing.arcs[FLANKS[each]] for each in (early, late))
    if rows[early].max() > rows[late].min() or abs(other) > max(closing.uncertainty, _UNFELT * abs(arc)):
        return None
    (_, lever) = kernel("flank_turning")(1.0, file.point, file.normal)
    arcs = [
        dict(zip(file.tooth[each], (file.deviation * lever)[each], strict=True))
        for each in by_flank(file, references(file, teeth))
    ]
    widths = {tooth: arcs[early][tooth] - arcs[late][tooth] for tooth in arcs[0].keys() & arcs[1].keys()}
    others = np.array([width for tooth, width in widths.items() if tooth])
    u = closing.uncertainty
    if 0 in widths and len(others) >= LEAST_TEETH:
        middle = float(np.median(others))
        u = max(u, float(np.median(np.abs(others - middle))) * _MAD)
        if abs(middle - widths[0] - arc) > abs(arc) / 2:
            return None
    if abs(arc) <= _BETWEEN * u or _has_missed(file, FLANKS[early], arc):
        return None
    return slip_between(file, int(rows[early].max()), int(rows[late].min()), arc, closing.uncertainty)


def _has_missed(file: FlankFile, flank: str, arc: float) -> bool:
    """Whether the reference point of tooth 0 is off its flank's smooth surface by a quarter of an arc."""
    if 0 not in teeth_in_full(file, flank):
        return False
    residual = evaluate_topography(file, flank, 0).residual[reference_point(file)]
    return bool(abs(residual) > abs(arc) / 4)


def _closed(file: FlankFile, teeth: int) -> Closing:
    """What tooth 0 measured again tells, by both flanks."""
    course = evenly(file)
    first, again = measured_twice(file, teeth)
    if not len(first):
        return Closing("not measured", course, np.zeros(len(file)), {}, math.nan)
    noise = stated_noise(file)
    noise = noise if math.isfinite(noise) else _UNKNOWN
    (_, levers) = kernel("flank_turning")(1.0, file.point[first], file.normal[first])
    change = (file.deviation[again] - file.deviation[first]) * levers
    arcs, points = {}, {}
    for flank in (flank for flank in FLANKS if (file.flank[first] == flank).any()):
        here = file.flank[first] == flank
        arcs[flank], points[flank] = float(np.median(change[here])), int(here.sum())
    u = noise * float(np.abs(levers).max()) * math.sqrt(2 / min(points.values()))
    pairs = _together(change, file.flank[first], arcs)
    first, again = first[pairs], again[pairs]
    even = Closing("still", course, moved_by(file, first, again, course), arcs, u)
    if not _has_moved(arcs, points, u) or not len(first):
        return even
    kind, told, doubt = tell_course(file, teeth, first, again, even.taken, noise)
    if told is None:
        return replace(even, kind=kind, doubt=doubt)
    return replace(even, kind=kind, course=told.part, taken=told.taken, teeth=told.teeth, doubt=doubt)


def _together(change: np.ndarray, flank: np.ndarray, arcs: dict[str, float]) -> np.ndarray:
    """Which of the pairs of points (m,) agree with their flank: a miss among several is none of the motion."""
    off = np.abs(change - np.array([arcs[each] for each in flank]))
    return off <= np.maximum(LEAST_BETWEEN_TEETH, 0.1 * np.abs(change).max(initial=0.0))


def _has_moved(arcs: dict[str, float], points: dict[str, int], u: float) -> bool:
    """Whether the return value is beyond its uncertainty, and not only at a single point that missed."""
    largest = max(arcs, key=lambda flank: abs(arcs[flank]))
    if abs(arcs[largest]) <= _SIGNIFICANT * u:
        return False
    if abs(arcs[largest]) <= LEAST_BETWEEN_TEETH or points[largest] > 1:
        return True
    others = [abs(arc) for flank, arc in arcs.items() if flank != largest]
    return any(arc >= CONFIRMS * abs(arcs[largest]) for arc in others)
