"""What ``gearmath evaluate`` prints: what was left out and withheld, tables of figures, a line for each thing found."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from gearmath.cli.common import table
from gearmath.quality.evaluation.member import MemberEvaluation
from gearmath.quality.evaluation.topography import ORDER_KEYS
from gearmath.quality.uncertainty.propagation import Uncertain

_FIGURES = ("max_deviation_um", "rms_um", "cubic_surface_residual_um", "F_p_um", "max_f_pt_um")

#: Less than this is shown as this: no uncertainty is zero.
_LEAST_SHOWN = 0.01
#: An axial position within so many standard uncertainties is none, as with the clamping.
_SIGNIFICANT = 3.0


def evaluation_text(found: MemberEvaluation, sure: Sequence[Uncertain] = ()) -> str:
    """The figures of an evaluation as text, with their uncertainties where they are known."""
    values = found.as_dict()
    flanks: dict[str, Any] = values["flanks"]
    first = table(
        ["flank", *_FIGURES],
        [[flank, *(_cell(row, name) for name in _FIGURES)] for flank, row in flanks.items()],
    )
    lines = [*_gaps(found), first, "", *_orders(flanks), *_sure(sure), *_lines(values)]
    return "\n".join([*lines, *([] if sure else [_unsure(values)]), *_others(found)]).rstrip()


def _cell(row: dict[str, Any], name: str) -> str:
    """A figure, nothing where it was not measured, and that it is withheld where there is a gap in the data."""
    return "" if name not in row else "withheld" if row[name] is None else f"{row[name]:.3f}"


def _gaps(found: MemberEvaluation) -> Iterator[str]:
    """Whether the work moved, what was left out, and which figures are withheld for that."""
    left_out = [f"left out: {line}" for line in _without_suffix(found.left_out)]
    lines = [*found.closing.said, *found.suspicions, *left_out, *found.withheld]
    yield from lines
    if lines:
        yield ""


def _without_suffix(lines: Sequence[str]) -> Iterator[str]:
    yield from (line.replace("; left out, ", "; ").removesuffix("; left out") for line in lines)


def _orders(flanks: dict[str, Any]) -> Iterator[str]:
    rows = [
        [flank, *(f"{row['orders'][name]:+.3f}" for name in ORDER_KEYS)]
        for flank, row in flanks.items()
        if row.get("orders")
    ]
    if rows:
        yield "first and second order / um:"
        yield table(["flank", *(name.removesuffix("_um") for name in ORDER_KEYS)], rows)
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
    for flank, row in values["flanks"].items():
        if "zeroed_at_reference" in row:
            yield _chart(flank, row["zeroed_at_reference"])
    yield from _seat(values["registration"])
    if values["rotation"] is not None:
        yield _rotation(values["rotation"])
    for flank, closure in values["drift_um"].items():
        how = "taken out as a step" if values["closing"]["kind"] == "step" else "taken out evenly"
        yield f"{flank} flank: tooth 0 measured again at the end: {closure:+.2f} um, {how}"
    runout, thickness, tolerance = values["runout"], values["thickness"], values["tolerance"]
    if runout is not None:
        yield from _runout(
            runout, values["runout_as_measured"] if (values["registration"] or {}).get("taken_out") else None
        )
    if thickness is not None:
        arc, chord = (
            f"{name} {thickness[f'{name}_mm']:.4f} mm {thickness[f'{name}_deviation_um']:+.2f} um"
            for name in ("arc", "chord")
        )
        circle = f"transverse circle through the reference point, radius {thickness['radius_mm']:.4f} mm"
        yield f"tooth thickness, mean, on the {circle}: {arc}, {chord}"
    if tolerance is None:
        yield "no grade: pitch was not measured"
    else:
        yield from _grades(tolerance)


def _unsure(values: dict[str, Any]) -> str:
    """What is said where the file does not know how sure its points are."""
    seat = values["registration"]
    left = None if seat is None else seat["noise_um"]
    how = (
        "no uncertainty is known" if left is None else f"± is from the {left:.2f} um of noise that the clamping leaves"
    )
    return f"the file has no u_um, and --sigma-um is not given: {how}"


def _others(found: MemberEvaluation) -> Iterator[str]:
    """The remarks that were not made first."""
    yield from (line for line in found.remarks if line not in found.first)


def _runout(runout: dict[str, Any], before: dict[str, Any] | None) -> Iterator[str]:
    wave = runout["first_harmonic_um"]
    harmonic = "" if wave is None else f", first harmonic {wave:.2f} um"
    if runout["F_r_um"] is None:
        yield f"runout F_r withheld{harmonic}"
        return
    clamped = "" if before is None or before["F_r_um"] is None else f"; as it was clamped {before['F_r_um']:.2f} um"
    yield f"runout F_r {_with(runout, 'F_r_um')} um, normal to the pitch cone{harmonic}{clamped}"
    if runout["F_r_of_noise_um"] is not None:
        mean, spread = runout["F_r_of_noise_um"], runout["F_r_of_noise_spread_um"]
        so = ": it is mostly noise" if runout["mostly_noise"] else ""
        yield f"  noise of the points alone would give F_r {mean:.2f} ± {spread:.2f} um{so}"


def _grades(tolerance: dict[str, Any]) -> Iterator[str]:
    """The grades, each figure without one with its reason, and the caveat beside them."""
    known = {name: grade for name, grade in tolerance["grades"].items() if name not in tolerance["withheld"]}
    module, diameter = tolerance["mean_normal_module"], tolerance["tolerance_diameter"]
    if known:
        yield f"grades: {_list(known)} (m_mn {module:.3f} mm, d_T {diameter:.2f} mm)"
    if tolerance["withheld"]:
        for flank, grades in tolerance["grades_of_flanks"].items():
            if grades:
                yield f"grades of the {flank} flank alone: {_list(grades)}"
        reasons: dict[str, list[str]] = {}
        for name, why in tolerance["withheld"].items():
            reasons.setdefault(why, []).append(name)
        yield from (f"no grade of {', '.join(names)}: {why}" for why, names in reasons.items())
    yield tolerance["remark"]


def _list(grades: dict[str, Any]) -> str:
    return ", ".join(f"{name} {grade or 'beyond 11'}" for name, grade in grades.items())


def _seat(seat: dict[str, Any] | None) -> Iterator[str]:
    if seat is None:
        return
    size, direction = _with(seat, "eccentricity_um"), seat["eccentricity_direction_deg"]
    if seat["taken_out"]:
        yield f"clamping taken out: eccentricity {size} um towards {direction:.1f} deg"
    if seat["taken_out"] and seat["tilt_um_per_100mm"] is not None:
        size, direction = _with(seat, "tilt_um_per_100mm"), seat["tilt_direction_deg"]
        yield f"clamping taken out: tilt {size} um per 100 mm about {direction:.1f} deg"
    shift, u = seat["axial"]["axial_um"], seat["axial"]["u_axial_um"]
    if shift is None or (u is not None and abs(shift) <= _SIGNIFICANT * u):
        return  # no more than the noise of the points would give
    size, twin = _with(seat["axial"], "axial_um"), seat["axial"]["confounded_with"]
    yield (
        f"axial position not corrected: {size} um along the axis would explain the mean form best, but an error of "
        f"{twin} looks the same: check how the work is clamped before that setting"
    )


def _chart(flank: str, zeroed: dict[str, Any]) -> str:
    most = "withheld" if zeroed["max_deviation_um"] is None else f"{zeroed['max_deviation_um']:+.3f} um"
    return f"{flank} flank, turned to zero at its reference point: max {most}, rms {zeroed['rms_um']:.3f} um"


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
    return f"{values[name]:.2f}" + ("" if uncertainty is None else f" ± {max(uncertainty, _LEAST_SHOWN):.2f}")
