"""Records that a user changes with means of Python's own: what cannot be is refused, nothing wrong is computed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import gearmath as gm
from gearmath.specs.bevel_set import BevelSet
from gearmath.specs.bevel_set import Member as MemberSpec


@pytest.fixture(scope="module")
def pair() -> gm.GearSet:
    return gm.load_set("nasa_tp3096_12x36.toml")


def with_flank(spec: MemberSpec, **changes: object) -> MemberSpec:
    return spec.model_copy(update={"concave": spec.concave.model_copy(update=changes)})


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"shaft_angle": "90"}, "shaft_angle = '90': must be a number"),
        ({"shaft_angle": math.nan}, "shaft_angle = nan: must be a finite number"),
        ({"title": 5}, "title = 5: must be text"),
        ({"pinion": None, "gear": None}, "holds neither a pinion nor a gear"),
        ({"pinion": {}}, "pinion.teeth is missing|teeth.* missing"),
        ({"shaft_angel": 90.0}, "shaft_angel: no such key is known here"),
    ],
)
def test_a_set_of_content_that_no_file_may_have_is_refused(pair: gm.GearSet, change: dict, sentence: str) -> None:
    spec = pair.spec.model_copy(update=change)
    for make in (pair.with_spec, gm.GearSet):
        with pytest.raises(gm.InputError, match=sentence):
            make(spec)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda spec: spec.model_copy(update={"teeth": "12"}), "teeth = '12': must be a whole number"),
        (lambda spec: spec.model_copy(update={"hand": "up"}), "hand = 'up': must be 'left' or 'right'"),
        (lambda spec: spec.model_copy(update={"concave": None}), "concave = None: must be a table of keys"),
        (lambda spec: with_flank(spec, radial_distance=math.inf), "concave.radial_distance = inf"),
        (lambda spec: with_flank(spec, radial_distanc=75.0), "concave.radial_distanc: no such key is known here"),
    ],
)
def test_a_member_of_content_that_no_file_may_have_is_refused(
    pair: gm.GearSet, change: Callable[[MemberSpec], MemberSpec], sentence: str
) -> None:
    with pytest.raises(gm.InputError, match=sentence):
        replace(pair.pinion, spec=change(pair.pinion.spec))


def test_a_member_put_in_as_the_other_one_is_the_other_one(pair: gm.GearSet) -> None:
    copied = pair.spec.model_copy(update={"gear": pair.spec.pinion})
    assert (copied.member("pinion").name, copied.member("gear").name) == ("pinion", "gear")
    assert pair.spec.member("pinion").name == "pinion"
    with pytest.raises(gm.InputError, match="pinion and gear are both left hand"):
        pair.with_spec(copied)


def test_a_set_that_came_out_of_a_file_and_was_changed_does_not_blame_the_file(pair: gm.GearSet) -> None:
    single = pair.with_spec(pair.spec.model_copy(update={"gear": None}))
    with pytest.raises(gm.InputError, match=r"^NASA .*: has no gear, only a pinion"):
        _ = single.gear


def test_measurements_of_another_set_are_refused_on_the_sheet_of_this_one(pair: gm.GearSet, tmp_path: Path) -> None:
    own, other = pair.pinion.deviations((3, 5)), gm.load_set("spiral_7x43.toml")
    with pytest.raises(gm.InputError, match="member_teeth = 43: the gear of the set has 36"):
        own.report(tmp_path / "sheet.html", other.gear.deviations((3, 5)))
    with pytest.raises(gm.InputError, match="member_teeth = 7: the pinion of the set has 12"):
        own.report(tmp_path / "sheet.html", again=[other.pinion.deviations((3, 5))])
    with pytest.raises(gm.InputError, match="two are of the pinion"):
        pair.contact(own, own)


def off_by(pair: gm.GearSet, member: gm.Member) -> gm.Correction:
    """The correction of a member that was cut with a radial distance 0.05 mm off."""
    made = member.with_settings(concave={"radial_distance": 0.05}).deviations((3, 5))
    return gm.Measurement(member, made.file).compensate(np.array(["radial_distance", "blank_offset"]))


@pytest.mark.parametrize("inch", [False, True])
def test_a_correction_of_a_changed_set_is_not_written_into_the_file_of_the_one_before(
    inch: bool, pair: gm.GearSet, tmp_path: Path
) -> None:
    """The nominal flanks of the corrected set are those that were measured against, not those of the old file."""
    before = pair.with_spec(pair.spec)
    source = before.save(tmp_path / "set.toml") if not inch else pair.source
    assert source is not None
    changed = pair.pinion.with_settings(concave={"radial_distance": 0.1, "cradle_angle": 0.01}).as_nominal()
    by_hand = gm.GearSet(changed.gear_set.spec, source)
    corrected = off_by(by_hand, by_hand.pinion).member
    for key, change in (("radial_distance", -0.05), ("cradle_angle", 0.0)):
        nominal = getattr(changed.spec.concave, key)
        assert getattr(corrected.spec.concave.nominal, key) == nominal
        assert getattr(corrected.spec.concave, key) == pytest.approx(nominal + change, abs=2e-3)


def test_a_set_that_is_saved_reads_back_to_the_last_digit(pair: gm.GearSet, tmp_path: Path) -> None:
    """So that what was measured against its flanks belongs to the file, too."""
    changed = pair.pinion.with_settings(concave={"radial_distance": 0.0123456789012345, "cradle_angle": 1e-11})
    for member in (changed, changed.as_nominal(), pair.pinion):
        place = member.gear_set.save(tmp_path / "set.toml")
        assert gm.load_set(place).spec == member.gear_set.spec
        assert gm.load_measurement(member.deviations((3, 5)).to_csv(tmp_path / "m.csv"), place).member == replace(
            member, gear_set=gm.load_set(place)
        )


def test_an_advance_counted_from_the_crossing_point_reads_back_to_the_last_digit() -> None:
    from gearmath.specs.set_text import _from_crossing

    rng = np.random.default_rng(1)
    for written, beyond in rng.uniform(-20, 20, (1000, 2)).tolist():
        read = written + beyond
        assert _from_crossing(read, beyond) + beyond == read


def test_what_a_user_writes_into_results_changes_no_later_ones(pair: gm.GearSet) -> None:
    tooth = pair.pinion.tooth(5)
    assert not tooth.space.concave.point.flags.writeable
    with pytest.raises(ValueError, match="read-only"):
        tooth.space.concave.point[:] = 0.0
    assert isinstance(pair.spec, BevelSet)
