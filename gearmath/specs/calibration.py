"""The calibrated probe: its tip as the machine found it, its stylus, and the artefacts it was calibrated on."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import numpy as np
import tomlkit
from pydantic import Field, model_validator

from gearmath.files import read_text, write_text
from gearmath.shown import Shown, Shows
from gearmath.specs.toml import Spec, load, parse

_Number = Annotated[float, Field(strict=True)]
_Place = Annotated[tuple[_Number, _Number, _Number], Field(strict=False)]


class Face(Spec):
    """The ring's face around its bore: D and F of equation (23.6), and the width of the wall between bore and rim.

    ``seat`` is the Z at which the tip's centre would stand in the plane that the ring sits on.
    """

    seat: float
    height: float = Field(gt=0, le=200)
    width: float = Field(ge=4, le=200)


class Ring(Spec):
    """Calibration ring: centre of its bore in X Y Z of the machine, at the height to touch, and its diameter."""

    center: _Place
    diameter: float = Field(ge=5, le=200)
    face: Face | None = None

    @model_validator(mode="after")
    def _inside(self) -> Ring:
        if self.face is not None and self.center[2] >= self.face.seat + self.face.height:
            top = self.face.seat + self.face.height
            raise ValueError(f"Z {self.center[2]} of center must be below the face, {top}")
        return self


class Sphere(Spec):
    """Calibration sphere: centre in X Y Z of the machine, and diameter."""

    center: _Place
    diameter: float = Field(ge=4, le=100)


class WorkSphere(Spec):
    """Sphere on an arbor that sits where the work does, off the work axis, on a stem that leads away from the apex.

    ``axial`` is the z_w of its centre, from the pitch apex: it has to be known. ``radius`` and ``azimuth`` say roughly
    where it is about the work axis, in mm and degrees at A = 0.
    """

    diameter: float = Field(ge=4, le=100)
    axial: float = Field(ge=-1000, le=1000)
    radius: float = Field(ge=10, le=500)
    azimuth: float = Field(default=0.0, ge=-360, le=360)
    stem_diameter: float = Field(ge=1, le=100)

    @model_validator(mode="after")
    def _sizes(self) -> WorkSphere:
        if self.stem_diameter > 0.6 * self.diameter:
            raise ValueError(f"stem_diameter {self.stem_diameter} must be at most 0.6 of diameter {self.diameter}")
        return self

    @property
    def place(self) -> np.ndarray:
        """Centre (3,) in the work, mm."""
        at = math.radians(self.azimuth)
        return np.array([self.radius * math.cos(at), self.radius * math.sin(at), self.axial])


class Calibration(Shown, Spec):
    """A touch probe in the tool spindle, mm; ``offset`` and ``tip_radius`` are what calibration finds."""

    name: str = Field(min_length=1, max_length=200)
    length: float = Field(gt=0, le=600)
    """Gauge line of the spindle to the centre of the tip."""
    tip_radius: float = Field(gt=0, le=5)
    offset: _Place = (0.0, 0.0, 0.0)
    """Centre of the tip off the spindle axis in X and Y, and off ``length`` in Z."""
    stylus_radius: float = Field(gt=0, le=5)
    stylus_length: float = Field(gt=0, le=200)
    lobing_um: float = Field(default=0.0, ge=0, le=20)
    """Amplitude of the lobes of the effective radius (23.3), and in degrees the azimuth of one of them."""
    lobing_phase: float = Field(default=0.0, ge=-360, le=360)
    overtravel: float = Field(default=0.5, gt=0, le=5)
    """How far a touch may be searched for beyond its nominal place."""
    ring: Ring | None = None
    sphere: Sphere | None = None
    work_sphere: WorkSphere | None = None

    @model_validator(mode="after")
    def _sizes(self) -> Calibration:
        if any(not abs(value) <= 5 for value in self.offset):
            raise ValueError("offset must lie between -5 and 5 mm")
        if self.stylus_radius >= self.tip_radius:
            raise ValueError(f"stylus_radius {self.stylus_radius} must be less than tip_radius {self.tip_radius}")
        if self.stylus_length >= self.length:
            raise ValueError(f"stylus_length {self.stylus_length} must be less than length {self.length}")
        if self.ring is not None and self.ring.diameter <= 4 * self.tip_radius:
            raise ValueError(f"ring.diameter {self.ring.diameter} must be greater than 4 tip_radius")
        return self

    @property
    def tip_offset(self) -> np.ndarray:
        """o of equation (15.3), (3,) mm."""
        return np.array(self.offset)

    def _shown(self) -> tuple[str, list[Shows]]:
        figures: list[Shows] = [("tip radius", self.tip_radius, "mm"), ("length", self.length, "mm")]
        return self.name, [*figures, ("offset", self.offset, "mm"), ("lobes", self.lobing_um, "um")]


def load_calibration(path: Path) -> Calibration:
    """Read a calibration file. Raises InputError naming file, key, value and limit."""
    return load(path, Calibration)


def save_calibration(
    source: Path, target: Path, tip_radius: float, offset: np.ndarray, lobes: tuple[float, float] = (0.0, 0.0)
) -> None:
    """Write the calibration of ``source``, comments kept, with a new tip to ``target``, whole or not at all.

    ``lobes`` are amplitude [mm] and azimuth [rad]; an amplitude of 0 leaves them out.
    """
    document = tomlkit.parse(read_text(source))
    document["tip_radius"] = round(float(tip_radius), 7)
    document["offset"] = [round(float(value), 7) for value in offset]
    values = {"lobing_um": round(lobes[0] * 1000, 4), "lobing_phase": round(math.degrees(lobes[1]), 4)}
    for key, value in values.items():
        if key in document:
            document.remove(key)
        if lobes[0] > 0.0:
            document[key] = value
    text = tomlkit.dumps(document)
    parse(text, Calibration, str(target))
    write_text(target, text)
