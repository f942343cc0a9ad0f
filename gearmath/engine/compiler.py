"""The C compiler of this computer, and libraries made by it."""

from __future__ import annotations

import ctypes
import importlib.util
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import weakref
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

from gearmath.errors import ComputationError

#: Contraction would make a*b + c differ from the two operations that CasADi evaluates.
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared")
SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


@cache
def find_compiler() -> tuple[str, ...]:
    """The command that compiles C: cc, gcc, or the compiler of the ziglang wheel (said once on standard error).

    Raises ComputationError that says what to install.
    """
    for name in ("cc", "gcc"):
        if path := shutil.which(name):
            return (path,)
    if importlib.util.find_spec("ziglang"):
        print("gearmath: no C compiler (cc, gcc) is installed, the one of the ziglang wheel is taken", file=sys.stderr)
        return (sys.executable, "-m", "ziglang", "cc")
    raise ComputationError(
        "no C compiler was found: install gcc (Debian: apt install gcc) or the zig wheel (pip install gearmath[zig])"
    )


def build(files: Mapping[str, str], folder: Path, flags: Sequence[str] = FLAGS) -> Path:
    """Compile the texts of ``files`` (name to text) into one shared library in a folder.

    Raises ComputationError with the compiler's first error.
    """
    for name, text in files.items():
        (folder / name).write_text(text, "utf-8", newline="\n")
    library = folder / f"libkernels{SUFFIX}"
    sources = [name for name in files if name.endswith(".c")]
    command = [*find_compiler(), *flags, *sources, "-o", library.name, "-lm"]
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace")
    except OSError as error:
        raise ComputationError(f"the C compiler {command[0]} cannot be run: {error.strerror}") from error
    if done.returncode:
        lines = [line for line in done.stderr.splitlines() if "error" in line] or ["no message"]
        raise ComputationError(f"the C compiler {command[0]} failed: {lines[0]}")
    if not library.is_file():
        raise ComputationError(f"the C compiler {command[0]} wrote no library, and said nothing")
    return library


def load(library: Path) -> ctypes.CDLL:
    """A library; its folder, which is ours, goes: at once, or with the library object where open files cannot go.

    A process that is killed would leave it behind otherwise.
    """
    loaded = ctypes.CDLL(str(library))
    if os.name == "posix":
        shutil.rmtree(library.parent, ignore_errors=True)
    else:
        weakref.finalize(loaded, shutil.rmtree, library.parent, ignore_errors=True)
    return loaded


def compile_library(files: Mapping[str, str], flags: Sequence[str] = FLAGS) -> ctypes.CDLL:
    """Compile texts of C into one shared library, in a folder of its own, and load it."""
    folder = Path(tempfile.mkdtemp(prefix="gearmath-"))
    try:
        return load(build(files, folder, flags))
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


@cache
def identity() -> str:
    """What the machine code depends on besides its source: the compiler, and the processor that ``native`` means."""
    command = find_compiler()
    program = Path(command[0]).resolve().stat()  # another version is another file; asking it would take 20 ms
    return repr((command, program.st_size, program.st_mtime_ns, platform.machine(), _processor()))


def _processor() -> str:
    """The features of the processor, where the system tells them: a home folder may be shared by several computers."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return ""
    return next((line for line in lines if line.startswith(("flags", "Features"))), "")
