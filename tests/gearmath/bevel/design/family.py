"""Pairs of the family that designs are drawn from."""

from __future__ import annotations

import math
import random
from typing import Any

from gearmath.specs.design import DesignData
from gearmath.specs.toml import checked


def mixed(seed: int) -> DesignData:
    """A pair of the family of issue 13: tooth counts, ratio, spiral angle, cutter and the methods of both members."""
    draw = random.Random(seed)
    z_1, ratio = draw.randint(7, 20), draw.uniform(2, 7)
    z_2, spiral, cutter = round(z_1 * ratio), draw.uniform(25, 40), draw.uniform(0.8, 1.5)
    generation, module = draw.choice(["generated", "formate"]), draw.uniform(2.5, 6)
    outer = module * z_2 / 2 / math.sin(math.atan2(z_2, z_1))
    width = min(0.3 * outer, 10 * module)
    values: dict[str, Any] = {
        "title": str(seed),
        "pinion_teeth": z_1,
        "wheel_teeth": z_2,
        "outer_transverse_module": module,
        "face_width": width,
        "mean_spiral_angle": spiral,
        "cutter": {"cutter_radius": cutter * (outer - width / 2)},
        "gear": {"generation": generation},
        "hand": draw.choice(["left", "right"]),
    }
    draw = random.Random(f"method {seed}")
    method, groups = draw.choice(["fixed", "completing", "hobbed"]), draw.randint(7, 17)
    if method != "fixed":
        values["pinion"] = {"cutting": "completing"}
    if method == "hobbed":
        values["cutter"] |= {"process": "face_hobbing", "blade_groups": groups}
    return checked(values, DesignData, str(seed))
