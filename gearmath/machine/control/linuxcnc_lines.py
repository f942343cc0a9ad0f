"""Lines of programs for LinuxCNC: code without blanks and comments, what is said, and where O-words lead."""

from __future__ import annotations

import re
from dataclasses import dataclass

from gearmath.machine.control.expression import refuse

#: Characters of a line, the end not counted.
LONGEST_LINE = 255
_COMMENT = re.compile(r"\(([^()]*)\)")
_FLOW = re.compile(r"O(\d+|<[^>]+>)(SUB|ENDSUB|CALL|IF|ELSEIF|ELSE|ENDIF|WHILE|ENDWHILE)(.*)")
#: What ends what begins with an O-word.
_ENDS = {"IF": ("ELSE", "ENDIF"), "ELSE": ("ENDIF",), "WHILE": ("ENDWHILE",), "SUB": ("ENDSUB",)}
_ACTIVE = re.compile(r"\s*(MSG|DEBUG|PRINT|ABORT|LOGOPEN|LOGAPPEND|LOG|LOGCLOSE)\s*(?:,(.*))?", re.IGNORECASE)


@dataclass(frozen=True)
class NgcLine:
    """One line: its number from 1, its code, what its comments do, and its O-word with what follows it."""

    number: int
    code: str
    said: tuple[tuple[str, str], ...]
    label: str = ""
    flow: str = ""


def lines_of(text: str, name: str) -> list[NgcLine]:
    """The lines of a program that are not empty. Raises InputError for what LinuxCNC would not read."""
    found: list[NgcLine] = []
    last = len(text.rstrip().splitlines())
    for number, raw in enumerate(text.splitlines(), 1):
        if len(raw) > LONGEST_LINE:
            refuse(name, number, LONGEST_LINE, f"the line has {len(raw)} characters, {LONGEST_LINE} are allowed")
        said = []
        code = raw.split(";", 1)[0] if "(" not in raw.split(";", 1)[0] else raw
        for comment in _COMMENT.findall(code):
            if (match := _ACTIVE.fullmatch(comment)) is not None:
                said.append((match[1].upper(), match[2] or ""))
        code = re.sub(r"\s+", "", _COMMENT.sub("", code).split(";", 1)[0]).upper()
        if "(" in code or ")" in code:
            refuse(name, number, 1, "a comment is not closed")
        if code == "%" and found and number < last:
            refuse(name, number, 1, "% ends the program: it stands in the first and the last line only")
        if code in ("", "%") and not said:
            continue
        flow = _FLOW.fullmatch(code)
        if code.startswith("O") and flow is None:
            refuse(name, number, 1, f"{code[:20]} is not understood")
        if flow is not None:
            found.append(NgcLine(number, flow[3], tuple(said), flow[1], flow[2]))
        else:
            found.append(NgcLine(number, code, tuple(said)))
    return found


def partners(lines: list[NgcLine], name: str) -> dict[int, int]:
    """For the place of every IF, ELSE, WHILE and SUB the place of what ends it; ENDWHILE leads back to WHILE."""
    open_: list[int] = []
    found: dict[int, int] = {}
    labels: set[str] = set()
    for place, line in enumerate(lines):
        if line.flow in ("", "CALL"):
            continue
        if line.flow == "ELSEIF":
            refuse(name, line.number, 1, "ELSEIF is not understood")
        if line.flow in ("IF", "WHILE", "SUB"):
            if line.label in labels:
                refuse(name, line.number, 1, f"O{line.label} begins for the second time: every label is there once")
            labels.add(line.label)
            open_.append(place)
            continue
        begun = lines[open_[-1]] if open_ else None
        if begun is None or begun.label != line.label or line.flow not in _ENDS[begun.flow]:
            refuse(name, line.number, 1, f"O{line.label} {line.flow} ends nothing")
        found[open_[-1]] = place
        if line.flow == "ENDWHILE":
            found[place] = open_[-1]
        open_.pop()
        if line.flow == "ELSE":
            open_.append(place)
    if open_:
        line = lines[open_[-1]]
        refuse(name, line.number, 1, f"O{line.label} {line.flow} is not ended")
    return found
