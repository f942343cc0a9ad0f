"""What is cut: gear and hob in the signs of chapter 30, and the motions of the machine without any error."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearmath.errors import InputError
from gearmath.gearbox.dimensions import Gear, straight_height
from gearmath.gearbox.kernels import evaluate, kernel

TURN = 2.0 * math.pi


@dataclass(frozen=True)
class HobTool:
    """A hob: starts, hand (+1 right), gashes, reference diameter, addendum and tip radius [mm].

    ``protuberance`` [mm] along the normal of the flank, at ``protuberance_angle`` [rad]. A topping hob turns the tip of
    the gear with its root, ``dedendum`` [mm] deep; None: it does not. ``gash_lead`` [mm] of gashes of the other hand
    than the threads; None: they are straight.
    """

    starts: int
    sign: int
    gashes: int
    diameter: float
    addendum: float
    tip_radius: float
    protuberance: float = 0.0
    protuberance_angle: float = 0.0
    dedendum: float | None = None
    gash_lead: float | None = None


@dataclass(frozen=True)
class HobbingJob:
    """Gear, hob and feed: ``helix_sign`` +1 right-hand, ``feed`` [mm per turn of the table], ``climb`` or not.

    ``face_width`` [mm]: the gear stands from height 0 to it. ``hob_offset`` [mm]: how far the middle of the hob stands
    from the pitch point along its axis, to the right as seen from the hob towards the gear.
    """

    gear: Gear
    helix_sign: int
    hob: HobTool
    face_width: float
    feed: float
    climb: bool = True
    hob_offset: float = 0.0

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
        hob = self.hob
        tip = (hob.addendum, hob.tip_radius, hob.protuberance, hob.protuberance_angle)
        return straight_height(self.gear.module, self.gear.alpha, *tip)

    @property
    def gash_twist(self) -> float:
        """κ of (30.21) [rad/mm]: turn of a gash per length along the hob."""
        return 0.0 if self.hob.gash_lead is None else self.hob.sign * TURN / self.hob.gash_lead

    @cached_property
    def axial_pitch(self) -> float:
        """Of the hob's teeth [mm] (30.19)."""
        return evaluate("hob_pitch", self.hob.starts, self.gear.module, self.hob.diameter)[0]

    @property
    def gash_phase(self) -> float:
        """Turn of the hob [rad] at which gash 0 passes the common perpendicular, in the hob's middle.

        A hob that is moved along its axis meshes again when it is turned by as much of its thread.
        """
        by_thread = TURN * self.hob.sign / (self.axial_pitch * self.hob.starts)
        return -(by_thread + self.gash_twist) * self.hob_offset

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

    def gash_at(self, side: int, edge: np.ndarray, thread: np.ndarray) -> np.ndarray:
        """Thread angle (n,), in the middle of the hob, of a gash that cuts there (30.21)."""
        return kernel("gash_of_thread")(edge, 0.0, thread, self.gash_twist, *self.pair(side))[1]

    def thread_at(self, side: int, edge: np.ndarray, gash_thread: np.ndarray) -> np.ndarray:
        """Thread angle (n,) where such a gash cuts at a height of its edge (30.21)."""
        return kernel("thread_of_gash")(edge, 0.0, gash_thread, self.gash_twist, *self.pair(side))[0]

    def generating_zone(self, shortest: float, longest: float) -> tuple[float, float]:
        """Between which places along the hob [mm], from the pitch point, it cuts the flanks (30.8, 30.19).

        Both flanks, between two lengths of roll; half a tooth to either side is in it, as the edges of one pitch cut
        both flanks of a space.
        """
        length = np.linspace(shortest, longest, 50)
        threads = np.concatenate([self.contact(side, length)[3] for side in (1, -1)])
        teeth = self.hob.sign * threads / TURN * self.hob.starts
        return (float(teeth.min()) - 0.5) * self.axial_pitch, (float(teeth.max()) + 0.5) * self.axial_pitch

    @property
    def topped_tip(self) -> tuple[float, ...]:
        """Radius of the tip that a topping hob leaves, ridges between its gashes and between feeds [mm] (30.22)."""
        assert self.hob.dedendum is not None
        return evaluate("topped_tip", self.hob.dedendum, self.hob.gashes, self.travel_per_rad, *self.pair(1))

    def feed_mark(self, length: float) -> float:
        """Height of the ridges between feed marks [mm] at a length of roll, by a hob of many gashes (30.10)."""
        _, edge, _, _ = (float(value[0]) for value in self.contact(1, np.array([length])))
        return evaluate("feed_mark", length, edge, self.travel_per_rad, *self.pair(1))[0]
