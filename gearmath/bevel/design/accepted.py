"""A design with its verdict; where nobody asked for a place of the contact, at one where the pair runs."""

from __future__ import annotations

from typing import Any

from gearmath.bevel.contact.mesh import Mesh
from gearmath.bevel.design.route import Designed, design
from gearmath.bevel.design.verdict import verdict
from gearmath.errors import ComputationError, InputError
from gearmath.specs.bevel_set import BevelSet
from gearmath.specs.design import DesignData

#: Places of the vertex from toe (0) to heel (1) that are tried in turn, where none is asked for: with uniform depth the
#: toe of a small pinion is undercut, and the contact must lie nearer to the heel.
_ALONG, _ALONG_UNIFORM = (0.5,), (0.5, 0.65, 0.75)


def accepted(
    data: DesignData, name: str = "design data", given: BevelSet | None = None
) -> tuple[Designed, dict[str, Any], dict[str, Mesh]]:
    """A pair from the data of a design as :func:`design` makes it, its figures, and the contact of both sides.

    Raises InputError and ComputationError as :func:`design` and :func:`verdict` do, those of the first place tried.
    """
    hobbed, free = data.cutter.process == "face_hobbing", data.drive.position is None or data.coast.position is None
    first: InputError | ComputationError | None = None
    for along in _ALONG_UNIFORM if hobbed and free else _ALONG:
        try:
            made = design(data, name, given, along)
            return made, *verdict(made)
        except (InputError, ComputationError) as error:
            first = first or error
    assert first is not None
    raise first
