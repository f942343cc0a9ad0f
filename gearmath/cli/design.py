"""``gearmath design``: a pair from the few data of a designer, or a pinion to a given gear."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import click

from gearmath.cli.common import HTML, JSON, NewFile, bars, echo_json, output, plot, save_plot, table
from gearmath.cli.design_reverse import reverse_design


@click.command()
@click.argument("data", metavar="DESIGN.toml")
@output("gear set, TOML")
@click.option(
    "--from", "given", metavar="SET.toml", help="Design the pinion to the gear of this set: file, or bundled."
)
@click.option(
    "--reverse",
    "points",
    metavar="POINTS.csv",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Find the settings of the member with these flanks (flank CSV), from its blank and method alone.",
)
@click.option(
    "--sheet",
    type=NewFile(*HTML),
    metavar="SUMMARY.html",
    help="Also write the summary sheet: it prints on A4.",
)
@JSON
@plot("transmission error, path and pattern of both sides")
def design(
    data: str,
    target: Path,
    given: str | None,
    points: Path | None,
    sheet: Path | None,
    as_json: bool,
    picture: Path | None,
) -> None:
    """A spiral bevel pair from tooth counts, module, face width, spiral angle and cutter: blank and settings.

    DESIGN.toml is a file of design data, or a bundled one such as design_7x43.toml; every key is in docs/design.md.
    What is asked of the contact is met at the mean point and checked by the exact contact of the rounded settings;
    what cannot be is refused, with the limit that binds.

    With --reverse it is a file of design data, of a blank, or a gear set, of which blank and method are taken.
    """
    from gearmath.errors import InputError
    from gearmath.front.design import design as designed
    from gearmath.front.sets import load_set

    if points is not None:
        for option, other in (("--from", given), ("--plot", picture)):
            if other is not None:
                raise InputError(f"{option} and --reverse: only one of them may be given")
        reverse_design(points, data, target, sheet, as_json)
        return
    gear = None if given is None else load_set(given)
    if gear is not None and len(gear.spec.members) < 2:
        raise InputError(f"{given}: a set with both members is needed: the blank of the pinion is taken from it")
    with bars(quiet=as_json) as begin:
        made = designed(data, gear, begin)
    made.gear_set.save(target)
    if sheet is not None:
        load_set(target).to_summary(sheet)  # of the file, with the digits that it keeps and so its digest
    if picture is not None:
        save_plot(made.plot(), picture, as_json)
    if as_json:
        echo_json({"set": str(target), **made.to_dict()})
        return
    click.echo(_text(made.gear_set.title, made.figures))
    click.echo(f"{target}: written")
    if sheet is not None:
        click.echo(f"{sheet}: summary sheet, prints on A4")


def _text(title: str, figures: dict[str, Any]) -> str:
    """The figures of a design for people."""
    from gearmath.bevel.ridge import RIDGE, ridge_words

    backlash, lands = figures["backlash_mm"], figures["top_land_mm"]
    rows = [
        ["cutter radius", f"{figures['cutter_radius_mm']:g} mm"],
        ["mean normal module", f"{figures['mean_normal_module_mm']:.4f} mm"],
        ["backlash at the mean point, transverse", f"{backlash['found']:.4f} mm, asked {backlash['asked']:.4f}"],
        *(
            [f"top land of the {name}, normal, toe mean heel", " ".join(f"{one:.3f}" for one in land.values()) + " mm"]
            for name, land in lands.items()
        ),
        *(
            [f"root of the {name}", ridge_words(math.inf if height is None else height / 1000)]
            for name, height in figures["root_ridge_um"].items()
            if height is None or height > 1000 * RIDGE
        ),
    ]
    changed = ", ".join(f"{key} = {value:g}" for key, value in figures["changed"].items())
    parts = [title, table(["figure", "value"], rows)]
    if changed:
        parts.append(f"the pair does not run with the values that keys left out start from; changed for it: {changed}")
    for side in ("drive", "coast"):
        parts.append(_side(side, figures[side]))
    return "\n\n".join(parts)


def _side(side: str, found: dict[str, Any]) -> str:
    second, path, axes = found["second_derivative"], found["path_angle_deg"], found["semi_axes_mm"]
    lag = ["left the flanks" if one is None else f"{one:.3f}" for one in found["lag_half_a_pitch_from_vertex_arcsec"]]
    vertex, bounds = found["vertex"], ", ".join(found["bounds_reached"]) or "none"
    rows = [
        ["second derivative at the vertex", f"{second['found']:.5g}, asked {second['asked']:.5g} rad/rad^2"],
        ["lag half a pitch before and after it", f"{lag[0]} and {lag[1]} arcsec"],
        ["transmission error, peak to peak", f"{found['peak_to_peak_arcsec']:.3f} arcsec"],
        ["contact ratio within the flanks", f"{found['contact_ratio']:.3f}"],
        [
            "vertex on the gear",
            f"cone distance {vertex['gear_cone_distance_mm']:.3f}, height {vertex['gear_height_mm']:+.3f} mm",
        ],
        ["path from root line towards tip", f"{path['found']:.2f}, asked {path['asked']:.2f} degrees"],
        [
            "half axes of the ellipse",
            f"{axes['found'][0]:.3f} and {axes['found'][1]:.3f} mm, asked {axes['asked_major']:.3f}",
        ],
        *(
            [f"{name.replace('_', ' ')} of the whole flank", f"{one['found']:.1f} um, asked {one['asked']:g}"]
            for name, one in (found["crownings_um"] or {}).items()
        ),
        [
            "ease-off less the wanted one",
            f"{found['ease_off_rms_um']:.2f} um RMS on {found['share_of_flank']:.0%} of the places its mate reaches",
        ],
        ["bounds reached", bounds],
    ]
    outcome = "".join([f"{side}: {found['outcome']}", *(f"; {remark}" for remark in found["remarks"])])
    return outcome + "\n" + table(["figure", "value"], rows)
