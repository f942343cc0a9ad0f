"""Names and numbers of a SINUMERIK 840D sl behind its OPC UA server, each with what confirms it.

``manual``: a page of the maker's manual was read; ``digest``: a third party's digest of a named manual; ``published``:
public code or a public report of a machine; ``unconfirmed``: to be checked on the control before it is relied on.
"""

from __future__ import annotations

from dataclasses import dataclass

from gearmath.control.interface import ChannelState

MANUAL, DIGEST, PUBLISHED, UNCONFIRMED = "manual", "digest", "published", "unconfirmed"


@dataclass(frozen=True)
class Confirmed:
    """One name of the control, and what confirms it."""

    text: str
    by: str
    where: str = ""

    def __call__(self, **values: object) -> str:
        """The name with its numbers filled in."""
        return self.text.format(**values)


NAMESPACE = Confirmed("SinumerikVarProvider", PUBLISHED, "its index is looked up; 2 in all that was seen")
ROOT = Confirmed("Sinumerik", DIGEST, "OPC UA manual 05/2022")
#: Areas below the root, browsed for by name.
METHODS = Confirmed("Methods", DIGEST, "OPC UA manual 05/2022")
FILES = Confirmed("FileSystem", DIGEST, "OPC UA manual 05/2022")
FILE_METHODS = Confirmed("Filehandling", DIGEST, "OPC UA manual 05/2022; older servers have the methods in Methods")

PARAMETER = Confirmed("/Channel/Parameter/R[u{channel},{first}]", MANUAL, "UA 10/2015")
PARAMETERS = Confirmed("/Channel/Parameter/R[u{channel},{first},#{count}]", MANUAL, "UA 10/2015")
POSITION = Confirmed("/Nck/MachineAxis/aaIm[u1,{axis}]", PUBLISHED)
CHANNEL_STATE = Confirmed("/Channel/State/chanStatus[u{channel}]", PUBLISHED)
PROGRAM_STATE = Confirmed("/Channel/State/progStatus[u{channel}]", PUBLISHED)
MODE = Confirmed("/Bag/State/opMode[u1]", PUBLISHED)
SELECTED = Confirmed("/Channel/ProgramInfo/selectedWorkPProg[u{channel},1]", PUBLISHED)
RUNNING = Confirmed("/Channel/ProgramInfo/progName[u{channel}]", PUBLISHED)
LINE = Confirmed("/Channel/ProgramInfo/actLineNumber[u{channel}]", PUBLISHED)
MESSAGE = Confirmed("/Channel/ProgramInfo/msg[u{channel}]", DIGEST, "OPC UA manual 05/2022: no alarm event for MSG")
ALARM_COUNT = Confirmed("/Nck/State/numAlarms", PUBLISHED)
LAST_ALARM = Confirmed("/Nck/LastAlarm/alarmNo", PUBLISHED)
TOP_ALARM = Confirmed("/Nck/TopPrioAlarm/alarmNo", PUBLISHED)
#: The form of the name is published, the number of the bit is not: DB10.DBX107.0, probe 1 actuated. Needs PlcRead.
PROBE = Confirmed("/Plc/DB10.DBX107.0", UNCONFIRMED)
ACCESS_LEVEL = Confirmed("/Nck/Configuration/accessLevel", PUBLISHED)

MY_RIGHTS = Confirmed("GetMyAccessRights", DIGEST, "OPC UA manual 05/2022; the form of its answer is unconfirmed")
COPY_TO = Confirmed("CopyFileToServer", PUBLISHED, "text path, bytes, overwrite")
COPY_FROM = Confirmed("CopyFileFromServer", PUBLISHED, "text path; returns bytes")
#: Path of a file for the two methods above, and the folder of a program by its extension.
FILE_PATH = Confirmed("Sinumerik/FileSystem/{folder}/{name}", PUBLISHED)
FOLDERS = {"MPF": Confirmed("Part Program", PUBLISHED), "SPF": Confirmed("Sub Program", PUBLISHED)}
#: A program as the variables of ProgramInfo name it.
PROGRAM_PATH = Confirmed("/_N_MPF0/_N_{stem}_{kind}", UNCONFIRMED)
#: Where a file lies that a program writes by WRITE with a bare name.
WRITTEN_FILE = Confirmed("{stem}.MPF", UNCONFIRMED)

ALARM_NAMESPACE = Confirmed("http://opcfoundation.org/UA/CNC", PUBLISHED, "OPC 40502")
ALARM_TYPE = Confirmed("CncAlarmType", PUBLISHED, "OPC 40502 6.10")

#: Rights by what they are needed for. Which right R parameters belong to is unconfirmed.
READ_STATE, WRITE_STATE, READ_ALARMS = "StateRead", "StateWrite", "AlarmRead"
READ_FILES, WRITE_FILES = "FsRead", "FsWrite"
READ_ALL, WRITE_ALL = "SinuReadAll", "SinuWriteAll"

#: Numbers of chanStatus and opMode: unconfirmed, no manual text was found.
CHANNEL_STATES = {0: ChannelState.RESET, 1: ChannelState.ACTIVE, 2: ChannelState.INTERRUPTED}
MODES = {0: "jog", 1: "MDA", 2: "automatic"}
#: Numbers of progStatus: unconfirmed, but for 3, which a server's log fits.
PROGRAM_INTERRUPTED, PROGRAM_STOPPED, PROGRAM_RUNNING, PROGRAM_WAITING, PROGRAM_ABORTED = 1, 2, 3, 4, 5
#: Alarm of the emergency stop (published, seen on a bench): it stays until RESET after the button is released.
EMERGENCY_STOP = "3000"

#: Limits of the 840D sl (manual, UA 04/2018 p69).
SESSIONS, SUBSCRIPTIONS, SAMPLES_PER_SECOND = 10, 10, 1000
SESSION_SECONDS = 60.0
INTERVALS_MS = (100, 250, 500, 1000, 2500, 5000)
#: Largest file of the copy methods (digest: 16 MB by default).
COPY_LIMIT = 16_000_000


def program_name(selected: str) -> str:
    """``NAME.MPF`` of a program as ProgramInfo names it: ``/_N_MPF0/_N_NAME_MPF``, ``NAME.MPF``; empty for none."""
    name = selected.strip().rstrip("\0").rsplit("/", 1)[-1].upper()
    name = name.removeprefix("_N_")
    for kind in FOLDERS:
        if name.endswith(f"_{kind}"):
            return f"{name.removesuffix(f'_{kind}')}.{kind}"
    return name if "." in name or not name else f"{name}.MPF"
