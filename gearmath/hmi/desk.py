"""What lies on the desk of the gear side: run and settings that all pages look at, and what was made of them."""

from __future__ import annotations

import functools
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gearmath.errors import ComputationError, InputError
from gearmath.front.member import Member
from gearmath.front.sets import GearSet, load_set
from gearmath.hmi.catalog import changed_at
from gearmath.hmi.flank_view import FlankView, view_of_run, view_of_settings
from gearmath.hmi.gear_settings import Place, changes, with_edits
from gearmath.hmi.hobbing_job import HobbingWish
from gearmath.hmi.judged_runs import JudgedRuns
from gearmath.hmi.work import Progress, Work

#: What the deviations of a flank are from: of the settings, or of a stored run.
SOURCES = ("settings", "run")


@dataclass
class Kept:
    """The result of one computation for one key; for another key it is computed anew, in a thread."""

    work: Work = field(default_factory=Work)
    key: Hashable = None

    def look(self, key: Hashable, compute: Callable[[Progress], Any]) -> bool:
        """Whether the computation for ``key`` has ended; begins it where it has not begun."""
        if not self.work.running and self.key != key:
            self.key = key
            self.work.start("", compute)
        return self.key == key and not self.work.running

    def has(self, key: Hashable) -> bool:
        """Whether there is a result for this key."""
        return self.key == key and not self.work.running and self.work.result is not None

    def forget(self) -> None:
        """Compute anew, be the key the same."""
        self.key = None


@dataclass
class Desk:
    """One desk for all pages: ``typed`` has the settings that were typed [mm, degrees], ``run`` is the one shown."""

    runs: JudgedRuns
    typed: dict[Place, float] = field(default_factory=dict)
    source: str = SOURCES[0]
    run: int | None = None
    compared: int | None = None
    which: str = "few"
    assembly: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """V, H, J [mm] at which the pair is brought into contact."""
    hobber: str = "hobbing_plewes.toml"
    wish: HobbingWish = field(default_factory=lambda: HobbingWish(teeth=17))
    decisions: int = 0
    """Counts what was decided on corrections."""
    wanted: dict[str, Hashable] = field(default_factory=dict)
    """Computations that begin only when somebody asks, by name: the key that was asked for."""
    kept: dict[str, Kept] = field(default_factory=dict)

    def of(self, name: str) -> Kept:
        """What is kept under a name."""
        return self.kept.setdefault(name, Kept())

    def shown_run(self) -> int | None:
        """The run that is shown: the one chosen, or else the last one that can be judged."""
        if self.run is not None:
            return self.run
        whole = self.runs.of_members()
        return whole[-1].run if whole else None


@dataclass(frozen=True, eq=False)
class Draft:
    """A member with the settings that were typed, as far as they are those of a pair; ``refused`` says why by place.

    ``view`` shows what the settings change of the flanks, or with ``source`` "run" what was measured.
    """

    path: Path
    member: Member
    edited: Member
    accepted: dict[Place, float]
    refused: dict[Place, str]
    view: FlankView | None
    no_view: str


@functools.lru_cache(maxsize=4)
def _loaded(path: Path, changed: int) -> GearSet:
    """A set as its file was when it was ``changed`` [ns]: judging it takes longer than anything that is typed."""
    return load_set(path)


def draft(path: Path, name: str, typed: dict[Place, float], runs: JudgedRuns, run: int | None) -> Draft:
    """The draft of a member of a set file; what was typed is taken together if it can be, else one after the other.

    ``run`` is the run whose deviations are shown, None for those of the settings. Raises InputError for a file that is
    no pair, and for one without this member.
    """
    member = _loaded(path, changed_at(str(path))).member(name)
    typed = changes(member, typed)
    refused: dict[Place, str] = {}
    try:
        accepted, edited = typed, with_edits(member, typed)
    except (InputError, ComputationError) as error:
        accepted, edited = {}, member
        if len(typed) == 1:
            refused, typed = dict.fromkeys(typed, str(error)), {}
        for place, value in typed.items():
            try:
                edited = with_edits(member, {**accepted, place: value})
                accepted = {**accepted, place: value}
            except (InputError, ComputationError) as error:
                refused[place] = str(error)
    view, why = None, ""
    try:
        if run is None:
            view = view_of_settings(edited)
        else:
            evaluated = runs.evaluated(run)
            view = view_of_run(evaluated.found, evaluated.member.teeth)
            why = "" if view is not None else f"run {run}: no tooth was measured in full"
    except (InputError, ComputationError) as error:
        why = str(error)
    return Draft(path, member, edited, accepted, refused, view, why)
