"""A design with its verdict; where the first one does not run, with other values for what nobody asked for."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Any

from gearmath.bevel.contact.mesh import Mesh
from gearmath.bevel.contact.report import SIDES
from gearmath.bevel.design.given import check_given
from gearmath.bevel.design.route import Designed, design
from gearmath.bevel.design.start import USUAL, Teeth
from gearmath.bevel.design.verdict import EdgeContact, verdict
from gearmath.errors import ComputationError, InputError
from gearmath.specs.bevel_set import BevelSet
from gearmath.specs.design import ContactRequest, DesignData

#: Where a pair runs on edges: paths nearer to the length of the tooth last longer; the least change first. [degree]
_LONGER_PATHS = ({"drive": 42.0, "coast": 138.0}, {"drive": 35.0, "coast": 145.0})
#: And with uniform depth the toe of a small pinion is undercut: the vertex lies so far from toe (0) to heel (1), and
#: farther where that is not enough.
_ALONG, _NEARER_TO_THE_HEEL = 0.5, (0.65, 0.68)
#: Where teeth are undercut or too thin, or no settings are found. [degree]
_PRESSURE_ANGLE = 22.5
#: Or shallower teeth, which reach less deep into the pinion, leave it a wider root and both members more land; and with
#: those a pinion that has more of the depth as its addendum.
_SHALLOWER, _LONGER_PINION = Teeth(0.9), Teeth(0.9, 0.8)

#: Usual spiral angles [degree]: one in radians would be one of these.
_RADIANS = (10.0, 50.0)
#: A pair, its figures, and the contact of both sides.
_Judged = tuple[Designed, dict[str, Any], dict[str, Mesh]]


@dataclass(frozen=True)
class Changed:
    """Design data with other ``values`` for keys that the file leaves out, where the vertex lies, from toe to heel, and
    the factors of the teeth."""

    data: DesignData
    values: dict[str, Any] = field(default_factory=dict)
    along: float = _ALONG
    teeth: Teeth = USUAL


def accepted(data: DesignData, name: str = "design data", given: BevelSet | None = None) -> _Judged:
    """A pair from the data of a design as :func:`design` makes it, its figures, and the contact of both sides.

    The figures tell under ``changed`` which keys that the file leaves out have other values than they start from.
    Raises InputError and ComputationError as :func:`design` and :func:`verdict` do, those of the first trial.
    """
    if given is not None:
        check_given(given, data, name)
    found, why = _tried(Changed(data), _on_edges(data), name, given)
    if found is None and not all(isinstance(error, EdgeContact) for error in why):
        for changed in _not_cut(data, given):
            found, _ = _tried(changed, _with_paths(changed), name, given)
            if found is not None:
                break
    if found is None:
        raise _in_degrees(data, why[0])
    return found


def _in_degrees(data: DesignData, error: InputError | ComputationError) -> InputError | ComputationError:
    """The error, with a word where the spiral angle that the file gives would be a usual one if it were in radians."""
    angle = data.mean_spiral_angle
    if not (_RADIANS[0] <= math.degrees(angle) <= _RADIANS[1]):
        return error
    return type(error)(
        f"{error}; mean_spiral_angle = {angle:g} is in degrees, and {angle:g} rad would be {math.degrees(angle):.4g}"
    )


def _tried(
    changed: Changed, on_edges: Iterator[Changed], name: str, given: BevelSet | None
) -> tuple[_Judged | None, list[InputError | ComputationError]]:
    """The pair of changed data or, where that one runs on edges, the first of others that is accepted; and what the
    ones before were refused for."""
    why: list[InputError | ComputationError] = []
    for one in chain([changed], on_edges):
        try:
            return _judged(one, name, given), why
        except (InputError, ComputationError) as error:
            why.append(error)
            if not isinstance(why[0], EdgeContact):
                break
    return None, why


def _judged(changed: Changed, name: str, given: BevelSet | None) -> _Judged:
    made = design(changed.data, name, given, changed.along, changed.teeth)
    figures, runs = verdict(made)
    parts, factors = vars(changed.teeth), figures["data_type_2"] or {}
    teeth = {f"data_type_2.{key}": factors[key] for key, part in parts.items() if part != 1}
    return made, {"changed": {**changed.values, **teeth}, **figures}, runs


def _on_edges(data: DesignData) -> Iterator[Changed]:
    """What may help a pair that runs on its edges."""
    yield from _with_paths(Changed(data))
    free = [side for side in SIDES if data.contact(side).position is None]
    if data.cutter.process == "face_hobbing" and free:
        for along in _NEARER_TO_THE_HEEL:
            yield Changed(data, {f"{side}.position[0]": along for side in free}, along)


def _not_cut(data: DesignData, given: BevelSet | None) -> Iterator[Changed]:
    """What may help a pair that cannot be cut, the least change first."""
    if given is not None:
        return
    angles = ("pressure_angle_drive", "pressure_angle_coast")
    values = dict.fromkeys(angles, _PRESSURE_ANGLE)
    steeper = None if data.model_fields_set & set(angles) else data.model_copy(update=values)
    if steeper is not None:
        yield Changed(steeper, values)
    if data.data_type_1 is None and data.data_type_2 is None:
        yield Changed(data, teeth=_SHALLOWER)
        if steeper is not None:
            yield Changed(steeper, values, teeth=_SHALLOWER)
            yield Changed(steeper, values, teeth=_LONGER_PINION)


def _with_paths(changed: Changed) -> Iterator[Changed]:
    """Paths nearer to the length of the tooth, where none is asked for."""
    data = changed.data
    free = [side for side in SIDES if _path_is_free(data.contact(side))]
    for path in _LONGER_PATHS if free else ():
        sides = {side: data.contact(side).model_copy(update={"path_angle": path[side]}) for side in free}
        values = {**changed.values, **{f"{side}.path_angle": path[side] for side in free}}
        yield replace(changed, data=data.model_copy(update=sides), values=values)


def _path_is_free(asked: ContactRequest) -> bool:
    return asked.path_angle is None and asked.lengthwise_crowning is None
