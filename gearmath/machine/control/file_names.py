"""Names of files on a control, and what of them may become a name here: nothing that leads out of a folder."""

from __future__ import annotations

import re

from gearmath.errors import InputError

#: 24 characters, two letters or _ and a letter first; then one extension.
_ON_CONTROL = re.compile(r"(?:[A-Z]{2}|_[A-Z])[A-Z0-9_]{0,22}\.(?:MPF|SPF)", re.ASCII)
#: LinuxCNC: a file of its folder of programs, or a result file.
_ON_LINUXCNC = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,80}\.(?:ngc|csv)", re.ASCII)
#: Names that Windows keeps for devices; the control refuses them too.
_DEVICES = re.compile(r"(?:CON|PRN|AUX|NUL|COM[0-9]|LPT[0-9])\.", re.ASCII)


def control_name(name: str) -> str:
    """``name`` in capitals, as a control keeps it. Raises InputError for what it would not, or what names a path."""
    upper = name.upper() if name.isascii() else name
    if _ON_CONTROL.fullmatch(upper) is None or _DEVICES.match(upper) is not None:
        raise InputError(
            f"file name {shown(name)}: must be like PROBE.MPF: 1 to 24 of A-Z, 0-9 and _, two letters first, or _ "
            "and a letter, then .MPF or .SPF, and no folder"
        )
    return upper


def linuxcnc_name(name: str) -> str:
    """``name`` as LinuxCNC keeps it. Raises InputError for what is no program or result file, or names a path."""
    if _ON_LINUXCNC.fullmatch(name) is None:
        raise InputError(
            f"file name {shown(name)}: must be like PROBE.ngc or PROBE_T.csv: letters, digits, _, . and -, and no "
            "folder"
        )
    return name


def shown(name: str) -> str:
    """A name from elsewhere, short and without control characters, for a sentence."""
    text = ascii(name)
    return text if len(text) <= 60 else f"{text[:57]}...{text[0]}"
