"""NC programs as text: bytes decoded, lines divided into code and comment, and the lengths that the control allows.

The control tells no capitals from small letters outside texts: code is handed on in capitals, texts as they are.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from gearmath.errors import InputError
from gearmath.files import read_bytes
from gearmath.machine.control.expression import refuse, shown
from gearmath.specs.control import CONTROLS

#: Characters of a block with its comment and its line end [unconfirmed; 242 on old software].
LONGEST_BLOCK = 512
#: Characters of a text: STRING and the record of WRITE.
LONGEST_TEXT = 200
#: Characters of a program's name.
LONGEST_PROGRAM_NAME = 24
_PROGRAM_NAME = re.compile(r"(?:[A-Z]{2}|_[A-Z])[A-Z0-9_]*")
_FILE_NAME = re.compile(r"[A-Z0-9_]+")
_AROUND = re.compile(r"^_N_|(?:_|\.)(?:MPF|SPF)$")
_RESERVED = re.compile(r"CON|PRN|AUX|NUL|COM[1-9]|LPT[1-9]")
_HEADER = re.compile(r"%_N_([A-Z0-9_]+)_(?:MPF|SPF)[ \t]*")
_NO_TEXT = re.compile(r"\r(?!\n)|[^\t\n\r\x20-\x7e\x80-\U0010ffff]")
#: The line of the head by which a program says that it is for LinuxCNC.
LINUXCNC_MARK = "; control: LinuxCNC"
_FOR_LINUXCNC = re.compile(rf"^{LINUXCNC_MARK}[ \t]*$", re.MULTILINE)
_MOVES = re.compile(r"^[^;(\n]*(?<![A-Z_$])[XYZAB]\s*[-+=.\[#0-9]", re.MULTILINE | re.IGNORECASE)
_SKIP = re.compile(r"^[ \t]*/", re.MULTILINE)


def is_for_linuxcnc(text: str) -> bool:
    """Whether the head of a program says that it is for LinuxCNC."""
    return "LinuxCNC" in text and _FOR_LINUXCNC.search(text) is not None


def readable(text: str) -> str:
    """A program in words that are known here: itself, but for those of a registered dialect."""
    return next((one.as_read(text) for one in CONTROLS.values() if one.as_read and one.mark in text), text)


def program_text(path: Path) -> str:
    """The text of a program file: UTF-8, or Windows-1252 as shops have it in comments; lines end with LF.

    A program of a registered dialect is given in words that the reader knows, line for line.

    Raises InputError if it cannot be read, is UTF-16, or holds control characters; what else is wrong in it,
    ``read_program`` says.
    """
    text = decoded(read_bytes(path), str(path))
    _check_characters(text, str(path))
    return readable(text.replace("\r\n", "\n"))


def check_moves(text: str, name: str) -> None:
    """Raises InputError for a text without any word of an axis outside comments, which is no program that cuts."""
    if not _MOVES.search(text):
        raise InputError(f"{name}: moves no axis, so that it is no cutting program")


def decoded(content: bytes, name: str) -> str:
    """The text of the bytes of a program."""
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise InputError(f"{name}: is UTF-16: the control reads one byte a character, save the program as UTF-8")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        # not UTF-8: letters beyond ASCII stand in comments and texts only, so that a wrong one changes no motion
        return content.decode("cp1252", errors="replace")


def skip_blocks(text: str) -> int:
    """How many blocks begin with ``/``: the operator can have them skipped; the reader takes them as not skipped."""
    return len(_SKIP.findall(text))


def divided(text: str, name: str) -> Iterator[tuple[int, str, str | None]]:
    """Number from 1, code and comment of each line; the comment is None where there is none.

    Raises InputError for control characters, a CR without LF, and what is longer than the control allows.
    """
    text = text.removeprefix("\ufeff")
    _check_characters(text, name)
    for number, line in enumerate(text.split("\n"), start=1):
        if len(line) >= LONGEST_BLOCK:
            what = f"the block has {len(line) + 1} characters with comment and line end; the control reads at most"
            refuse(name, number, LONGEST_BLOCK, f"{what} {LONGEST_BLOCK}")
        line = line.removesuffix("\r")
        comment: str | None
        if '"' in line:
            code, comment = _with_texts(line, name, number)
        else:
            code, sign, rest = line.partition(";")
            comment = rest.strip() if sign else None
            if not code.isascii():
                _refuse_letter(code, 0, name, number)
            code = code.upper()
        if number == 1 and code.startswith("%"):
            _check_header(code, name)
            code = ""
        yield number, code, comment


def _with_texts(line: str, name: str, number: int) -> tuple[str, str | None]:
    """A line that holds texts: its code, in capitals outside them, and its comment."""
    code, at = [], 0
    for place, part in enumerate(line.split('"')):
        if place % 2 == 0:
            before, sign, _ = part.partition(";")
            if not before.isascii():
                _refuse_letter(before, at, name, number)
            code.append(before.upper())
            if sign:
                return '"'.join(code), line[at + len(before) + 1 :].strip()
        else:
            if len(part) > LONGEST_TEXT:
                what = f"the text has {len(part)} characters; the control holds at most {LONGEST_TEXT}"
                refuse(name, number, at, what)
            code.append(part)
        at += len(part) + 1
    if len(code) % 2 == 0:
        refuse(name, number, at - len(code[-1]) - 1, "the text that begins here has no closing quotation mark")
    return '"'.join(code), None


def _check_characters(text: str, name: str) -> None:
    if (found := _NO_TEXT.search(text)) is None:
        return
    at, character = found.start(), found[0]
    line, column = text.count("\n", 0, at) + 1, at - text.rfind("\n", 0, at)
    if character == "\r":
        refuse(name, line, column, "the line ends with CR alone: save the program with LF or CR LF at line ends")
    refuse(name, line, column, f"the control character {ord(character):#04x} is no part of a program")


def _refuse_letter(code: str, offset: int, name: str, line: int) -> None:
    at = next(at for at, character in enumerate(code) if not character.isascii())
    refuse(name, line, offset + at + 1, f"the character {code[at]!a} may stand in comments and texts only")


def _check_header(code: str, name: str) -> None:
    header = _HEADER.fullmatch(code)
    if header is None:
        refuse(name, 1, 1, "a line with % is read only as %_N_NAME_MPF or %_N_NAME_SPF, the first line of an archive")
    check_program_name(header[1], name, 1, 5)


def check_program_name(word: str, name: str, line: int, column: int) -> None:
    """Refuse what cannot be the name of a program on the control, given in capitals."""
    if len(word) > LONGEST_PROGRAM_NAME:
        what = f"the program name {word[:40]} has {len(word)} characters; the control allows {LONGEST_PROGRAM_NAME}"
        refuse(name, line, column, what)
    if _PROGRAM_NAME.fullmatch(word) is None or _RESERVED.fullmatch(word):
        what = f"{word!a} is no program name: two letters, or _ and a letter, then letters, digits and _"
        refuse(name, line, column, what)


def check_file_name(text: str, name: str, line: int, column: int) -> None:
    """Refuse what cannot be a file on the control, given with or without its folder and its _N_ and _MPF."""
    last = _AROUND.sub("", text.upper().rpartition("/")[2])
    if len(last) > LONGEST_PROGRAM_NAME or _FILE_NAME.fullmatch(last) is None:
        what = f"{shown(last)} is no name of a file: 1 to {LONGEST_PROGRAM_NAME} letters, digits and _"
        refuse(name, line, column, what)
