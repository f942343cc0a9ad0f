"""What a measurement or a program belongs to is told by digests, and no two methods have the same."""

from __future__ import annotations

from gearmath.specs.bevel_set import Motion, design_sha256, load_bevel_set, settings_sha256
from gearmath.specs.toml import bundled


def test_digests_tell_methods_apart() -> None:
    member = load_bevel_set(bundled("nasa_tp3096_12x36.toml")).gear
    moving = Motion(work_rotation_offset=(0.0, 1.0))
    flanks = {flank: member.flank(flank).model_copy(update={"motion": moving}) for flank in ("concave", "convex")}
    others = [member.model_copy(update=flanks), member.model_copy(update={"generation": "formate"})]
    for digest in (design_sha256, settings_sha256):
        assert len({digest(one) for one in (member, *others)}) == 3
