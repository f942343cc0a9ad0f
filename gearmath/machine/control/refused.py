"""Words that the control knows, the reader does not, and what to write instead."""

from __future__ import annotations

import re

from gearmath.machine.control.expression import shown

_JUMP = "jumps are not read: write IF, WHILE or FOR"
_ARC = "arcs are not read: write G1 blocks"
_RELATIVE = "the program is read with G90 only: write X=IC(...)"
_UNIT = "the program is read in mm only: write G710"
_TYPE = "only DEF INT and DEF REAL are read"
_LOOP = "write WHILE or FOR"
_CALL = "calls of other programs are not read: write their blocks here"
_FRAME = "only TRANS is read of the frames"
_SPLINE = "the path is read as G1 and POLY blocks: write these"
_MEASURE = "write MEAS=1 in a G1 block"
_TOOL = 'write the tool by its name, T="NAME", of 1 to 31 letters, digits and _'

_HINTS: dict[str, str] = {
    **dict.fromkeys(("GOTO", "GOTOF", "GOTOB", "GOTOC", "GOTOS", "CASE"), _JUMP),
    **dict.fromkeys(("REPEAT", "REPEATB", "UNTIL", "LOOP", "ENDLOOP"), _LOOP),
    **dict.fromkeys(("CALL", "EXTCALL", "PCALL", "MCALL"), _CALL),
    **dict.fromkeys(("G2", "G3", "CIP", "CT", "TURN", "CR"), _ARC),
    "G33": "threads are not read",
    "G91": _RELATIVE,
    **dict.fromkeys(("G70", "G71", "G700"), _UNIT),
    **dict.fromkeys(("G95", "G96", "G97"), "the feed is read with G93 or G94 only"),
    **dict.fromkeys(("G18", "G19"), "the plane is read as G17 only"),
    **dict.fromkeys(("G41", "G42"), "radius compensation is not read: write G40"),
    "G9": "write G60",
    **dict.fromkeys(("STRING", "BOOL", "CHAR", "AXIS", "FRAME"), _TYPE),
    **dict.fromkeys(("ATRANS", "ROT", "AROT", "SCALE", "ASCALE", "MIRROR", "AMIRROR"), _FRAME),
    **dict.fromkeys(("POLYPATH", "ASPLINE", "BSPLINE", "CSPLINE", "SPLINEPATH"), _SPLINE),
    **dict.fromkeys(("COMPON", "COMPCURV", "COMPSURF"), "the compressor is read as COMPCAD or COMPOF only"),
    **dict.fromkeys(("G643", "G644", "G645", "G602", "G601"), "the path mode is read as G60, G64, G641 or G642 only"),
    **dict.fromkeys(("MEAW", "MEASA", "MEAC", "MEAWA"), _MEASURE),
    **dict.fromkeys(("SPOSA", "M19", "M70"), "write SPOS=0"),
    "T": _TOOL,
    "M1": "an optional stop is not read: write M0",
    "M7": "write M8",
    **dict.fromkeys(("M98", "M99"), _CALL),
    **dict.fromkeys(("TRAORI", "TRACYL", "TRANSMIT"), "the axes are read as machine axes, without a transformation"),
    **dict.fromkeys(("EGDEF", "EGON", "EGONSYN", "EGONSYNE", "EGOFS", "EGOFC", "EGDEL"), "write G1 blocks"),
    "LIMS": "write S",
    "PROC": "it stands in the first line only",
    "O": "the name of a program is the name of its file",
    "(": "a comment begins with ;",
    "#": "a variable is written R1",
    "%": "% stands in the first line only, as %_N_NAME_MPF",
}
_WORD = re.compile(r"[A-Z]+")
_WITH_NUMBER = re.compile(r"([GM])0*([0-9]+)")
#: Words whose name ends before their number or parameter.
_ADDRESSES = {"O", "T", "CR", "TURN", "LIMS"}


def instead(text: str) -> str | None:
    """What to write instead of the word with which ``text`` begins, as a sentence; None where nothing is known."""
    if (address := re.match(r"([A-QS-Z])[0-9]+[ \t]*=(?!=)", text)) is not None:
        what = f"{address[1]} with a number before = means another axis or spindle"
        return f"{shown(text.split('=')[0].strip() + '=')} is not understood: {what}"
    if (code := _WITH_NUMBER.match(text)) is not None:
        return _sentence(f"{code[1]}{int(code[2][:9])}")
    if text.startswith(("SPOS(", "SPOS[")):
        return "SPOS is read as SPOS=90 only: write that"
    if (call := re.match(r"(?:L|CYCLE)[0-9]+", text)) is not None:
        return f"{shown(call[0])} is not understood: {_CALL}"
    word = _WORD.match(text)
    found = word[0] if word else text[:1]
    after = text[len(found) : len(found) + 1]
    if (after.isalnum() or after == "_") and found not in _ADDRESSES and word:
        return None
    return _sentence(found)


def _sentence(word: str) -> str | None:
    return f"{word} is not understood: {_HINTS[word]}" if word in _HINTS else None


def refused_words() -> dict[str, str]:
    """All words that are refused by name, with what to write instead."""
    return dict(_HINTS)
