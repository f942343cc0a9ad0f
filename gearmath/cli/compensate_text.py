"""What ``gearmath compensate`` says of a correction: two lines for everybody, tables when asked, all of it as JSON."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from gearmath.bevel.identify.variables import reading
from gearmath.cli.common import table
from gearmath.cli.uncertainty import effects_text
from gearmath.errors import counted
from gearmath.quality.correction.analysis import Analysis, weak_words
from gearmath.quality.correction.member import MemberCorrection, setting_changes
from gearmath.specs.bevel_set import Member


def verdict(member: Member, correction: MemberCorrection) -> tuple[str, str]:
    """What remains of what was measured, by which settings; and which limit binds, or what could be reached."""

    remains = []
    for flank, (before, after) in correction.rms.items():
        changes = [
            f"{name} {(new - old) * reading(name)[0]:+.4f} {reading(name)[1]}".rstrip()
            for where, name, old, new in setting_changes(member, correction)
            if where == flank
        ]
        (found,) = (one for group, one in correction.identified.items() if flank in group)
        kept = (
            "expected to remain"
            if found.converged
            else f"left where the fit stopped after {counted(found.iterations, 'step')}"
        )
        remains.append(
            f"{flank} {after * 1000:.2f} um {kept} of {before * 1000:.2f} um "
            f"({', '.join(changes) or 'nothing is changed'})"
        )
    limits = []
    for group, found in correction.identified.items():
        flanks, best = " and ".join(group), correction.reachable[group] * 1000
        if not found.converged:
            limits.append(f"{flanks}: not converged, name fewer settings with --settings")
        elif found.active:
            limits.append(f"{flanks}: held back by the limit of {', '.join(found.active)}, {best:.2f} um at best")
        else:
            limits.append(f"{flanks}: no limit binds, all settings that are free would leave {best:.2f} um")
    return f"RMS: {'; '.join(remains)}", "; ".join(limits)


def say_changes(values: dict[str, Any]) -> Iterator[str]:
    """The table of settings old and new, with their uncertainties where they are known."""

    head = ["flank", "setting", "old", "new", "unit"]
    rows = [
        [change["flank"], change["setting"], f"{change['old']:.6f}", f"{change['new']:.6f}", change["unit"]]
        for change in values["changes"]
    ]
    if "u" in values:
        head.insert(4, "u")
        for row in rows:
            u = values["u"][row[0]].get(row[1])
            row.insert(4, "" if u is None else f"{u:.6f}")
    yield table(head, rows) if rows else "nothing to correct"
    if "no_uncertainties" in values:
        yield f"no uncertainties of settings: {values['no_uncertainties']}"
    yield from effects_text(values)


def say_analysis(flanks: str, analysis: Analysis) -> Iterator[str]:
    """What the measurement tells of the settings that are free."""
    kind = "simple" if analysis.is_simple else "complex"
    yield (
        f"{flanks}: {kind} target, RMS {analysis.rms * 1000:.3f} um; these {len(analysis.names)} settings would leave "
        f"{analysis.best_rms * 1000:.3f} um by a linear estimate without bounds"
    )
    yield "  singular values [um]: " + ", ".join(f"{value * 1000:.3g}" for value in analysis.singular_values)
    for first, second, cosine in analysis.alike:
        how = "alike" if cosine > 0 else "opposite ways"
        yield f"  {first} and {second} move the flank {how} (cosine {cosine:.5f}): correct one of the two only"
    for k in analysis.weak:
        yield f"  hardly measured: {weak_words(analysis, k)}"
    if analysis.unseen:
        yield f"  without effect on the flank: {', '.join(analysis.unseen)}"
    choice = analysis.choose()
    if len(choice.names) < len(analysis.names):
        yield f"  enough: {', '.join(choice.names)}, with a loss of {choice.loss * 1000:.3f} um"


def say_result(correction: MemberCorrection) -> Iterator[str]:
    """What remains of every group of flanks, and how far the root lines move."""
    for group, found in correction.identified.items():
        kept = "expected to remain" if found.converged else "not converged, left so far"
        before, after = correction.measured_rms(group) * 1000, found.rms_after * 1000
        yield f"{' and '.join(group)}: RMS {before:.3f} um, {kept} {after:.3f} um ({found.iterations} iterations)"
    for flank, moved in correction.root.items():
        yield f"{flank}: root line {moved[0] * 1000:+.1f} um at the toe, {moved[1] * 1000:+.1f} um at the heel"
