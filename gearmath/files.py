"""Writing files so that nothing is ever half-written: to a temporary name beside the target, then renamed."""

from __future__ import annotations

import csv
import io
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from gearmath.errors import InputError

#: Bytes of the largest file that is read as text, a program of many blocks.
LARGEST = 200_000_000


def check_place(path: Path) -> None:
    """Whether a file can be written to its folder. Raises InputError naming the file where it cannot."""
    try:
        tempfile.TemporaryFile(dir=path.parent).close()  # not os.access, which grants root what no file system does
    except OSError as error:
        raise _unwritten(path, error) from error


def check_writable(path: Path) -> None:
    """Whether a file that is there can be written where it is. Raises InputError naming the file where it cannot."""
    try:
        os.close(os.open(path, os.O_WRONLY))  # not os.access, which knows no file system that is mounted to be read
    except OSError as error:
        raise _unwritten(path, error) from error


def _unwritten(path: Path, error: OSError) -> InputError:
    """Why a file cannot be written, in words that say what to do; else as the system has it."""
    why = error.strerror
    if not os.path.isdir(path.parent):  # where Path raises: a name too long, a folder that nobody may enter
        why = f"there is no folder {path.parent}"
    elif os.path.isdir(path):
        why = "is a folder, name a file"
    return InputError(f"{path}: cannot be written: {why}")


def write_text(path: Path, text: str) -> None:
    """Write ``text`` (UTF-8, LF) to ``path`` in one step. Raises InputError if the place cannot be written.

    Bytes that are no UTF-8, as the name of another file may hold that the text speaks of, become question marks.
    """
    write_bytes(path, text.encode("utf-8", "replace"))


def csv_text(head: Sequence[str], rows: Iterable[Iterable[object]]) -> str:
    """Lines of a CSV file, with the names of the columns in the first; what is None stays empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(head)
    writer.writerows(rows)
    return text.getvalue()


def named(values: Mapping[str, Any] | Sequence[Any], way: str = "") -> Iterator[tuple[str, Any]]:
    """Every value within mappings and lists, by the way to it: ``flanks.concave.rms_um``, ``remarks.0``."""
    for key, value in values.items() if isinstance(values, Mapping) else enumerate(values):
        if isinstance(value, Mapping | list | tuple):
            yield from named(value, f"{way}{key}.")
        else:
            yield f"{way}{key}", value


def write_bytes(path: Path, content: bytes) -> None:
    """Write ``content`` to ``path`` in one step. Raises InputError if the place cannot be written."""
    try:
        if path.exists() and not (path.is_file() or path.is_dir()):  # a file would take its place
            raise InputError(f"{path}: cannot be written: is a device, name a file")
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:
        raise _unwritten(path, error) from error
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
        os.chmod(name, 0o644)
        os.replace(name, path)
    except OSError as error:
        os.unlink(name)
        raise _unwritten(path, error) from error


def read_text(path: Path, most: int = LARGEST) -> str:
    """The text of a file: UTF-8, with or without a byte order mark, line ends of any kind as LF.

    Raises InputError naming the file if it is missing, is no text, or has more than ``most`` bytes.
    """
    content = read_bytes(path, most)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is no text file: byte {error.start} is not UTF-8") from error
    if "\0" in text:
        raise InputError(f"{path}: is no text file: it holds a zero byte")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def read_bytes(path: Path, most: int = LARGEST) -> bytes:
    """The bytes of a file. Raises InputError naming it if it cannot be read or has more than ``most`` bytes."""
    try:
        with path.open("rb") as stream:
            content = stream.read(most + 1)
    except OSError as error:
        why = "is a folder, name a file" if os.path.isdir(path) else error.strerror  # Path raises for a name too long
        raise InputError(f"{path}: cannot be read: {why}") from error
    if len(content) > most:
        raise InputError(f"{path}: is larger than {most / 1e6:g} MB, which is the limit")
    return content
