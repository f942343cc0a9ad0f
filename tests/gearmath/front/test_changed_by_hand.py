"""Records that a user changes with means of Python's own: what cannot be is refused, nothing wrong is computed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import gearmath as gm
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
        ({"pinion": {}}, "pinion: .*missing|pinion.*missing"),
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


def test_tables_in_place_of_records_become_records(pair: gm.GearSet) -> None:
    tables = pair.spec.model_copy(update={"pinion": pair.spec.pinion.model_dump()})  # type: ignore[union-attr]
    assert pair.with_spec(tables).pinion.flank("concave", (1, 1)).point.shape == (1, 1, 3)


def test_a_machine_that_no_file_may_describe_is_refused() -> None:
    machine = gm.load_machine()
    for change, sentence in (
        ({"tool_length": "x"}, "tool_length = 'x': must be a number"),
        ({"tool_lenght": 100.0}, "tool_lenght: no such key is known here"),
    ):
        with pytest.raises(gm.InputError, match=sentence):
            replace(machine, spec=machine.spec.model_copy(update=change))


def test_a_program_of_another_text_is_not_judged_by_the_plan_of_the_first(pair: gm.GearSet) -> None:
    program = pair.pinion.program(spaces=[0])
    assert program.made is not None
    assert replace(program, name="OTHER").made is program.made
    for other in (replace(program, text="G1\n"), replace(program, member=pair.gear)):
        assert other.made is None
    with pytest.raises(gm.InputError, match="ends without M30"):
        replace(program, text="G1\n").time()
    with pytest.raises(gm.InputError, match="member = 'gear' in the measured file: must be 'pinion'"):
        program.judge(milled=pair.gear.deviations((3, 5)))


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("deviation", np.zeros(3), r"deviation: must be an array \(30,\) of numbers"),
        ("deviation", [0.0] * 30, r"deviation: must be an array \(30,\) of numbers"),
        ("point", np.zeros((30, 2)), r"point: must be an array \(30, 3\) of numbers"),
        ("flank", np.full(30, "left"), "flank = 'left': must be concave or convex"),
        ("header", {}, "header: member is missing"),
    ],
)
def test_a_measurement_of_arrays_that_do_not_fit_is_refused(
    pair: gm.GearSet, name: str, value: object, sentence: str
) -> None:
    measured = pair.pinion.deviations((3, 5))
    with pytest.raises(gm.InputError, match=sentence):
        gm.Measurement(pair.pinion, replace(measured.file, **{name: value}))


def test_a_name_that_is_no_utf_8_stands_in_a_correction_with_question_marks(pair: gm.GearSet, tmp_path: Path) -> None:
    file = pair.pinion.deviations((3, 5)).to_csv(tmp_path / "m\udcff.csv")
    corrected = gm.load_measurement(file, pair).compensate("radial_distance").save(tmp_path / "corrected.toml")
    assert "from m?.csv" in corrected.read_text("utf-8")


def test_a_path_that_cannot_be_looked_at_is_refused_in_a_sentence(pair: gm.GearSet, tmp_path: Path) -> None:
    for load in (gm.load_set, gm.load_machine, gm.load_blank, gm.design, gm.MeasurementStore.open):
        for place in ("x" * 300, tmp_path / ("x" * 300)):
            with pytest.raises(gm.InputError, match=r"x: cannot be (read|opened)"):
                load(place)
    with pytest.raises(gm.InputError, match="cannot be written: File name too long"):
        gm.export_c(gm.kernel("contact_start"), tmp_path / ("x" * 300))
    with pytest.raises(gm.InputError, match=r"path = array\(.*must be the path of a file"):
        pair.save(np.zeros(3))  # type: ignore[arg-type]
    with pytest.raises(gm.InputError, match="must be a finite number of mm or degrees"):
        pair.pinion.with_settings(concave={"radial_distance": 10**400})


def test_what_a_user_writes_into_results_changes_no_later_ones(pair: gm.GearSet) -> None:
    tooth = pair.pinion.tooth(5)
    assert not tooth.space.concave.point.flags.writeable
    with pytest.raises(ValueError, match="read-only"):
        tooth.space.concave.point[:] = 0.0
