"""Every number field of every page offers what the library accepts and nothing beyond: both are tried at the limits."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from nicegui import ui
from pydantic import ValidationError

from gearmath.errors import InputError
from gearmath.front.contact import contact
from gearmath.front.hobbing import Job, plan
from gearmath.front.machines import Machine, load_hobber, load_machine, load_probe
from gearmath.front.probing import probing
from gearmath.front.sets import load_set
from gearmath.hmi.hobbing_job import HobbingWish, planned
from gearmath.hmi.messages import Text
from gearmath.hmi.number_field import NumberField
from gearmath.hmi.numbers import Limits
from gearmath.hmi.shell import PAGES
from gearmath.hmi.state import Choice, Shared
from gearmath.machine.planning.cut_plan import CuttingJob, cutting_plan
from gearmath.machine.planning.limits import check_spindle_speed
from gearmath.specs.bevel_set import FLANKS, SETTINGS
from gearmath.specs.cut import Settings
from gearmath.specs.toml import find
from tests.gearmath.hmi.built import Built, build  # noqa: F401

TEXT = Text("en")
Accepts = Callable[[Any], object]
#: By how much a number passes a limit that is none of a count.
BEYOND = 0.01
HOBBED = Choice("crown_gear_hobbed_14x39.toml", "pinion", "vertical_5axis_counting.toml")


class _BegunError(Exception):
    """What was asked for was accepted: only the long part is left."""


def _is_accepted(accepts: Accepts, value: float) -> bool:
    try:
        accepts(value)
    except _BegunError:
        return True
    except (InputError, ValidationError):
        return False
    return True


def _around(limits: Limits, whole: bool) -> list[float]:
    """Numbers at both limits, and just beyond and within them."""
    step = 1 if whole else BEYOND
    return [one + k * step for one in (limits.low, limits.high) for k in (-1, 0, 1)]


def _is_offered(one: NumberField, value: float) -> bool:
    one.field.value = f"{value}" if isinstance(value, int) else f"{value:.9f}"
    return not one.is_refused


def _is_one_truth(page: Built, accepts: dict[str, Accepts]) -> None:
    """What every field offers is what the library accepts; no field is left out."""
    assert set(page.fields) == set(accepts)
    with page.client:
        for label, one in page.fields.items():
            for value in _around(one.limits, isinstance(one.limits.high, int)):
                assert _is_offered(one, value) == _is_accepted(accepts[label], value), f"{label} = {value}"


def _cutting(choice: Choice, dry_run: bool = False) -> dict[str, Accepts]:
    member, machine = load_set(choice.gear_set).member(choice.member), load_machine(choice.machine)

    def job(**asked: Any) -> None:
        wanted = CuttingJob(**{"spaces": range(member.teeth), "tolerance": 0.1, "dry_run": dry_run, **asked})
        check_spindle_speed("CUT", machine.spec, wanted.spindle_rpm)
        cutting_plan(member.gear_set.spec, member.name, machine.spec, wanted)

    return {
        TEXT("programs.feed"): lambda feed: job(feed=feed),
        TEXT("programs.spindle_rpm"): lambda rpm: job(spindle_rpm=rpm),
        TEXT("programs.tolerance"): lambda um: job(tolerance=um / 1000),
        TEXT("programs.roughing_stock"): lambda stock: job(roughing_stock=stock),
        TEXT("programs.finishing_stock"): lambda stock: job(finishing_stock=stock),
    }


def _probing(choice: Choice) -> dict[str, Accepts]:
    member, spec = load_set(choice.gear_set).member(choice.member), load_machine(choice.machine).spec
    # how long a result file may be is a limit of all touches together, not of one field
    machine = Machine(spec.model_copy(update={"control": spec.control.model_copy(update={"result_file_kB": 10_000})}))

    def begun(steps: int, unit: str) -> Any:
        raise _BegunError

    def program(teeth: int, repeat: int) -> None:
        if teeth < 0:
            raise InputError("a range of teeth cannot be negative")
        probing(member, machine, load_probe(choice.calibration), "PROBE", range(teeth), repeat=repeat, begin=begun)

    return {
        TEXT("programs.teeth"): lambda teeth: program(teeth, 1),
        TEXT("programs.repeat"): lambda repeat: program(1, repeat),
    }


@pytest.mark.parametrize(("choice", "dry_run"), [(Choice(), False), (Choice(), True), (HOBBED, False)])
def test_programs(build: Callable[..., Built], tmp_path: Path, choice: Choice, dry_run: bool) -> None:  # noqa: F811
    page = build(Shared(tmp_path / "runs.db", choice), "programs")
    boxes = {one.text: one for one in page.client.elements.values() if isinstance(one, ui.checkbox)}
    boxes[TEXT("programs.dry_run")].value = dry_run
    page.look()
    _is_one_truth(page, _cutting(choice, dry_run) | _probing(choice))


def test_limits_follow_the_choice(build: Callable[..., Built], tmp_path: Path) -> None:  # noqa: F811
    """The machine of an operator, with less of everything."""
    shared = Shared(tmp_path / "runs.db")
    page, machine = build(shared, "programs"), tmp_path / "small.toml"
    text = find(shared.choice.machine).read_text("utf-8")
    for key, value in (("max_feed_per_min", "900.0"), ("spindle_speed_rpm", "[50.0, 400.0]")):
        text, found = re.subn(rf"^{key} = \S+(?: \S+\])?", f"{key} = {value}", text, flags=re.MULTILINE)
        assert found == 1
    machine.write_text(text, "utf-8")
    shared.choose(machine=str(machine), member="gear")
    page.look()
    fields = page.fields
    assert fields[TEXT("programs.feed")].limits.high == 900.0
    assert fields[TEXT("programs.spindle_rpm")].limits == Limits(50.0, 400.0)
    assert fields[TEXT("programs.teeth")].limits.high == 36
    _is_one_truth(page, _cutting(shared.choice) | _probing(shared.choice))


def test_gear(build: Callable[..., Built], tmp_path: Path) -> None:  # noqa: F811
    pair = load_set(Choice().gear_set)
    accepts: dict[str, Accepts] = {
        TEXT(f"gear.{name}"): lambda mm, name=name: contact(pair, sides=("drive",), **{name: mm}) for name in "vhj"
    }
    for flank in FLANKS:
        spec = pair.pinion.spec.flank(flank)
        values = {key: getattr(spec, key) for key in SETTINGS}
        for key in SETTINGS:
            label = f"{TEXT(f'gear.{key}')}, {TEXT(f'blocks.{flank}')}"
            accepts[label] = lambda value, key=key, values=values: Settings(**{**values, key: value})
    _is_one_truth(build(Shared(tmp_path / "runs.db"), "gear"), accepts)


@pytest.mark.parametrize(
    ("name", "wish"),
    [
        ("hobbing_plewes.toml", HobbingWish(teeth=17)),
        ("hobbing_metric.toml", HobbingWish(teeth=5, starts=2)),  # so few that the motor binds, and not the hob
        ("lathe_example.toml", HobbingWish(pitch="1.25mm")),
    ],
)
def test_gearbox(build: Callable[..., Built], tmp_path: Path, name: str, wish: HobbingWish) -> None:  # noqa: F811
    shared, machine = Shared(tmp_path / "runs.db"), load_hobber(name)
    shared.desk.hobber, shared.desk.wish = name, wish
    run: Job = planned(machine, wish)
    hob = machine.hobs[0].name if machine.hobs else None

    def job(**asked: Any) -> None:
        given = {"starts": wish.starts, **asked}
        own = {"pitch": wish.pitch} if machine.profile == "lathe" else {"teeth": wish.teeth}
        plan(machine, **{**own, **{key: value for key, value in given.items() if value is not None}})

    def helix(angle: float) -> None:
        if angle:  # 0 is none
            planned(machine, HobbingWish(teeth=wish.teeth, hob=hob, helix=angle, feed="1"))

    def teeth(count: int) -> None:
        """Any the train has a name for; whether it can be cut with this one is said by the plan."""
        try:
            plan(machine, teeth=count)
        except InputError as error:
            if re.match(r"teeth = -?\d+: must lie", str(error)):
                raise

    accepts: dict[str, Accepts] = {
        TEXT("gearbox.starts"): lambda starts: job(starts=starts),
        TEXT("gearbox.rpm"): lambda rpm: job(rpm=rpm),
        TEXT("gearbox.edges"): lambda edges: _simulated(run, edges=edges),
        TEXT("gearbox.start"): lambda start: _simulated(run, edges=1, start=start),
    }
    if machine.profile == "hobbing":
        accepts |= {TEXT("gearbox.teeth"): teeth, TEXT("gearbox.helix"): helix}
    page = build(shared, "gearbox")
    if name == "hobbing_metric.toml":
        assert page.fields[TEXT("gearbox.rpm")].limits.high < machine.limits.hob_rpm
    _is_one_truth(page, accepts)


def _simulated(run: Job, **asked: int) -> None:
    def told(edges: int) -> None:
        raise _BegunError

    run.simulate(**asked, progress=told)


def test_other_pages_have_no_field_of_a_number(build: Callable[..., Built], tmp_path: Path) -> None:  # noqa: F811
    for name in PAGES.keys() - {"programs", "gear", "gearbox"}:
        assert build(Shared(tmp_path / "runs.db"), name).fields == {}
