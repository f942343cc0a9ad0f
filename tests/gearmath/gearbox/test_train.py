"""Planning a hobbing job: the figures of the source text and of the field, and what is refused."""

from fractions import Fraction

import pytest

from gearmath.errors import InputError
from gearmath.gearbox.train import WIDEST, plan
from gearmath.specs.hobbing import HobbingMachine, load_hobbing_machine
from gearmath.specs.toml import bundled, parse

TEXT = bundled("hobbing_plewes.toml").read_text("utf-8")


def machine(**changes: str) -> HobbingMachine:
    """The machine of the source text with some values of its file replaced."""
    text = TEXT
    for key, value in changes.items():
        lines = [f"{key} = {value}" if line.startswith(f"{key} = ") else line for line in text.splitlines()]
        text = "\n".join(lines)
    return parse(text, HobbingMachine, "machine.toml")


@pytest.fixture(scope="module")
def plewes() -> HobbingMachine:
    return load_hobbing_machine(bundled("hobbing_plewes.toml"))


def test_ten_teeth_on_the_first_machine_of_the_text_give_2_56():
    job = plan(machine(decoder="1", microsteps="1"), 10)  # 1024 counts, 4000 steps
    assert job.exact_pulse_ratio == Fraction("2.56")
    assert job.pulse_ratio == 2.56
    assert (job.steps_numerator, job.steps_denominator, job.first_remainder) == (25, 64, 32)


@pytest.mark.parametrize(
    ("changes", "ratio"),
    [({}, Fraction(40960, 16000)), ({"worm": "5"}, Fraction(40960, 8000)), ({"lines": "200"}, Fraction(8000, 16000))],
)  # fmt: skip
def test_ratios_of_the_edited_machines_of_the_text(changes, ratio):
    if ratio < 1:  # 16000 steps to 800 counts: the text says nothing of it, an edge would have to give two steps
        with pytest.raises(InputError, match="2/1 motor steps per encoder count"):
            plan(machine(**changes), 10)
    else:
        assert plan(machine(**changes), 10).exact_pulse_ratio == ratio


def test_ratio_of_multi_start_hob(plewes):
    assert plan(plewes, 30, starts=3).exact_pulse_ratio == plan(plewes, 10).exact_pulse_ratio


def test_rates_of_the_field_reference(plewes):
    """gearbox.md 4.3: 4096 counts at 800 rpm are 54.6 kHz of edges; 6 teeth and 16000 steps are 35.6 kHz of steps."""
    job = plan(plewes, 6, rpm=800.0)
    assert job.edge_rate_hz == pytest.approx(54.6e3, abs=50)
    assert job.step_rate_hz == pytest.approx(35.6e3, abs=50)
    assert job.hob_rpm_percent == 100.0
    assert job.step_rate_percent == pytest.approx(800 / 60 * 16000 / 6 / 40000 * 100, rel=1e-14)


def test_highest_speed_keeps_both_limits():
    job = plan(machine(step_rate_hz="20000.0"), 10)
    assert job.rpm == job.highest_rpm == pytest.approx(750.0, rel=1e-14)  # 20 kHz / 1600 steps a hob turn
    assert job.step_rate_percent == pytest.approx(100.0, rel=1e-14)
    assert plan(machine(), 160).highest_rpm == 800.0


@pytest.mark.parametrize(
    ("rule", "depths"),
    [
        ("2.157/P", (0.0674, 0.0449, 0.0337, 0.0270, 0.0205, 0.0171)),
        ("2.25/P", (0.0703, 0.0469, 0.0352, 0.0281, 0.0214, 0.0179)),
        ("2.2/P+0.002in", (0.0708, 0.0478, 0.0364, 0.0295, 0.0230, 0.0195)),
    ],
)
def test_depths_of_the_published_rules(rule, depths):
    """gearbox.md 6.1, P = 32, 48, 64, 80, 105, 126, in inches to four places."""
    text = TEXT.replace('"2.25/P"', f'"{rule}"')
    chosen = parse(text, HobbingMachine, "machine.toml")
    for pitch, depth in zip((32, 48, 64, 80, 105, 126), depths, strict=True):
        (blank,) = plan(chosen, 30, hob=f"{pitch}dp").blanks
        assert f"{blank.cut_depth / 25.4:.4f}" == f"{depth:.4f}"
        assert blank.depth_rule == rule


def test_blanks_of_the_source_text(plewes):
    """(G + 2)/P and 2.25/P in inches; m (G + 2) and 2.25 m in mm."""
    blanks = plan(plewes, 30).blanks
    assert len(blanks) == 10
    for blank, hob in zip(blanks[:-1], plewes.hobs[:-1], strict=True):
        assert blank.blank_diameter == pytest.approx(32 / hob.diametral_pitch * 25.4, rel=1e-14)
        assert blank.cut_depth == pytest.approx(2.25 / hob.diametral_pitch * 25.4, rel=1e-14)
    assert (blanks[-1].hob, blanks[-1].blank_diameter, blanks[-1].cut_depth) == ("m1", 32.0, 2.25)


@pytest.mark.parametrize(
    ("teeth", "options", "words"),
    [
        (0, {}, ("teeth = 0", "between 1 and 999")),
        (-3, {}, ("teeth = -3", "between")),
        (1000, {}, ("teeth = 1000", "999")),
        (3, {}, ("teeth = 3", "125/96", "nearest tooth count that can be cut is 4")),
        (10, {"starts": 0}, ("starts = 0", "between 1")),
        (7, {"starts": 3}, ("nearest tooth count that can be cut is 12",)),  # 48000/4096 = 11.7
        (10, {"hob": "20dp"}, ("20dp", "32dp, 36dp", "m1")),
        (10, {"rpm": 0.0}, ("rpm = 0", "positive")),
        (10, {"rpm": float("nan")}, ("rpm = nan", "positive")),
        (10, {"rpm": 801.0}, ("801", "800.0 rpm", "limits.hob_rpm")),
        (4, {"rpm": 700.0}, ("700", "600.0 rpm", "limits.step_rate_hz = 40000")),  # 40 kHz / 4000 steps a hob turn
    ],
)
def test_what_cannot_be_met_is_refused_with_the_nearest_choice(plewes, teeth, options, words):
    with pytest.raises(InputError) as caught:
        plan(plewes, teeth, **options)
    for word in words:
        assert word in str(caught.value)


def test_ratio_too_wide_for_32_bits_is_refused_with_the_nearest_choice():
    wide = machine(lines="999983", microsteps="1", full_steps="1", belt="1", worm="10")
    with pytest.raises(InputError, match="32-bit arithmetic") as caught:
        plan(wide, 997)
    nearest = int(str(caught.value).rsplit(" ", 1)[1])
    job = plan(wide, nearest)
    assert job.steps_denominator <= WIDEST
    between = range(min(nearest, 997) + 1, max(nearest, 997) + 1)
    assert all(Fraction(10, 4 * 999983 * teeth).denominator > WIDEST for teeth in between)


def test_hopeless_drive_train_is_said_to_be_hopeless():
    with pytest.raises(InputError, match="no tooth count from 1 to 999"):
        plan(machine(lines="1", decoder="1"), 20)
