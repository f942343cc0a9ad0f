"""What is wrong with a hobbing machine, its hob and the clamping: the section ``[errors]`` of a machine file.

Nothing is wrong unless it is written there. Angles of the table are in arcseconds, lengths in µm, phases in degrees.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from gearmath.specs.toml import Spec

Phase = Annotated[float, Field(ge=-360.0, le=360.0)]
Order = Annotated[int, Field(ge=1, le=1000)]


class TableHarmonic(Spec):
    """One sine of an angle: amplitude [arcsec], how many times per turn, and its phase [degrees] at the start."""

    amplitude_arcsec: float = Field(ge=0.0, le=3600.0)
    order: Order = 1
    phase: Phase = 0.0


class LengthHarmonic(Spec):
    """One sine of a length: amplitude [µm], how many times per turn, and its phase [degrees] at the start."""

    amplitude_um: float = Field(ge=0.0, le=1000.0)
    order: Order = 1
    phase: Phase = 0.0


class RatioHarmonic(Spec):
    """One sine of the hob's speed: amplitude [percent], how many times per turn of the hob, and its phase [degrees]."""

    amplitude_percent: float = Field(ge=0.0, le=20.0)
    order: Order = 1
    phase: Phase = 0.0


class CuttingErrors(Spec):
    """Everything that lets a hobbing machine, or a lathe, cut other than its ratio says; none by default."""

    worm: tuple[TableHarmonic, ...] = Field(default=(), strict=False)
    """Of the table, per turn of the worm."""
    wheel: tuple[TableHarmonic, ...] = Field(default=(), strict=False)
    """Of the table, per turn of the table."""
    encoder: tuple[TableHarmonic, ...] = Field(default=(), strict=False)
    """Of the encoder's angle, per turn of its shaft."""
    speed_ripple: tuple[RatioHarmonic, ...] = Field(default=(), strict=False)
    """Of the speed of hob or spindle."""
    motor_time_constant_ms: float = Field(default=0.0, ge=0.0, le=1000.0)
    """Damping over stiffness of motor and belt: the table follows its steps with this lag."""
    stop_in_cut_mm: float | None = Field(default=None, gt=0.0, le=1000.0)
    """Height on the gear at which the hob was stopped within the cut and started again, in phase; None where not."""
    run_up_seconds: float = Field(default=1.0, gt=0.0, le=60.0)
    """How long the hob takes to its speed, and from it: the motor that lags catches up meanwhile."""
    microstep_percent: float = Field(default=0.0, ge=0.0, le=50.0)
    """Error of the position within a full step, amplitude in percent of it."""
    backlash_taken_by_cut: bool = False
    """Whether the cut pushes the table through its play to whichever side; else the table rests on the driving one."""
    hob_eccentricity_um: float = Field(default=0.0, ge=0.0, le=500.0)
    hob_eccentricity_phase: Phase = 0.0
    hob_axial_runout_um: float = Field(default=0.0, ge=0.0, le=500.0)
    """Amplitude of the hob's wobble along its axis, once a turn."""
    hob_axial_runout_phase: Phase = 0.0
    hob_lead_um_per_turn: float = Field(default=0.0, ge=-200.0, le=200.0)
    """How much the thread of the hob is too long, along its axis, per turn of the hob."""
    hob_starts_um: tuple[Annotated[float, Field(ge=-500.0, le=500.0)], ...] = Field(default=(), strict=False)
    """By how much the thread of every start is displaced along the hob's axis, in the order in which they cut."""
    feed: tuple[LengthHarmonic, ...] = Field(default=(), strict=False)
    """Of the travel along the gear, or of the carriage of a lathe, per turn of its screw."""
    feed_screw_pitch: float = Field(default=2.0, gt=0.0, le=50.0)
    """Travel per turn of the feed screw [mm]."""
    blank_eccentricity_um: float = Field(default=0.0, ge=0.0, le=1000.0)
    blank_eccentricity_phase: Phase = 0.0
    blank_tilt_um_per_100mm: float = Field(default=0.0, ge=0.0, le=1000.0)
    """Wobble of the gear's axis: deviation over 100 mm of its length."""
    blank_tilt_phase: Phase = 0.0
