"""How much of a board's memory the sketch takes: measured on its compiled files, by board; a test measures again."""

from __future__ import annotations

from collections.abc import Iterator

from gearmath.export.markdown import paragraph
from gearmath.specs.hobbing import HobbingMachine

#: kB of flash and RAM of the sketch's own files, GCC 12 -O2 ("Faster"), Cortex-M4 and M7.
OWN = {"teensy32": (25.0, 0.9), "teensy40": (25.5, 0.9), "teensy41": (26.5, 1.0)}
#: kB of flash with -Os ("Smallest Code"); RAM is the same.
SMALLEST = {"teensy32": 21.2, "teensy40": 21.2, "teensy41": 22.2}
#: kB of flash and RAM of published builds of a sketch of a few lines with USB Serial, in bytes: 8840 and 3436 on a
#: Teensy 3.2; code 9252 with data 3016, and variables 3520, on a 4.0.
_CORE = {"teensy32": (8.8, 3.4), "teensy40": (12.3, 3.5), "teensy41": (12.3, 3.5)}
#: The same of Wire, EEPROM, Encoder, IntervalTimer and the display's library, estimated from their source: Wire alone
#: holds two objects of 0.1 kB on a Teensy 3.2, four on a 4.x.
_LIBRARIES = {"teensy32": (6.0, 0.6), "teensy40": (6.0, 0.8), "teensy41": (6.0, 0.8)}
#: kB that the board has.
_HAS = {"teensy32": (256, 64), "teensy40": (1984, 1024), "teensy41": (7936, 1024)}


def memory(machine: HobbingMachine) -> Iterator[str]:
    """What the chapter about flashing says of flash and RAM."""
    flash, ram = OWN[machine.board]
    (core_flash, core_ram), (libraries_flash, libraries_ram) = _CORE[machine.board], _LIBRARIES[machine.board]
    most, fast = _HAS[machine.board]
    words = (
        f"The files of this folder take about {flash:g} kB of flash and {ram:g} kB of RAM (arm-none-eabi-gcc 12, -O2, "
        f'"Faster" in the IDE; {SMALLEST[machine.board]:g} kB of flash with -Os, "Smallest Code"), '
        f"of the {most} kB and {fast} kB of a {machine.hardware.title}. The core of Teensyduino comes on top, "
        f"{core_flash:g} kB and {core_ram:g} kB in a published build of a small sketch, and the libraries, about "
        f"{libraries_flash:g} kB and {libraries_ram:g} kB by estimate: {flash + core_flash + libraries_flash:.0f} kB "
        f"of flash and {ram + core_ram + libraries_ram:.1f} kB of RAM are to be expected. The sum was not measured "
        "here; the IDE prints it when it compiles."
    )
    if machine.board != "teensy32":
        words += " Code runs in RAM on this board, in blocks of 32 kB: that takes 64 kB of it besides."
    yield from paragraph(words)
