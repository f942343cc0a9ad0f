"""The virtual gear as a solid: closed, and as large as the gear that a rack generates."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.bevel.solid import volume
from gearmath.exchange.hobbed_stl import write_gear
from gearmath.gearbox.dimensions import Gear
from gearmath.gearbox.hobbed.envelope import Envelope
from gearmath.gearbox.hobbed.inspection import layout
from gearmath.gearbox.hobbed.job import HobbingJob, HobTool

ALPHA = math.radians(20)


def rolled_area(teeth: int, shift: float, cells: int = 250) -> float:
    """Area [mm²] of a gear of module 1: what a rack of ISO 53 A leaves of a tooth's pitch, counted in small cells."""
    pitch, form, rounding = teeth / 2, 1.25 - 0.38 * (1 - math.sin(ALPHA)), 0.38
    low, high = pitch + shift - 1.25, pitch + shift + 1
    edges = np.linspace(low, high, cells + 1)
    radius = (edges[1:] + edges[:-1]) / 2
    angle = (np.arange(cells) + 0.5) / cells * math.pi / teeth
    r, theta = np.meshgrid(radius, angle, indexing="ij")
    cut = np.zeros_like(r, bool)
    middle = math.pi / 4 - (1.25 - rounding) * math.tan(ALPHA) - rounding / math.cos(ALPHA)
    for turn in np.linspace(-8.0 / pitch, 8.0 / pitch, 301):
        x, y = r * np.cos(theta + turn), r * np.sin(theta + turn)
        height, across = pitch + shift - x, np.abs(y - pitch * turn)
        straight = (height <= form) & (across < math.pi / 4 - height * math.tan(ALPHA))
        deep = np.clip(height - (1.25 - rounding), 0.0, rounding)
        rounded = (height > form) & (height < 1.25) & (across < middle + np.sqrt(rounding**2 - deep**2))
        cut |= straight | rounded
    cell = r * (edges[1] - edges[0]) * (math.pi / teeth / cells)
    return math.pi * low**2 + 2 * teeth * float(cell[~cut].sum())


@pytest.mark.parametrize(("teeth", "shift"), [(24, 0.0), (12, 0.0), (8, 0.5)])
def test_solid_has_the_volume_of_the_gear_that_a_rack_leaves(teeth, shift, tmp_path):
    """Within 0.1 %, undercut too: a large hob of many gashes is nearly that rack."""
    hob = HobTool(1, 1, 240, 4000.0, 1.25, 0.38)
    of = HobbingJob(Gear(teeth, 1.0, ALPHA, 0.0, shift), 1, hob, 5.0, 1.0)
    found = write_gear(tmp_path / "gear.stl", Envelope(of), layout(of))
    assert volume(found) / 5.0 == pytest.approx(rolled_area(teeth, shift), rel=1e-3)


def test_helical_solid_is_closed_and_faces_outwards(tmp_path):
    of = HobbingJob(Gear(11, 1.5, ALPHA, math.radians(30), 0.2), -1, HobTool(2, 1, 10, 40.0, 1.9, 0.5), 8.0, 1.0)
    found = write_gear(tmp_path / "gear.stl", Envelope(of), layout(of))
    edges = {
        (a.tobytes(), b.tobytes()) for facet in found for a, b in zip(facet, np.roll(facet, -1, axis=0), strict=True)
    }
    assert len(edges) == 3 * len(found)
    assert all((b, a) in edges for a, b in edges)
    radius = 11 * 1.5 / math.cos(math.radians(30)) / 2
    assert volume(found) / (8.0 * math.pi * radius**2) == pytest.approx(
        1.0, abs=0.05
    )  # tooth and space are about alike
