"""Gear sets: load, save, look at the pair in contact, write it for other programs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmath.arguments.call import checked_call
from gearmath.arguments.composed import Each
from gearmath.arguments.kinds import Content, OneOf, Record
from gearmath.arguments.known import ORIGIN
from gearmath.bevel.pair import check_pair, load_pair
from gearmath.errors import about
from gearmath.files import write_text
from gearmath.front.member import Member
from gearmath.front.progress import Begin, silent
from gearmath.shown import Shown, Shows, html_table
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SETTINGS, BevelSet
from gearmath.specs.cut import ANGULAR
from gearmath.specs.toml import find, rechecked

if TYPE_CHECKING:
    from gearmath.bevel.ease_off import Parts
    from gearmath.exchange.step import WrittenSolid
    from gearmath.front.contact import Contact
    from gearmath.front.measured import Measurement


_SPEC = Record("gearmath.specs.bevel_set", "BevelSet", "the checked content of a set file")


@checked_call(spec=_SPEC, source=ORIGIN, remarks=Each(Content(), "must be a list of sentences"))
@dataclass(frozen=True, repr=False)
class GearSet(Shown):
    """A pinion and a gear, or one of them, that are one physical pair; ``spec`` is the checked content of the file.

    ``source`` is the file that it was read from, ``remarks`` what was left aside there.
    """

    spec: BevelSet
    source: Path | None = None
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "spec", rechecked(self.spec, str(self.source or self.spec.title)))

    @property
    def title(self) -> str:
        """What the file says it is."""
        return self.spec.title

    @property
    def pinion(self) -> Member:
        """The pinion. Raises InputError where the set has none."""
        return self.member("pinion")

    @property
    def gear(self) -> Member:
        """The gear. Raises InputError where the set has none."""
        return self.member("gear")

    @checked_call(name=OneOf(MEMBERS))
    def member(self, name: str) -> Member:
        """The member called ``name``, "pinion" or "gear". Raises InputError."""
        return Member(self, name, self.spec.member(name))

    @checked_call
    def with_member(self, member: Member) -> GearSet:
        """The set with this member in place of the one of its name.

        Raises InputError where the two are no pair any more, naming member, flank, key, value and limit.
        """
        return self.with_spec(self.spec.model_copy(update={member.name: member.spec}))

    @checked_call(spec=_SPEC)
    def with_spec(self, spec: BevelSet) -> GearSet:
        """The set of other content, which no file has yet. Raises InputError where it is no pair."""
        made = GearSet(spec)
        check_pair(made.spec)
        return made

    def contact(self, *measured: Measurement | str | Path, **options: Any) -> Contact:
        """How the pair runs at an assembly, on its nominal flanks or on ``measured`` ones of a member or of both.

        ``options``: v, h, j [mm] and shaft, by how much the shaft angle grows [degrees], docs/contact.md; sides, of
        "drive" and "coast"; tolerance, to search V and H at which the pattern reaches an edge. Raises InputError where
        the set has one member only, or a measurement holds no tooth in full.

        >>> import gearmath as gm
        >>> found = gm.load_set("nasa_tp3096_12x36.toml").contact(sides=("drive",))
        >>> found.runs["drive"].outcome
        'reversed parabola'
        """
        from gearmath.front.contact import contact

        return contact(self, *measured, **options)

    @staticmethod
    @checked_call
    def from_rexs(path: str | Path) -> GearSet:
        """The set of the bevel stage in a REXS 2.0.0 file; its remarks say what of the file has no place in a set.

        Raises InputError naming what is missing or no pair.
        """
        from gearmath.exchange.rexs import read_rexs

        pair, left_aside = read_rexs(Path(path))
        with about(Path(path)):
            check_pair(pair)
        return GearSet(pair, remarks=left_aside)

    @checked_call
    def save(self, path: str | Path) -> Path:
        """Write the set as TOML (mm, degrees), in one step. Raises InputError where the place cannot be written."""
        from gearmath.specs.set_text import set_text

        write_text(Path(path), set_text(self.spec))
        return Path(path)

    def to_dict(self) -> dict[str, Any]:
        """The set with the keys of its file, mm and degrees."""
        return self.spec.model_dump(exclude_defaults=True)

    def mates(self) -> dict[str, Any] | None:
        """Backlash [mm] at the mean point, and by the pinion's flank what it and its mate differ by [degrees, um].

        None where the set has one member. Raises InputError where flanks do not meet.
        """
        from gearmath.bevel.mates import pair_figures

        return pair_figures(self.spec, self._ease_off)

    def edge_note(self) -> str:
        """What to say of a pair that runs on edges of its teeth, as a small slip in a file makes it; else empty.

        Raises InputError where flanks do not meet.
        """
        from gearmath.bevel.mates import edge_note

        return edge_note(self._ease_off)

    @cached_property
    def _ease_off(self) -> dict[str, Parts] | None:
        from gearmath.bevel.mates import ease_off_of

        return ease_off_of(self.spec)

    @checked_call
    def to_step(self, path: str | Path, begin: Begin = silent) -> dict[str, WrittenSolid]:
        """Write the pair in mesh, or the only member, as closed solids for CAD; by member, what was written.

        Raises InputError where the kernel of CAD is not installed: pip install '.[cad]'.
        """
        if len(self.spec.members) == 1:
            return self.member(next(iter(self.spec.members))).to_step(path, begin)
        from gearmath.exchange.in_mesh import pair_patches
        from gearmath.exchange.step import require_kernel, write_step

        require_kernel()
        progress = begin(5, "stage")
        bodies = pair_patches(self.spec)
        progress(2)
        return write_step(Path(path), bodies, progress)

    @checked_call
    def to_stl(self, path: str | Path, begin: Begin = silent) -> int:
        """Write the pair in mesh as triangles, touching on the drive side; how many. Of one member: ``tooth().to_stl``.

        Raises InputError where the set has one member.
        """
        from gearmath.bevel.solid import write_stl
        from gearmath.exchange.in_mesh import pair_triangles

        for name in MEMBERS:
            self.spec.member(name)
        progress = begin(2, "stage")
        triangles = pair_triangles(self.spec)
        progress(1)
        write_stl(Path(path), triangles, "pair in mesh")
        progress(1)
        return len(triangles)

    @checked_call
    def to_rexs(self, path: str | Path) -> int:
        """Write the set as REXS 2.0.0; the number of its components."""
        from gearmath.exchange.rexs import write_rexs

        return write_rexs(Path(path), self.spec)

    @checked_call
    def to_summary(self, path: str | Path) -> Path:
        """Write the summary sheet, HTML that prints on A4: blank, settings and cutter build, in mm and inches."""
        from gearmath.setup_sheet.summary import summary_sheet

        write_text(Path(path), summary_sheet(self.spec))
        return Path(path)

    def _shown(self) -> tuple[str, list[Shows]]:
        spec = self.spec
        teeth = " x ".join(str(spec.member(name).teeth) for name in spec.members)
        kinds = ", ".join(dict.fromkeys(spec.member(name).process.replace("_", " ") for name in spec.members))
        return self.title, [("teeth", teeth, ""), ("shaft angle", spec.shaft_angle, "degrees"), ("made by", kinds, "")]

    def _repr_html_(self) -> str:
        flanks = [(name, flank) for name in self.spec.members for flank in FLANKS]
        rows = [
            [
                key,
                "degree" if key in ANGULAR else "1" if key == "ratio_of_roll" else "mm",
                *(getattr(self.spec.member(name).flank(flank), key) for name, flank in flanks),
            ]
            for key in SETTINGS
        ]
        return html_table(self.title, ["setting", "unit", *(f"{name} {flank}" for name, flank in flanks)], rows)


@checked_call
def load_set(path: str | Path) -> GearSet:
    """Read a gear set: a TOML file, or the name of a bundled one. See docs/set_file.md.

    Raises InputError naming file, member, flank, key, value and limit of what is no physical pair.

    >>> import gearmath as gm
    >>> gm.load_set("nasa_tp3096_12x36.toml").pinion.teeth
    12
    """
    source = find(str(path))
    return GearSet(load_pair(source), source)


def set_of(given: GearSet | str | Path) -> GearSet:
    """A gear set, or that of a file."""
    return given if isinstance(given, GearSet) else load_set(given)
