"""Planning a hobbing job: the figures of the source text and of the field, and what is refused."""

from fractions import Fraction

import pytest

from gearmath.errors import InputError
from gearmath.gearbox.job import WIDEST, plan_thread
from gearmath.gearbox.train import plan
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
    job = plan(machine(decoder='"ls7184_x1"', microsteps="1"), 10)  # 1024 counts, 4000 steps
    assert job.exact_pulse_ratio == Fraction("2.56")
    assert job.pulse_ratio == 2.56
    assert (job.steps_numerator, job.steps_denominator, job.first_remainder) == (25, 64, 32)


@pytest.mark.parametrize(
    ("changes", "ratio"),
    [({}, Fraction(40960, 16000)), ({"worm": "5"}, Fraction(40960, 8000)), ({"lines": "200"}, Fraction(8000, 16000))],
)
def test_ratios_of_the_edited_machines_of_the_text(changes, ratio):
    assert plan(machine(**changes), 10).exact_pulse_ratio == ratio


def test_several_steps_an_edge_are_a_base_and_a_rest():
    """16000 steps to 800 counts and 3 teeth: 20/3 steps an edge, 6 of them every time."""
    job = plan(machine(lines="200"), 3)
    assert Fraction(job.steps_numerator, job.steps_denominator) == Fraction(20, 3)
    assert (job.base_steps, job.increments) == ((6, 0), (2, 0))
    assert job.highest_rpm == pytest.approx(40000 / (16000 / 3) * 60 / 1.01)  # the trip, 1 % above, keeps the rate
    assert not job.carried_at_every_speed


def test_ratio_of_multi_start_hob(plewes):
    assert plan(plewes, 30, starts=3).exact_pulse_ratio == plan(plewes, 10).exact_pulse_ratio


def test_left_hand_hob_turns_the_table_the_other_way(plewes):
    left, right = plan(machine(hob_hand='"left"'), 30), plan(plewes, 30)
    assert left.exact_pulse_ratio == -right.exact_pulse_ratio == -Fraction(192, 25)
    assert left.step_rate_hz == right.step_rate_hz > 0
    assert (left.base_steps, left.increments) == ((-1, 0), (192 - 25, 0))


def test_rates_of_the_field_reference(plewes):
    """gearbox.md 4.3: 4096 counts at 800 rpm are 54.6 kHz of edges; 6 teeth and 16000 steps are 35.6 kHz of steps."""
    job = plan(plewes, 6, rpm=800.0)
    assert job.edge_rate_hz == pytest.approx(54.6e3, abs=50)
    assert job.step_rate_hz == pytest.approx(35.6e3, abs=50)
    assert job.hob_rpm_percent == 100.0
    assert job.step_rate_percent == pytest.approx(800 / 60 * 16000 / 6 / 40000 * 100, rel=1e-14)


def test_plan_tells_what_the_acceleration_allows(plewes):
    """24 teeth at 800 rpm: 8888.9 steps/s at 8000 steps/s^2. By hand: 1.111 s, 720 rpm/s; engaged at speed 4938 steps
    are missed, which 5819 steps/s more (sqrt(3/7) w) overtake, in 1.111 + 0.727 + 0.970 s."""
    motion = plan(plewes, 24, rpm=800.0).motion
    assert motion.run_up_s == pytest.approx(1.1111, abs=1e-4)
    assert motion.hob_acceleration_rpm_per_s == pytest.approx(720.0)
    assert motion.catch_up_s == pytest.approx(2.808, abs=2e-3)
    assert motion.catch_up_turns == pytest.approx(2.808 * 800 / 60, abs=0.03)
    assert motion.engage_rpm == 800.0
    fast = plan(plewes, 6, rpm=800.0).motion  # 35.6 kHz of 40: 4.4 kHz more overtake 79 000 steps, in 290 hob turns
    assert (fast.catch_up_s, fast.catch_up_turns) == (None, None)
    assert 300 < fast.engage_rpm < 800


def test_hob_that_runs_up_too_fast_is_refused_with_the_nearest_speed(plewes):
    assert plan(plewes, 24, rpm=800.0, run_up=1.2).rpm == 800.0
    with pytest.raises(
        InputError, match=r"run_up = 0.5 s: .* at least 1.11 s to 800 rpm .* nearest speed .* is 3\d\d rpm"
    ):
        plan(plewes, 24, rpm=800.0, run_up=0.5)  # 4000 steps/s are 360 rpm
    quick = plewes.model_copy(update={"limits": plewes.limits.model_copy(update={"run_up_s": 0.5})})
    with pytest.raises(InputError, match=r"limits.run_up_s = 0.5 s"):
        plan(quick, 24, rpm=800.0)
    assert plan(quick, 24, rpm=800.0, run_up=2.0).rpm == 800.0  # what is asked for counts
    assert plan(quick, 127, rpm=800.0).rpm == 800.0


def test_resolution_at_the_pitch_circle(plewes):
    """24 teeth of 32 DP: 19.05 mm; 59.85 mm round, 16000 steps, 24 x 4096 counts."""
    (blank,) = plan(plewes, 24, hob="32dp").blanks
    assert blank.step_um == pytest.approx(3.7405, abs=1e-3)
    assert blank.count_um == pytest.approx(0.6088, abs=1e-3)


def test_proposed_speed_keeps_a_tenth_of_what_is_possible_as_a_margin():
    job = plan(machine(step_rate_hz="20000.0"), 10)
    assert job.rpm == pytest.approx(0.9 * job.highest_rpm, rel=1e-14)
    assert max(job.step_rate_percent, job.hob_rpm_percent) < 91


def test_highest_speed_keeps_both_limits():
    job = plan(machine(step_rate_hz="20000.0"), 10)
    assert job.highest_rpm == pytest.approx(750.0 / 1.01, rel=1e-14)  # 20 kHz / 1600 steps a hob turn
    at_most = plan(machine(step_rate_hz="20000.0"), 10, rpm=job.highest_rpm)
    assert at_most.step_rate_percent == pytest.approx(100.0 / 1.01, rel=1e-14)
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
        (10, {"starts": 0}, ("starts = 0", "between 1")),
        (10, {"shift": 1.2}, ("shift = 1.2", "-0.5 and 1")),
        (10, {"pin": -1.0}, ("pin = -1", "positive")),
        (10, {"hob": "20dp"}, ("20dp", "32dp, 36dp", "m1")),
        (10, {"rpm": 0.0}, ("rpm = 0", "positive")),
        (10, {"rpm": float("nan")}, ("rpm = nan", "positive")),
        (10, {"rpm": 801.0}, ("801", "800.0 rpm", "limits.hob_rpm")),
        (
            4,
            {"rpm": 700.0},
            ("700", "594.1 rpm", "limits.step_rate_hz = 40000"),
        ),  # 600 rpm trip: 40 kHz / 4000 steps a turn
    ],
)
def test_what_cannot_be_met_is_refused_with_the_nearest_choice(plewes, teeth, options, words):
    with pytest.raises(InputError) as caught:
        plan(plewes, teeth, **options)
    for word in words:
        assert word in str(caught.value)


def test_steps_that_may_not_wait_are_refused_with_the_nearest_choice():
    """800 counts, 16000 steps, lag of 2: one edge of 9 teeth would give up to 3 steps (20/9)."""
    small = machine(lines="200", lag_steps="2")
    with pytest.raises(
        InputError, match=r"20/9 .* up to 3 at once, all that .*lag_steps lets wait is 2; .* cut is 10$"
    ):
        plan(small, 9)
    assert plan(small, 10).base_steps == (2, 0)


def test_more_than_64_steps_an_edge_are_beyond_the_rule():
    """100 counts, 16000 steps: 80 steps an edge for 2 teeth, 53 1/3 for 3."""
    with pytest.raises(InputError, match=r"80 motor steps .* up to 80 at once, the most .* is 64; .* is 3$"):
        plan(machine(lines="25"), 2)


def test_hopeless_drive_train_is_said_to_be_hopeless():
    coarse = machine(lines="20")
    limits = coarse.limits.model_copy(update={"lag_steps": 0})  # no file may say this
    with pytest.raises(InputError, match="no tooth count from 1 to 999"):
        plan(coarse.model_copy(update={"limits": limits}), 20)


# --- threads ------------------------------------------------------------------------------------------------------

LATHE = bundled("lathe_example.toml").read_text("utf-8")


@pytest.fixture(scope="module")
def lathe() -> HobbingMachine:
    return parse(LATHE, HobbingMachine, "lathe.toml")


@pytest.mark.parametrize(
    ("pitch", "starts", "hand", "turns"),
    [
        (Fraction(127, 40), 1, "right", Fraction(1)),  # 8 tpi on a screw of 8 tpi: turn for turn
        (Fraction(127, 80), 1, "right", Fraction(1, 2)),  # 16 tpi
        (Fraction(127, 5) / Fraction(23, 2), 1, "left", -Fraction(16, 23)),  # 11 1/2 tpi
        (Fraction(127, 100), 1, "right", Fraction(2, 5)),  # 1.27 mm = 20 tpi: the wheel with 127 teeth
        (Fraction(1), 1, "right", Fraction(40, 127)),
        (Fraction(3, 2), 4, "left", -Fraction(240, 127)),
    ],
)
def test_turns_of_the_lead_screw_per_turn_of_the_spindle(lathe, pitch, starts, hand, turns):
    job = plan_thread(lathe, pitch, starts, hand, rpm=100.0)
    assert Fraction(job.steps_numerator, job.steps_denominator) * 4000 / 4800 == turns
    assert job.lead == starts * pitch
    assert job.feed_numerator == 0


def test_metric_screw_cuts_inch_threads_exactly():
    """2 mm screw, 8 tpi: 127/80 turns; the old change wheel of 127 teeth."""
    metric = parse(LATHE.replace('"8tpi"', '"2mm"'), HobbingMachine, "lathe.toml")
    job = plan_thread(metric, Fraction(127, 40), rpm=100.0)
    assert Fraction(job.steps_numerator, job.steps_denominator) * 4000 / 4800 == Fraction(127, 80)


def test_thread_beyond_32_bits_is_refused():
    """5987 lines and a pitch of prime numbers: D is 5987 x 127 x 999983."""
    prime = parse(LATHE.replace("lines = 1000", "lines = 5987"), HobbingMachine, "lathe.toml")
    assert not prime.wide
    with pytest.raises(InputError, match=r"/760336074067 needs more than 1073741824, the limit of 32-bit arithmetic"):
        plan_thread(prime, Fraction(999_979, 999_983))
    assert plan_thread(prime, Fraction(999, 1000), rpm=10.0).steps_denominator < WIDEST


def test_a_lathe_cuts_no_gear_and_a_hobbing_machine_no_thread(lathe, plewes):
    with pytest.raises(InputError, match="lathe, give the pitch"):
        plan(lathe, 10)
    with pytest.raises(InputError, match="hobbing machine, give the number of teeth"):
        plan_thread(plewes, Fraction(2))
