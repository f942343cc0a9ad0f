"""``gearmath points``: points of another measuring machine, as plain text, to a measured flank file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click

from gearmath.cli.common import FLANK_CSV, JSON, MEMBER, SET_OPTION, about, bars, echo_json, member_of, of, output
from gearmath.errors import InputError, counted

if TYPE_CHECKING:
    from gearmath.quality.foreign.member import Phase
    from gearmath.specs.point_text import PointText

_T = TypeVar("_T")


@click.command(epilog=FLANK_CSV)
@click.argument("texts", type=click.Path(path_type=Path), metavar="POINTS.txt ...", nargs=-1, required=True)
@SET_OPTION
@MEMBER
@click.option(
    "--flank",
    "sides",
    type=of("flank"),
    multiple=True,
    required=True,
    help="Flank of the points: once for all files, or once for each, in their order.",
)
@click.option(
    "--tooth",
    "teeth",
    type=click.IntRange(min=0),
    multiple=True,
    default=(0,),
    show_default=True,
    help="Tooth of the points, counted from 0: once for all files, or once for each.",
)
@click.option("--unit", type=of("unit"), default="mm", show_default=True, help="Unit of the files.")
@click.option(
    "--axis",
    type=click.Choice(["+x", "-x", "+y", "-y", "+z", "-z"]),
    default="+z",
    show_default=True,
    help="Direction of the work axis in the files, from the pitch apex to the back.",
)
@click.option(
    "--apex-offset",
    type=float,
    default=0.0,
    show_default=True,
    help="Where the origin of the files lies on the axis, from the pitch apex towards the back, in mm.",
)
@click.option(
    "--tip-radius",
    type=float,
    default=0.0,
    show_default=True,
    help="Radius of the probe tip in mm, where the points are centers of the tip and not contact points.",
)
@click.option(
    "--phase",
    type=of("phase"),
    default="common",
    show_default=True,
    help="Rotation about the axis: found for all files at once, for each by itself, or kept as it is.",
)
@click.option(
    "--leave-out",
    is_flag=True,
    help="Take files in which points are missing or stand far out from the others; these are left out.  [default: "
    "refused]",
)
@JSON
@output("flank CSV")
def points(
    texts: Sequence[Path],
    gear_set: str,
    member: str | None,
    sides: Sequence[str],
    teeth: Sequence[int],
    unit: str,
    axis: str,
    apex_offset: float,
    tip_radius: float,
    phase: Phase,
    leave_out: bool,
    as_json: bool,
    target: Path,
) -> None:
    """Points of another measuring machine, as plain text, to a measured flank file.

    Each file holds one flank of one tooth: rows 'x y z' or 'x y z i j k' in any order, with any header lines; columns
    parted by blanks, tabs, commas or semicolons (docs/files.md). The rotation about the axis is found, and said;
    deviations are those along the normals of the nominal flank. The result is read by evaluate, compensate and report.
    """
    from gearmath.front.judged import foreign_points
    from gearmath.front.sets import load_set
    from gearmath.quality.foreign.points import Frame
    from gearmath.specs.point_text import read_point_text

    sides, teeth = _for_each(texts, sides, "--flank"), _for_each(texts, teeth, "--tooth")
    _check_lengths(apex_offset, tip_radius)
    one = member_of(load_set(gear_set), member)
    _check_parts(texts, sides, teeth, one.teeth)
    read = [read_point_text(path, unit) for path in texts]
    told = [
        _check_stated(text, {"flank": side, "unit": unit, "member": one.name, "tooth": str(tooth)})
        for text, side, tooth in zip(read, sides, teeth, strict=True)
    ]
    parts = dict(zip(zip(sides, teeth, strict=True), read, strict=True))
    with bars() as begin:
        made = foreign_points(parts, one, Frame(axis, apex_offset, tip_radius), phase, leave_out, begin)
    found = made.found
    if found.gaps and not leave_out:
        more = f" (and {len(found.gaps) - 1} more)" if len(found.gaps) > 1 else ""
        raise InputError(f"{found.gaps[0]}{more}; --leave-out takes the other points")
    made.measurement.to_csv(target)
    header = found.file.header
    remarks = [f"{text.path}: {remark}" for text in read for remark in text.remarks] + list(found.remarks)
    remarks[:0] = doubts = [each for each in (*told, *found.doubts) if each]
    remarks = list(dict.fromkeys(remarks))
    for doubt in doubts:
        click.echo(doubt, err=True)
    if as_json:
        turned = [
            {
                "file": str(path),
                "flank": side,
                "tooth": tooth,
                "points": len(text.point),
                "turned_deg": math.degrees(turn),
            }
            for path, side, tooth, text, turn in zip(texts, sides, teeth, read, found.turns, strict=True)
        ]
        kept = {key: header[key] for key in ("grid", "margins", "phase_zeroed")}
        echo_json({"member": one.name, **kept, "files": turned, "remarks": remarks})
        return
    for path, side, tooth, turn in zip(texts, sides, teeth, found.turns, strict=True):
        click.echo(f"{path}: {side} flank of tooth {tooth}, turned by {math.degrees(turn):.6f} degrees")
    for remark in remarks:
        if remark not in doubts:
            click.echo(remark)
    zeroed = "set to zero at the reference point" if header["phase_zeroed"] == "true" else "as found, thickness stays"
    if phase == "kept":
        zeroed = "kept as in the files"
    click.echo(f"grid {header['grid']}, margins {header['margins']}; rotation {zeroed}")
    click.echo(f"{target}: {counted(len(found.file), 'point')} of the {one.name}")


def _for_each(texts: Sequence[Path], given: Sequence[_T], option: str) -> Sequence[_T]:
    """One value for every file."""
    if len(given) == 1:
        return list(given) * len(texts)
    if len(given) != len(texts):
        raise InputError(f"{option}: given {len(given)} times for {len(texts)} files: once, or once for each")
    return given


def _check_stated(text: PointText, options: dict[str, str]) -> str:
    """What to say where a file counts its teeth otherwise. Raises InputError where its text contradicts an option."""
    for key, (value, line) in text.stated.items():
        if key == "tooth":
            if int(value) != int(options[key]):
                return f"{text.path}, line {line}: says tooth {value}, read as --tooth {options[key]}"
        elif value != options[key]:
            raise InputError(f"{text.path}, line {line}: says {value}, the options say --{key} {options[key]}")
    return ""


def _check_lengths(apex_offset: float, tip_radius: float) -> None:
    if not abs(apex_offset) <= 2000:
        raise InputError(f"--apex-offset {apex_offset:g}: must lie between -2000 and 2000 mm")
    if not 0 <= tip_radius <= 10:
        raise InputError(f"--tip-radius {tip_radius:g}: must lie between 0 and 10 mm")


def _check_parts(texts: Sequence[Path], sides: Sequence[str], teeth: Sequence[int], count: int) -> None:
    seen: dict[tuple[str, int], Path] = {}
    for path, side, tooth in zip(texts, sides, teeth, strict=True):
        with about(path):
            if tooth >= count:
                raise InputError(f"--tooth {tooth}: the member has teeth 0 to {count - 1}")
            if (side, tooth) in seen:
                raise InputError(
                    f"is taken for the {side} flank of tooth {tooth}, as is {seen[side, tooth]}: give --flank and "
                    "--tooth once for each file"
                )
        seen[side, tooth] = path
