"""Where a store may lie, and which names of files may come from a control."""

from __future__ import annotations

import ctypes
import ntpath
import os
import string
import sys
from pathlib import Path, PurePosixPath, PureWindowsPath

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from gearmath.control import store_place
from gearmath.control.store import MeasurementStore
from gearmath.control.store_place import file_system, inside, network_share
from gearmath.errors import InputError

#: /proc/mounts of a shop computer: its disk, a share of the server, one with a blank in its name, one over sshfs.
MOUNTS = r"""/dev/sda2 / ext4 rw,relatime 0 0
tmpfs /run tmpfs rw,nosuid 0 0
//server/shop /mnt/shop cifs rw,vers=3.0 0 0
server:/export /mnt/cell\0401 nfs4 rw,relatime 0 0
systemd-1 /data autofs rw,relatime 0 0
/dev/sdb1 /data xfs rw,relatime 0 0
me@server: /srv/remote fuse.sshfs rw 0 0
/dev/sdc1 /mnt/shop/local ext4 rw 0 0
"""
PARTS = [
    "..",
    ".",
    "/",
    "\\",
    "C:",
    "\\\\server\\share",
    "~",
    "PROBE",
    ".MPF",
    ".db",
    "\0",
    "\n",
    "\x1b",
    " ",
    "CON",
    "$HOME",
    "%TEMP%",
    "\u2215",
    "\u202e",
    "é",
    "*",
    "?",
    '"',
    ":",
    "-",
    "_",
    "A" * 300,
    "a",
    "1",
]


@example("..").via("the parent")
@example("/etc/passwd").via("an absolute path")
@example("\\\\server\\share\\PROBE.MPF").via("UNC")
@example("PROBE.MPF.MPF").via("two extensions")
@example("A" * 300).via("300 characters")
@example("PROBE\n.MPF").via("a line end")
@example("PROBE.MPF\n").via("a line end that $ would pass")
@example("COM1.MPF").via("a device")
@example("runs.db:stream").via("a stream of NTFS")
@example("").via("none")
@given(st.one_of(st.text(), st.lists(st.sampled_from(PARTS), max_size=6).map("".join)))
def test_no_name_of_a_control_leads_out_of_the_folder(name: str) -> None:
    folder = Path("folder")
    try:
        path = inside(folder, name)
    except InputError as error:
        sentence = str(error)
    else:
        sentence = ""
    assert sentence.isprintable()
    assert len(sentence) < 250
    if sentence:
        return
    assert path.parent == folder
    assert path.name == name
    for flavor in (PurePosixPath, PureWindowsPath):
        read = flavor("folder", name)
        assert read.parent == flavor("folder")
        assert read.suffixes in ([], [read.suffix])
    # from Python 3.13 on the path class says it no more
    reserved = getattr(ntpath, "isreserved", None) or (lambda given: PureWindowsPath(given).is_reserved())
    assert not reserved(name)
    assert set(name) <= set(string.ascii_letters + string.digits + "_-.")


@pytest.mark.parametrize("name", ["PROBE.MPF", "PROBE_T", "_N_PROBE_MPF", "SHAFT-12.SPF", "set.toml", "9.csv"])
def test_names_as_controls_give_them_are_taken(name: str) -> None:
    assert inside(Path("folder"), name) == Path("folder") / name


@pytest.mark.parametrize(
    ("path", "kind"),
    [
        ("/srv/runs.db", "ext4"),
        ("/mnt/shop/runs.db", "cifs"),
        ("/mnt/shopping/runs.db", "ext4"),
        ("/mnt/shop/local/runs.db", "ext4"),
        ("/mnt/cell 1/runs.db", "nfs4"),
        ("/data/runs.db", "xfs"),
        ("/srv/remote/a/b/runs.db", "fuse.sshfs"),
    ],
)
def test_the_innermost_and_last_mount_says_what_holds_a_path(path: str, kind: str) -> None:
    assert file_system(Path(path), MOUNTS) == kind


def test_a_store_on_a_network_share_is_refused_and_not_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(store_place, "network_share", lambda path: "nfs4")
    with pytest.raises(InputError, match=r"runs\.db: lies on a network share \(nfs4\): a store must lie on a disk of"):
        MeasurementStore.open(tmp_path / "runs.db")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc/mounts")
def test_a_link_to_a_share_is_a_share(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "share").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "share")
    mounts = f"/dev/sda2 / ext4 rw 0 0\nserver:/x {tmp_path}/share nfs rw 0 0\n"
    monkeypatch.setattr(Path, "read_text", lambda self, *args, **kwargs: mounts)
    assert network_share(tmp_path / "link" / "runs.db") == "nfs"
    assert network_share(tmp_path / "runs.db") is None


@pytest.mark.parametrize(
    ("real", "answer", "kind"),
    [
        (r"\\server\shop\runs.db", 1, "UNC path"),
        (r"Z:\runs.db", 4, "network drive"),
        (r"C:\runs.db", 3, None),
    ],
)
def test_windows_is_asked_for_the_type_of_the_drive(
    monkeypatch: pytest.MonkeyPatch, real: str, answer: int, kind: str | None
) -> None:
    class Kernel32:
        @staticmethod
        def GetDriveTypeW(root: str) -> int:
            assert root.endswith(":\\")
            return answer

    class Windll:
        kernel32 = Kernel32

    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setattr(ctypes, "windll", Windll, raising=False)
    monkeypatch.setattr(os.path, "realpath", lambda path: real)
    monkeypatch.setattr(os.path, "splitdrive", ntpath.splitdrive)
    assert network_share(Path("runs.db")) == kind
