"""The other way round: the coarsest parts with which a gear still reaches a class, each tried in the virtual cut."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from fractions import Fraction
from typing import Any

from gearmath.errors import ComputationError, InputError
from gearmath.gearbox.helix import Helix
from gearmath.gearbox.hobbed.classes import COARSEST, FINEST, NOT_CONFIRMED, outside
from gearmath.gearbox.hobbed.setup import CutSetup, VirtualGear, blame, cut_and_inspect, ridges, setup
from gearmath.shown import Shown, Shows
from gearmath.specs.cutting_errors import CuttingErrors
from gearmath.specs.hob import Hob
from gearmath.specs.hobbing import HobbingMachine

#: What can be bought or set, from coarse to fine: microsteps, lines of the encoder, gashes, feeds [mm a turn].
MICROSTEPS = (1, 2, 4, 8, 16, 32, 64, 128, 256)
LINES = (100, 200, 360, 500, 600, 1000, 1024, 2000, 2048, 2500, 3600, 5000)
GASHES = (8, 9, 10, 12, 14, 16, 18, 20, 24)
FEEDS = (2.0, 1.5, 1.0, 0.75, 0.5, 0.4, 0.3, 0.2, 0.15, 0.1, 0.05)
LADDERS: tuple[tuple[float, ...], ...] = (MICROSTEPS, LINES, GASHES, FEEDS)

#: Feed whose marks are far below what the finest class allows.
FINE_FEED = 0.2
#: Cuts of a search at most: every step down all ladders, and back.
MOST_CUTS = 2 * sum(map(len, LADDERS))


@dataclass(frozen=True)
class ChosenParts:
    """Parts and feed [mm per turn of the table]."""

    microsteps: int
    lines: int
    gashes: int
    feed: float


@dataclass(frozen=True, repr=False)
class Choice(Shown):
    """Parts that reach a class, the gear that they cut, and the highest speed of the hob with them [1/min]."""

    wanted: int
    parts: ChosenParts
    gear: VirtualGear
    rpm: float
    tried: int

    def as_dict(self) -> dict[str, Any]:
        """In plain numbers by name, as ``gearmath gearbox choose --json`` prints it; figures in µm."""
        return {
            "class": self.wanted,
            **asdict(self.parts),
            "rpm": self.rpm,
            "cuts": self.tried,
            "reached": self.gear.accuracy_class,
            "figures": [asdict(row) for row in self.gear.classes],
            "tolerances": NOT_CONFIRMED,
        }

    def _shown(self) -> tuple[str, list[Shows]]:
        parts = self.parts
        return f"parts for class {self.wanted}", [
            ("microsteps", parts.microsteps, ""),
            ("encoder lines", parts.lines, ""),
            ("gashes", parts.gashes, ""),
            ("feed", parts.feed, "mm per turn of the table"),
            ("highest speed", self.rpm, "rpm"),
            ("class reached", self.gear.accuracy_class, ""),
            ("cuts tried", self.tried, ""),
        ]


@dataclass(frozen=True)
class _Wish:
    """The gear that is wanted, and the machine it is cut on."""

    machine: HobbingMachine
    module: float
    teeth: int
    face_width: float | None
    helix: Helix | None

    def with_parts(self, parts: ChosenParts) -> CutSetup:
        """What is cut with these parts; without an encoder on the feed, the ratio of a helical gear is that feed's."""
        machine = self.machine
        assert machine.table is not None
        known = next((hob for hob in machine.hobs if abs(hob.module_mm - self.module) < 1e-9), None)
        hob = known or Hob(module=self.module, depth_rule="2.25m")
        changed = machine.model_copy(
            update={
                "table": machine.table.model_copy(update={"microsteps": parts.microsteps}),
                "encoder": machine.encoder.model_copy(update={"lines": parts.lines}),
                "hobs": (hob.model_copy(update={"gashes": parts.gashes}),),
            }
        )
        helix = self.helix
        if helix is not None and machine.feed is None:
            helix = replace(helix, feed=Fraction(str(parts.feed)))
        return setup(changed, self.teeth, helix=helix, feed=parts.feed, face_width=self.face_width)


def choose(
    machine: HobbingMachine,
    wanted: int,
    module: float,
    teeth: int,
    face_width: float | None = None,
    helix: Helix | None = None,
    progress: Callable[[int], object] = lambda done: None,
) -> Choice:
    """The coarsest microsteps, lines, gashes and feed with which a gear reaches the class ``wanted``.

    From the coarsest on, the part that is most to blame is refined until the cut gear reaches the class; then each is
    made coarser again as long as it still does. The rest of the machine, its errors too, is that of the file.
    Raises InputError where no class can be given, ComputationError where the finest parts do not reach it.
    """
    if not FINEST <= wanted <= COARSEST:
        raise InputError(f"class = {wanted}: must lie between {FINEST} and {COARSEST}")
    if machine.table is None or machine.table.microsteps is None:
        raise InputError(f"{machine.name}: only a hobbing machine with a step motor has microsteps to choose")
    places, tried = [0, 0, 0, 0], 0
    wish = _Wish(machine, module, teeth, face_width, helix)

    def reached(at: list[int]) -> tuple[CutSetup, VirtualGear]:
        nonlocal tried
        tried += 1
        prepared = wish.with_parts(_parts(at))
        gear = cut_and_inspect(prepared, "exact")
        progress(1)
        return prepared, gear

    prepared, gear = reached(places)
    why = outside(prepared.job)
    if why is not None:
        raise InputError(f"no class: {why}")
    if machine.errors != CuttingErrors():  # they stay, however fine the parts are
        finest = [*(len(ladder) - 1 for ladder in LADDERS[:3]), FEEDS.index(FINE_FEED)]
        if not _is(reached(finest)[1], wanted):
            raise ComputationError(
                f"class {wanted} is not reached with the finest parts: the errors of {machine.name} forbid it"
            )
    while not _is(gear, wanted):
        part = _to_refine(prepared, gear, places)
        if part is None:
            raise ComputationError(f"class {wanted} is not reached with the finest parts, {_parts(places)}")
        places[part] += 1
        prepared, gear = reached(places)
    for part in range(len(LADDERS)):
        while places[part] > 0:
            coarser = [place - (k == part) for k, place in enumerate(places)]
            other, less = reached(coarser)
            if not _is(less, wanted):
                break
            places, prepared, gear = coarser, other, less
    return Choice(wanted, _parts(places), gear, prepared.train.rpm, tried)


def _is(gear: VirtualGear, wanted: int) -> bool:
    return gear.accuracy_class is not None and gear.accuracy_class <= wanted


def _parts(places: list[int]) -> ChosenParts:
    microsteps, lines, gashes, feed = (ladder[place] for ladder, place in zip(LADDERS, places, strict=True))
    return ChosenParts(int(microsteps), int(lines), int(gashes), feed)


def _to_refine(prepared: CutSetup, gear: VirtualGear, places: list[int]) -> int | None:
    """Which part is most to blame, and can be had finer: microsteps, lines, gashes or feed."""
    shares = {share.source: share for share in blame(prepared, gear)}
    steps, cuts = shares["steps"], shares["gashes"]
    count = prepared.train.ratio.numerators[0] / prepared.train.ratio.denominator  # motor steps a count
    flat, mark = ridges(prepared.job)
    by_steps = max(steps.profile_percent, steps.helix_percent, steps.pitch_percent)
    order = [0, 1] if abs(count) < 1 else [1, 0]
    by_cut = [2, 3] if flat > mark else [3, 2]
    failing = max(cuts.profile_percent, cuts.helix_percent, cuts.pitch_percent)
    wishes = order + by_cut if by_steps >= failing else by_cut + order
    return next((part for part in wishes if places[part] + 1 < len(LADDERS[part])), None)
