"""A design with its verdict; where the first one does not run, with other values for what nobody asked for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from gearmath.bevel.contact.mesh import Mesh
from gearmath.bevel.design.route import Designed, design
from gearmath.bevel.design.verdict import EdgeContact, verdict
from gearmath.errors import ComputationError, InputError
from gearmath.specs.bevel_set import BevelSet
from gearmath.specs.design import ContactRequest, DesignData

#: Where a pair runs on edges: a path nearer to the length of the tooth lasts longer. [degree]
_LONGER_PATH = {"drive": 35.0, "coast": 145.0}
#: And with uniform depth the toe of a small pinion is undercut: the vertex lies so far from toe (0) to heel (1), and
#: farther where that is not enough.
_ALONG, _NEARER_TO_THE_HEEL = 0.5, (0.65, 0.68)
#: Where teeth are undercut, also in a pair that runs, or no settings are found. [degree]
_PRESSURE_ANGLE = 22.5

#: A pair, its figures, and the contact of both sides.
_Judged = tuple[Designed, dict[str, Any], dict[str, Mesh]]


@dataclass(frozen=True)
class Changed:
    """Design data with other values for keys that the file leaves out, and where the vertex lies, from toe to heel."""

    data: DesignData
    values: dict[str, Any] = field(default_factory=dict)
    along: float = _ALONG


def accepted(data: DesignData, name: str = "design data", given: BevelSet | None = None) -> _Judged:
    """A pair from the data of a design as :func:`design` makes it, its figures, and the contact of both sides.

    The figures tell under ``changed`` which keys that the file leaves out have other values than they start from.
    Raises InputError and ComputationError as :func:`design` and :func:`verdict` do, those of the first trial.
    """
    try:
        first = _judged(Changed(data), name, given)
    except (InputError, ComputationError) as error:
        changes = _on_edges(data) if isinstance(error, EdgeContact) else _not_cut(data, given)
        if (found := next(_that_run(changes, name, given), None)) is None:
            raise
        return found
    if not _is_undercut(first):
        return first
    others = _that_run(_not_cut(data, given), name, given)
    return next((found for found in others if not _is_undercut(found)), first)


def _judged(changed: Changed, name: str, given: BevelSet | None) -> _Judged:
    made = design(changed.data, name, given, changed.along)
    figures, runs = verdict(made)
    return made, {"changed": changed.values, **figures}, runs


def _that_run(changes: Iterator[Changed], name: str, given: BevelSet | None) -> Iterator[_Judged]:
    """The pairs of changed data that can be made and run."""
    for changed in changes:
        try:
            yield _judged(changed, name, given)
        except (InputError, ComputationError):
            continue


def _is_undercut(found: _Judged) -> bool:
    return any(found[1]["undercut_mm"].values())


def _on_edges(data: DesignData) -> Iterator[Changed]:
    """What may help a pair that runs on its edges."""
    path = _with_paths(data)
    if path.values:
        yield path
    free = [side for side in _LONGER_PATH if data.contact(side).position is None]
    if data.cutter.process == "face_hobbing" and free:
        for along in _NEARER_TO_THE_HEEL:
            yield Changed(data, {f"{side}.position[0]": along for side in free}, along)


def _not_cut(data: DesignData, given: BevelSet | None) -> Iterator[Changed]:
    """What may help a pair that cannot be cut."""
    keys = [key for key in ("pressure_angle_drive", "pressure_angle_coast") if key not in data.model_fields_set]
    if given is not None or len(keys) < 2:
        return
    values = dict.fromkeys(keys, _PRESSURE_ANGLE)
    steeper = data.model_copy(update=values)
    yield Changed(steeper, dict(values))
    path = _with_paths(steeper)
    if path.values:
        yield Changed(path.data, {**values, **path.values})


def _with_paths(data: DesignData) -> Changed:
    """Paths nearer to the length of the tooth, where none is asked for."""
    free = [side for side in _LONGER_PATH if _path_is_free(data.contact(side))]
    sides = {side: data.contact(side).model_copy(update={"path_angle": _LONGER_PATH[side]}) for side in free}
    return Changed(data.model_copy(update=sides), {f"{side}.path_angle": _LONGER_PATH[side] for side in free})


def _path_is_free(asked: ContactRequest) -> bool:
    return asked.path_angle is None and asked.lengthwise_crowning is None
