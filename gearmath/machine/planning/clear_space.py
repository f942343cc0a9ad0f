"""How much room the work and what holds it take, however A and B turn them: where a tool may move freely."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.machine.bodies.profiles import rings, work_profiles
from gearmath.specs.bevel_set import Member
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.obstacles import Fixture

#: Room [mm] that is kept about everything that does not touch.
MARGIN = 5.0
#: Steps of B in which the work is turned. [rad]
_STEP = math.radians(1.0)


@dataclass(frozen=True)
class Room:
    """What work and fixture fill for any A and B of the travel, seen from the B axis [mm], ``MARGIN`` included.

    They reach up to ``top``, to X = ``front`` and from there to the rear, and in Y to ``half`` on both sides.
    """

    top: float
    front: float
    half: float


def room_of(member: Member, machine: MillingMachine, fixture: Fixture) -> Room:
    """The room of one member on its fixture."""
    profiles = work_profiles(member, fixture).values()
    # the machine's X and Z of a point depend on its x_w alone beside z_w, and Y on its y_w: a ring is farthest at these
    around = np.concatenate([rings(profile, azimuths=4) for profile in profiles])
    low, high = machine.travel[4]
    swivels = np.linspace(low, high, 2 + int((high - low) / _STEP))
    # between two steps a point moves on by its distance from the axis at most
    missed = float(np.linalg.norm(around + machine.pivot, axis=1).max()) * (swivels[1] - swivels[0]) / 2
    positions = np.repeat(swivels, len(around))[:, None] * np.array([0.0, 0.0, 0.0, 0.0, 1.0])
    (places,) = kernel("seen_from_tool")(positions, np.tile(around, (len(swivels), 1)), 0.0, machine.pivot)
    places[:, 1] = np.abs(places[:, 1])
    front, half, top = places.max(axis=0) + missed + MARGIN
    return Room(float(top), float(front), float(half))


def clear_height(room: Room, machine: MillingMachine, tip: float) -> float:
    """The Z [mm] from which on a tool ``tip`` mm below the gauge line clears the room at every B."""
    return machine.gauge_line_height + tip + room.top


def check_home(room: Room, machine: MillingMachine, tip: float, name: str) -> None:
    """Raises InputError where a tool ``tip`` mm below the gauge line does not clear the room at the home of Z."""
    needed = clear_height(room, machine, tip)
    if machine.home < needed:
        raise InputError(
            f"{name}: home of Z = {machine.home:g} mm: the tool clears the work at every B from Z {needed:.1f} mm on: "
            f"{machine.name} needs a higher home_z, a shorter tool, or less travel of B"
        )
