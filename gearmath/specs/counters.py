"""The hardware counters of the boards: which pins reach them, and how long their filters may be.

Teensy 3.2: the quadrature decoders of FTM1 and FTM2, each with its own pins. Teensy 4: the crossbar connects any of
some pins with the decoders ENC1 (hob) and ENC3 (feed). Both read channels A and B, or pulse and direction.
"""

from __future__ import annotations

from dataclasses import dataclass

Pair = tuple[int, int]


@dataclass(frozen=True)
class Counter:
    """One counter: its number, and for each of its two pins the multiplexer, crossbar input and daisy of the pad."""

    unit: int
    mux: Pair
    crossbar: Pair = (0, 0)
    daisy: Pair = (0, 0)


#: Pins of phase A and phase B -> FTM, from the pin tables of the MK20DX256 and the Teensy 3.2.
_FTM = {(16, 17): Counter(1, (6, 6)), (3, 4): Counter(1, (7, 7)), (32, 25): Counter(2, (6, 6))}
#: Pin -> multiplexer, input of XBAR1, daisy, from the pin tables of the IMXRT1062 and the Teensy 4.0 and 4.1.
_CROSSBAR = {
    0: (1, 17, 1),
    2: (3, 6, 0),
    3: (3, 7, 0),
    4: (3, 8, 0),
    5: (3, 17, 0),
    7: (1, 15, 1),
    8: (1, 14, 1),
    30: (1, 23, 0),
    31: (1, 22, 0),
    33: (3, 9, 0),
}
#: Pins of the hob encoder at a counter where the machine file names none.
DEFAULT_PINS = {"teensy32": (16, 17), "teensy40": (5, 7), "teensy41": (5, 7)}

#: ns of a period: a filter of the FTM is n x 4 bus clocks, of ENC 5 samples n clocks apart. The FTM's clock is that at
#: a CPU speed of 72 MHz; at 96 MHz the filter is shorter.
_FTM_STEP, _ENC_STEP = 4 / 0.036, 5 / 0.150
_FTM_MOST, _ENC_MOST = 15, 255
#: Of a pulse of the LS7184, which is at least 1 us, a filter may take so much [ns].
LS7184_FILTER = 250.0


def counter(board: str, pins: Pair, feed: bool) -> Counter | None:
    """The counter that these pins reach, or None; ``feed`` for the second encoder."""
    if board == "teensy32":
        return _FTM.get(pins)
    first, second = (_CROSSBAR.get(pin) for pin in pins)
    if first is None or second is None or first[1] == second[1]:
        return None
    mux, crossbar, daisy = zip(first, second, strict=True)
    return Counter(3 if feed else 1, mux, crossbar, daisy)


def pins_in_words(board: str) -> str:
    """Which pins reach a counter, for a sentence."""
    if board == "teensy32":
        return ", ".join(f"{first} and {second}" for first, second in _FTM)
    return "any two of " + ", ".join(str(pin) for pin in _CROSSBAR) + " but 0 with 5"


def filter_setting(board: str, longest: float) -> tuple[int, float]:
    """Register value and time [ns] of the longest filter within ``longest`` ns; pulses shorter than it are ignored."""
    step, most = (_FTM_STEP, _FTM_MOST) if board == "teensy32" else (_ENC_STEP, _ENC_MOST)
    setting = min(most, int(longest / step))
    return setting, setting * step
