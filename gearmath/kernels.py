"""The kernels of all expressions by name: the one cache of what is derived and lowered."""

from __future__ import annotations

import difflib
import json
import sys
from collections.abc import Mapping
from dataclasses import asdict
from functools import cache
from importlib.metadata import version
from importlib.resources import files
from typing import Any

import casadi as ca

import derivations
from derivations.quantity import Quantity
from gearmath.engine import cache as kept
from gearmath.engine.kernel import Kernel
from gearmath.errors import InputError


@cache
def kernel(name: str) -> Kernel:
    """The Kernel of the Expression called ``name``: derived and lowered once, then kept in the cache of this user.

    What is kept was made from the very text of all chapters and of the lowering, by the same SymPy and CasADi; when one
    of them changes it is made again. ``derivations.index()`` has all names, by chapter. Raises InputError where no
    chapter has an expression of this name.
    """
    if name not in derivations.index():
        near = difflib.get_close_matches(name, derivations.index(), 3)
        nearest = f"near are {', '.join(near)}" if near else "derivations.index() has all"
        raise InputError(f"{name!r}: no chapter has an expression of this name; {nearest}")
    file = f"{name}-{_origin()}.json"
    data = kept.read(file)
    if data is not None:
        return _from_json(json.loads(data))
    from gearmath.lowering import lower  # loads SymPy

    made = lower(derivations.derive(name))
    kept.write(file, json.dumps(_to_json(made)).encode())
    return made


@cache
def _origin() -> str:
    """A digest of all that a lowered expression is made from."""
    texts = [derivations.source(chapter) for chapter in (*derivations.CHAPTERS, *_BESIDE_CHAPTERS)]
    texts += [
        files("gearmath").joinpath(name).read_text("utf-8")
        for name in ("lowering.py", "engine/kernel.py", "kernels.py")
    ]
    return kept.key(*texts, version("sympy"), version("casadi"), sys.platform)


_BESIDE_CHAPTERS = ("__init__", "notation", "quantity", "expression", "proof")


def _to_json(made: Kernel) -> dict[str, object]:
    return {
        "function": made.function.serialize(),
        "description": made.description,
        "inputs": [asdict(quantity) for quantity in made.inputs],
        "outputs": [asdict(quantity) for quantity in made.outputs],
        "source": made.source,
        "requires": made.requires,
    }


def _from_json(data: Mapping) -> Kernel:
    inputs, outputs = (tuple(map(_quantity, data[kind])) for kind in ("inputs", "outputs"))
    function = ca.Function.deserialize(data["function"])
    return Kernel(function, data["description"], inputs, outputs, data["source"], tuple(data["requires"]))


def _quantity(data: Mapping) -> Quantity:
    """A Quantity from JSON, where tuples are lists."""
    given: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in data.items()}
    return Quantity(**{**given, "components": tuple(map(_quantity, data["components"]))})
