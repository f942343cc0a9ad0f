"""What only plain face milling has so far is refused by name for the other methods, and nothing is written."""

from __future__ import annotations

import pytest

<<<<<<< HEAD
from gearmath import cli
=======
from gearmath.bevel.flank import blank_grid
from gearmath.errors import InputError
from gearmath.machine.mill import nominal_flank
from gearmath.quality.correction import correct
>>>>>>> b59f9a6 (Mill face hobbing programs blade by blade, and show that the flanks keep the tolerance)
from gearmath.specs.bevel_set import Motion, design_sha256, load_bevel_set, settings_sha256
from gearmath.specs.toml import bundled


<<<<<<< HEAD
def test_program_of_a_face_hobbed_member_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "CUT.MPF"
    with pytest.raises(SystemExit) as stopped:
        cli.main(["nc", "cut", "crown_gear_hobbed_14x39.toml", "--member", "pinion", "-o", str(target)])
    assert stopped.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "pinion: is face hobbed" in line
    assert not target.exists()
=======
@pytest.mark.parametrize(
    ("gear_set", "name", "words"),
    [
        ("crown_gear_hobbed_14x39.toml", "pinion", "face hobbed"),
        ("crown_gear_formate_14x39.toml", "gear", "Formate cut"),
        ("crown_gear_universal_14x39.toml", "pinion", "cut with settings that move"),
    ],
)
def test_compensation_of_another_method_is_refused(gear_set: str, name: str, words: str) -> None:
    member = load_bevel_set(bundled(gear_set)).member(name)
    nominal = nominal_flank(member, name, "concave", blank_grid(member))
    with pytest.raises(InputError, match=rf"{name}: compensation is there for plain face milling only; .*{words}"):
        correct(member, name, nominal)
>>>>>>> b59f9a6 (Mill face hobbing programs blade by blade, and show that the flanks keep the tolerance)


def test_digests_tell_methods_apart() -> None:
    member = load_bevel_set(bundled("nasa_tp3096_12x36.toml")).gear
    moving = Motion(work_rotation_offset=(0.0, 1.0))
    flanks = {flank: member.flank(flank).model_copy(update={"motion": moving}) for flank in ("concave", "convex")}
    others = [member.model_copy(update=flanks), member.model_copy(update={"generation": "formate"})]
    for digest in (design_sha256, settings_sha256):
        assert len({digest(one) for one in (member, *others)}) == 3
