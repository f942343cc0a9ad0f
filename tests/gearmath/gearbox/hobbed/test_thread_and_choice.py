"""Threads of a lathe over their length, and parts that reach a class."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from gearmath.errors import ComputationError, InputError
from gearmath.gearbox.helix import Helix
from gearmath.gearbox.hobbed.choice import FEEDS, GASHES, LINES, MICROSTEPS, choose
from gearmath.gearbox.hobbed.setup import cut_and_inspect, setup
from gearmath.gearbox.hobbed.thread import cut_thread
from gearmath.gearbox.job import plan_thread
from gearmath.specs.cutting_errors import CuttingErrors
from gearmath.specs.hobbing import HobbingMachine, find_hobbing_machine

UM = 1e-3


def lathe(**errors: object) -> HobbingMachine:
    return find_hobbing_machine("lathe_example.toml").model_copy(
        update={"errors": CuttingErrors.model_validate(errors)}
    )


@pytest.mark.parametrize("pitch", ["1", "2", "5/4", "127/40", "1/2"])
def test_thread_is_never_off_by_more_than_half_a_step_and_a_count(pitch):
    machine = lathe()
    planned = plan_thread(machine, Fraction(pitch))
    trace = cut_thread(machine, planned, 60.0)
    bound = (planned.step_um / 2 + planned.count_um) * UM
    assert np.abs(trace.deviation).max() <= bound + 1e-12
    assert abs(trace.drift) < 0.1 * bound


def test_error_of_the_lead_screw_comes_back_once_a_turn_of_it_and_none_without_it():
    """15 um on 8 tpi, ideal steps: amplitude and period of 3.175 mm."""
    machine = lathe(feed=[{"amplitude_um": 15.0}], feed_screw_pitch=3.175)
    trace = cut_thread(machine, plan_thread(machine, Fraction(2)), 3.175 * 20, "ideal")
    spectrum = np.abs(np.fft.rfft(trace.deviation[:-1])) * 2 / (len(trace.deviation) - 1)
    assert spectrum.argmax() == 20
    assert spectrum[20] == pytest.approx(0.015, rel=0.001)
    clean = lathe()
    assert cut_thread(clean, plan_thread(clean, Fraction(2)), 50.0, "ideal").total == 0.0


def test_left_hand_thread_is_as_good_and_a_thread_shorter_than_its_lead_is_refused():
    machine = lathe()
    right, left = (cut_thread(machine, plan_thread(machine, Fraction(3), 2, hand), 60.0) for hand in ("right", "left"))
    assert left.total == pytest.approx(right.total, rel=0.2)
    with pytest.raises(InputError, match="at least one lead of 6 mm"):
        cut_thread(machine, plan_thread(machine, Fraction(3), 2), 5.0)


@pytest.mark.parametrize(
    ("name", "wanted", "teeth", "helix"),
    [("hobbing_default.toml", 8, 24, None), ("hobbing_helical.toml", 7, 30, Helix(15.0, "left"))],
)
def test_chosen_parts_reach_the_class_and_no_part_can_be_coarser(name, wanted, teeth, helix):
    machine = find_hobbing_machine(name)
    found = choose(machine, wanted, 1.0, teeth, helix=helix)
    assert found.gear.accuracy_class <= wanted
    parts = found.parts
    for ladder, key in ((MICROSTEPS, "microsteps"), (LINES, "lines"), (GASHES, "gashes"), (FEEDS, "feed")):
        place = ladder.index(getattr(parts, key))
        if not place:
            continue
        coarser = {**vars(parts), key: ladder[place - 1]}
        changed = machine.model_copy(
            update={
                "table": machine.table.model_copy(update={"microsteps": coarser["microsteps"]}),
                "encoder": machine.encoder.model_copy(update={"lines": coarser["lines"]}),
                "hobs": tuple(hob.model_copy(update={"gashes": coarser["gashes"]}) for hob in machine.hobs),
            }
        )
        reached = cut_and_inspect(
            setup(changed, teeth, hob="m1", helix=helix, feed=coarser["feed"]), "exact"
        ).accuracy_class
        assert reached is None or reached > wanted, key


def test_feed_chosen_for_a_helical_gear_is_that_of_its_ratio_where_no_encoder_is_on_the_feed():
    """A machine without that encoder cuts a helical gear at one feed only, which its ratio contains."""
    machine = find_hobbing_machine("hobbing_default.toml")
    found = choose(machine, 8, 1.0, 24, helix=Helix(20.0))
    assert machine.feed is None
    # 0.1 mm a turn of another feed would tilt the teeth by some hundredths over ten modules
    assert abs(found.gear.found.figures["f_H_beta"]) < 2 * UM


def test_class_that_a_bad_worm_forbids_is_not_promised():
    bad = find_hobbing_machine("hobbing_default.toml").model_copy(
        update={"errors": CuttingErrors.model_validate({"worm": [{"amplitude_arcsec": 600.0}]})}
    )
    with pytest.raises(ComputationError, match="class 4 is not reached with the finest parts"):
        choose(bad, 4, 1.0, 12)


def test_gear_that_the_standard_does_not_cover_gets_no_choice():
    with pytest.raises(InputError, match=r"module 0\.3 is outside"):
        choose(find_hobbing_machine("hobbing_default.toml"), 8, 0.3, 24)
