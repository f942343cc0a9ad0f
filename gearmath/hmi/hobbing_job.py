"""A job of the electronic gearbox as an operator asks for it: the plan as lines with units, the firmware as a zip."""

from __future__ import annotations

import io
import math
import re
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from derivations import notation
from gearmath.errors import InputError
from gearmath.export.folder import MANIFEST, manifest
from gearmath.export.teensy import teensy_files
from gearmath.front.hobbing import Job, plan
from gearmath.gearbox.helix import STEEPEST
from gearmath.gearbox.hobbed.classes import FigureClass
from gearmath.gearbox.hobbed.setup import cut_and_inspect, setup
from gearmath.gearbox.job import GearboxJob, ThreadPlan
from gearmath.gearbox.simulation import LAST_START, MOST_EDGES
from gearmath.gearbox.train import GearboxPlan, HobbedBlank
from gearmath.hmi.numbers import Limits
from gearmath.specs.helix import FeedSense, Helix
from gearmath.specs.hobbing import Hand, HobbingMachine

#: Edges of a run of the step rule, and the count of the hob before it.
EDGES, START = Limits(1, MOST_EDGES), Limits(0, LAST_START)
#: A name within the zip: a plain file of the sketch's folder.
_PLAIN = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,62}", re.ASCII)
#: A feed as it is typed: 1.25 or 5/4; no power of ten, which may have more digits than there is memory.
_FEED = re.compile(r"[+-]?(?:\d{1,15}(?:\.\d{0,15}|/0*[1-9]\d{0,14})?|\.\d{1,15})", re.ASCII)
#: The time of every file in the zip: the same firmware is the same file.
_TIME = (1980, 1, 1, 0, 0, 0)


@dataclass(frozen=True)
class HobbingWish:
    """What is to be cut: a gear of ``teeth``, or on a lathe a thread of ``pitch`` ("1.25mm", "8tpi").

    None takes what the machine file says: all hobs, its starts, the highest speed within the limits. Helix [degrees],
    feed [mm per turn of the table], rpm [1/min], shift [modules].
    """

    teeth: int | None = None
    pitch: str | None = None
    starts: int | None = None
    hob: str | None = None
    helix: float = 0.0
    hand: Hand = "right"
    cut: FeedSense = "climb"
    feed: str = ""
    rpm: float | None = None
    shift: float = 0.0


@dataclass(frozen=True)
class PlanLine:
    """One line of a plan: ``key`` names it, ``value`` has its digits; ``percent`` of a limit where it has one."""

    key: str
    value: str
    unit: str
    percent: float | None = None


def limits(machine: HobbingMachine) -> dict[str, Limits]:
    """What the fields of a job on a machine may hold, by their keys, as far as that does not depend on the job."""
    starts = notation.thread_starts if machine.profile == "lathe" else notation.hob_starts
    return {
        "teeth": _counts(notation.teeth.domain),
        "starts": _counts(starts.domain),
        "helix": Limits(0.0, STEEPEST),
        "rpm": Limits(0.0, machine.limits.hob_rpm, above=True),
    }


def rpm_limits(job: GearboxJob) -> Limits:
    """The speeds at which a job keeps the limits of its machine [1/min]."""
    return Limits(0.0, math.floor(100 * job.highest_rpm) / 100, above=True)  # what a field shows of it keeps it


def _counts(domain: tuple[float, float]) -> Limits:
    low, high = domain
    return Limits(int(low), int(high))


def planned(machine: HobbingMachine, wish: HobbingWish) -> Job:
    """The job. Raises InputError naming the limit that it would break."""
    given: dict[str, Any] = {key: getattr(wish, key) for key in ("starts", "rpm") if getattr(wish, key) is not None}
    if machine.profile == "lathe":
        return plan(machine, pitch=(wish.pitch or "").replace(",", "."), hand=wish.hand, **given)
    if wish.hob is not None:
        given["hob"] = wish.hob
    if wish.helix:
        given |= {"helix": wish.helix, "hand": wish.hand, "cut": wish.cut, "feed": _feed(wish.feed)}
    return plan(machine, teeth=wish.teeth, shift=wish.shift, **given)


def predicted(
    machine: HobbingMachine, wish: HobbingWish, progress: Callable[[int], object] = lambda _: None
) -> tuple[tuple[FigureClass, ...], int | None]:
    """The figures of the gear that would be cut, with their classes, and the class of all; the wish's hob or the first.

    Raises InputError as :func:`planned`, and on a lathe, which cuts no gear.
    """
    if machine.profile == "lathe" or wish.teeth is None:
        raise InputError(f"{machine.name}: teeth: only a gear has a class")
    feed = _feed(wish.feed)
    helix = Helix(wish.helix, wish.hand, wish.cut, feed) if wish.helix else None
    given: dict[str, Any] = {} if feed is None else {"feed": float(feed)}
    given |= {key: value for key in ("hob", "starts", "rpm") if (value := getattr(wish, key)) is not None}
    made = setup(machine, wish.teeth, helix=helix, shift=wish.shift, climb=wish.cut == "climb", **given)
    found = cut_and_inspect(made, made.train.rule, progress)
    return tuple(found.classes), found.accuracy_class


def figure_symbol(name: str) -> str:
    """A figure as drawings have it: f_Hα for f_H_alpha."""
    sign, *index = name.split("_")
    return f"{sign}_{''.join({'alpha': 'α', 'beta': 'β'}.get(part, part) for part in index)}"


def plan_lines(job: GearboxJob) -> list[PlanLine]:
    """Ratio, rates against their limits and the motion of the motor."""
    found = [
        PlanLine("ratio", str(job.exact_pulse_ratio), "counts/step"),
        PlanLine("ratio_decimal", f"{job.pulse_ratio:.9g}", "counts/step"),
    ]
    if isinstance(job, ThreadPlan):
        found += [
            PlanLine("pitch", f"{float(job.pitch):.6g}", "mm"),
            PlanLine("lead", f"{float(job.lead):.6g}", "mm"),
            PlanLine("count_way", f"{job.count_um:z.2f}", "µm"),
            PlanLine("step_way", f"{job.step_um:z.2f}", "µm"),
        ]
    if isinstance(job, GearboxPlan) and job.helix is not None:
        found += [
            PlanLine("helix_lead", f"{job.helix.lead:z.4f}", "mm"),
            PlanLine("helix_error", f"{job.helix.error_steps:.1e}", f"steps / {job.helix.travel:g} mm"),
        ]
        if job.helix.feed_mm is None:
            found.append(PlanLine("feed_ratio", f"{job.feed_numerator}/{job.steps_denominator}", "steps/count"))
    return [*found, *_rates(job)]


def blank_lines(blank: HobbedBlank) -> list[PlanLine]:
    """What to turn, set and measure for one hob."""
    found = [
        PlanLine("blank_diameter", f"{blank.blank_diameter:z.4f}", "mm"),
        PlanLine("cut_depth", f"{blank.cut_depth:z.4f}", "mm"),
    ]
    if blank.reaches_axis:
        found.append(PlanLine("reaches_axis", f"{blank.blank_diameter / 2:z.4f}", "mm"))
    elif blank.undercut is not None:
        found.append(PlanLine("undercut_below", f"{blank.undercut.least_teeth:.1f}", "1"))
        found.append(PlanLine("needed_shift", f"{blank.undercut.needed_shift:z.3f}", "m"))
    if blank.swivel is not None:
        found.append(PlanLine("swivel", f"{blank.swivel.swivel:+z.3f}", "°"))
    if blank.span is not None:
        found.append(PlanLine("span", f"{blank.span.length:z.4f}", "mm"))
        found.append(PlanLine("span_teeth", f"{blank.span.teeth}", "1"))
    if blank.chord is not None:
        found.append(PlanLine("chord", f"{blank.chord.thickness:z.4f}", "mm"))
        found.append(PlanLine("chord_height", f"{blank.chord.height:z.4f}", "mm"))
    if blank.over_pins is not None:
        found.append(PlanLine("over_pins", f"{blank.over_pins.length:z.4f}", "mm"))
        found.append(PlanLine("pin", f"{blank.over_pins.pin:.4g}", "mm"))
    found.append(PlanLine("count_way", f"{blank.count_um:z.2f}", "µm"))
    found.append(PlanLine("step_way", f"{blank.step_um:z.2f}", "µm"))
    return found


def firmware_zip(machine: HobbingMachine, sketch: str = "gearbox") -> bytes:
    """The sketch folder of a machine as a zip, with the manifest that a folder written by the command has.

    Raises InputError where the name cannot be a sketch's, or a file would not lie in that folder.
    """
    files = teensy_files(machine, sketch)
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as folder:
        for name, text in {**files, MANIFEST: manifest(files)}.items():
            if _PLAIN.fullmatch(name) is None or ".." in name:
                raise InputError(f"{sketch}/{name}: is no plain name of a file of the sketch")
            folder.writestr(zipfile.ZipInfo(f"{sketch}/{name}", _TIME), text.encode("utf-8"), zipfile.ZIP_DEFLATED)
    return stream.getvalue()


def sketch_name(machine: HobbingMachine) -> str:
    """The name of a machine as that of a sketch."""
    plain = re.sub(r"[^a-z0-9]+", "_", machine.name.lower()).strip("_")[:40]
    return plain or "gearbox"


def _rates(job: GearboxJob) -> Iterator[PlanLine]:
    motion = job.motion
    yield PlanLine("rpm", f"{job.rpm:z.1f}", "1/min", job.hob_rpm_percent)
    yield PlanLine("edge_rate", f"{job.edge_rate_hz:z.0f}", "Hz", job.edge_rate_percent)
    yield PlanLine("step_rate", f"{job.step_rate_hz:z.0f}", "Hz", job.step_rate_percent)
    yield PlanLine("highest_rpm", f"{job.highest_rpm:z.1f}", "1/min")
    yield PlanLine("run_up", f"{motion.run_up_s:z.2f}", "s")
    yield PlanLine("shortest_run_up", f"{motion.shortest_run_up_s:z.2f}", "s")
    if motion.catch_up_s is not None:
        yield PlanLine("catch_up", f"{motion.catch_up_s:z.2f}", "s")
    yield PlanLine("engage_rpm", f"{motion.engage_rpm:z.0f}", "1/min")


def _feed(typed: str) -> Fraction | None:
    if not typed.strip():
        return None
    plain = typed.strip().replace(",", ".")
    if _FEED.fullmatch(plain) is None:
        raise InputError(f"feed = {plain[:30]!r}: must be a number of mm per turn of the table")
    return Fraction(plain)
