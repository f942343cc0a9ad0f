"""``gearmath design --reverse``: settings out of the points of a member, and what they leave of them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gearmath.cli.common import bars, echo_json, table
from gearmath.errors import counted

if TYPE_CHECKING:
    from gearmath.bevel.design.reverse import ReversedFlank

#: The bound of the root in words: points of a flank do not tell how deep the blade went.
_ROOT = "root line (0.2 of the clearance from the blank's)"


def reverse_design(points: Path, data: str, target: Path, sheet: Path | None, as_json: bool) -> None:
    """Find the settings of the member of a flank file, write them as a set, and print how well they do."""
    from gearmath.front.design import settings_of
    from gearmath.front.sets import load_set

    with bars(quiet=as_json) as begin:
        made = settings_of(points, data, begin)
    made.gear_set.save(target)
    if sheet is not None:
        load_set(target).to_summary(sheet)  # of the file, with the digits that it keeps and so its digest
    figures = made.to_dict()
    if as_json:
        echo_json({"set": str(target), **figures})
        return
    how = ", ".join(figures[key] for key in ("member", "cutting", "process", "generation"))
    click.echo(f"{made.title}: {how}")
    for name, flank in made.found.flanks.items():
        click.echo("\n" + _text(name, figures[name], flank))
    for note in figures["notes"]:
        click.echo(f"\n{note}")
    click.echo(f"\n{target}: written")
    if sheet is not None:
        click.echo(f"{sheet}: summary sheet, prints on A4")


def _text(name: str, found: dict[str, Any], flank: ReversedFlank) -> str:
    """The figures of a flank for people, and whether anything is left that is no scatter."""
    worst = found["largest"]
    rows = [
        ["deviation of the crown gear that it starts from", f"{found['rms_before_um']:.3g} um RMS"],
        ["deviation of the settings found", f"{found['rms_um']:.3g} um RMS"],
        ["scatter of the points about a smooth flank", f"{found['scatter_um']:.3g} um RMS"],
        ["largest deviation", f"{worst['deviation_um']:+.3g} um at row {worst['row']}, col {worst['col']}"],
        ["fitted", ", ".join(found["fitted"])],
    ]
    left = "all but the scatter of its points is reproduced"
    if flank.not_reproduced > flank.scatter:
        bounds = [_ROOT if name == "root line" else name for name in found["bounds_reached"]]
        rows.append(["bounds reached", ", ".join(bounds) or "none"])
        left = f"{found['not_reproduced_um']:.3g} um RMS of its form are not reproduced"
    return f"{name} flank, {counted(found['points'], 'point')}: {left}\n" + table(["figure", "value"], rows)
