"""Every number on the page of a hob is the exact one, to its last digit."""

from __future__ import annotations

import ctypes
from decimal import ROUND_HALF_UP, Decimal, localcontext
from fractions import Fraction

import pytest

from gearmath.engine.compiler import find_compiler
from gearmath.errors import ComputationError
from gearmath.specs.hobbing import load_hobbing_machine
from gearmath.specs.toml import bundled

SINGLE = "-fsingle-precision-constant"
DEPTHS = {
    "2.25/P": lambda m: Fraction("2.25") * m,
    "2.157/P": lambda m: Fraction("2.157") * m,
    "2.2/P+0.002in": lambda m: Fraction("2.2") * m + Fraction("0.002"),
    "2.25m": lambda m: Fraction("2.25") * m,
}


def digits(value: Fraction, decimals: int) -> str:
    with localcontext() as context:
        context.prec = 60
        exact = Decimal(value.numerator) / Decimal(value.denominator)
        return str(exact.quantize(Decimal(1).scaleb(-decimals), ROUND_HALF_UP))


@pytest.fixture(params=["as it is", SINGLE])
def library_of(request, firmware):
    def make(machine: str, **macros: int):
        if request.param != SINGLE:
            return firmware(machine, **macros)
        try:
            return firmware(machine, SINGLE, **macros)
        except ComputationError:
            pytest.skip(f"{find_compiler()[-1]} knows no {SINGLE}")

    return make


@pytest.mark.parametrize("machine", ["hobbing_plewes", "hobbing_metric", "hobbing_helical"])
def test_blank_and_depth_of_all_hobs_and_6_to_999_teeth(library_of, machine, panel):
    library = library_of(machine)
    display = panel(machine)
    display.library = library
    display.power_up(None)
    for number, hob in enumerate(load_hobbing_machine(bundled(f"{machine}.toml")).hobs):
        inch = hob.diametral_pitch is not None
        # the module in the unit of the display, from the text that the machine file holds
        m = 1 / Fraction(str(hob.diametral_pitch)) if inch else Fraction(str(hob.module))
        unit, decimals = ("in", 4) if inch else ("mm", 3)
        depth = f"Depth{digits(DEPTHS[hob.depth_rule](m), decimals):>12} {unit}"
        for teeth in range(6, 1000):
            library.board_hob_page(number, teeth)
            rows = display.screen.split("\n")
            assert rows[1] == f"Blank{digits((teeth + 2) * m, decimals):>12} {unit}"
            assert rows[2] == depth
            assert rows[3].rstrip() == hob.depth_rule
        name = f"{hob.diametral_pitch if inch else hob.module:g}"
        assert rows[0] == f"Hob{name:>8} {'DP' if inch else 'm ':2} no {number + 1:2}"


def test_speeds_and_places_of_the_run(library_of, panel):
    library = library_of("hobbing_plewes")
    display = panel("hobbing_plewes")
    display.library = library
    display.power_up(None)

    def page(view: int, teeth: int, rate: int, edges: int, position: int, pending: int) -> list[str]:
        library.board_run_page(
            view, teeth, ctypes.c_uint32(rate), ctypes.c_int64(edges), ctypes.c_int64(position), pending
        )
        return display.screen.split("\n")

    for teeth in range(6, 1000, 7):
        rate, edges, position = 54613 * teeth // 999, 7 * teeth**3 - 10**9, 10**10 - teeth**4
        speed, place = page(0, teeth, rate, edges, position, -teeth), page(1, teeth, rate, edges, position, 0)
        assert speed[1] == f"Hob{digits(Fraction(rate * 60, 4096), 1):>13} rpm"
        assert speed[2] == f"Table{digits(Fraction(rate * 60, 4096 * teeth), 2):>11} rpm"
        assert speed[3] == f"In phase: lag{-teeth:7}"
        turns = ("-" if edges < 0 else "") + digits(abs(Fraction(edges, 4096)), 2)
        assert place[1] == f"Hob turns{turns:>11}"
        angle = Fraction(position % 16000, 16000)
        assert place[2] == f"Table{digits(360 * angle, 2):>11} deg"
        assert place[3] == f"Tooth{int(angle * teeth) + 1:15}"
