"""``gearmath design --reverse``: settings out of the points of a member, and what they leave of them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gearmath.cli.common import about, bar, echo_json, table
from gearmath.errors import counted

if TYPE_CHECKING:
    from gearmath.bevel.design.reverse import ReversedFlank


def reverse_design(points: Path, data: Path, target: Path, sheet: Path | None, as_json: bool) -> None:
    """Find the settings of the member of a flank file, write them as a set, and print how well they do."""
    from gearmath.bevel.design.reverse_route import load_known, reversed_set
    from gearmath.files import write_text
    from gearmath.setup_sheet.summary import summary_sheet
    from gearmath.specs.flank_csv import read_flank_csv
    from gearmath.specs.set_text import set_text

    known = load_known(data)
    file = read_flank_csv(points)
    with bar(1, "member", quiet=as_json) as done, about(points):
        found, how_well = reversed_set(known, file, f"settings found from the points of {points.name}")
        done(1)
    write_text(target, set_text(found))
    if sheet is not None:
        write_text(sheet, summary_sheet(found))
    member = how_well.member
    figures: dict[str, Any] = {
        "set": str(target),
        "member": file.member,
        "cutting": member.cutting,
        "process": member.process,
        "generation": member.generation,
        **{name: _figures(flank) for name, flank in how_well.flanks.items()},
    }
    if as_json:
        echo_json(figures)
        return
    click.echo(f"{known.title}: {file.member}, {member.cutting}, {member.process}, {member.generation}")
    for name, flank in how_well.flanks.items():
        click.echo("\n" + _text(name, figures[name], flank))
    click.echo(f"\n{target}: written")
    if sheet is not None:
        click.echo(f"{sheet}: summary sheet, prints on A4")


def _figures(flank: ReversedFlank) -> dict[str, Any]:
    worst = flank.largest
    return {
        "points": len(flank.after),
        "rms_before_um": 1000 * flank.rms_before,
        "rms_um": 1000 * flank.rms,
        "scatter_um": 1000 * flank.scatter,
        "not_reproduced_um": 1000 * flank.not_reproduced,
        "largest": {
            "deviation_um": 1000 * float(flank.after[worst]),
            "row": int(flank.given.row[worst]),
            "col": int(flank.given.col[worst]),
        },
        "fitted": list(flank.free),
        "bounds_reached": list(flank.active),
    }


def _text(name: str, found: dict[str, Any], flank: ReversedFlank) -> str:
    """The figures of a flank for people, and whether anything is left that is no scatter."""
    worst = found["largest"]
    rows = [
        ["deviation of the crown gear that it starts from", f"{found['rms_before_um']:.3g} um RMS"],
        ["deviation of the settings found", f"{found['rms_um']:.3g} um RMS"],
        ["scatter of the points about a smooth flank", f"{found['scatter_um']:.3g} um RMS"],
        ["largest deviation", f"{worst['deviation_um']:+.3g} um at row {worst['row']}, col {worst['col']}"],
        ["fitted", ", ".join(found["fitted"])],
        ["bounds reached", ", ".join(found["bounds_reached"]) or "none"],
    ]
    left = "all but the scatter of its points is reproduced"
    if flank.not_reproduced > flank.scatter:
        left = f"{found['not_reproduced_um']:.3g} um RMS of its form are not reproduced"
    return f"{name} flank, {counted(found['points'], 'point')}: {left}\n" + table(["figure", "value"], rows)
