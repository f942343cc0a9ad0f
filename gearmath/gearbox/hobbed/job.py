"""What is cut: gear and hob in the signs of chapter 30, and the motions of the machine without any error."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearmath.errors import InputError
from gearmath.gearbox.dimensions import Gear
from gearmath.gearbox.kernels import evaluate, kernel

TURN = 2.0 * math.pi


@dataclass(frozen=True)
class HobTool:
    """A hob: starts, hand (+1 right), gashes, reference diameter, addendum and tip radius [mm]."""

    starts: int
    sign: int
    gashes: int
    diameter: float
    addendum: float
    tip_radius: float


@dataclass(frozen=True)
class HobbingJob:
    """Gear, hob and feed: ``helix_sign`` +1 right-hand, ``feed`` [mm per turn of the table], ``climb`` or not.

    ``face_width`` [mm]: the gear stands from height 0 to it.
    """

    gear: Gear
    helix_sign: int
    hob: HobTool
    face_width: float
    feed: float
    climb: bool = True

    def __post_init__(self) -> None:
        if math.cos(self.swivel) < 0.1:
            raise InputError(f"helix: the hob's axis would stand {math.degrees(self.swivel):.0f} degrees off the plane")

    def pair(self, side: int) -> tuple[float, ...]:
        """The arguments of chapter 30 that say what is cut, for the flank ``side`` of a space."""
        gear, hob = self.gear, self.hob
        return (
            side,
            hob.sign,
            self.helix_sign,
            hob.starts,
            hob.diameter,
            gear.teeth,
            gear.module,
            gear.alpha,
            gear.beta,
            gear.shift,
        )

    @cached_property
    def transverse(self) -> tuple[float, ...]:
        """Transverse module and pressure angle, base helix angle, reference and base diameter (9.6)."""
        gear = self.gear
        return evaluate("transverse_gear", gear.teeth, gear.module, gear.alpha, gear.beta)

    @property
    def base_radius(self) -> float:
        """Radius of the base cylinder [mm]."""
        return self.transverse[4] / 2

    @property
    def base_helix(self) -> float:
        """Helix angle on it [rad]."""
        return self.transverse[2]

    @property
    def reference_diameter(self) -> float:
        """Of the gear [mm]."""
        return self.transverse[3]

    @property
    def turns_per_mm(self) -> float:
        """s_β/L: turns of a tooth per mm along the axis."""
        gear = self.gear
        if not gear.beta:
            return 0.0
        return self.helix_sign / evaluate("helical_lead", gear.teeth, gear.module, gear.beta)[0]

    @cached_property
    def swivel(self) -> float:
        """How the hob's axis stands [rad] (9.5)."""
        gear, hob = self.gear, self.hob
        shape = (hob.starts, gear.module, gear.beta, hob.diameter)
        return evaluate("swivel", hob.sign, self.helix_sign, *shape)[1]

    @cached_property
    def lead_angle(self) -> float:
        """Of the hob [rad]."""
        gear, hob = self.gear, self.hob
        shape = (hob.starts, gear.module, gear.beta, hob.diameter)
        return evaluate("swivel", hob.sign, self.helix_sign, *shape)[0]

    @property
    def form_height(self) -> float:
        """How far above its reference cylinder the hob's edge is straight [mm]."""
        hob, gear = self.hob, self.gear
        return evaluate("hob_form", gear.module, hob.addendum, hob.tip_radius, gear.alpha)[0]

    @cached_property
    def travel_per_rad(self) -> float:
        """v of (30.3): travel of the hob [mm] per radian of its turn; climbing, it goes down."""
        sign = 1 if self.climb else -1
        by_helix = 1.0 + sign * self.hob.sign * self.turns_per_mm * self.feed
        return -sign * self.feed * self.hob.starts / (self.gear.teeth * TURN * by_helix)

    @cached_property
    def start_height(self) -> float:
        """Height of the hob at ψ = 0 [mm]: above the gear when climbing, else below, clear of it."""
        run_in = self.hob.diameter / 2
        return self.face_width + run_in if self.climb else -run_in

    @property
    def hob_turns(self) -> float:
        """Turns of the hob through the whole cut."""
        return (self.face_width + self.hob.diameter) / abs(self.travel_per_rad) / TURN

    def hob_height(self, psi: np.ndarray) -> np.ndarray:
        """Height of the hob [mm] at the hob's turn ψ [rad]."""
        return self.start_height + self.travel_per_rad * psi

    def table_angle(self, psi: np.ndarray) -> np.ndarray:
        """The ideal table angle [rad], right-handed about the gear's axis."""
        by_hob = -self.hob.sign * self.hob.starts / self.gear.teeth * psi
        return by_hob - TURN * self.turns_per_mm * self.hob_height(psi)

    def contact(self, side: int, length: np.ndarray) -> tuple[np.ndarray, ...]:
        """Where hob and flank touch at lengths of roll (n,): height, edge, turn, thread (30.8)."""
        return kernel("line_of_action")(length, *self.pair(side))

    def generating_length(self, shortest: float, longest: float) -> float:
        """How much of the hob's length cuts the flanks [mm], both of them, between two lengths of roll: (30.8, 30.19).

        And a tooth: the edges of one pitch cut both flanks of a space.
        """
        length = np.linspace(shortest, longest, 50)
        threads = np.concatenate([self.contact(side, length)[3] for side in (1, -1)])
        (pitch,) = evaluate("hob_pitch", self.hob.starts, self.gear.module, self.hob.diameter)
        return (float(np.ptp(threads)) / TURN * self.hob.starts + 1.0) * pitch

    def feed_mark(self, length: float) -> float:
        """Height of the ridges between feed marks [mm] at a length of roll, by a hob of many gashes (30.10)."""
        _, edge, _, _ = (float(value[0]) for value in self.contact(1, np.array([length])))
        return evaluate("feed_mark", length, edge, self.travel_per_rad, *self.pair(1))[0]
