"""The virtual gear on a gear inspection machine: profile and helix traces, pitch of all teeth, runout, thickness.

A tooth is named by the space in front of it: the right flank of tooth i bounds space i, its left flank space i + 1, as
seen from above (+z) with the tip up. Deviations are along the normal, positive where metal is left on.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from gearmath.errors import InputError
from gearmath.gearbox.dimensions import PIN, PinContact, Span, blank_diameter, pin_contact, span
from gearmath.gearbox.hobbed.envelope import Envelope
from gearmath.gearbox.hobbed.job import HobbingJob
from gearmath.gearbox.hobbed.root import undercut_radius
from gearmath.gearbox.hobbed.topping import topped_radii
from gearmath.gearbox.kernels import evaluate, kernel

Side = Literal["right", "left"]
SIDES: dict[Side, int] = {"right": 1, "left": -1}
#: Teeth that are traced, evenly around the gear.
TRACED = 4
#: Points of a profile trace, and of a helix trace per feed, at least and at most in all.
PROFILE_POINTS, PER_FEED, HELIX_POINTS = 161, 10, (161, 801)
#: Of the length between form circle and tip that is left out at the tip [unconfirmed: ISO 1328-1].
TIP_LEFT_OUT = 0.08
#: Least part of the flank, as deep as the straight edges of the basic rack at most [modules], that can be measured.
LEAST_PART, STRAIGHT_DEPTH = 0.1, 2.0
#: Lengths of roll among which the form circle is found.
_FORM_STEPS = 400


@dataclass(frozen=True)
class MeasuredTrace:
    """Deviations (n,) [mm] of one flank along ``place`` (n,) [mm]: length of roll, or height on the gear.

    ``across`` is the other of the two, the same for all points.
    """

    side: Side
    tooth: int
    place: np.ndarray
    deviation: np.ndarray
    across: float

    @cached_property
    def line(self) -> np.ndarray:
        """The mean line through it (n,) [mm]: least squares."""
        return np.polyval(np.polyfit(self.place, self.deviation, 1), self.place)

    @property
    def total(self) -> float:
        """F: range of the deviations [mm]."""
        return float(np.ptp(self.deviation))

    @property
    def slope(self) -> float:
        """f_H: how much the mean line rises from its beginning to its end [mm]."""
        return float(self.line[-1] - self.line[0])

    @property
    def form(self) -> float:
        """f_f: range of the deviations from the mean line [mm]."""
        return float(np.ptp(self.deviation - self.line))


@dataclass(frozen=True)
class PitchRow:
    """Position of every tooth of one flank along the circle (z,) [mm], less where it should be."""

    side: Side
    position: np.ndarray

    @property
    def single(self) -> np.ndarray:
        """f_pt of every tooth (z,): how much farther it is from the tooth before than it should be [mm]."""
        return self.position - np.roll(self.position, 1)

    @property
    def worst(self) -> float:
        """The largest single pitch deviation, without sign [mm]."""
        return float(np.abs(self.single).max())

    @property
    def total(self) -> float:
        """F_p [mm]."""
        return float(np.ptp(self.position))


@dataclass(frozen=True)
class MeasuredThickness:
    """A measured dimension of the teeth [mm]: nominal, mean over the gear, and range."""

    what: str
    nominal: float
    mean: float
    range: float


@dataclass(frozen=True)
class Inspection:
    """What the inspection found."""

    profiles: tuple[MeasuredTrace, ...]
    helices: tuple[MeasuredTrace, ...]
    pitches: tuple[PitchRow, ...]
    ball: np.ndarray
    """How far a ball stands out of every space (z,) [mm]."""
    thicknesses: tuple[MeasuredThickness, ...]

    @property
    def runout(self) -> float:
        """F_r [mm]."""
        return float(np.ptp(self.ball))

    @property
    def figures(self) -> dict[str, float]:
        """The worst of each figure that has a tolerance [mm], by its name in the standard."""
        return {
            "f_pt": max(row.worst for row in self.pitches),
            "F_p": max(row.total for row in self.pitches),
            "F_r": self.runout,
            "f_H_alpha": max((trace.slope for trace in self.profiles), key=abs),
            "f_f_alpha": max(trace.form for trace in self.profiles),
            "F_alpha": max(trace.total for trace in self.profiles),
            "f_H_beta": max((trace.slope for trace in self.helices), key=abs),
            "f_f_beta": max(trace.form for trace in self.helices),
            "F_beta": max(trace.total for trace in self.helices),
        }


@dataclass(frozen=True)
class Layout:
    """Where a gear is measured: lengths of roll and heights of the traces, circle of the pitch, pins and span."""

    profile: np.ndarray
    helix: np.ndarray
    middle: float
    """Length of roll of helix and pitch."""
    middle_height: float
    teeth: np.ndarray
    """Which teeth are traced."""
    pin: PinContact | None
    span: Span | None

    @property
    def points(self) -> int:
        """How many points are measured, without pitch and thickness."""
        return 2 * len(self.teeth) * (len(self.profile) + len(self.helix))


def layout(job: HobbingJob) -> Layout:
    """Where the gear of a job is measured.

    Raises InputError where the hob leaves no involute to measure.
    """
    gear, base = job.gear, job.base_radius
    tip = math.sqrt(max(0.0, (blank_diameter(gear) / 2) ** 2 - base**2))
    form = form_length(job, tip)
    if not tip - form > LEAST_PART * min(tip, STRAIGHT_DEPTH * gear.module / math.sin(job.transverse[1])):
        raise InputError(f"teeth = {gear.teeth}: the hob leaves no involute between form circle and tip")
    end = tip - TIP_LEFT_OUT * (tip - form)
    middle = _middle(job, form, end)
    margin = min(0.05 * job.face_width, gear.module)
    least, most = HELIX_POINTS
    along = round(min(most, max(least, PER_FEED * job.face_width / job.feed)))
    touched = pin_contact(gear, PIN * gear.module)
    if touched is not None and not form < touched.roll_length < tip:
        touched = None
    return Layout(
        np.linspace(form, end, PROFILE_POINTS),
        np.linspace(margin, job.face_width - margin, along),
        middle,
        job.face_width / 2,
        np.unique(np.arange(TRACED) * gear.teeth // TRACED),
        touched,
        _span(job, form, tip),
    )


def form_length(job: HobbingJob, tip: float) -> float:
    """Length of roll [mm] from which the straight edges of the hob cut the flank, on both sides."""
    lengths = np.linspace(0.02 * tip, tip, _FORM_STEPS)
    edges = np.maximum(*(job.contact(side, lengths)[1] for side in SIDES.values()))
    (cut,) = np.nonzero(edges <= job.form_height)
    if not len(cut):
        return tip
    # the edges of two gashes meet there: the upper one must have a straight edge still
    ((flat,),) = (evaluate("generating_flat", tip, job.hob.starts, job.gear.teeth, job.hob.gashes),)
    per_gash = 2 * math.sqrt(2 * flat / tip) * job.base_radius  # length of roll from gash to gash
    lowest = float(lengths[cut[0]] + per_gash)
    if cut[0] and not job.hob.protuberance:
        return lowest
    # the tips of the hob cut involute away again: where the straight edges reach down to the base cylinder, or where a
    # protuberance is meant to
    undercut = undercut_radius(job, math.hypot(tip, job.base_radius))
    return lowest if undercut is None else max(lowest, math.sqrt(undercut**2 - job.base_radius**2) + per_gash)


def _middle(job: HobbingJob, form: float, end: float) -> float:
    """Length of roll on the circle d + 2 x m_n, or in the middle of what is measured where that is outside."""
    radius = job.reference_diameter / 2 + job.gear.shift * job.gear.module
    squared = radius**2 - job.base_radius**2
    length = math.sqrt(squared) if squared > 0 else 0.0
    return length if form < length < end else (form + end) / 2


def _span(job: HobbingJob, form: float, tip: float) -> Span | None:
    measured = span(job.gear)
    if measured is None or measured.face_width > job.face_width:
        return None
    return measured if form < measured.length * math.cos(job.base_helix) / 2 < tip else None


def inspect(cut: Envelope, where: Layout, progress: Callable[[int], object] = lambda done: None) -> Inspection:
    """Measure a cut gear. ``progress`` is told how many points are done."""
    profiles: list[MeasuredTrace] = []
    helices: list[MeasuredTrace] = []
    for name, side in SIDES.items():
        spaces = where.teeth if side == 1 else (where.teeth + 1) % cut.job.gear.teeth
        for traces, lengths, heights in (
            (profiles, where.profile, where.middle_height),
            (helices, where.middle, where.helix),
        ):
            place = where.profile if traces is profiles else where.helix
            size = len(place)
            found = cut.deviation(
                side,
                np.repeat(spaces, size),
                np.tile(np.broadcast_to(lengths, size), len(spaces)),
                np.tile(np.broadcast_to(heights, size), len(spaces)),
                progress,
            ).reshape(len(spaces), size)
            rows = zip(where.teeth, found, strict=True)
            across = where.middle_height if traces is profiles else where.middle
            traces.extend(MeasuredTrace(name, int(tooth), place, deviation, across) for tooth, deviation in rows)
    return Inspection(
        tuple(profiles),
        tuple(helices),
        _pitches(cut, where),
        _ball(cut, where),
        tuple(_thicknesses(cut, where)),
    )


def _all_spaces(cut: Envelope, side: int, length: float, height: float) -> np.ndarray:
    """δ (z,) [mm] of every space."""
    return cut.deviation(side, np.arange(cut.job.gear.teeth), np.array([length]), np.array([height]))


def _circle_angle(job: HobbingJob, length: float) -> float:
    """α_yt where the length of roll is so much."""
    return math.atan2(length, job.base_radius)


def _pitches(cut: Envelope, where: Layout) -> tuple[PitchRow, ...]:
    job, gear = cut.job, cut.job.gear
    right, left = (_all_spaces(cut, side, where.middle, where.middle_height) for side in (1, -1))
    angle = _circle_angle(job, where.middle)
    positions = kernel("circle_positions")(right, left, angle, gear.alpha, gear.beta)
    return (PitchRow("right", positions[0]), PitchRow("left", np.roll(positions[1], -1)))


def _ball(cut: Envelope, where: Layout) -> np.ndarray:
    """Of every space (z,) [mm]."""
    gear = cut.job.gear
    length = where.middle if where.pin is None else where.pin.roll_length
    angle = _circle_angle(cut.job, where.middle) if where.pin is None else where.pin.angle
    right, left = (_all_spaces(cut, side, length, where.middle_height) for side in (1, -1))
    return kernel("ball_radial")(right, left, angle, gear.alpha, gear.beta)[0]


def _thicknesses(cut: Envelope, where: Layout) -> list[MeasuredThickness]:
    job, teeth = cut.job, cut.job.gear.teeth
    found = []
    if where.span is not None:
        length, rise = where.span.length, job.helix_sign * math.sin(job.base_helix) * where.span.length / 2
        contact = length * math.cos(job.base_helix) / 2
        right = _all_spaces(cut, 1, contact, where.middle_height + rise)
        left = _all_spaces(cut, -1, contact, where.middle_height - rise)
        measured = length + right + np.roll(left, -where.span.teeth)
        found.append(_thickness(f"span over {where.span.teeth} teeth", length, measured))
    if where.pin is not None:
        ball = _ball(cut, where)
        half = math.cos(math.pi / 2 / teeth) if teeth % 2 else 1.0
        measured = where.pin.over_pins + half * (ball + np.roll(ball, -(teeth // 2)))
        found.append(_thickness(f"over pins of {PIN * job.gear.module:.4g} mm", where.pin.over_pins, measured))
    if job.hob.dedendum is not None:
        found.append(_thickness("tip radius", job.topped_tip[0], topped_radii(cut, where.middle_height)))
    return found


def _thickness(what: str, nominal: float, measured: np.ndarray) -> MeasuredThickness:
    return MeasuredThickness(what, nominal, float(measured.mean()), float(np.ptp(measured)))
