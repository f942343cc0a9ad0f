"""A gear that was cut virtually, in plain numbers by name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from gearmath.gearbox.hobbed.classes import NOT_CONFIRMED, outside
from gearmath.gearbox.hobbed.contributions import Contribution
from gearmath.gearbox.hobbed.setup import CutSetup, VirtualGear, ridges


def cut_values(cut: CutSetup, gears: Sequence[VirtualGear], shares: Sequence[Contribution]) -> dict[str, Any]:
    """What was cut, figures with their classes, who is to blame. Figures in µm, dimensions in mm."""
    job = cut.job
    flat, mark = ridges(job)
    return {
        "machine": cut.train.machine.name,
        "teeth": job.gear.teeth,
        "module": job.gear.module,
        "profile_shift": job.gear.shift,
        "hob": {
            "name": cut.hob_name,
            "starts": job.hob.starts,
            "gashes": job.hob.gashes,
            "diameter": job.hob.diameter,
            "diameter_assumed": cut.assumed_diameter,
            "tip_radius": job.hob.tip_radius,
            "protuberance": job.hob.protuberance,
            "topping": job.hob.dedendum is not None,
            "gash_lead": job.hob.gash_lead,
            "shift": job.hob_offset,
            "shift_range": cut.offsets,
        },
        "face_width": job.face_width,
        "feed": job.feed,
        "rpm": cut.train.rpm,
        "seconds": cut.train.seconds,
        "generating_length": cut.hob_length,
        "generating_flat_um": flat * 1000,
        "feed_mark_um": mark * 1000,
        "tolerances": NOT_CONFIRMED,
        "not_covered": outside(job),
        "gears": [
            {
                "rule": gear.rule,
                "accuracy_class": gear.accuracy_class,
                "figures": [asdict(row) for row in gear.classes],
                "thickness": [asdict(each) for each in gear.found.thicknesses],
            }
            for gear in gears
        ],
        "contributions": [asdict(share) for share in shares],
    }
