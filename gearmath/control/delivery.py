"""A program on its way to a control: written, and read back."""

from __future__ import annotations

from gearmath.control.interface import Control
from gearmath.control.sinumerik import READ_FILES, READ_STATE, WRITE_FILES
from gearmath.errors import ComputationError

RIGHTS = (READ_STATE, READ_FILES, WRITE_FILES)


async def deliver(control: Control, name: str, content: bytes, replace: bool = False) -> None:
    """Write a program, and read it back. Raises ComputationError where it is refused, or comes back otherwise."""
    await control.put(name, content, replace)
    if await control.get(name) != content:
        raise ComputationError(f"{control.name}: {name} on the control is not what was sent: write it again")
