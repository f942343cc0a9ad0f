"""Programs: written from what the fields ask for; those that were written are in :mod:`gearmath.hmi.program_list`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from nicegui import ui

from gearmath.errors import InputError
from gearmath.hmi import acting, blocks, program_list, programs_work, widgets
from gearmath.hmi.messages import Text
from gearmath.hmi.number_field import NumberField, numbers
from gearmath.hmi.numbers import Limits
from gearmath.hmi.programs_work import WrittenProgram
from gearmath.hmi.state import Choice, Shared
from gearmath.hmi.words import duration
from gearmath.hmi.work import Progress
from gearmath.machine.measuring.checked import ProbingChoice
from gearmath.machine.planning.cut_plan import DEFAULT_FEED, DEFAULT_SPINDLE_RPM, CuttingJob
from gearmath.machine.planning.path import DEFAULT_TOLERANCE

#: What the fields ask for: a cutting job, or what is probed.
Asked = TypeVar("Asked", CuttingJob, ProbingChoice)

#: The computations of this page.
_CUT, _PROBE = "programs.cut", "programs.probe"
#: The fields of a cutting program: key, value at first, unit.
_OF_CUT = (
    ("feed", DEFAULT_FEED, "mm/min"),
    ("spindle_rpm", DEFAULT_SPINDLE_RPM, "1/min"),
    ("tolerance", 1000 * DEFAULT_TOLERANCE, "µm"),
    ("roughing_stock", 0.0, "mm"),
    ("finishing_stock", 0.0, "mm"),
)


def build(shared: Shared, text: Text) -> None:
    """The content of the page."""
    _cutting(shared, text)
    _probing(shared, text)
    program_list.show(shared, text)


def _head(shared: Shared, text: Text, kind: str) -> ui.input:
    """What the program is for, and the field of its name; both follow the choice, wherever it is changed."""
    seen = [shared.choice]
    about = widgets.note("")
    name = widgets.word(text("programs.name"), f"{kind}_{seen[0].member.upper()}", text("programs.name_hint"))

    def look() -> None:
        now, before = shared.choice, seen[0]
        if now != before and name.value == f"{kind}_{before.member.upper()}":
            name.value = f"{kind}_{now.member.upper()}"
        seen[0] = now
        member = blocks.member_name(text, now.member)
        about.text = text("programs.chosen", gear_set=now.gear_set, member=member, machine=now.machine)

    acting.watch(text, look)
    return name


def _cutting(shared: Shared, text: Text) -> None:
    first = _first_limits(shared.choice)
    with widgets.panel(text("programs.cut")):
        name = _head(shared, text, "CUT")
        with widgets.fields():
            fields = {
                key: NumberField(text, text(f"programs.{key}"), value, unit, first[key]) for key, value, unit in _OF_CUT
            }
        dry = ui.checkbox(text("programs.dry_run"))
        _limited(shared, text, fields, dry)

        def job() -> CuttingJob:
            values = numbers(fields)
            return CuttingJob(
                tolerance=values["tolerance"] / 1000,
                feed=values["feed"],
                spindle_rpm=values["spindle_rpm"],
                roughing_stock=values["roughing_stock"],
                finishing_stock=values["finishing_stock"],
                dry_run=bool(dry.value),
            )

        label = text("programs.generate_cut"), "description"
        _writing(shared, text, _CUT, label, name, job, programs_work.write_cutting)


def _probing(shared: Shared, text: Text) -> None:
    first = _first_limits(shared.choice)
    with widgets.panel(text("programs.probe")):
        name = _head(shared, text, "PROBE")
        with widgets.fields():
            fields = {
                key: NumberField(text, text(f"programs.{key}"), 1, "", first[key], digits=0)
                for key in ("teeth", "repeat")
            }
        _limited(shared, text, fields)
        pitch = ui.checkbox(text("programs.pitch"), value=True)
        around = ui.checkbox(text("programs.registration"), value=True)

        def chosen() -> ProbingChoice:
            values = numbers(fields)
            return ProbingChoice(
                tuple(range(int(values["teeth"]))), bool(pitch.value), bool(around.value), int(values["repeat"])
            )

        label = text("programs.generate_probe"), "my_location"
        _writing(shared, text, _PROBE, label, name, chosen, programs_work.write_probing)


def _first_limits(choice: Choice) -> dict[str, Limits]:
    """Those of the choice; where a file of it is refused, which is said beside the fields, of the bundled ones."""
    try:
        return programs_work.limits(choice, False)
    except InputError:
        return programs_work.limits(Choice(), False)


def _limited(shared: Shared, text: Text, fields: Mapping[str, NumberField], dry: ui.checkbox | None = None) -> None:
    """The limits of the fields follow the choice, wherever it is changed, and whether air is cut."""

    def look() -> None:
        now = programs_work.limits(shared.choice, dry is not None and bool(dry.value))
        for key, one in fields.items():
            one.limit(now[key])

    acting.watch(text, look)


def _writing(
    shared: Shared,
    text: Text,
    kind: str,
    label: tuple[str, str],
    name: ui.input,
    asked: Callable[[], Asked],
    write: Callable[[Path, Choice, str, Asked, Progress], WrittenProgram],
) -> None:
    """The button that reads the fields and starts to write the program they ask for, its progress and the verdict."""
    work = shared.works[kind]
    button = widgets.button(label[0], lambda: start(), label[1], primary=True)
    said = widgets.Message()

    def start() -> None:
        wanted, what, choice = name.value or "", asked(), shared.choice
        work.start(
            wanted, lambda progress: write(shared.folder, choice, wanted, what, progress), (choice, wanted, what)
        )
        button.enabled = False  # the second click of a double one is none

    def is_current() -> bool:
        try:
            return work.asked == (shared.choice, name.value or "", asked())
        except InputError:  # what stands in the fields is refused
            return False

    def ended() -> None:
        found = work.result
        if not isinstance(found, WrittenProgram):
            said.show("")
            return
        words = _verdict(text, found)
        if is_current():
            said.show(words, "good")
        else:
            said.show(text("shell.outdated", words=words))

    def look() -> None:
        button.enabled = not work.running

    widgets.progress(text, work, lambda: text("programs.writing", name=work.name), ended, is_current)
    acting.watch(text, look)


def _verdict(text: Text, found: WrittenProgram) -> str:
    values: dict[str, Any] = {"name": found.file.name, "blocks": found.blocks}
    if found.touches is None:
        return text("programs.written_cut", **values, time=duration(text, found.seconds or 0.0))
    values |= {"touches": found.touches, "clearance": text.quoted(found.verdict)}
    return text("programs.written_probe", **values)
