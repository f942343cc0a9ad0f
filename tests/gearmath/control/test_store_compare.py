"""What is said of files that are not the same: the keys of a set that changed, line by line."""

from __future__ import annotations

import pytest

from gearmath.control.store_compare import _file_changes

SET = b"""title = "pair"
[pinion]
teeth = 12
[pinion.concave]
radial_distance = 74.87
blank_offset = 3.92
"""


@pytest.mark.parametrize(
    ("new", "same_design", "said"),
    [
        (SET.replace(b"74.87", b"74.91"), True, ["pinion.concave.radial_distance 74.87 -> 74.91 (+0.04)"]),
        (SET.replace(b"74.87", b"74.870"), True, ["has the same values, written in another way"]),
        (
            SET.replace(b"3.92", b"3.95") + b"[pinion.concave.design]\nblank_offset = 3.92\n",
            True,
            ["pinion.concave.blank_offset 3.92 -> 3.95 (+0.03)"],
        ),
        (
            SET + b"[pinion.concave.design]\nblank_offset = 3.9\n",
            False,
            ["pinion.concave.design.blank_offset none -> 3.9"],
        ),
        (
            SET.replace(b"teeth = 12", b"index_correction = [0.1, 0.2]"),
            True,
            ["pinion.teeth 12 -> none", "pinion.index_correction none -> a list"],
        ),
        (b"\xff no TOML", True, ["is not the same"]),
        (None, True, ["is stored with the earlier run only"]),
    ],
)
def test_every_key_of_a_file_that_changed_is_named(new: bytes | None, same_design: bool, said: list[str]) -> None:
    assert list(_file_changes(SET, new, same_design)) == said
