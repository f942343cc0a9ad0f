"""A spiral bevel gear set: blanks, cutters and machine settings of its members, in REXS vocabulary, mm and degrees.

A file may be in inches, have angles in degrees, minutes and seconds (``sheet``), give the ratio of roll as cradle by
work, and count ``machine_center_to_crossing_point`` from a crossing point that the pitch apex lies beyond. What is
loaded is in mm and degrees, with work by cradle, and counts from the pitch apex.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
import tomlkit
from pydantic import Field, model_validator

from derivations import Quantity, cradle, notation
from gearmath.errors import InputError
from gearmath.files import read_text, write_text
from gearmath.specs.sheet import (
    UNITS,
    Angle,
    Length,
    Sheet,
    Unit,
    angle_text,
    is_number,
    refusal_of,
    shown,
    unit_of,
)
from gearmath.specs.toml import Spec, load, parse

if TYPE_CHECKING:
    from gearmath.lowering import Kernel

MEMBERS = ("pinion", "gear")
FLANKS = ("concave", "convex")
#: +1 outer blade cuts the concave flank, -1 inner blade the convex flank, for both hands.
SIDES = {"concave": 1, "convex": -1}
SETTINGS = tuple(component.name for component in notation.settings.components)
#: The settings that belong to the machine and not to the blade: a completing cut shares them.
MACHINE_SETTINGS = tuple(name for name in SETTINGS if not name.startswith("blade_"))
#: The largest radius of a blade that is no straight one [mm]: its sagitta over 10 mm is 0.6 um.
STRAIGHT = 20_000.0
_ANGULAR = {component.name for component in notation.settings.components if component.unit == "rad"}
#: Cradle rotation by work rotation, in place of the ratio of roll.
CRADLE_PER_WORK = "ratio_of_roll_cradle_per_work"
_FILE = "_file"
#: A corrected machine may stand steeper than the face of a uniform tooth by so much. [degree]
_ROOT_BEYOND = 1.0
_RATIO, _ADVANCE, _BEYOND = "ratio_of_roll", "machine_center_to_crossing_point", "pitch_apex_beyond_crossing_point"


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
    def vector(self) -> np.ndarray:
        """The blank as the vector of ``notation.blank`` (8,), mm and rad."""
        return _vector(self, notation.blank.components)


_Coefficients = Annotated[tuple[Annotated[float, Field(ge=-1000, le=1000)], ...], Field(strict=False, max_length=7)]
_Lengths = Annotated[_Coefficients, Unit("mm")]
_Angles = Annotated[_Coefficients, Unit("degree")]


class Motion(Sheet):
    """Coefficients of θ^1 ... θ^7 of machine settings, mm and degrees per rad^j; ``modified_roll`` is 2C, 6D, ..."""

    radial_distance: _Lengths = ()
    cradle_angle: _Angles = ()
    cutter_tilt: _Angles = ()
    cutter_swivel: _Angles = ()
    blank_offset: _Lengths = ()
    sliding_base: _Lengths = ()
    machine_center_to_crossing_point: _Lengths = ()
    machine_root_angle: _Angles = ()
    ratio_of_roll: _Coefficients = ()
    work_rotation_offset: _Angles = ()
    modified_roll: Annotated[_Coefficients, Field(max_length=4)] = ()

    @property
    def matrix(self) -> np.ndarray:
        """The motion as the matrix of ``notation.motion`` (10,7), mm and rad, without the modified roll."""
        matrix = np.zeros(notation.motion.shape)
        for row, name in zip(matrix, MACHINE_SETTINGS, strict=True):
            values = np.array(getattr(self, name), dtype=float)
            row[: len(values)] = np.radians(values) if name in _ANGULAR else values
        return matrix

    @property
    def roll(self) -> np.ndarray:
        """2C, 6D, 24E, 120F (4,)."""
        return np.pad(np.array(self.modified_roll, dtype=float), (0, 4 - len(self.modified_roll)))


class Settings(Sheet):
    """The settings of machine and cutter of one flank (mm, degrees).

    A file may give the ratio of roll, work by cradle, as ``ratio_of_roll_cradle_per_work`` instead.
    """

    radial_distance: Length = Field(gt=0, le=1000)
    cradle_angle: Angle = Field(ge=-180, le=180)
    cutter_tilt: Angle = Field(ge=-45, le=45)
    cutter_swivel: Angle = Field(ge=-360, le=360)
    blank_offset: Length = Field(ge=-200, le=200)
    sliding_base: Length = Field(ge=-200, le=200)
    machine_center_to_crossing_point: Length = Field(ge=-200, le=200)
    machine_root_angle: Angle = Field(gt=0, lt=87)
    ratio_of_roll: float = Field(gt=0.1, le=50)
    work_rotation_offset: Angle = Field(ge=-360, le=360)
    blade_point_radius: Length = Field(gt=5, le=500)
    blade_pressure_angle: Angle = Field(ge=3, le=45)

    @classmethod
    def keys(cls) -> list[str]:
        """The keys of its table in a file."""
        return [*super().keys(), CRADLE_PER_WORK]

    @classmethod
    def plain(cls, values: Mapping[str, Any], mm: float, where: tuple[str, ...]) -> dict[str, Any]:
        plain = super().plain(values, mm, where)
        if CRADLE_PER_WORK in plain:
            ratio = plain.pop(CRADLE_PER_WORK)
            if _RATIO in plain:
                raise refusal_of(
                    cls, (*where, CRADLE_PER_WORK), ratio, f"{_RATIO} is given too: only one of them may be"
                )
            if not is_number(ratio) or not 1 / 50 <= ratio < 1 / 0.1:
                raise refusal_of(cls, (*where, CRADLE_PER_WORK), ratio, "must be at least 0.02 and less than 10")
            plain[_RATIO] = 1 / ratio
        return plain

    @property
    def vector(self) -> np.ndarray:
        """The settings as the vector of ``notation.settings`` (12,), mm and rad."""
        return _vector(self, notation.settings.components)


class Design(Settings):
    """The settings of the nominal flank of a corrected one; ``motion`` where the motion was corrected too.

    ``blade_spheric_radius`` is that of the nominal blade, or "straight", where it was corrected.
    """

    motion: Motion | None = None
    blade_spheric_radius: Annotated[Length, Field(ge=-STRAIGHT, le=STRAIGHT)] | Literal["straight"] | None = None


class Flank(Settings):
    """How one flank is cut; ``design``, where given, holds the settings of the nominal flank, the others corrected."""

    blade_profile_height: Length = Field(gt=0, le=60)
    blade_edge_radius: Length = Field(default=0.0, ge=0, le=10)
    #: Of a fixed-setting cutter, which has another side (mm); without it the root of the space decides.
    blade_point_width: Length | None = Field(default=None, gt=0, le=60)
    blade_spheric_radius: Length | None = Field(default=None, ge=-STRAIGHT, le=STRAIGHT)
    blade_reference_height: Length = Field(default=0.0, ge=0, le=60)
    toprem_angle: Angle | None = Field(default=None, ge=0.5, le=45)
    toprem_height: Length = Field(default=0.0, ge=0, le=10)
    blade_offset_angle: Angle = Field(default=0.0, ge=-45, le=45)
    motion: Motion = Motion()
    design: Design | None = None

    @model_validator(mode="after")
    def _blade(self) -> Flank:
        if self.blade_spheric_radius is not None and abs(self.blade_spheric_radius) < 2 * self.blade_profile_height:
            radius, limit = shown(self.blade_spheric_radius), shown(2 * self.blade_profile_height)
            raise ValueError(f"blade_spheric_radius = {radius}: must be at least {limit} in size")
        if (self.toprem_angle is not None) != (self.toprem_height > 0):
            raise ValueError("toprem_angle and toprem_height belong together")
        return self

    @property
    def nominal(self) -> Settings:
        """The settings whose tooth surface is wanted."""
        return self.design or self

    @property
    def nominal_spheric_radius(self) -> float | None:
        """The radius of the blade whose tooth surface is wanted, None where it is straight."""
        before = self.design.blade_spheric_radius if isinstance(self.design, Design) else None
        return self.blade_spheric_radius if before is None else None if before == "straight" else before

    @property
    def nominal_motion(self) -> Motion:
        """The motion of the settings whose tooth surface is wanted."""
        return (self.design.motion if isinstance(self.design, Design) else None) or self.motion


class Member(Sheet):
    """One member of the pair. ``index_correction`` turns each tooth space by that many degrees before it is cut."""

    teeth: int = Field(ge=3, le=400)
    hand: Literal["left", "right"]
    cutting: Literal["fixed_setting", "completing"]
    process: Literal["face_milling", "face_hobbing"] = "face_milling"
    generation: Literal["generated", "formate"] = "generated"
    blade_groups: int | None = Field(default=None, ge=1, le=60)
    #: Sign of the indexing by the cutter's angle: -1 where cutter and crown gear roll on each other from outside, which
    #: gives the epicycloid of ISO 23509; 1 from inside. A hobbed member has to state it.
    indexing_sign: Literal[1, -1] = 1
    blank: Blank
    concave: Flank
    convex: Flank
    index_correction: Annotated[tuple[float, ...], Unit("degree")] = Field(default=(), strict=False)

    @classmethod
    def plain(cls, values: Mapping[str, Any], mm: float, where: tuple[str, ...]) -> dict[str, Any]:
        plain = super().plain(values, mm, where)
        blank = plain.get("blank")
        beyond = blank.get(_BEYOND, 0.0) if isinstance(blank, dict) else 0.0
        if beyond and is_number(beyond):
            flanks = [plain[flank] for flank in FLANKS if isinstance(plain.get(flank), dict)]
            for table in (*flanks, *(flank["design"] for flank in flanks if isinstance(flank.get("design"), dict))):
                if is_number(table.get(_ADVANCE)):
                    table[_ADVANCE] = _from_apex(table[_ADVANCE], beyond)
        return plain

    @model_validator(mode="after")
    def _consistent(self) -> Member:
        if self.index_correction and len(self.index_correction) != self.teeth:
            raise ValueError(f"index_correction has {len(self.index_correction)} values, the member {self.teeth} teeth")
        if any(not abs(value) <= 1 for value in self.index_correction):
            raise ValueError("index_correction must lie between -1 and 1 degree")
        if (self.process == "face_hobbing") != (self.blade_groups is not None):
            raise ValueError("blade_groups belongs to face_hobbing, and face_hobbing needs it")
        if self.indexing_sign != 1 and self.blade_groups is None:
            raise ValueError("indexing_sign belongs to face_hobbing")
        if self.process == "face_hobbing" and "indexing_sign" not in self.model_fields_set:
            raise ValueError(
                "indexing_sign: the key is missing: face_hobbing needs it, -1 where cutter and crown gear roll on each "
                "other from outside (the epicycloid of ISO 23509), 1 from inside"
            )
        if self.process == "face_hobbing" and self.cutting != "completing":
            raise ValueError("face_hobbing cuts both flanks at once: cutting must be completing")
        for flank in FLANKS:
            self._check_cutter(flank)
        if self.cutting == "completing":
            differing = [name for name in MACHINE_SETTINGS if getattr(self.concave, name) != getattr(self.convex, name)]
            if self.concave.motion != self.convex.motion:
                differing.append("motion")
            if differing:
                raise ValueError(f"a completing cut has one {differing[0]} for both flanks, not two")
        return self

    def _check_cutter(self, name: str) -> None:
        """Whether the cutter of a flank can stand in the tooth at all: what fails here has no real contact."""
        spec, blank = self.flank(name), self.blank
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
                f"{name}.blade_point_radius = {shown(r):g}: no real contact, the cutter does not reach the mean point: "
                f"at radial_distance = {shown(S):g} it must lie between {shown(abs(R - S) - slack):.4g} and "
                f"{shown(R + S + slack):.4g}"
            )

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

    @model_validator(mode="after")
    def _mates(self) -> BevelSet:
        if not self.members:
            raise ValueError("holds neither a pinion nor a gear")
        if self.pinion and self.gear and self.pinion.hand == self.gear.hand:
            raise ValueError(f"pinion and gear are both {self.pinion.hand} hand: a pair has one of each hand")
        return self

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
    )  # fmt: skip


def _digest(member: Member, motions: list[Motion], radii: list[float | None], *settings: list) -> str:
    """The digest of settings and motions together with the method and the blades, which no correction changes."""
    method = member.model_dump(include={"teeth", "process", "generation", "blade_groups", "indexing_sign"})
    others = {"design", *SETTINGS}
    blades = [
        member.flank(flank).model_dump(exclude=others) | {"motion": motion.model_dump(), "blade_spheric_radius": radius}
        for flank, motion, radius in zip(FLANKS, motions, radii, strict=True)
    ]
    return hashlib.sha256(repr((sorted(method.items()), blades, *settings)).encode()).hexdigest()


def save_corrected(
    source: Path,
    target: Path,
    member: str,
    settings: dict[str, np.ndarray],
    index_correction: np.ndarray | None = None,
    motions: dict[str, np.ndarray] | None = None,
    curvatures: dict[str, float] | None = None,
    check: Callable[[BevelSet], object] = lambda _: None,
) -> None:
    """Write the set of ``source``, comments kept, with new settings (12,) of each flank, to ``target``.

    A setting that stays is left as it is written. The nominal settings are kept under ``design``.
    ``index_correction`` (z,) in rad replaces that of the member, and ``motions`` (10,7) of each flank, without the
    modified roll, its motion, and ``curvatures`` [1/mm] those of its blade. The text is checked as a set, and by
    ``check`` besides, before anything is written. Raises InputError naming the target.
    """
    content = read_text(source)
    before, document = parse(content, BevelSet, str(source)).member(member), tomlkit.parse(content)
    table: Any = document[member]
    mm, beyond = UNITS[document.get("unit", "mm")], table["blank"].get(_BEYOND, 0.0)
    for flank, vector in settings.items():
        written = _written(table[flank], vector, mm, beyond)
        if "design" not in table[flank]:
            table[flank]["design"] = {key: table[flank][key] for key in written}
        changed = vector != before.flank(flank).vector
        for (key, value), new in zip(written.items(), changed, strict=True):
            if new:
                table[flank][key] = value
    for flank, matrix in (motions or {}).items():
        _save_motion(table[flank], matrix, mm)
    for flank, curvature in (curvatures or {}).items():
        _save_curvature(table[flank], curvature, mm)
    if index_correction is not None:
        table["index_correction"] = [round(math.degrees(value), 7) + 0.0 for value in index_correction]
    text = tomlkit.dumps(document)
    corrected = parse(text, BevelSet, str(target))
    try:
        check(corrected)
    except InputError as error:
        raise InputError(f"{target}: {error}") from error
    write_text(target, text)


def _written(table: Any, vector: np.ndarray, mm: float, beyond: float) -> dict[str, float | str]:
    """Settings (12,) by key as the table of a flank has them: its unit, its angles, its ratio, its crossing point.

    Nine decimals of a millimetre, or as many digits of an inch.
    """
    written: dict[str, float | str] = {}
    for name, value in zip(SETTINGS, vector.tolist(), strict=True):
        if name in _ANGULAR:
            degrees, old = math.degrees(value), table.get(name)
            written[name] = angle_text(degrees, old) if isinstance(old, str) else round(degrees, 9)
        elif name == _RATIO:
            inverse = CRADLE_PER_WORK in table
            written[CRADLE_PER_WORK if inverse else _RATIO] = round(1 / value, 11) if inverse else round(value, 9)
        else:
            apart = beyond if name == _ADVANCE else 0.0
            written[name] = round(value / mm - apart, _decimals(mm))
    return written


def _decimals(mm: float) -> int:
    return 9 if mm == 1 else 11


def _from_apex(advance: float, beyond: float) -> float:
    """X_p from the pitch apex out of X_C from the crossing point (2.6)."""
    (value,) = _advance_kernel()(advance, beyond)
    return float(value)


@cache
def _advance_kernel() -> Kernel:
    from gearmath.lowering import lower

    return lower(cradle.advance_from_apex())


def _save_motion(table: Any, matrix: np.ndarray, mm: float) -> None:
    """A motion (10,7) into the table of a flank; the nominal one goes under ``design``, the modified roll stays."""
    before = dict(table.get("motion", {}))
    if "motion" not in table["design"]:
        table["design"]["motion"] = before
    motion = {"modified_roll": before["modified_roll"]} if "modified_roll" in before else {}
    for row, name in zip(matrix, MACHINE_SETTINGS, strict=True):
        factor = 1 / mm if unit_of(Motion, name) == "mm" else 1.0
        values = np.trim_zeros(np.round(np.degrees(row) if name in _ANGULAR else row * factor, _decimals(mm)), "b")
        if len(values):
            motion[name] = values.tolist()
    table["motion"] = motion


def _save_curvature(table: Any, curvature: float, mm: float) -> None:
    """The curvature [1/mm] of a blade into the table of a flank; the nominal radius goes under ``design``."""
    if "blade_spheric_radius" not in table["design"]:
        table["design"]["blade_spheric_radius"] = table.get("blade_spheric_radius", "straight")
    table.pop("blade_spheric_radius", None)
    if abs(curvature) > 1 / STRAIGHT:
        table["blade_spheric_radius"] = round(1 / curvature / mm, 6 if mm == 1 else 8)


def _vector(model: Spec, components: tuple[Quantity, ...]) -> np.ndarray:
    values = [(getattr(model, component.name), component.unit) for component in components]
    return np.array([math.radians(value) if unit == "rad" else value for value, unit in values])


def set_text(gear_set: BevelSet) -> str:
    """A gear set as the text of its file, without what has its default value; numbers to nine decimals."""
    values = gear_set.model_dump(exclude_defaults=True)
    for name in (name for name in MEMBERS if name in values):
        if gear_set.member(name).process == "face_hobbing":
            values[name]["indexing_sign"] = gear_set.member(name).indexing_sign  # it has to be stated, whatever it is
    for member in (values[name] for name in MEMBERS if name in values):
        for table in (member[flank] for flank in FLANKS):
            for settings in (table, *([table["design"]] if "design" in table else [])):
                settings[_ADVANCE] -= member["blank"].get(_BEYOND, 0.0)
    head = "# Lengths in mm, angles in degrees.\n"
    return head + tomlkit.dumps(_plain(values))


def _plain(value: Any) -> Any:
    """Tables, lists and rounded numbers, without a negative zero."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return round(value, 9) + 0.0 if isinstance(value, float) else value
