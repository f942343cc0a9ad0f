"""Numbers into fields of the display: exact, rounded half away from zero, and never beyond their field."""

from __future__ import annotations

import ctypes
from fractions import Fraction

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

INT64 = st.integers(-(2**63), 2**63 - 1)


def expected(value: Fraction, width: int, decimals: int) -> str:
    """Python's own long numbers; # where it does not fit."""
    units = (2 * abs(value) * 10**decimals + 1) // 2  # half away from zero
    digits = str(units).rjust(decimals + 1, "0")
    text = digits[: len(digits) - decimals] + ("." + digits[len(digits) - decimals :] if decimals else "")
    text = ("-" if value < 0 and units else "") + text
    return text.rjust(width) if len(text) <= width else "#" * width


@pytest.fixture(scope="session")
def write(firmware):
    library = firmware("hobbing_plewes")

    def call(width: int, numerator: int, denominator: int, decimals: int) -> tuple[int, str]:
        field = ctypes.create_string_buffer(b"~" * 30, 30)
        status = library.gm_format_ratio(field, width, ctypes.c_int64(numerator), ctypes.c_int64(denominator), decimals)
        assert field.raw[max(width, 0) :] == b"~" * (30 - max(width, 0))
        return status, field.raw[: max(width, 0)].decode("ascii")

    return call


@given(INT64, INT64.filter(bool), st.integers(0, 9), st.integers(0, 20))
@example(-(2**63), -1, 0, 20)
@example(2**63 - 1, 2**63 - 1, 9, 20)
@example(-(2**63), 2**63 - 1, 9, 20)
@example(1, -(2**63), 9, 20)
@example(9995, 1000, 2, 5)
@example(-1, 2000, 3, 6)
@example(-1, 2001, 3, 6)
def test_every_fraction_of_64_bits_is_rounded_exactly_or_refused(write, numerator, denominator, decimals, width):
    text = expected(Fraction(numerator, denominator), width, decimals)
    assert write(width, numerator, denominator, decimals) == (-1 if "#" in text or width == 0 else 0, text)


@given(st.integers(-(10**9), 10**9), st.integers(1, 10**6), st.integers(0, 4))
def test_numbers_of_the_size_on_the_display_are_exact(write, numerator, denominator, decimals):
    assert write(14, numerator, denominator, decimals)[1] == expected(Fraction(numerator, denominator), 14, decimals)


@pytest.mark.parametrize(("width", "denominator", "decimals"), [(6, 0, 2), (6, 1, -1), (6, 1, 10)])
def test_what_has_no_value_is_marked(write, width, denominator, decimals):
    assert write(width, 1, denominator, decimals) == (-1, "#" * width)


def test_words_fill_their_field_or_are_refused(firmware):
    library, field = firmware("hobbing_plewes"), ctypes.create_string_buffer(b"~" * 8, 8)
    assert library.gm_format_text(field, 6, b"lag") == 0
    assert field.raw == b"lag   ~~"
    assert library.gm_format_text(field, 6, b"too long") == -1
    assert field.raw == b"######~~"
