"""Step drivers: the published table of times, its ticks, and the levels of the pins."""

import math

import pytest
from pydantic import ValidationError

from gearmath.specs.drivers import DRIVERS, Driver, StepTiming

#: LinuxCNC's tables of step timing and stepconf [ns]: step high, step low, DIR hold, DIR set-up.
PUBLISHED = {
    "gecko201": (500, 4000, 20_000, 1000),
    "gecko210": (500, 4000, 20_000, 1000),
    "gecko212": (500, 4000, 20_000, 1000),
    "gecko202": (500, 4500, 20_000, 1000),
    "gecko201x": (500, 3000, 20_000, 1000),
    "gecko203v": (1000, 2000, 200, 200),
    "gecko_g540": (5000, 5000, 10_000, 10_000),
    "m542": (1500, 1500, 8000, 5000),
    "dm556": (2500, 2500, 10_000, 5000),
    "dm422": (7500, 7500, 20_000, 5000),
    "dm860t": (5000, 5000, 5000, 5000),
    "a4988": (1000, 1000, 200, 200),
    "drv8825": (1900, 1900, 650, 650),
    "xylotex_8s3": (2000, 1000, 200, 200),
    "keling_4030": (5000, 5000, 20_000, 20_000),
    "sherline": (22_000, 22_000, 100_000, 100_000),
    "tb6560": (150_000, 150_000, 150_000, 150_000),
    "tmc2208": (100, 100, 20, 20),
    "tmc2209": (100, 100, 20, 20),
}


@pytest.mark.parametrize("name", PUBLISHED)
def test_times_are_those_published(name):
    timing = DRIVERS[name]
    assert (timing.step_high, timing.step_low, timing.dir_hold, timing.dir_setup) == PUBLISHED[name]
    assert timing.confirmed


def test_what_no_maker_states_is_cautious_and_says_so():
    doubtful = {name: timing for name, timing in DRIVERS.items() if not timing.confirmed}
    of_one_maker = {"dm542", "cl57t", "cl86t", "hbs57", "hbs86h"}
    assert set(doubtful) == set(DRIVERS) - set(PUBLISHED) == {"tb6600", "unsure"} | of_one_maker
    for name in ("tb6600", "unsure"):
        assert doubtful[name].ticks(1000, 2000)[:4] == (10, 10, 10, 10)
    for name in of_one_maker:  # no shorter than the published times of the same maker's nearest
        assert all(a >= b for a, b in zip(doubtful[name].ticks(1000, 0), DRIVERS["dm556"].ticks(1000, 0), strict=True))


@pytest.mark.parametrize(("tick_ns", "jitter_ns"), [(2000, 500), (5000, 2000), (5000, 0)])
@pytest.mark.parametrize("name", DRIVERS)
def test_ticks_are_never_shorter_than_the_driver_asks_even_if_one_comes_late(name, tick_ns, jitter_ns):
    timing = DRIVERS[name]
    wanted = (timing.step_high, timing.step_low, timing.dir_setup, timing.dir_hold)
    late = jitter_ns if timing.confirmed else 0
    for ticks, time in zip(timing.ticks(tick_ns, jitter_ns), wanted, strict=True):
        assert ticks >= 1
        assert time + late <= ticks * tick_ns < max(time + late, 1) + tick_ns
    period = sum(timing.ticks(tick_ns, jitter_ns)[:2]) * tick_ns * 1e-9
    assert timing.highest_rate(tick_ns, jitter_ns) == math.floor(1 / period + 1e-9)


def test_highest_rates_of_a_tick_of_five_microseconds():
    assert StepTiming(0, 0, 0, 0).highest_rate(5000, 2000) == 100_000
    assert DRIVERS["unsure"].highest_rate(5000, 2000) == 50_000  # 10 us and 10 us
    assert DRIVERS["tb6560"].highest_rate(5000, 2000) == 3225  # 31 ticks each


def test_times_of_the_file_are_taken_as_they_are():
    given = {"step_high_ns": 30_000, "step_low_ns": 31_000, "dir_setup_ns": 32_000, "dir_hold_ns": 33_000}
    driver = Driver(**given, output="direct", step_active="high")
    assert driver.timing == StepTiming(30_000, 31_000, 32_000, 33_000)


@pytest.mark.parametrize(
    ("output", "level", "low"),
    [
        ("direct", "high", False),
        ("direct", "low", True),
        ("open_collector", "low", False),  # the source text: pin high, transistor on, opto-coupler pulled down
        ("open_collector", "high", True),
    ],
)
def test_an_open_collector_inverts_every_level(output, level, low):
    driver = Driver(name="m542", output=output, step_active=level)
    assert driver.pin_active_low(level) is low


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"name": "m541"}, ("m541", "known are", "m542", "step_high_ns")),
        ({"name": "m542", "step_high_ns": 1000}, ("m542", "step_high_ns", "one of them")),
        ({"step_high_ns": 1000}, ("all of", "dir_hold_ns")),
        ({}, ("name of a driver",)),
    ],
)
def test_a_driver_that_states_no_times_or_two_is_refused(values, words):
    with pytest.raises(ValidationError) as caught:
        Driver(**values, output="direct", step_active="high")
    for word in words:
        assert word in str(caught.value)
