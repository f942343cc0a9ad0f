"""What stands about tool and work, as surfaces of revolution: the cutter's head, and what holds the work."""

from __future__ import annotations

from pydantic import Field

from gearmath.specs.toml import Spec


class CutterHead(Spec):
    """The head above the blades: a cylinder of a radius beyond the outer blade's tip (mm), then the spindle (mm)."""

    beyond_tip: float = Field(default=0.0, ge=-50, le=100)
    height: float = Field(default=60.0, gt=0, le=500)
    spindle_radius: float = Field(default=60.0, gt=0, le=500)


class Fixture(Spec):
    """What holds the work (mm): the shank behind the back cone, and the fixture behind the shank.

    ``shank_radius`` 0 takes 60 % of the heel's root radius.
    """

    shank_radius: float = Field(default=0.0, ge=0, le=1000)
    shank_length: float = Field(default=60.0, gt=0, le=1000)
    radius: float = Field(default=40.0, gt=0, le=1000)
    length: float = Field(default=100.0, gt=0, le=2000)
