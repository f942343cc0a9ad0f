"""What a new user writes: few lines, one import, and nothing heavy loaded before it is used."""

from __future__ import annotations

import ctypes
import doctest
import importlib
import math
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import gearmath as gm


def test_ten_lines_from_a_set_to_corrected_settings(tmp_path: Path) -> None:
    pair = gm.load_set("nasa_tp3096_12x36.toml")
    off = pair.pinion.with_settings(concave={"radial_distance": +0.05})
    measured = off.deviations()
    assert measured.plot().get_axes()
    correction = measured.compensate()
    assert [(flank, name) for flank, name, _ in correction.changes] == [("concave", "radial_distance")]
    # the machine that is 0.05 off one way must be set 0.05 the other way
    assert correction.changes[0][2] == pytest.approx(-0.05, abs=1e-4)
    assert correction.rms["concave"][1] < 1e-3 * correction.rms["concave"][0]


def test_contact_of_a_pair_as_it_is_and_as_it_was_measured() -> None:
    pair = gm.load_set("nasa_tp3096_12x36.toml")
    off = pair.pinion.with_settings(concave={"machine_root_angle": 0.05}).deviations()
    nominal, measured = (pair.contact(*files, sides=("drive",)) for files in ((), (off,)))
    before, after = (found.to_dict(step=15)["drive"] for found in (nominal, measured))
    assert before["peak_to_peak_arcsec"] != after["peak_to_peak_arcsec"]
    assert after["measured"]["pinion"]["rms_um"] > 1
    with pytest.raises(gm.InputError, match="sides: 'left': must be of drive, coast"):
        pair.contact(sides=("left",))
    other = pair.with_member(pair.pinion.with_settings(concave={"machine_root_angle": 0.05}))
    bare = gm.GearSet(
        other.spec.model_copy(
            update={
                "pinion": other.spec.pinion.model_copy(
                    update={"concave": other.spec.pinion.concave.model_copy(update={"design": None})}
                )
            }
        )
    )
    with pytest.raises(gm.InputError, match=r"pinion\.concave: was measured against other nominal settings"):
        bare.contact(off)


def test_a_change_and_its_opposite_leave_the_flank_as_it_was() -> None:
    pinion = gm.load_set("nasa_tp3096_12x36.toml").pinion
    there = pinion.with_settings(concave={"radial_distance": 0.05}, convex={"cradle_angle": -0.01})
    back = there.with_settings(concave={"radial_distance": -0.05}, convex={"cradle_angle": 0.01})
    assert abs(there.deviations().deviation).max() > 0.005
    assert abs(back.deviations().deviation).max() < 1e-9
    np.testing.assert_array_equal(there.flank("concave").point, pinion.flank("concave").point)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"radial_distanc": 0.1}, "pinion.concave.radial_distanc: is no setting"),
        ({"radial_distance": "0.1"}, "pinion.concave.radial_distance = '0.1': must be a finite number"),
        ({"radial_distance": float("nan")}, "pinion.concave.radial_distance = nan: must be a finite number"),
        ({"radial_distance": 30.0}, "pinion"),
        ({"blade_pressure_angle": 8.0}, "pinion"),
    ],
)
def test_a_setting_that_cannot_be_is_refused(change: dict[str, float], sentence: str) -> None:
    with pytest.raises(gm.InputError, match=sentence):
        gm.load_set("nasa_tp3096_12x36.toml").pinion.with_settings(concave=change)


def test_a_set_says_that_it_runs_on_edges_as_the_command_line_does() -> None:
    """The published pair is no good design, as its transmission error says; the designed one runs within its flanks."""
    assert (
        gm.load_set("nasa_tp3096_12x36.toml").edge_note().startswith("the pair runs on edges of its teeth (pinion conc")
    )
    assert gm.load_set("spiral_7x43.toml").edge_note() == ""


def test_a_member_made_from_values_is_the_one_that_it_is_said_to_be() -> None:
    pinion = gm.load_set("nasa_tp3096_12x36.toml").pinion
    made = gm.Member(pinion.gear_set, "pinion", type(pinion.spec).model_validate(pinion.spec.model_dump()))
    np.testing.assert_array_equal(made.flank("convex", (1, 2)).point, pinion.flank("convex", (1, 2)).point)
    assert pinion.gear_set.with_member(made).spec == pinion.gear_set.spec


def test_a_set_is_written_and_read_back(tmp_path: Path) -> None:
    pair = gm.load_set("nasa_tp3096_12x36.toml")
    again = gm.load_set(pair.save(tmp_path / "set.toml"))
    np.testing.assert_allclose(again.gear.flank("convex").point, pair.gear.flank("convex").point, atol=1e-7)


def test_fifteen_lines_from_an_expression_to_a_called_c_function(tmp_path: Path, host_compiler) -> None:
    depth = gm.Quantity("depth", "depth of a cut by a round tool", "mm", "h", domain=(0.1, 1))
    radius = gm.Quantity("radius", "radius of the tool", "mm", "r", domain=(2, 50))
    width = gm.Quantity("width", "width of the cut", "mm", "b")
    h, r = depth.symbol, radius.symbol
    cut = gm.Expression("cut_width", "Width of a cut.", (depth, radius), ((width, 2 * (h * (2 * r - h)) ** 0.5),))
    files = gm.export_c(cut, tmp_path / "c")
    assert [path.name for path in files[:2]] == ["gm_cut_width.h", "gm_cut_width.c"]
    sources = [str(path) for path in files if path.suffix == ".c"]
    library = tmp_path / "cut.so"
    subprocess.run([*host_compiler, "-shared", "-fPIC", *sources, "-o", str(library), "-lm"], check=True)
    result = ctypes.c_double()
    ctypes.CDLL(str(library)).gm_cut_width(ctypes.c_double(0.5), ctypes.c_double(10.0), ctypes.byref(result))
    assert result.value == pytest.approx(2 * (10.0**2 - 9.5**2) ** 0.5)  # the chord at the distance r - h
    (lowered,) = gm.lower(cut)(0.5, 10.0)
    assert lowered == result.value


@pytest.mark.parametrize(("page", "most"), [("README.md", 10), ("docs/how_to/own_expression.md", 15)])
def test_the_script_of_a_page_is_short_and_runs(
    page: str, most: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, host_compiler, capsys
) -> None:
    text = (Path(__file__).parents[3] / page).read_text("utf-8")
    script = re.findall(r"```python\n(.*?)```", text, re.DOTALL)[0]
    assert len([line for line in script.splitlines() if line.strip()]) <= most
    assert script.count("import gearmath as gm") == 1
    assert "from gearmath" not in script
    monkeypatch.chdir(tmp_path)
    code = compile(script.replace('["cc", ', f"[*{host_compiler!r}, "), page, "exec")
    exec(code, {})
    capsys.readouterr()
    exec(code, {})  # again in the same folder, as a cell of a notebook is
    said = capsys.readouterr().out.split()
    if page == "README.md":
        assert (tmp_path / "topography.png").stat().st_size > 1000
        assert "'radial_distance'" in " ".join(said)
    else:
        chord = 2 * (10.0**2 - 9.5**2) ** 0.5  # by Pythagoras
        assert [float(value) for value in said] == pytest.approx([chord, chord])


def test_a_program_of_one_space_leaves_what_it_promises() -> None:
    pinion = gm.load_set("nasa_tp3096_12x36.toml").pinion
    program = pinion.program(spaces=[0], tolerance=1e-3)
    assert not program.faults()
    milled = program.mill()
    assert abs(milled.deviation).max() < 1e-3
    assert "table" in milled.evaluate()._repr_html_()


def test_a_set_that_is_saved_is_the_same_when_it_is_loaded(tmp_path: Path) -> None:
    pair = gm.load_set("nasa_tp3096_12x36.toml")
    changed = pair.with_member(pair.pinion.with_settings(concave={"radial_distance": 1 / 30}))
    measured = changed.pinion.deviations((3, 3)).to_csv(tmp_path / "m.csv")
    assert gm.load_set(changed.save(tmp_path / "changed.toml")).spec == changed.spec
    assert gm.load_measurement(measured, tmp_path / "changed.toml").member.spec == changed.pinion.spec


def test_a_corrected_member_can_be_measured_and_corrected_again(tmp_path: Path) -> None:
    file = gm.load_set("nasa_tp3096_12x36.toml").save(tmp_path / "set.toml")
    pair = gm.load_set(file)
    wanted = pair.pinion.spec.concave.radial_distance
    member = pair.pinion.with_settings(concave={"radial_distance": +0.05})
    file.unlink()  # what it was read from may be gone, or another set by then
    for most in (1e-4, 1e-6):  # mm
        member = member.deviations().compensate("radial_distance").member
        assert abs(member.spec.concave.radial_distance - wanted) < most
    measured = pair.pinion.deviations((3, 3))
    assert measured.compensate("radial_distance").save(tmp_path / "corrected.toml").is_file()


def test_importing_loads_nothing_heavy() -> None:
    program = "import sys, gearmath\nprint([m for m in ('numpy', 'casadi', 'sympy', 'pydantic') if m in sys.modules])"
    said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    assert said.strip() == "[]"


def test_what_runs_kept_kernels_needs_neither_sympy_nor_matplotlib() -> None:
    gm.load_set("nasa_tp3096_12x36.toml").pinion.flank("concave")  # derives what no process of this user has yet
    program = """
import sys
import gearmath as gm
from gearmath.front import contact, hobbing, judged, measured, probing, programs
gm.load_set("nasa_tp3096_12x36.toml").pinion.flank("concave")
print([name for name in ("sympy", "matplotlib", "scipy", "tqdm") if name in sys.modules])
"""
    said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    assert said.strip() == "[]"


def test_every_name_is_there_and_says_what_it_is() -> None:
    for name in gm.__all__:
        one = getattr(gm, name)
        assert one.__doc__, name
        for inner in getattr(one, "__all__", ()):
            assert getattr(one, inner).__doc__, inner
    assert set(gm.__all__) <= set(dir(gm))
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        gm.nothing  # noqa: B018


def test_the_names_for_type_checkers_are_the_names_at_run_time() -> None:
    text = Path(gm.__file__).read_text()
    block = text[text.index("if TYPE_CHECKING:") : text.index("#: The names")]
    typed = {line.split(" as ")[-1].strip() for line in block.splitlines() if " as " in line}
    assert typed == set(gm.__all__)


def test_the_front_door_is_about_thirty_names_wide() -> None:
    assert 25 <= len(gm.__all__) <= 32


@pytest.mark.parametrize("module", ["sets", "member", "machines", "hobbing", "design"])
def test_the_examples_of_the_front_door_are_true(module: str) -> None:
    result = doctest.testmod(importlib.import_module(f"gearmath.front.{module}"))
    assert result.attempted > 0
    assert result.failed == 0


def test_no_name_is_that_of_a_module_which_would_hide_it() -> None:
    folder = Path(gm.__file__).parent
    modules = {path.stem for path in folder.iterdir() if path.suffix == ".py" or (path / "__init__.py").is_file()}
    assert not modules & set(gm.__all__)


def test_the_page_of_the_api_has_the_names_of_the_package() -> None:
    page = (Path(__file__).parents[3] / "docs" / "api.md").read_text()
    listed = set(re.findall(r"::\s*gearmath\.([\w.]+)", page))
    modules = {"hobbing": gm.hobbing, "results": gm.results}
    inner = {f"{name}.{one}" for name, module in modules.items() for one in module.__all__}
    assert listed == set(gm.__all__) - {"__version__", *modules} | inner


def test_a_helix_is_its_angle_and_hand_as_on_the_command_line() -> None:
    """The lead of a left-hand helix is that of a right-hand one the other way: z m π/sin(β), by hand."""
    right = gm.hobbing.plan("hobbing_helical.toml", teeth=30, hob="m1", helix=15.0).plan
    left = gm.hobbing.plan("hobbing_helical.toml", teeth=30, hob="m1", helix=15.0, hand="left").plan
    for each in (right, left):
        assert each.helix.lead == pytest.approx(30 * math.pi / math.sin(math.radians(15.0)))
    assert right.feed_numerator == -left.feed_numerator
    found = gm.hobbing.choose("hobbing_helical.toml", 11, 1.0, 30, helix=15.0, hand="left", face_width=5.0)
    assert found.gear.found


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda pinion: pinion.probing(repeat=0), "repeat = 0: must be a whole number from 1 to 100"),
        (lambda pinion: pinion.probing(repeat=2.5), "repeat = 2.5: must be a whole number"),
        (lambda _: gm.load_machine().calibrating(cycle="axis"), "cycle = 'axis': must be 'tip' or 'axes'"),
        (
            lambda _: gm.hobbing.plan("hobbing_helical.toml", teeth=30, hand="left"),
            "hand = 'left': has no meaning without",
        ),
        (
            lambda _: gm.hobbing.plan("hobbing_helical.toml", teeth=30, helix=15, hand="links"),
            "must be 'right' or 'left'",
        ),
    ],
)
def test_an_argument_that_cannot_be_is_refused_in_a_sentence(call: Callable[..., object], sentence: str) -> None:
    with pytest.raises(gm.InputError, match=sentence):
        call(gm.load_set("nasa_tp3096_12x36.toml").pinion)
