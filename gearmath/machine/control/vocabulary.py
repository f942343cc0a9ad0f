"""The words of the language: codes by group, instructions, types, and names that nothing else may have."""

from __future__ import annotations

from gearmath.machine.control.expression import AXES, CUTTER_AXIS, FUNCTIONS

#: The codes that are understood, by group. One code of a group at a time, in a block and in force.
GROUP_OF_CODE = {
    code: group
    for group, codes in {
        "motion": "G0 G1 POLY",
        "dwell": "G4",
        "plane": "G17",
        "radius compensation": "G40",
        "work offset": "G54 G55 G56 G57",
        "frame suppression": "G53 G153 SUPA",
        "dimensioning": "G90",
        "units": "G710",
        "feed mode": "G93 G94",
        "stop mode": "G60 G64 G641 G642",
        "acceleration": "BRISK SOFT",
        "feed forward": "FFWON FFWOF",
        "compressor": "COMPCAD COMPOF",
        "transformation": "TRAFOOF",
        "diameter programming": "DIAMOF",
        "buffer": "FIFOCTRL",
        "spindle": "M3 M4 M5",
        "tool change": "M6",
        "coolant": "M8 M9",
        "program stop": "M0",
        "program end": "M2 M17 M30 RET",
    }.items()
    for code in codes.split()
}
COMMANDS = {"STOPRE", "MSG", "SETAL", "WRITE", "DELETE", "TRANS", "FGROUP", "SPCON", "SPCOF"}
TYPES = ("INT", "REAL")
STRUCTURE = ("IF", "ELSE", "ENDIF", "WHILE", "ENDWHILE", "FOR", "ENDFOR")
LETTERS = frozenset(f"{AXES}{CUTTER_AXIS}FSD")
ADDRESSES = ("SPOS", "MEAS", "ADIS", "ADISPOS", "FGREF", "CTOL", "OTOL", "OVR", "OVRRAP", "ACC", "PO", "PL")
RESERVED = frozenset(
    (
        *GROUP_OF_CODE,
        *COMMANDS,
        *TYPES,
        *STRUCTURE,
        *ADDRESSES,
        *FUNCTIONS,
        "DEF",
        "TO",
        "PROC",
        "EXTERN",
        "DIV",
        "MOD",
        "AND",
        "OR",
        "XOR",
        "NOT",
        "DC",
        "IC",
        "AC",
        "ACP",
        "ACN",
    )
)
