"""How much of a board's memory the sketch takes: measured on its compiled files, by board; a test measures again."""

from __future__ import annotations

from collections.abc import Iterator

from gearmath.export.markdown import paragraph
from gearmath.specs.hobbing import HobbingMachine

#: kB of flash and RAM of the sketch's own files, GCC 12 -O2 ("Faster"), Cortex-M4 and M7.
OWN = {"teensy32": (25.0, 0.9), "teensy40": (25.5, 0.9), "teensy41": (26.5, 1.0)}
#: kB of flash with -Os ("Smallest Code"); RAM is the same.
SMALLEST = {"teensy32": 21.2, "teensy40": 21.2, "teensy41": 22.2}
#: kB of code with data, and of variables in RAM1, that a published build of a sketch of a few lines has (Teensy 4.0,
#: USB Serial: code 9252, data 3016, variables 3520); for a Teensy 3.2 none was found.
_CORE = {"teensy40": (12.3, 3.5), "teensy41": (12.3, 3.5)}
#: kB that the board has.
_HAS = {"teensy32": (256, 64), "teensy40": (1984, 1024), "teensy41": (7936, 1024)}


def memory(machine: HobbingMachine) -> Iterator[str]:
    """What the chapter about flashing says of flash and RAM."""
    flash, ram = OWN[machine.board]
    most, fast = _HAS[machine.board]
    words = (
        f"The files of this folder take about {flash:g} kB of flash and {ram:g} kB of RAM (arm-none-eabi-gcc 12, -O2, "
        f'"Faster" in the IDE; {SMALLEST[machine.board]:g} kB of flash with -Os, "Smallest Code"), '
        f"of the {most} kB and {fast} kB of a {machine.hardware.title}. The core of Teensyduino and its libraries come "
        "on top; "
    )
    if machine.board in _CORE:
        code, variables = _CORE[machine.board]
        words += (
            f"a published build of a small sketch for a Teensy 4.0 has {code:g} kB of flash and {variables:g} kB of "
            f"RAM for the core, so that {flash + code:.0f} kB and {ram + variables:.1f} kB are to be expected, and "
            "some kB for the libraries. They "
        )
    else:
        words += "they "
    yield from paragraph(f"{words}were not measured here, and the IDE prints the sum when it compiles.")
