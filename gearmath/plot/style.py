"""What all charts share: colors that differ in lightness too, for paper without color, and numbers with their sign."""

from __future__ import annotations

import math

#: Colors of "before" and "after", of metal left on and missing, of what is nominal, and of what was measured.
BEFORE, AFTER = "#c23b22", "#1f6f8b"
MORE, LESS = "#b3301a", "#2b7fa3"
NOMINAL, INK = "#9a9a9a", "#1a1a1a"


def signed(um: float) -> str:
    """A deviation [µm] with its sign: tenths below 100, none for zero."""
    text = f"{um:+.1f}" if abs(um) < 99.95 else f"{um:+.0f}"
    return "0.0" if float(text) == 0 else text.replace("-", "\N{MINUS SIGN}")


def round_length(most: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not greater than ``most``."""
    power = 10.0 ** math.floor(math.log10(most))
    return power * next(step for step in (5, 2, 1) if step * power <= most * (1 + 1e-9))


def or_withheld(value: float) -> str:
    """A maximum [mm] in µm, or that it is withheld: there is none over data with a gap."""
    return "withheld" if math.isnan(value) else f"{value * 1000:.1f} µm"
