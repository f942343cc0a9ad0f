"""``gearmath contact``: how a pair runs, nominal flanks at any assembly."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gearmath.arguments.known import LEAST_STEP, MOST_DEG, MOST_MM, MOST_STEP
from gearmath.cli.common import JSON, SET, bars, echo_json, plot, save_plot, table
from gearmath.errors import InputError

if TYPE_CHECKING:
    from gearmath.bevel.contact.system import Assembly, System

_LIMIT_TRIALS = 10
_SENSES = tuple((name, sense) for name in ("v", "h") for sense in ("minus", "plus"))
#: Figures of a measured pair with an uncertainty: key, words and unit.
_SURE = (
    ("peak_to_peak_arcsec", "the transmission error", "arcsec"),
    ("center_cone_distance_mm", "the pattern's center, cone distance", "mm"),
    ("center_height_mm", "the pattern's center, height", "mm"),
)


@click.command()
@SET
@click.option("--v", "v", type=float, default=0.0, show_default=True, help="Gear axis shifted along Y = Z x X, mm.")
@click.option("--h", "h", type=float, default=0.0, show_default=True, help="Pinion withdrawn along its axis Z, mm.")
@click.option("--j", "j", type=float, default=0.0, show_default=True, help="Gear withdrawn along its axis X, mm.")
@click.option("--shaft", type=float, default=0.0, show_default=True, help="Growth of the shaft angle, degrees.")
@click.option("--step", type=float, default=1.0, show_default=True, help="Positions of the path, degrees of pinion.")
@click.option(
    "--tolerance",
    "with_tolerance",
    is_flag=True,
    help="Also V and H, from the assembly as given, at which the pattern reaches an edge or the outcome changes.",
)
@click.option(
    "--measured-pinion", type=click.Path(path_type=Path), metavar="CSV", help="Measured flank CSV of the pinion."
)
@click.option("--measured-gear", type=click.Path(path_type=Path), metavar="CSV", help="Measured flank CSV of the gear.")
@JSON
@plot("transmission error, path, pattern and V-H diagram of both sides")
def contact(
    gear_set: str,
    v: float,
    h: float,
    j: float,
    shaft: float,
    step: float,
    with_tolerance: bool,
    measured_pinion: Path | None,
    measured_gear: Path | None,
    as_json: bool,
    picture: Path | None,
) -> None:
    """How a pair runs: path of contact, transmission error, V-H check, of drive (pinion concave) and coast side.

    The contact is exact: flanks, edges of tip, toe and heel, and corners, of one pair of teeth and its neighbors. The
    path is that of one pair of teeth over three pitches. Rotation 0: both mean points on the pitch line. With measured
    flanks, of either member or both, the pair runs on these: clamping and rotation of the work are taken out first.
    """
    from gearmath.bevel.contact.report import SIDES
    from gearmath.bevel.contact.system import Assembly
    from gearmath.front.contact import contact as in_contact
    from gearmath.front.measured import load_measurement
    from gearmath.front.sets import load_set

    _check(v, h, j, shaft, step)
    pair = load_set(gear_set)
    files = {"pinion": measured_pinion, "gear": measured_gear}
    measured = [load_measurement(file, pair.member(name)) for name, file in files.items() if file is not None]
    with bars(quiet=as_json) as begin:
        found = in_contact(pair, *measured, v=v, h=h, j=j, shaft=shaft, tolerance=with_tolerance, begin=begin)
    given = Assembly(v, h, j, math.radians(shaft))
    for side, run in found.runs.items():
        if run.outcome == "contact lost" and given != Assembly():
            raise InputError(f"{pair.source}: {_lost(found.measured.system(side), side, given)}")
    if picture is not None:
        save_plot(found.plot(), picture, as_json)
    results = found.to_dict(step)
    if as_json:
        echo_json(results)
        return
    for remark in found.measured.remarks:
        click.echo(remark)
    for side, result in results.items():
        click.echo(_text(side, SIDES[side], result))


def _check(v: float, h: float, j: float, shaft: float, step: float) -> None:
    for name, value, most, unit in (
        ("--v", v, MOST_MM, "mm"),
        ("--h", h, MOST_MM, "mm"),
        ("--j", j, MOST_MM, "mm"),
        ("--shaft", shaft, MOST_DEG, "degrees"),
    ):
        if not abs(value) <= most:
            raise InputError(f"{name} {value:g}: must lie between -{most:g} and {most:g} {unit}")
    if not LEAST_STEP <= step <= MOST_STEP:
        raise InputError(f"--step {step:g}: must lie between {LEAST_STEP:g} and {MOST_STEP:g} degrees")


def _lost(system: System, side: str, given: Assembly) -> str:
    """Which displacement takes the flanks out of contact, and how far it may go."""
    from gearmath.bevel.contact.mesh import mesh

    def keeps(assembly: Assembly) -> bool:
        return mesh(system, assembly).outcome != "contact lost"

    names = {
        "V": ("--v", 1.0, "mm"),
        "H": ("--h", 1.0, "mm"),
        "J": ("--j", 1.0, "mm"),
        "shaft": ("--shaft", math.degrees(1), "degrees"),
    }
    there = [name for name in names if getattr(given, name)]
    for name in there:
        if not keeps(replace(given, **{name: 0.0})):
            continue
        value, (option, unit, word) = getattr(given, name), names[name]
        low, high = 0.0, 1.0
        for _ in range(_LIMIT_TRIALS):
            middle = (low + high) / 2
            low, high = (middle, high) if keeps(replace(given, **{name: middle * value})) else (low, middle)
        others = " with the other displacements as given" if len(there) > 1 else ""
        return (
            f"{option} {value * unit:g}: the flanks of the {side} side lose contact; it may go to about "
            f"{low * value * unit:.3g} {word}{others}"
        )
    stated = ", ".join(f"{names[name][0]} {getattr(given, name) * names[name][1]:g}" for name in there)
    return f"{stated}: the flanks of the {side} side are out of contact, and no one of these alone brings it back"


def _text(side: str, flank: str, result: dict[str, Any]) -> str:
    """One side for people."""
    spread = result["peak_to_peak_arcsec"]
    other = "convex" if flank == "concave" else "concave"
    lines = [f"{side}: pinion {flank} with gear {other}: {result['outcome']}"]
    runs_on = [kind for kind in result["leading_kinds"] if kind != "interior"]
    if runs_on and not result["outcome"].startswith(runs_on[0]):
        lines[0] += f", running on {' and '.join(f'{kind} contact' for kind in runs_on)} in turn"
    if result["on_fillets"]:
        lines[0] += f": {', '.join(result['on_fillets'])}"
    lines += [_gap_text(gap) for gap in result["gaps"]]
    rows = [
        ["transmission error, peak to peak", "none" if spread is None else f"{spread:.3f} arcsec"],
        ["contact ratio within the flanks", f"{result['contact_ratio']:.3f}"],
    ]
    if (mean := result["at_mean"]) is not None:
        major, minor = mean["semi_axes_mm"]
        rows += [
            ["nearest to the mean point", f"pinion at {mean['pinion_rotation_deg']:.3f} degrees"],
            ["second derivative", f"{mean['second_derivative']:.5g} rad/rad^2"],
            ["half axes of the ellipse", f"{major:.3f} and {minor:.3f} mm"],
            ["path from root line towards tip", f"{mean['path_angle_deg']:.2f} degrees"],
        ]
    found = result["pattern"]
    if "length_share" in found:
        rows += [
            [
                f"pattern at {found['thickness_mm'] * 1000:.3g} um",
                f"{found['share']:.0%} of the flank, {found['length_share']:.0%} of its width",
            ],
            [
                "center of the pattern",
                f"cone distance {found['center_cone_distance_mm']:.2f}, height {found['center_height_mm']:+.2f} mm",
            ],
        ]
    for name, values in result.get("measured", {}).items():
        text = (
            "nominal: this flank was not measured in full"
            if values is None
            else (f"{values['rms_um']:.2f} um RMS off nominal, {values['spline_residual_um']:.2f} of it smoothed")
        )
        rows.append([f"{name} as measured", text])
    if (sure := result.get("uncertainty")) is not None:
        rows += [
            [f"standard uncertainty of {words}", f"{sure[key]:.3g} {unit}"]
            for key, words, unit in _SURE
            if sure[key] is not None
        ]
    for place, found in result["v_h_mm"].items():
        rows.append(
            [f"V and H for contact at {place}", "none" if found is None else f"{found[0]:+.4f} and {found[1]:+.4f} mm"]
        )
    if "tolerance_mm" in result:
        rows += _tolerance_rows(result["tolerance_mm"], result["outcome"])
    lines.append(table(["figure", "value"], rows))
    if result["path"]:
        head = ["pinion deg", "kind", "error arcsec", "cone distance mm", "height mm"]
        cells = [
            [
                f"{row['pinion_rotation_deg']:.3f}",
                row["kind"],
                f"{row['transmission_error_arcsec']:z.3f}",
                f"{row['gear_cone_distance_mm']:.4f}",
                f"{row['gear_height_mm']:.4f}",
            ]
            for row in result["path"]
        ]
        lines += ["path of one pair of teeth:", table(head, cells)]
    return "\n".join(lines) + "\n"


def _gap_text(gap: dict[str, Any]) -> str:
    """Where the path of a pair of teeth breaks off."""
    step = gap["step_arcsec"]
    ahead = "with no other contact there" if step is None else f"{step:.3f} arcsec ahead of any other"
    return (
        f"gap in the path: with the pinion at {gap['pinion_rotation_deg']:.3f} degrees the contact that carries ends, "
        f"{ahead}; it does not go on along flanks, edges, or fillets of rounded blades: the members run into each "
        "other below the fillet, or a flank is undercut"
    )


def _tolerance_rows(found: dict[str, Any] | None, outcome: str) -> list[list[str]]:
    """V and H to both senses: to another outcome, and to the edge that the pattern reaches."""
    if found is None:
        return [["V and H to the edges", "none: no pattern with edges of its own"]]
    rows = []
    changes = found["outcome_changes"]
    if changes is None:
        rows.append(["V and H to the limits", f"none: {outcome} as it stands"])
    for name, sense in _SENSES if changes else ():
        (value, what), (far, edge) = changes[name][sense].values(), found[name][sense].values()
        side = f"{name.upper()} to the {sense} side"
        rows.append([side, f"{value:+.4f} mm: {what or 'no other outcome up to there'}"])
        rows.append([f"{side}, pattern", f"{far:+.3f} mm: {edge or 'no edge up to there'}"])
    if found["reached"]:
        rows.append(["pattern as it stands reaches", ", ".join(found["reached"])])
    return rows
