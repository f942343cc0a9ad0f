"""What the head of a program says of set and machine, compared with their files: a machine is set up by it."""

from __future__ import annotations

import re
from collections.abc import Iterator

from gearmath.machine.judging.faults import Fault
from gearmath.machine.judging.stated import Stated
from gearmath.machine.planning.path import Cut
from gearmath.machine.planning.setup_facts import BlankSizes, blade_words, member_note, work_notes, z_note
from gearmath.specs.bevel_set import Member, settings_sha256
from gearmath.specs.milling_machine import MillingMachine


def header_faults(text: str, member: Member, machine: MillingMachine) -> Iterator[Fault]:
    """Comments that say something else of cutter, blank, clamping and Z than the files of set and machine.

    And what a program of ours does not say, so that less could be judged.
    """
    stated = Stated.of(text)
    if stated.unsaid:
        yield Fault(f"the header does not state: {', '.join(stated.unsaid)}")
    if stated.doubled:
        yield Fault(f"the header states more than once: {', '.join(stated.doubled)}")
    wanted = dict(_statements(member, machine))
    for number, line in enumerate(text.splitlines(), 1):
        if not line.startswith(";"):
            if line and not line.startswith("%"):
                break
            continue
        said = " ".join(line[1:].split())
        known = wanted.get(_about(said))
        if known is not None and said != (known := " ".join(known.split())):
            one, other = _differing(said, known)
            yield Fault(f"says '{one}', the files of set and machine have '{other}'", number, "head")


def _differing(said: str, known: str) -> tuple[str, str]:
    """The first parts between commas that differ, or the whole."""
    parts = list(zip(said.split(", "), known.split(", "), strict=False))
    return next(((one, other) for one, other in parts if one != other), (said, known))


def _statements(member: Member, machine: MillingMachine) -> Iterator[tuple[str, str]]:
    """What a line begins with, and the whole of it."""
    notes = [f"machine settings sha256: {settings_sha256(member)}", member_note(member), z_note(machine)]
    notes += work_notes(BlankSizes.of(member, machine), machine)
    for cut in Cut.of(member):
        notes += [f"tool {cut.tool}, {flank}: {blade_words(member.flank(flank))}" for flank in cut.flanks]
    for note in notes:
        yield _about(note), note


def _about(note: str) -> str:
    """What a note begins with: all before its colon or its first figure."""
    return re.split("[:0-9]", note)[0]
