"""What ``gearmath runs`` prints."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

from gearmath.cli.common import table
from gearmath.control.store_compare import COVERAGE, Comparison, FigureRow
from gearmath.control.store_run import StoredRun
from gearmath.control.store_summary import RunSummary, parts, summary
from gearmath.errors import counted

#: Longer sentences on how a run stands are cut in a table.
_LONGEST_STATE = 60


def list_text(path: Path, found: Sequence[RunSummary]) -> str:
    """A line a run."""
    if not found:
        return f"{path}: holds no run"
    rows = [
        [
            each.run,
            _local(each.begun),
            each.operator,
            each.member or "ring and spheres",
            each.program,
            f"{each.touches}/{each.points}",
            each.refers_to or "",
            each.alarms or "",
            _short(each.state),
        ]
        for each in found
    ]
    return table(["run", "begun", "operator", "of", "program", "touches", "again of", "alarms", "state"], rows)


def show_values(run: StoredRun) -> dict[str, Any]:
    """All that is stored of a run but touches and texts, for programs."""
    return {
        **vars(summary(run)),
        "settings": dict(run.start.settings),
        "files": [
            {"role": role, "name": name, "bytes": len(content), "sha256": sha256}
            for role, name, content, sha256 in run.store.files(run.id)
        ],
        "sessions": run.sessions(),
        "endings": run.endings(),
        "alarm_list": [vars(alarm) for alarm in run.alarms()],
        "results": sorted(run.results()),
        "missing": run.missing(),
    }


def show_text(values: dict[str, Any]) -> str:
    """The same for people."""
    return "\n".join(_show_lines(values))


def _show_lines(values: dict[str, Any]) -> Iterator[str]:
    what = f"the {values['member']}" if values["member"] else "ring and spheres"
    yield f"run {values['run']}: {values['program']} of {what} on {values['control']}, {values['state']}"
    if values["refers_to"] is not None:
        yield f"points of run {values['refers_to']} probed again"
    yield f"{values['touches']} of {counted(values['points'], 'point')} touched" + _missing_words(values["missing"])
    for session, how in zip(values["sessions"], ["begun", *["gone on with"] * len(values["sessions"])], strict=False):
        by = session["operator"] or "not known"
        yield f"{_local(session['at'])} {how} by {by} on {session['host']}, gearmath {session['gearmath']}"
    yield from (f"{_local(ending['at'])} ended: {ending['outcome']}" for ending in values["endings"])
    for alarm in values["alarm_list"]:
        yield f"alarm {alarm['number']}{'' if alarm['active'] else ' gone'}: {alarm['text']}"
    yield from (f"{name}: {value}" for name, value in values["settings"].items())
    if values["results"]:
        yield f"results: {', '.join(values['results'])}"
    yield ""
    rows = [[each["role"], each["name"], each["bytes"], each["sha256"][:12]] for each in values["files"]]
    yield table(["role", "name", "bytes", "sha256"], rows)


def _missing_words(missing: Sequence[int]) -> str:
    return f"; {len(missing)} missing, the first is point {missing[0]}" if missing else ""


def compare_text(found: Comparison) -> str:
    """Runs, what was not the same, and a table of figures."""
    return "\n".join(_compare_lines(found))


def _compare_lines(found: Comparison) -> Iterator[str]:
    for each in found.runs:
        known = summary(each.run)
        by = f" by {known.operator}" if known.operator else ""
        yield f"run {known.run}: {_local(known.begun)}{by}, {known.program}, {each.name}"
    yield from (f"not the same: {line}" for line in found.differs)
    if not found.differs:
        yield "set, machine, probe, program, control and operator are the same"
    yield ""
    heads = ["flank", "figure / um", *(f"run {each.run.id}" for each in found.runs), "change", "u", ""]
    yield table(heads, [[row.flank, row.name.removesuffix("_um"), *_cells(row)] for row in found.figures])
    yield ""
    first, last = found.runs[0].run.id, found.runs[-1].run.id
    if any(row.beyond_noise is not None for row in found.figures):
        yield f"* a change of more than {COVERAGE:g} u; u is the standard uncertainty by the noise of the touches alone"
    else:
        yield "no u: neither repeated touches nor the corners of several teeth tell the noise of the touches"
    for change in found.changes:
        yield (
            f"{change.flank} flank, run {last} less run {first}: rms {change.rms_um:.3f} um, largest "
            f"{change.largest_um:+.3f} um at row {change.row}, col {change.col}"
        )
    noise = [f"run {each.run.id} {um:.2f} um" for each, um in zip(found.runs, found.noise_um, strict=True) if um]
    if noise:
        yield f"noise of one point that the clamping leaves: {', '.join(noise)}"
    for each in found.runs:
        yield from (f"run {each.run.id}: {line}" for line in (*each.found.first, *each.found.withheld))


def _cells(row: FigureRow) -> list[str]:
    values = ["withheld" if value is None else f"{value:+.3f}" for value in row.values]
    change, u = row.change, row.change_uncertainty
    mark = "*" if row.beyond_noise else ""
    return [*values, "" if change is None else f"{change:+.3f}", "" if u is None else f"{u:.3f}", mark]


def resume_values(run: StoredRun) -> dict[str, Any]:
    """How a run goes on, for programs: the stretches are R90 and R91 of each NC start."""
    missing = run.missing()
    return {
        "run": run.id,
        "refers_to": run.start.refers_to,
        "program": run.start.program,
        "missing": missing,
        "points": len(run.start.points),
        "stretches": [list(each) for each in parts(run, missing)],
    }


def resume_text(values: dict[str, Any]) -> str:
    """The same for people."""
    run, missing = values["run"], values["missing"]
    kept = values["points"] - len(missing)
    lines = [f"run {run}: {kept} of {counted(values['points'], 'point')} touched{_missing_words(missing)}"]
    if values["refers_to"] is not None:
        lines[0] = f"run {run}: begun, to probe {counted(len(missing), 'point')} of run {values['refers_to']} again"
    if not missing:
        return f"{lines[0]}; every point has its touch, and the run is not closed"
    for first, last in values["stretches"]:
        lines.append(f"{values['program']}: R104=1 R90={first} R91={last}, then NC start")
    return "\n".join([*lines, f"with the control: gearmath control measure --resume {run}"])


def _local(at: str) -> str:
    """A time of the store in the time zone of this computer, to the minute."""
    return datetime.fromisoformat(at).astimezone().strftime("%Y-%m-%d %H:%M")


def _short(state: str) -> str:
    return state if len(state) <= _LONGEST_STATE else f"{state[: _LONGEST_STATE - 3]}..."
