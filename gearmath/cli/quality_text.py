"""What ``gearmath evaluate`` prints: tables of figures, then one line for each thing that was found or left out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from gearmath.cli.common import table
from gearmath.quality.evaluation import Evaluation
from gearmath.quality.uncertainty import Uncertain

_FIGURES = ("max_deviation_um", "rms_um", "cubic_surface_residual_um", "F_p_um", "max_f_pt_um")
_ORDERS = (
    "mean_um", "pressure_angle_deviation_um", "spiral_angle_deviation_um", "profile_crowning_um", "length_crowning_um",
    "twist_um", "residual_um",
)  # fmt: skip


def evaluation_text(found: Evaluation, sure: Sequence[Uncertain] = ()) -> str:
    """The figures of an evaluation as text, with their uncertainties where they are known."""
    values = found.as_dict()
    flanks: dict[str, Any] = values["flanks"]
    first = table(
        ["flank", *_FIGURES],
        [[flank, *(f"{row[name]:.3f}" if name in row else "" for name in _FIGURES)] for flank, row in flanks.items()],
    )
    return "\n".join([first, "", *_orders(flanks), *_sure(sure), *_lines(values)]).rstrip()


def _orders(flanks: dict[str, Any]) -> Iterator[str]:
    rows = [
        [flank, *(f"{row['orders'][name]:+.3f}" for name in _ORDERS)]
        for flank, row in flanks.items()
        if "orders" in row
    ]
    if rows:
        yield "first and second order / um:"
        yield table(["flank", *(name.removesuffix("_um") for name in _ORDERS)], rows)
        yield ""


def _sure(found: Sequence[Uncertain]) -> Iterator[str]:
    """Standard and expanded uncertainties of the figures in µm, without those of single teeth and coefficients."""
    rows = [
        [
            one.figure.flank,
            one.figure.name,
            f"{one.uncertainty * 1000:.3f}",
            *(f"{end * 1000:.3f}" for end in one.interval),
        ]
        for one in found
        if one.figure.unit == "um" and not one.figure.name.startswith(("c_", "f_pt_"))
    ]
    if rows:
        yield "standard uncertainties u and intervals of 95 % / um:"
        yield table(["flank", "figure", "u", "from", "to"], rows)
        yield ""


def _lines(values: dict[str, Any]) -> Iterator[str]:
    yield from _seat(values["registration"])
    if values["rotation"] is not None:
        yield _rotation(values["rotation"])
    for flank, closure in values["drift_um"].items():
        yield f"{flank} flank: tooth 0 measured again at the end: {closure:+.2f} um, taken out evenly"
    runout, thickness, tolerance = values["runout"], values["thickness"], values["tolerance"]
    if runout is not None:
        yield f"runout F_r {runout['F_r_um']:.2f} um, first harmonic {runout['first_harmonic_um']:.2f} um"
    if thickness is not None:
        arc, chord = (
            f"{name} {thickness[f'{name}_mm']:.4f} mm {thickness[f'{name}_deviation_um']:+.2f} um"
            for name in ("arc", "chord")
        )
        yield f"tooth thickness at the reference point: {arc}, {chord}"
    if tolerance is not None and tolerance["grades"]:
        grades = [f"{name} {grade or 'beyond 11'}" for name, grade in tolerance["grades"].items()]
        module, diameter = tolerance["mean_normal_module"], tolerance["tolerance_diameter"]
        yield f"grades: {', '.join(grades)} (m_mn {module:.3f} mm, d_T {diameter:.2f} mm)"
    if tolerance is not None:
        yield tolerance["remark"]
    yield from values["remarks"]


def _seat(seat: dict[str, Any] | None) -> Iterator[str]:
    if seat is None:
        return
    size, direction = _with(seat, "eccentricity_um"), seat["eccentricity_direction_deg"]
    yield f"clamping taken out: eccentricity {size} um towards {direction:.1f} deg"
    if seat["tilt_um_per_100mm"] is not None:
        size, direction = _with(seat, "tilt_um_per_100mm"), seat["tilt_direction_deg"]
        yield f"clamping taken out: tilt {size} um per 100 mm about {direction:.1f} deg"
    if seat["axial"]["axial_um"] is None:
        return
    size, twin = _with(seat["axial"], "axial_um"), seat["axial"]["confounded_with"]
    yield f"axial position, left in: {size} um if the mean form were nothing else; {twin} does the same"


def _rotation(turn: dict[str, Any]) -> str:
    at = f"{turn['radius_mm']:.2f} mm radius"
    size, arc = _with(turn, "angle_arcsec"), _with(turn, "arc_um")
    return (
        f"rotation common to both flanks taken out: {turn['angle_deg']:+.6f} deg = {size} arcsec, "
        f"an arc of {arc} um at {at}"
    )


def _with(values: dict[str, Any], name: str) -> str:
    """A figure with its standard uncertainty, if there is one."""
    uncertainty = values[f"u_{name}"]
    return f"{values[name]:.2f}" + ("" if uncertainty is None else f" ± {uncertainty:.2f}")
