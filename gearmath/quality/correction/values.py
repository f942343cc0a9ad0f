"""A correction as figures for people and programs, names as ``gearmath compensate --json`` prints them."""

from __future__ import annotations

import math
from typing import Any

from gearmath.bevel.identify.variables import reading
from gearmath.quality.correction.member import MemberCorrection, setting_changes
from gearmath.specs.bevel_set import Member


def correction_values(member: Member, correction: MemberCorrection) -> dict[str, Any]:
    """Settings old and new, what remains, what could be reached and which limit binds: µm, degrees, mm by name."""
    changes = []
    for flank, name, old, new in setting_changes(member, correction):
        factor, unit = reading(name)
        changes.append({"flank": flank, "setting": name, "old": old * factor, "new": new * factor, "unit": unit})
    return {
        "changes": changes,
        "rms_um": {flank: [value * 1000 for value in both] for flank, both in correction.rms.items()},
        "expected_max_um": {flank: value * 1000 for flank, value in correction.expected.items()},
        "index_correction_deg": [] if correction.index is None else [math.degrees(v) for v in correction.index],
        "root_line_um": {flank: [value * 1000 for value in moved] for flank, moved in correction.root.items()},
        "left_out": correction.left_out,
        "rotation_left_open_deg": [math.degrees(angle) for angle in correction.rotation.angles],
        "fits": [_fit_values(correction, group) for group in correction.identified],
    }


def _fit_values(correction: MemberCorrection, group: tuple[str, ...]) -> dict[str, Any]:
    analysis, found = correction.analysis[group], correction.identified[group]
    choice = analysis.choose()
    return {
        "flanks": list(group),
        "free": list(analysis.names),
        "settings": list(dict.fromkeys(variable.name for variable in found.variables)),
        "simple": analysis.is_simple,
        "singular_values_um": [value * 1000 for value in analysis.singular_values],
        "alike": [list(pair) for pair in analysis.alike],
        "weak_directions": [analysis.direction(k) for k in analysis.weak],
        "without_effect": list(analysis.unseen),
        "rms_um": correction.measured_rms(group) * 1000,
        "linear_estimate_rms_um": analysis.best_rms * 1000,
        "reachable_rms_um": correction.reachable[group] * 1000,
        "remaining_rms_um": found.rms_after * 1000,
        "converged": found.converged,
        "enough": {"settings": list(choice.names), "loss_um": choice.loss * 1000},
        "held_back_by": list(found.active),
        "iterations": found.iterations,
    }
