"""The blade of a flank as the kernels on a line take it: its curvature, and points counted from its foot."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmath.bevel.newton import FlankPoints
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import Flank


def blade_curve(spec: Flank) -> tuple[float, float]:
    """Curvature [1/mm] of the blade of a flank, zero where it is straight, and its reference height [mm]."""
    return 0.0 if spec.blade_spheric_radius is None else 1 / spec.blade_spheric_radius, spec.blade_reference_height


def nominal_curvature(spec: Flank) -> float:
    """Curvature [1/mm] of the blade that the nominal flank is cut by."""
    return 0.0 if spec.nominal_spheric_radius is None else 1 / spec.nominal_spheric_radius


def by_foot(spec: Flank, nominal: FlankPoints) -> FlankPoints:
    """Points of a flank with the height of the foot (10.9) as the blade parameter, as the kernels on a line take it."""
    if spec.nominal_spheric_radius is None:
        return nominal
    (foot,) = kernel("arc_foot")(
        nominal.contact[:, 0], spec.nominal.vector[-1], spec.nominal_spheric_radius, spec.blade_reference_height
    )
    return replace(nominal, contact=np.column_stack([foot, nominal.contact[:, 1:]]))
