"""The contact of a pair as the figures that ``gearmath contact`` prints, names as in its JSON."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from gearmath.bevel.contact.local import LocalContact, local_at
from gearmath.bevel.contact.mesh import Mesh, MeshRow, mesh
from gearmath.bevel.contact.misalignment import contact_at, sensitivities
from gearmath.bevel.contact.outcome_limits import Change
from gearmath.bevel.contact.pattern import pattern
from gearmath.bevel.contact.surface import BORDERS, edges_of, nominal_surface
from gearmath.bevel.contact.system import Assembly, System, pair_system
from gearmath.bevel.contact.tolerance import EDGES, Tolerance
from gearmath.shown import Shows
from gearmath.specs.bevel_set import FLANKS, MEMBERS, BevelSet

#: The flank of the pinion that works on each side; the gear's is the other one.
SIDES = {"drive": "concave", "coast": "convex"}
ARCSEC = math.degrees(1) * 3600
_DISPLACEMENTS = {"v_per_mm": 1.0, "h_per_mm": 1.0, "j_per_mm": 1.0, "shaft_per_deg": math.radians(1)}


def side_system(pair: BevelSet, side: str) -> System:
    """The flanks of a set that work on a side, ``drive`` or ``coast``. Raises InputError for a set without both."""
    own = SIDES[side]
    mating = FLANKS[1 - FLANKS.index(own)]
    pinion, gear = (nominal_surface(pair.member(name), flank) for name, flank in (("pinion", own), ("gear", mating)))
    return pair_system(pinion, gear, pair.rad("shaft_angle"))


def side_mesh(pair: BevelSet, side: str, assembly: Assembly) -> Mesh:
    """The contact of a set on a side."""
    return mesh(side_system(pair, side), assembly)


def figures(run: Mesh, step: float) -> dict[str, Any]:
    """The JSON object of one side, positions at multiples of ``step`` [rad]."""
    zero = run.reference or 0.0
    rows = run.path(step)
    followed = run.followed(np.array([row.rotation for row in rows]))
    return {
        "outcome": run.outcome,
        "leading_kinds": list(run.leads.kinds),
        "on_fillets": on_fillets(run),
        "gaps": [
            {
                "pinion_rotation_deg": _degrees(gap.rotation),
                "step_arcsec": gap.step * ARCSEC if math.isfinite(gap.step) else None,
            }
            for gap in run.gaps
        ],
        "contact_ratio": run.contact_ratio,
        "at_mean": _at_mean(run, zero),
        "path": [
            {
                "pinion_rotation_deg": _degrees(row.rotation),
                "kind": row.kind,
                "transmission_error_arcsec": (row.error - zero) * ARCSEC,
                "gear_cone_distance_mm": row.cone_distance,
                "gear_height_mm": row.height,
                "gear_follows_arcsec": float(ahead - zero) * ARCSEC,
                **_local(run, row),
            }
            for row, ahead in zip(rows, followed, strict=True)
        ],
        "pattern": pattern(run).figures,
        "peak_to_peak_arcsec": peak_to_peak_arcsec(run),
        "v_h_mm": v_h(run),
    }


def peak_to_peak_arcsec(run: Mesh) -> float | None:
    """Transmission error of a pair from peak to peak; None where the contact, or the path of it, is not whole."""
    spread = None if run.gaps else run.leads.peak_to_peak
    return None if spread is None else spread * ARCSEC


def on_fillets(run: Mesh) -> list[str]:
    """Which edges run on the fillet of which mate, in words."""
    names = {which: edge for edge, which in EDGES.items()}
    return sorted(
        {
            f"{names[edge]} on the {MEMBERS[root // len(BORDERS)]}'s fillet"
            for active in run.leads.fillets
            for root in set(active) - set(edges_of(active))
            for edge in edges_of(active)
            if edge // len(BORDERS) != root // len(BORDERS)
        }
    )


def shown_runs(runs: Mapping[str, Mesh]) -> list[Shows]:
    """What matters most of the sides of a pair, where its record is shown."""
    shown: list[Shows] = []
    for side, run in runs.items():
        shown.append((f"{side}: transmission error", peak_to_peak_arcsec(run), "arcsec"))
    shown += [(f"{side}: contact ratio", run.contact_ratio, "") for side, run in runs.items()]
    return [*shown, *((f"{side}: outcome", run.outcome, "") for side, run in runs.items())]


def _degrees(rotation: float) -> float:
    """Whole multiples of a step read as such."""
    return round(math.degrees(rotation), 9) + 0.0


def _local(run: Mesh, row: MeshRow) -> dict[str, Any]:
    """What is known of a contact within both flanks: curvature and motion."""
    if row.kind != "interior" or row.x is None:
        return dict.fromkeys(("second_derivative", "semi_axes_mm", "path_angle_deg"))
    return _shape(local_at(run.system, row.x, row.rotation, run.assembly))


def _shape(here: LocalContact) -> dict[str, Any]:
    return {
        "second_derivative": here.second_derivative,
        "semi_axes_mm": list(here.semi_axes) if here.definite else None,
        "path_angle_deg": math.degrees(here.path_angle),
    }


def _at_mean(run: Mesh, zero: float) -> dict[str, Any] | None:
    if run.at_mean is None:
        return None
    touch, here = run.at_mean
    moved = sensitivities(run.system, touch, run.assembly)
    distance, height = run.system.gear_place(touch.x)
    return {
        "pinion_rotation_deg": _degrees(touch.rotation),
        "transmission_error_arcsec": (run.system.transmission_error(touch) - zero) * ARCSEC,
        "gear_cone_distance_mm": distance,
        "gear_height_mm": height,
        **_shape(here),
        "sensitivity": {
            name: {
                "gear_cone_distance_mm": float(column[0] * unit),
                "gear_height_mm": float(column[1] * unit),
                "transmission_error_arcsec": float(column[2] * unit * ARCSEC),
            }
            for (name, unit), column in zip(_DISPLACEMENTS.items(), moved.T, strict=True)
        },
    }


def v_h(run: Mesh) -> dict[str, list[float] | None]:
    """V and H that bring the contact to toe, mean and heel, the other displacements as they are."""
    if run.is_line:
        return dict.fromkeys(("toe", "mean", "heel"))
    toe, heel = run.system.gear.ends
    places = {"toe": toe, "mean": run.system.gear.blank.mean_cone_distance, "heel": heel}
    found = {name: contact_at(run.system, at, *run.assembly[2:]) for name, at in places.items()}
    return {name: None if one is None else [one.V, one.H] for name, one in found.items()}


def tolerance_figures(
    found: Tolerance | None, changes: dict[str, tuple[Change, Change]] | None = None
) -> dict[str, Any] | None:
    """The JSON object ``tolerance_mm`` of one side: limits of the pattern, ``changes`` of the outcome."""
    if found is None:
        return None
    limits = _both_senses(found.limits, lambda limit: {"value": limit.value, "edge": limit.edge})
    others = changes and _both_senses(changes, lambda one: {"value": one.value, "outcome": one.outcome})
    return {"reached": list(found.reached), **limits, "outcome_changes": others}


def _both_senses(found: dict[str, tuple[Any, Any]], words: Callable[[Any], dict[str, Any]]) -> dict[str, Any]:
    senses = ("minus", "plus")
    return {
        name.lower(): {sense: words(one) for sense, one in zip(senses, both, strict=True)}
        for name, both in found.items()
    }
