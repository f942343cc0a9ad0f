"""What is said of a pair that the check takes: a figure of it that is a little wrong puts it on edges of its teeth."""

from __future__ import annotations

import tomllib

import pytest

from gearmath.bevel.ease_off import Parts, is_least_inside
from gearmath.bevel.mates import ease_off_of, edge_note
from gearmath.bevel.pair import check_pair
from gearmath.specs.bevel_set import BevelSet
from gearmath.specs.toml import bundled, checked

SPIRAL = "spiral_7x43.toml"


def designed(member: str = "", flank: str = "", ratio: float = 0.0) -> BevelSet:
    values = tomllib.loads(bundled(SPIRAL).read_text("utf-8"))
    for each in (flank,) if flank else ("concave", "convex") if member else ():
        values[member][each]["ratio_of_roll"] = ratio
    pair = checked(values, BevelSet, "set")
    check_pair(pair)
    return pair


@pytest.mark.parametrize(
    ("member", "flank", "ratio", "said"),
    [
        ("pinion", "concave", 6.253208, ["concave"]),  # one digit of 6.233208
        ("pinion", "convex", 5.76437, ["convex"]),  # two digits of 5.74637 exchanged
        ("gear", "", 1.00259, ["concave", "convex"]),  # two digits of 1.00529 exchanged
    ],
)
def test_digit_of_a_ratio_that_no_limit_refuses_is_told_by_the_edge_that_carries(member, flank, ratio, said) -> None:
    """Three parts in a thousand of the roll: 24.9 arcsec where 2 were designed, and within what mates may differ by."""
    note = edge_note(ease_off_of(designed(member, flank, ratio)))
    assert [f"pinion {each}: " in note for each in ("concave", "convex")] == [
        each in said for each in ("concave", "convex")
    ]


def test_nothing_is_said_of_a_designed_pair_and_of_a_member_without_its_mate() -> None:
    pair = designed()
    assert edge_note(ease_off_of(pair)) == ""
    assert edge_note(ease_off_of(pair.model_copy(update={"gear": None}))) == ""


def test_published_pair_that_runs_on_its_edges_is_told_so() -> None:
    """NASA CR-191009, of which contact gives 105 arcsec and edges on both sides."""
    text = bundled("nasa_tp3096_12x36.toml").read_text("utf-8")
    note = edge_note(ease_off_of(checked(tomllib.loads(text), BevelSet, "set")))
    assert "pinion concave: " in note
    assert "pinion convex: " in note


@pytest.mark.parametrize(
    ("slope", "profile_slope", "crowning", "twist", "profile_crowning", "inside"),
    [
        (0.0, 0.0, 3.0, 0.0, 1.0, True),
        (5.0, 0.0, 3.0, 0.0, 1.0, True),  # the least of 5 x + 3 x² at x = -5/6
        (7.0, 0.0, 3.0, 0.0, 1.0, False),  # at -7/6, beyond the toe
        (0.0, -1.9, 3.0, 0.0, 1.0, True),
        (0.0, -2.1, 3.0, 0.0, 1.0, False),
        (0.0, 0.0, 3.0, 4.0, 1.0, False),  # a saddle: 16 > 12
        (0.0, 0.0, -3.0, 0.0, -1.0, False),  # hollow
    ],
)
def test_least_gap_lies_inside_where_the_slopes_are_less_than_the_crownings(
    slope, profile_slope, crowning, twist, profile_crowning, inside
) -> None:
    assert is_least_inside(Parts(slope, profile_slope, crowning, twist, profile_crowning, 0.0)) is inside
