"""Arguments of public functions, checked before any work: what cannot be is refused in one sentence."""

from __future__ import annotations

import difflib
import functools
import inspect
from collections.abc import Callable, Mapping
from typing import Any, TypeVar, overload

from gearmath.arguments.kinds import Kind, stated
from gearmath.arguments.known import KNOWN
from gearmath.errors import CallError, InputError

F = TypeVar("F", bound=Callable[..., Any])
_SELF = ("self", "cls")


@overload
def checked_call(function: F, /) -> F: ...
@overload
def checked_call(**own: Kind) -> Callable[[F], F]: ...
def checked_call(function: Any = None, /, **own: Kind) -> Any:
    """Check the arguments of a function, or of a class that makes records, each time it is called.

    An argument must be of the kind that the table has by its name, or of its ``own``; None where that is its default.
    Raises InputError naming argument, value and limit, or the arguments there are; TypeError where one has no kind.
    """
    if function is None:
        return functools.partial(_checked, own=own)
    return _checked(function, own)


def _checked(function: Any, own: Mapping[str, Kind]) -> Any:
    if isinstance(function, type):
        made: Any = function
        made.__init__ = _wrapped(made.__init__, function.__name__, own)
        return made
    return _wrapped(function, function.__name__, own)


def _wrapped(function: Callable[..., Any], called: str, own: Mapping[str, Kind]) -> Callable[..., Any]:
    signature = inspect.signature(function)
    given = [one for one in signature.parameters.values() if one.name not in _SELF]
    unknown = [one.name for one in given if one.name not in own and one.name not in KNOWN]
    if unknown:
        raise TypeError(f"{called}: {', '.join(unknown)}: no kind of argument is known by this name")
    kinds = {one.name: own.get(one.name) or KNOWN[one.name] for one in given}
    optional = {one.name for one in given if one.default is None}
    many = {one.name for one in given if one.kind is one.VAR_POSITIONAL}

    @functools.wraps(function)
    def call(*arguments: Any, **options: Any) -> Any:
        try:
            bound = signature.bind(*arguments, **options).arguments
        except TypeError as error:
            raise CallError(_misuse(called, signature, options, str(error))) from None
        for name, value in bound.items():
            if name in _SELF or (value is None and name in optional):
                continue
            for each in value if name in many else (value,):
                refused = kinds[name].refusal(name, each)
                if refused is not None:
                    raise InputError(refused)
        return function(*arguments, **options)

    return call


def _misuse(called: str, signature: inspect.Signature, options: Mapping[str, Any], why: str) -> str:
    """What to say of a call with an argument that there is not, or without one that must be."""
    there = [name for name in signature.parameters if name not in _SELF]
    known = ", ".join(there) or "none"
    for key in options:
        if key not in there:
            near = difflib.get_close_matches(key, there, 1)
            meant = f"did you mean {near[0]}? " if near else ""
            return f"{called}: {stated(key, options[key], 'is no argument')}; {meant}there are {known}"
    return f"{called}: {why}; the arguments are {known}"
