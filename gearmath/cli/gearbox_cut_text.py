"""What ``gearmath gearbox cut`` prints for people."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from gearmath.cli.common import table
from gearmath.gearbox.hobbed.choice import Choice
from gearmath.gearbox.hobbed.classes import NOT_CONFIRMED, outside
from gearmath.gearbox.hobbed.contributions import Contribution
from gearmath.gearbox.hobbed.setup import CutSetup, VirtualGear, ridges
from gearmath.gearbox.hobbed.thread import ThreadTrace
from gearmath.gearbox.job import ThreadPlan

#: Shares below this are not printed [percent].
_LEAST_SHARE = 0.5


@dataclass(frozen=True)
class Columns:
    """A table between the lines."""

    head: Sequence[str]
    rows: Sequence[Sequence[str]]


Part = str | Columns


def as_text(parts: Iterable[Part]) -> str:
    """Lines and tables as a terminal shows them."""
    return "\n".join(part if isinstance(part, str) else table(part.head, part.rows) for part in parts)


def cut_parts(cut: CutSetup, gears: Sequence[VirtualGear], shares: Sequence[Contribution]) -> list[Part]:
    """What was cut, the figures with their classes, and which part is to blame."""
    return [*_head(cut), *_figures(cut, gears), *_thickness(gears), *_shares(shares)]


def _head(cut: CutSetup) -> Iterator[str]:
    job, hob = cut.job, cut.job.hob
    hand = "" if not job.gear.beta else f", {'right' if job.helix_sign > 0 else 'left'}-hand helix"
    yield f"{cut.train.machine.name}: {job.gear.teeth} teeth, module {job.gear.module:.4g} mm{hand}"
    assumed = " (assumed: the file has no diameter)" if cut.assumed_diameter else ""
    yield (
        f"  hob {cut.hob_name}: {hob.starts} start{'s' * (hob.starts > 1)}, {hob.gashes} gashes, "
        f"{hob.diameter:g} mm{assumed}"
    )
    way = "climb" if job.climb else "conventional"
    feed = f"feed {job.feed:g} mm per turn of the table, {way}"
    yield f"  face width {job.face_width:g} mm, {feed}, {cut.train.rpm:.0f} rpm"
    shifted = "more of it lets it be shifted"
    if cut.offsets is not None:
        shifted = f"it may be shifted from {cut.offsets[0]:.1f} to {cut.offsets[1]:.1f} mm"
    yield f"  {cut.hob_length:.1f} mm of the hob's length cut the flanks; {shifted}"
    flat, mark = ridges(job)
    yield f"  ridges by themselves: generating flats {flat * 1000:.2f} um, feed marks {mark * 1000:.2f} um"


def _figures(cut: CutSetup, gears: Sequence[VirtualGear]) -> Iterator[Part]:
    yield ""
    head = ["figure"]
    for gear in gears:
        head += [f"{gear.rule} / um", "class"]
    rows = []
    for k, row in enumerate(gears[0].classes):
        cells = [row.figure]
        for gear in gears:
            one = gear.classes[k]
            cells += [f"{one.value_um:.2f}", "-" if one.accuracy_class is None else str(one.accuracy_class)]
        rows.append(cells)
    yield Columns(head, rows)
    why = outside(cut.job)
    for gear in gears:
        reached = gear.accuracy_class
        if why is not None:
            yield f"no class: {why}"
            break
        words = "coarser than class 11" if reached is None else f"class {reached}"
        yield f"{gear.rule} rule: {words} of ISO 1328-1:2013"
    yield f"  {NOT_CONFIRMED}"


def _thickness(gears: Sequence[VirtualGear]) -> Iterator[str]:
    for gear in gears:
        for each in gear.found.thicknesses:
            yield (
                f"  {gear.rule}: {each.what} {each.mean:.4f} mm, {(each.mean - each.nominal) * 1000:+.1f} um off the "
                f"plan, range {each.range * 1000:.1f} um"
            )


def _shares(shares: Sequence[Contribution]) -> Iterator[Part]:
    if not shares:
        return
    yield ""
    yield "to blame, percent of the squares:"
    rows = [
        [share.words, *(f"{value:.0f}" for value in (share.profile_percent, share.helix_percent, share.pitch_percent))]
        for share in shares
        if max(share.profile_percent, share.helix_percent, share.pitch_percent) >= _LEAST_SHARE
    ]
    yield Columns(["source", "profile", "helix", "pitch"], rows)
    yield f"change first: {shares[0].change}"


def thread_parts(planned: ThreadPlan, traces: Sequence[ThreadTrace]) -> list[Part]:
    """Pitch error of a thread over its length, by rule."""
    rows = [
        [trace.rule, *(f"{value * 1000:.2f}" for value in (trace.single_lead, trace.total, trace.drift))]
        for trace in traces
    ]
    length = traces[0].place[-1]
    head = f"{planned.machine}: pitch {float(planned.pitch):.6g} mm, {length:g} mm long, {planned.rpm:.0f} rpm"
    return [head, Columns(["rule", "one lead / um", "whole length / um", "drift / um"], rows)]


def choice_text(found: Choice) -> str:
    """The parts, and the figures of the gear that they cut."""
    parts = found.parts
    rows = [
        [row.figure, f"{row.value_um:.2f}", "-" if row.accuracy_class is None else str(row.accuracy_class)]
        for row in found.gear.classes
    ]
    return "\n".join(
        [
            f"class {found.wanted} of ISO 1328-1:2013 is reached with",
            f"  {parts.microsteps} microsteps, an encoder of {parts.lines} lines, a hob of {parts.gashes} gashes,",
            f"  a feed of {parts.feed:g} mm per turn of the table, up to {found.rpm:.0f} rpm",
            table(["figure", "um", "class"], rows),
            f"  {NOT_CONFIRMED}",
        ]
    )
