"""Which method or motion is to blame where flanks are cut that do not fit the mate: another one makes the set pass."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from gearmath.specs.bevel_set import FLANKS, Flank, Member, Motion

_OTHER = {"generated": "formate", "formate": "generated"}
#: What a motion may have been written by: the other sense, coefficients that hold a 1/2 or lack it.
_FACTORS = (-1.0, 2.0, 0.5)

Members = dict[str, Member]


def likely_method(members: Members, passes: Callable[[Members], bool]) -> str:
    """What to say of the method or the motions of a set, empty where none of those tried makes it pass."""
    for words, changed in _others(members):
        if passes(changed):
            return f"; {words}"
    return ""


def _others(members: Members) -> Iterator[tuple[str, Members]]:
    for name, member in members.items():
        other = _OTHER[member.generation]
        moves = any(member.flank(flank).motion.moves for flank in FLANKS)
        if other == "generated" or not moves:
            words = f"it would fit with {name}.generation = {other!r}, not {member.generation!r}"
            yield words, {**members, name: member.model_copy(update={"generation": other})}
        if not moves:
            continue
        one, two = (member.flank(flank) for flank in FLANKS)
        exchanged = {"concave": _moving(one, two.motion), "convex": _moving(two, one.motion)}
        words = f"it would fit with {name}.concave.motion and {name}.convex.motion"
        yield f"{words} exchanged", _with(members, name, exchanged)
        for factor in _FACTORS:
            scaled = {
                flank: _moving(spec, _times(spec.motion, factor))
                for flank, spec in zip(FLANKS, (one, two), strict=True)
            }
            yield f"{words} times {factor:g}", _with(members, name, scaled)


def _times(motion: Motion, factor: float) -> Motion:
    return Motion(**{key: tuple(factor * value for value in values) for key, values in motion.model_dump().items()})


def _moving(flank: Flank, motion: Motion) -> Flank:
    return flank.model_copy(update={"motion": motion})


def _with(members: Members, name: str, flanks: dict[str, Flank]) -> Members:
    return {**members, name: members[name].model_copy(update=flanks)}
