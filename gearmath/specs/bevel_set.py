"""A spiral bevel gear set: blanks, cutters and machine settings of its members, in REXS vocabulary, mm and degrees.

A file may be in inches, have angles in degrees, minutes and seconds (``sheet``), give the ratio of roll as cradle by
work, and count ``machine_center_to_crossing_point`` from a crossing point that the pitch apex lies beyond. What is
loaded is in mm and degrees, with work by cradle, and counts from the pitch apex.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, PrivateAttr, ValidationInfo, field_validator, model_validator

from derivations import notation
from gearmath.errors import InputError, counted
from gearmath.kernels import kernel
from gearmath.specs.cut import (
    CRADLE_PER_WORK,
    MACHINE_SETTINGS,
    RATIO,
    SETTINGS,
    Design,
    Flank,
    Motion,
    Settings,
    vector_of,
)
from gearmath.specs.sheet import Angle, Length, Sheet, Unit, is_number, refusal_of, shown
from gearmath.specs.toml import load

#: With what a set is made of, which is read from here.
__all__ = [
    "ADVANCE",
    "BEYOND",
    "CRADLE_PER_WORK",
    "FLANKS",
    "MACHINE_SETTINGS",
    "MEMBERS",
    "SETTINGS",
    "SIDES",
    "BevelSet",
    "Blank",
    "Design",
    "Flank",
    "Member",
    "Motion",
    "Settings",
    "design_sha256",
    "load_bevel_set",
    "settings_sha256",
]

MEMBERS = ("pinion", "gear")
FLANKS = ("concave", "convex")
#: +1 outer blade cuts the concave flank, -1 inner blade the convex flank, for both hands.
SIDES = {"concave": 1, "convex": -1}
_FILE = "_file"
#: Corrections of neighbouring spaces may differ by so much [degree]: no work axis is off by more from one to the next.
_INDEX_STEP = 0.25
#: A corrected machine may stand steeper than the face of a uniform tooth by so much. [degree]
_ROOT_BEYOND = 1.0
ADVANCE, BEYOND = "machine_center_to_crossing_point", "pitch_apex_beyond_crossing_point"


class Blank(Sheet):
    """Blank of one member, counted from its pitch apex (mm, degrees).

    ``pitch_apex_beyond_crossing_point`` t_z is positive where the apex lies beyond the crossing point, seen from the
    teeth. A file with it counts ``machine_center_to_crossing_point`` X_C from the crossing point (2.6)::

        heel [ teeth ] toe      crossing point <-- t_z --> pitch apex      X_p = X_C + t_z, counted from the apex
    """

    pitch_angle: Angle = Field(gt=3, lt=87)
    face_angle: Angle = Field(gt=3, lt=90)
    root_angle: Angle = Field(gt=1, lt=87)
    mean_cone_distance: Length = Field(gt=5, le=1000)
    face_width: Length = Field(gt=1, le=300)
    mean_addendum: Length = Field(gt=0, le=50)
    mean_dedendum: Length = Field(gt=0, le=50)
    clearance: Length = Field(ge=0, le=10)
    pitch_apex_beyond_crossing_point: Length = Field(default=0.0, ge=-200, le=200)

    @model_validator(mode="after")
    def _consistent(self) -> Blank:
        if not self.root_angle <= self.pitch_angle <= self.face_angle:
            raise ValueError(f"root_angle {self.root_angle} <= pitch_angle {self.pitch_angle} <= face_angle must hold")
        if self.face_width >= self.mean_cone_distance:
            face_width, distance = shown(self.face_width), shown(self.mean_cone_distance)
            raise ValueError(f"face_width {face_width} must be less than mean_cone_distance {distance}")
        if self.clearance >= self.mean_dedendum:
            clearance, dedendum = shown(self.clearance), shown(self.mean_dedendum)
            raise ValueError(f"clearance {clearance} must be less than mean_dedendum {dedendum}")
        return self

    @property
    def delta(self) -> float:
        """Pitch angle δ [rad]."""
        return math.radians(self.pitch_angle)

    @property
    def delta_a(self) -> float:
        """Face angle δ_a [rad]."""
        return math.radians(self.face_angle)

    @property
    def delta_f(self) -> float:
        """Root angle δ_f [rad]."""
        return math.radians(self.root_angle)

    @property
    def vector(self) -> np.ndarray:
        """The blank as the vector of ``notation.blank`` (8,), mm and rad."""
        return vector_of(self, notation.blank.components)


class Member(Sheet):
    """One member of the pair. ``index_correction`` turns each tooth space by that many degrees before it is cut.

    The members of a set know which one they are: ``name``, which is no key of the file.
    """

    teeth: int = Field(ge=3, le=400)
    hand: Literal["left", "right"]
    cutting: Literal["fixed_setting", "completing"]
    process: Literal["face_milling", "face_hobbing"] = "face_milling"
    generation: Literal["generated", "formate"] = "generated"
    blade_groups: int | None = Field(default=None, ge=1, le=60)
    #: Sign of the indexing by the cutter's angle: -1 where cutter and crown gear roll on each other from outside, which
    #: gives the epicycloid of ISO 23509; 1 from inside. A hobbed member has to state it.
    indexing_sign: Literal[1, -1] = Field(default=1, json_schema_extra={"default": "required in face hobbing"})
    blank: Blank
    concave: Flank
    convex: Flank
    index_correction: Annotated[tuple[float, ...], Unit("degree")] = Field(default=(), strict=False)
    _name: str | None = PrivateAttr(default=None)

    @property
    def name(self) -> str:
        """Which member of its set it is: "pinion" or "gear". Raises LookupError for one that was in no set yet."""
        if self._name is None:
            raise LookupError("this Member was in no BevelSet yet: say which one it is with named('pinion')")
        return self._name

    def named(self, name: str) -> Member:
        """The member as the pinion or the gear of a set."""
        if name == self._name:
            return self
        member = self.model_copy()
        member._name = name
        return member

    @classmethod
    def plain(cls, values: Mapping[str, Any], mm: float, where: tuple[str, ...]) -> dict[str, Any]:
        if values.get("index_correction") == []:
            words = "holds no value, so it has no effect; leave it out"
            raise refusal_of(cls, (*where, "index_correction"), [], words)
        plain = super().plain(values, mm, where)
        if plain.get("generation") == "formate":
            _fill_still_roll(plain)
        blank = plain.get("blank")
        beyond = blank.get(BEYOND, 0.0) if isinstance(blank, dict) else 0.0
        if beyond and is_number(beyond):
            flanks = [plain[flank] for flank in FLANKS if isinstance(plain.get(flank), dict)]
            for table in (*flanks, *(flank["design"] for flank in flanks if isinstance(flank.get("design"), dict))):
                if is_number(table.get(ADVANCE)):
                    table[ADVANCE] = _from_apex(table[ADVANCE], beyond)
        return plain

    @model_validator(mode="after")
    def _consistent(self) -> Member:
        if self.index_correction and len(self.index_correction) != self.teeth:
            raise ValueError(
                f"index_correction has {counted(len(self.index_correction), 'value')}, the member "
                f"{counted(self.teeth, 'tooth')}"
            )
        if any(not abs(value) <= 1 for value in self.index_correction):
            raise ValueError("index_correction must lie between -1 and 1 degree")
        for tooth, value in enumerate(self.index_correction):
            if (step := abs(value - self.index_correction[tooth - 1])) > _INDEX_STEP:
                raise ValueError(
                    f"index_correction: teeth {(tooth - 1) % self.teeth} and {tooth} differ by {step:g} degrees; "
                    f"neighbors may differ by {_INDEX_STEP:g}"
                )
        if (self.process == "face_hobbing") != (self.blade_groups is not None):
            raise ValueError("blade_groups belongs to face_hobbing, and face_hobbing needs it")
        if self.indexing_sign != 1 and self.blade_groups is None:
            raise ValueError("indexing_sign belongs to face_hobbing")
        if self.process == "face_hobbing" and "indexing_sign" not in self.model_fields_set:
            raise ValueError(
                "indexing_sign: the key is missing: face_hobbing needs it, -1 where cutter and crown gear roll on each "
                "other from outside (the epicycloid of ISO 23509), 1 from inside"
            )
        if self.process == "face_hobbing" and any(self.index_correction):
            raise ValueError("index_correction: face hobbing indexes without end: no space can be turned by itself")
        if self.process == "face_hobbing" and self.cutting != "completing":
            raise ValueError("face_hobbing cuts both flanks at once: cutting must be completing")
        for flank in FLANKS:
            if self.process == "face_hobbing" and self.flank(flank).blade_count is not None:
                raise ValueError(
                    f"{flank}.blade_count = {self.flank(flank).blade_count}: belongs to face_milling; in face_hobbing "
                    "blade_groups says how many blades there are"
                )
            self._check_cutter(flank)
        if self.cutting == "completing":
            shared = self.shared_settings
            differing = [name for name in shared if getattr(self.concave, name) != getattr(self.convex, name)]
            if self.concave.motion != self.convex.motion:
                differing.append("motion")
            if differing:
                raise ValueError(f"a completing cut has one {differing[0]} for both flanks, not two")
            concave, convex = self.concave.nominal, self.convex.nominal
            differing = [name for name in shared if getattr(concave, name) != getattr(convex, name)]
            if differing:
                raise ValueError(f"design: a completing cut has one {differing[0]} for both flanks, not two")
        return self

    def _check_cutter(self, name: str) -> None:
        """Whether the cutter of a flank can stand in the tooth at all: what fails here has no real contact."""
        spec, blank = self.flank(name), self.blank
        if spec.machine_root_angle <= 0 and not abs(spec.cutter_tilt) > abs(spec.machine_root_angle):
            raise ValueError(
                f"{name}.machine_root_angle = {spec.machine_root_angle:g}: must be above 0, or the cutter tilted by "
                f"more (cutter_tilt = {spec.cutter_tilt:g})"
            )
        highest = blank.face_angle + abs(spec.cutter_tilt) + _ROOT_BEYOND
        if spec.machine_root_angle > highest:
            raise ValueError(
                f"{name}.machine_root_angle = {spec.machine_root_angle:g}: beyond the blank, it must be at most "
                f"face_angle + |cutter_tilt| + {_ROOT_BEYOND:g} = {highest:g}"
            )
        S, r, R = spec.radial_distance, spec.blade_point_radius, blank.mean_cone_distance
        slack = abs(spec.blank_offset) + abs(spec.machine_center_to_crossing_point) + spec.blade_profile_height
        if not abs(S - r) - slack <= R <= S + r + slack:
            raise ValueError(
                f"{name}: no real contact, the cutter does not reach the mean point: "
                f"radial_distance = {shown(S):g} must lie between {shown(abs(R - r) - slack):.4g} and "
                f"{shown(R + r + slack):.4g}, or blade_point_radius = {shown(r):g} between "
                f"{shown(abs(R - S) - slack):.4g} and {shown(R + S + slack):.4g}"
            )

    @property
    def shared_settings(self) -> tuple[str, ...]:
        """The settings of the machine that both flanks have in common: none where each is cut by itself.

        In face hobbing the inner blades may follow the outer ones; the work turns in between by what the work rotation
        offsets differ in.
        """
        if self.cutting != "completing":
            return ()
        apart = self.concave.work_rotation_offset != self.convex.work_rotation_offset
        own = ("work_rotation_offset",) if self.process == "face_hobbing" and apart else ()
        return tuple(name for name in MACHINE_SETTINGS if name not in own)

    def flank(self, flank: str) -> Flank:
        return self.concave if flank == "concave" else self.convex


class BevelSet(Sheet):
    """A pair or one member of it, with where it comes from.

    ``unit`` is that of the file's lengths; those of a loaded set are in mm.
    """

    unit: Literal["mm", "inch"] = "mm"
    title: str = Field(min_length=1, max_length=200)
    source: str = Field(max_length=1000)
    shaft_angle: Angle = Field(gt=0, lt=180)
    pinion: Member | None = None
    gear: Member | None = None

    @field_validator(*MEMBERS)
    @classmethod
    def _named(cls, member: Member | None, info: ValidationInfo) -> Member | None:
        return None if member is None or info.field_name is None else member.named(info.field_name)

    @model_validator(mode="after")
    def _mates(self) -> BevelSet:
        if not self.members:
            raise ValueError("holds neither a pinion nor a gear")
        if self.pinion and self.gear and self.pinion.hand == self.gear.hand:
            raise ValueError(f"pinion and gear are both {self.pinion.hand} hand: a pair has one of each hand")
        return self

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> BevelSet:
        """A copy; one with other values is that of no file, and its members are those that they were put as."""
        made = super().model_copy(update=update, deep=deep)
        if update:
            made.__dict__.pop(_FILE, None)
            members = [(name, one) for name, one in made.members.items() if isinstance(one, Member)]
            made.__dict__.update({name: one.named(name) for name, one in members})
        return made

    @property
    def members(self) -> dict[str, Member]:
        """The members that are there, by name."""
        both = {"pinion": self.pinion, "gear": self.gear}
        return {name: member for name, member in both.items() if member is not None}

    def member(self, name: str) -> Member:
        """The member called ``name``. Raises InputError for any name but pinion and gear, and for one not there."""
        if name not in MEMBERS:
            raise InputError(f"member = {name!r}: must be pinion or gear")
        members = self.members
        if name not in members:
            raise InputError(f"{self.__dict__.get(_FILE, self.title)}: has no {name}, only a {next(iter(members))}")
        return members[name]


def load_bevel_set(path: Path) -> BevelSet:
    """Read a gear set. Raises InputError naming file, key, value and limit."""
    gear_set = load(path, BevelSet)
    gear_set.__dict__[_FILE] = str(path)  # for sentences; no field, so that sets are equal whatever their file
    return gear_set


def design_sha256(member: Member) -> str:
    """What a measurement is judged against: the digest of all that makes the nominal flanks of a member."""
    nominal = [member.flank(flank).nominal.vector.tolist() for flank in FLANKS]
    motions = [member.flank(flank).nominal_motion for flank in FLANKS]
    return _digest(member, motions, [member.flank(flank).nominal_spheric_radius for flank in FLANKS], nominal)


def settings_sha256(member: Member) -> str:
    """What a program is made from: the digest of the method, the machine settings and the index corrections."""
    actual = [member.flank(flank).vector.tolist() for flank in FLANKS]
    radii = [member.flank(flank).blade_spheric_radius for flank in FLANKS]
    return _digest(
        member, [member.flank(flank).motion for flank in FLANKS], radii, actual, list(member.index_correction)
    )


def _digest(member: Member, motions: list[Motion], radii: list[float | None], *settings: list) -> str:
    """The digest of settings and motions together with the method and the blades, which no correction changes.

    How many blades there are changes no flank, and no digest; tips in the plane of the point radii are as none stated.
    """
    method = member.model_dump(include={"teeth", "process", "generation", "blade_groups", "indexing_sign"})
    others = {"design", "blade_count", *SETTINGS}
    level = {"blade_tip_height"} if not any(member.flank(flank).blade_tip_height for flank in FLANKS) else set()
    blades = [
        member.flank(flank).model_dump(exclude=others | level)
        | {"motion": motion.model_dump(), "blade_spheric_radius": radius}
        for flank, motion, radius in zip(FLANKS, motions, radii, strict=True)
    ]
    return hashlib.sha256(repr((sorted(method.items()), blades, *settings)).encode()).hexdigest()


def _fill_still_roll(member: dict[str, Any]) -> None:
    """A Formate flank needs no ratio of roll: where it is left out, it is that of the crown gear (14.2)."""
    blank = member.get("blank")
    pitch: Any = blank.get("pitch_angle") if isinstance(blank, dict) else None
    flanks = [member[flank] for flank in FLANKS if isinstance(member.get(flank), dict)]
    for table in (*flanks, *(flank["design"] for flank in flanks if isinstance(flank.get("design"), dict))):
        root: Any = table.get("machine_root_angle")
        if RATIO not in table and is_number(pitch) and is_number(root) and 0 < float(pitch) < 90:
            table[RATIO] = _still_roll(float(pitch), float(root))


def _still_roll(pitch_angle: float, machine_root_angle: float) -> float:
    """The ratio of roll of the crown gear (14.2) of angles in degrees."""
    (value,) = kernel("crown_gear_roll")(math.radians(pitch_angle), math.radians(machine_root_angle))
    return float(value)


def _from_apex(advance: float, beyond: float) -> float:
    """X_p from the pitch apex out of X_C from the crossing point (2.6)."""
    (value,) = kernel("advance_from_apex")(advance, beyond)
    return float(value)
