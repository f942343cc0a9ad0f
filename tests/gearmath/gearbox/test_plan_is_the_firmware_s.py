"""The planner and the portable firmware make the same job of the same numbers, each with its own arithmetic."""

from __future__ import annotations

import ctypes
import math
import re
from collections.abc import Callable
from fractions import Fraction
from importlib import resources

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from gearmath.engine.compiler import compile_library
from gearmath.export.machine_header import machine_header
from gearmath.gearbox.helix import Helix, JobRatio, helical_ratio, hob_ratio, one_term
from gearmath.gearbox.job import WIDEST, thread_ratio
from gearmath.specs.hobbing import HobbingMachine
from gearmath.specs.ratio import pitch
from gearmath.specs.toml import bundled, parse

pytestmark = pytest.mark.usefixtures("host_compiler")

PROBE = """\
#include "gm_job.h"

int probe(const int32_t *s, int64_t *out)
{
  gm_settings settings = {0};
  gm_job job;
  gm_facts facts;
  gm_refusal refusal;
  settings.profile = (uint8_t)s[0];
  settings.hob_unit = GM_MM;
  settings.depth_rule = GM_DEPTH_225_M;
  settings.starts = (int8_t)s[1];
  settings.left = (uint8_t)s[2];
  settings.climb = (uint8_t)s[3];
  settings.pitch_kind = (uint8_t)s[4];
  settings.teeth = (uint16_t)s[5];
  settings.helix = (uint16_t)s[6];
  settings.hob_size = s[7];
  settings.pitch = s[8];
  settings.feed = s[9];
  refusal = gm_job_make(&settings, &job, &facts);
  if (refusal != GM_JOB_OK) return (int)refusal;
  out[0] = job.denominator;
  out[1] = job.base[GM_HOB];
  out[2] = job.increment[GM_HOB];
  out[3] = job.base[GM_FEED];
  out[4] = job.increment[GM_FEED];
  return 0;
}
"""

Firmware = Callable[..., JobRatio | None]


def firmware(name: str, **changes: str) -> tuple[HobbingMachine, Firmware]:
    """A bundled machine with lines changed, and what its firmware makes of some settings; None where it refuses."""
    text = bundled(name).read_text("utf-8")
    for key, value in changes.items():
        text, found = re.subn(rf"^{key} = .*$", f"{key} = {value}", text, count=1, flags=re.MULTILINE)
        assert found, key
    machine = parse(text, HobbingMachine, name)
    folder = resources.files("gearmath.export") / "firmware"
    files = {name: (folder / name).read_text("utf-8") for name in ("gm_job.c", "gm_job.h", "gm_core.h")}
    files |= {name: (folder / name).read_text("utf-8") for name in ("gm_exact.c", "gm_exact.h")}
    library = compile_library(files | {"gm_machine.h": machine_header(machine), "probe.c": PROBE})

    def make(**changes: int) -> JobRatio | None:
        settings_ = {
            "profile": int(machine.profile == "lathe"),
            "starts": 1,
            "left": 0,
            "climb": 1,
            "kind": 0,
            "teeth": 30,
            "helix": 0,
            "size": 10_000,
            "pitch": 1000,
            "feed": 300,
        } | changes
        out = (ctypes.c_int64 * 5)()
        if library.probe((ctypes.c_int32 * 10)(*settings_.values()), out):
            return None
        denominator, *axes = out
        return JobRatio(denominator, (axes[0] * denominator + axes[1], axes[2] * denominator + axes[3]))

    return machine, make


@pytest.fixture(scope="module")
def helical() -> tuple[HobbingMachine, Firmware]:
    return firmware("hobbing_helical.toml")


@pytest.fixture(scope="module")
def plewes() -> tuple[HobbingMachine, Firmware]:
    return firmware("hobbing_plewes.toml")


@pytest.fixture(scope="module")
def lathe() -> tuple[HobbingMachine, Firmware]:
    return firmware("lathe_example.toml")


def same(ours: JobRatio, theirs: JobRatio | None, counts_up: int = 1) -> bool:
    """Equal, but for a numerator of the feed that lies between two whole numbers.

    ``counts_up`` is -1 where the sketch turns the counts of the feed round before the firmware sees them.
    """
    if theirs is None:
        return False
    (hob, feed), (other_hob, other_feed) = ours.numerators, theirs.numerators
    return (ours.denominator, hob) == (theirs.denominator, other_hob) and abs(feed - counts_up * other_feed) <= 1


@settings(max_examples=300)
@given(
    teeth=st.integers(6, 999), hundredths=st.integers(1, 6000), left=st.integers(0, 1), size=st.integers(1000, 99_990)
)
def test_two_term_jobs(helical, teeth, hundredths, left, size):
    machine, make = helical
    helix = Helix(hundredths / 100, "left" if left else "right")
    ours, _ = helical_ratio(machine, teeth, 1, size / 10_000, helix)
    assert machine.feed_climbs  # the firmware wants counts that go up in conventional cutting
    assert same(ours, make(teeth=teeth, helix=hundredths, left=left, size=size), counts_up=-1)


@settings(max_examples=300)
@given(
    teeth=st.integers(6, 999),
    hundredths=st.integers(1, 4500),
    left=st.integers(0, 1),
    climb=st.integers(0, 1),
    feed=st.integers(50, 2000),
)
@example(teeth=250, hundredths=1, left=0, climb=1, feed=50)  # nearly 1/64: two convergents lie side by side
@example(teeth=250, hundredths=1, left=1, climb=1, feed=50)
def test_jobs_at_a_fixed_feed(plewes, teeth, hundredths, left, climb, feed):
    machine, make = plewes
    hand, cut = "left" if left else "right", "climb" if climb else "conventional"
    theirs = make(teeth=teeth, helix=hundredths, left=left, climb=climb, feed=feed)
    ours, _ = helical_ratio(machine, teeth, 1, 1.0, Helix(hundredths / 100, hand, cut, Fraction(feed, 1000)))
    if theirs is None:  # a denominator beyond 32 bits, or too many steps per second
        fast = abs(ours.numerators[0]) * machine.max_edge_rate > ours.denominator * machine.max_step_rate
        assert fast or ours.denominator > WIDEST
    else:
        assert same(ours, theirs)


@pytest.mark.parametrize("teeth", [6, 7, 25, 60, 127, 999])
@pytest.mark.parametrize("starts", [1, 2, -1])
def test_spur_jobs(plewes, teeth, starts):
    machine, make = plewes
    if starts < 0:
        machine = machine.model_copy(update={"hob_hand": "left"})
    ours, theirs = one_term(hob_ratio(machine, teeth, abs(starts))), make(teeth=teeth, starts=starts)
    if theirs is None:  # more steps per second at the highest speed than the driver takes
        assert abs(ours.numerators[0]) * machine.max_edge_rate > ours.denominator * machine.max_step_rate
    else:
        assert ours == theirs


@settings(max_examples=200)
@given(thousandths=st.integers(10, 3000), left=st.integers(0, 1))
def test_metric_threads(lathe, thousandths, left):
    machine, make = lathe
    ours = thread_ratio(machine, Fraction(thousandths, 1000), 1, "left" if left else "right")
    assert ours == make(pitch=thousandths, left=left)


@settings(max_examples=200)
@given(hundredths=st.integers(850, 99_999), left=st.integers(0, 1))
def test_inch_threads(lathe, hundredths, left):
    machine, make = lathe
    ours = thread_ratio(machine, Fraction(2540, hundredths), 1, "left" if left else "right")
    assert ours == make(kind=1, pitch=hundredths, left=left)


# --- rational trains ------------------------------------------------------------------------------------------------

TRAINS = {
    # counts and steps per turn, by hand: 4 x 1024 x 20/17, 800 x 2 x 10
    "encoder on other pulleys": ({"lines": '1024\nbelt = "20/17"'}, Fraction(81920, 17), Fraction(16000)),
    "4444.44 counts": ({"lines": '1000\nbelt = "10/9"'}, Fraction(40000, 9), Fraction(16000)),
    "gears 120:127 on the motor": ({"belt": '"127/120"', "worm": "3"}, Fraction(4096), Fraction(2540)),
    "belt 20/17 and worm 90": ({"belt": '"20/17"', "worm": "90"}, Fraction(4096), Fraction(1_440_000, 17)),
    "both": ({"lines": '1000\nbelt = "40/41"', "worm": '"73/7"'}, Fraction(160_000, 41), Fraction(116_800, 7)),
}


@pytest.fixture(scope="module", params=list(TRAINS))
def train(request) -> tuple[HobbingMachine, Firmware]:
    changes, counts, steps = TRAINS[request.param]
    machine, make = firmware("hobbing_plewes.toml", step_rate_hz="50000.0", hob_rpm="300.0", **changes)
    assert (machine.encoder_counts, machine.motor_steps) == (counts, steps)
    return machine, make


def test_spur_jobs_of_rational_trains(train):
    machine, make = train
    cut = 0
    for teeth in (1, 2, 3, 4, 5, 6, 7, 17, 25, 41, 53, 60, 127, 999):
        theirs = make(teeth=teeth)
        exact = machine.motor_steps / (teeth * machine.encoder_counts)  # one turn of the hob turns the table by 1/z
        if theirs is None:
            fast = exact * machine.max_edge_rate * 101 > machine.max_step_rate * 100
            assert fast or exact.denominator * machine.encoder_counts.denominator > WIDEST
            continue
        cut += 1
        assert Fraction(theirs.numerators[0], theirs.denominator) == exact
        assert theirs == one_term(hob_ratio(machine, teeth, 1), machine.encoder_counts.denominator)
        # a turn of the hob is a whole number of 1/D steps
        assert (exact * machine.encoder_counts * theirs.denominator).denominator == 1
    assert cut >= 5


@pytest.mark.parametrize("belt", ["1", '"20/17"'])
def test_helical_jobs_of_rational_trains(belt):
    machine, make = firmware("hobbing_helical.toml", lines=f"1024\nbelt = {belt}", worm='"73/7"', hob_rpm="300.0")
    for teeth, angle in ((30, 2000), (17, 1512), (127, 4500)):
        ours, rounding = helical_ratio(machine, teeth, 1, 1.0, Helix(angle / 100))
        assert same(ours, make(teeth=teeth, helix=angle), counts_up=-1)
        assert rounding.error <= rounding.bound <= 0.01


@pytest.mark.parametrize(("kind", "text", "value"), [(3, "1.5m", 1500), (4, "16dp", 1600), (3, "0.75m", 750)])
def test_worms_by_module_and_diametral_pitch(lathe, kind, text, value):
    machine, make = lathe
    worm = pitch(text)
    length = Fraction(value, 1000) if kind == 3 else Fraction(2540, value)
    assert 0 < float(worm) - math.pi * float(length) < 9e-8 * math.pi * float(length)
    assert thread_ratio(machine, worm, 1, "right") == make(kind=kind, pitch=value)
