"""Where a store may lie and what may be written beside it: local disks only, and names that cannot leave a folder."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path

from gearmath.errors import InputError

#: What Linux calls file systems of other computers, or of the host of a virtual machine: the shared memory of WAL does
#: not reach across, so that two computers could each believe that they hold the store alone.
NETWORK = frozenset(
    {
        "9p",
        "afs",
        "autofs",
        "ceph",
        "cifs",
        "coda",
        "davfs",
        "fuse.glusterfs",
        "fuse.rclone",
        "fuse.sshfs",
        "fuse.vmhgfs-fuse",
        "gfs2",
        "glusterfs",
        "lustre",
        "ncpfs",
        "nfs",
        "nfs4",
        "ocfs2",
        "prl_fs",
        "smb2",
        "smb3",
        "smbfs",
        "vboxsf",
        "virtiofs",
    }
)
#: What GetDriveTypeW of Windows answers for a network drive.
_DRIVE_REMOTE = 4
#: Longest file name that every control and computer takes, with its extension.
LONGEST_NAME = 64
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]*(\.[A-Za-z0-9]{1,8})?", re.ASCII)
#: Names that Windows takes for devices, whatever their extension.
_DEVICE = re.compile(r"(con|prn|aux|nul|com[0-9]|lpt[0-9])(\..*)?", re.ASCII | re.IGNORECASE)


def inside(folder: Path, name: str) -> Path:
    """The path of a file in ``folder`` with a ``name`` that a control gave.

    The name may be one word of A-Z a-z 0-9 _ and -, with one extension at most. Raises InputError naming it for all
    else: folders, drives, devices, control characters, too many characters.
    """
    if len(name) > LONGEST_NAME:
        raise InputError(f"file name {_shown(name)}: has {len(name)} characters, {LONGEST_NAME} are allowed")
    if not _NAME.fullmatch(name):
        raise InputError(
            f"file name {_shown(name)}: must be letters, digits, _ and - with one extension at most, without a folder"
        )
    if _DEVICE.fullmatch(name):
        raise InputError(f"file name {name!r}: is a device on Windows")
    return folder / name


def _shown(name: str) -> str:
    """A name in a message: control characters and what is not ASCII escaped, the middle left out where it is long."""
    shown = ascii(name)
    return shown if len(shown) <= LONGEST_NAME else f"{shown[:30]}...{shown[-20:]}"


def check_local(path: Path) -> None:
    """Raise InputError where ``path`` lies on a network share, as far as Linux and Windows tell it."""
    share = network_share(path)
    if share is not None:
        raise InputError(
            f"{path}: lies on a network share ({share}): a store must lie on a disk of this computer, for it is not "
            "safe from a power cut elsewhere"
        )


def network_share(path: Path) -> str | None:
    """The kind of network share on which ``path`` lies; None for a local disk, or where the system does not tell."""
    if sys.platform == "win32":
        return _windows_share(path)
    mounts = Path("/proc/mounts")
    if not mounts.exists():
        return None
    kind = file_system(path.resolve(), mounts.read_text("utf-8", errors="surrogateescape"))
    return kind if kind in NETWORK else None


def file_system(path: Path, mounts: str) -> str | None:
    """The type of the file system that holds an absolute ``path``, by the text of /proc/mounts."""
    found, depth = None, -1
    for line in mounts.splitlines():
        device_point_type = line.split(" ")[:3]
        if len(device_point_type) < 3:
            continue
        point = Path(re.sub(r"\\([0-7]{3})", lambda code: chr(int(code[1], 8)), device_point_type[1]))
        # a later mount on the same folder covers the earlier one
        if path.is_relative_to(point) and len(point.parts) >= depth:
            found, depth = device_point_type[2], len(point.parts)
    return found


def _windows_share(path: Path) -> str | None:
    import ctypes

    anchor = os.path.splitdrive(os.path.realpath(path))[0]
    if anchor.startswith(("\\\\", "//")):
        return "UNC path"
    kind = ctypes.windll.kernel32.GetDriveTypeW(f"{anchor}\\")  # type: ignore[attr-defined]
    return "network drive" if kind == _DRIVE_REMOTE else None
