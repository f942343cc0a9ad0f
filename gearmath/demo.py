"""The main job on bundled data, end to end: what ``gearmath demo`` runs, step by step, each step timed and printed."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np

import derivations
from derivations import flank as flank_chapter
from derivations import gearbox as gearbox_chapter
from gearmath.arguments.call import checked_call
from gearmath.bevel.contact.mesh import mesh
from gearmath.bevel.contact.pattern import pattern
from gearmath.bevel.contact.report import SIDES as SIDES_OF_CONTACT
from gearmath.bevel.contact.system import Assembly
from gearmath.bevel.design.route import design
from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.pair import check_corrected, load_pair
from gearmath.export.cnc import export_cnc
from gearmath.export.folder import new_folder
from gearmath.export.host import compile_kernel, run_edges
from gearmath.export.teensy import export_teensy
from gearmath.files import write_text
from gearmath.gearbox.simulation import Simulation, simulate
from gearmath.gearbox.train import GearboxPlan, plan
from gearmath.kernels import kernel
from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.milling.mill import mill_member, probed
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.writing.cutting import cutting_program
from gearmath.plot import member_figure, save
from gearmath.quality.contact.pair import MeasuredPair, flanks_of
from gearmath.quality.correction.member import correct
from gearmath.quality.evaluation.pitch import Pitch, evaluate_pitch
from gearmath.quality.evaluation.topography import Topography, evaluate_topography
from gearmath.shown import Shown, Shows
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SIDES
from gearmath.specs.design import load_design
from gearmath.specs.flank_csv import FlankFile, write_flank_csv
from gearmath.specs.hobbing import load_hobbing_machine
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.set_text import save_corrected, set_text
from gearmath.specs.simulated_machine import Probe, SimulatedMachine, load_simulated_machine
from gearmath.specs.toml import bundled

GEAR_SET, MILLING_MACHINE, SHOP = "nasa_tp3096_12x36.toml", "vertical_5axis.toml", "simulated_shop.toml"
DESIGN = "design_7x43.toml"
HOBBING_MACHINE, HOBBED_TEETH, EDGES = "hobbing_plewes.toml", 17, 2_000_000

Say = Callable[[str], object]


@dataclass(frozen=True, repr=False)
class MemberResult(Shown):
    """True state of one member, without probe noise, after the first cut and after the corrected one: ``cut``."""

    member: str
    before: dict[str, Topography]
    after: dict[str, Topography]
    pitch_before: list[Pitch]
    pitch_after: list[Pitch]
    cut: tuple[FlankFile, FlankFile]

    @property
    def profile(self) -> tuple[float, float]:
        """Largest profile deviation of both flanks, with its sign, before and after [mm]."""
        first, second = (max((t.extreme for t in state.values()), key=abs) for state in (self.before, self.after))
        return first, second

    @property
    def cumulative_pitch(self) -> tuple[float, float]:
        """F_p, the larger of both flanks, before and after [mm]."""
        first, second = (max(p.total for p in pitches) for pitches in (self.pitch_before, self.pitch_after))
        return first, second

    def _shown(self) -> tuple[str, list[Shows]]:
        profile, pitch = ([1000 * value for value in values] for values in (self.profile, self.cumulative_pitch))
        return f"{self.member}, before and after the correction", [
            ("largest profile deviation", profile, "um"),
            ("F_p", pitch, "um"),
        ]


@checked_call
def run_demo(folder: str | Path, say: Say) -> list[MemberResult]:
    """Run everything; programs, measurements, corrected sets, pictures and C become the content of ``folder``.

    Raises InputError if the folder holds anything that an earlier demo did not write.
    """
    with new_folder(Path(folder)) as place:
        results = _run_steps(place, say)
    say(f"pictures, programs, measurements, corrected sets and C are in {folder}")
    return results


def _run_steps(folder: Path, say: Say) -> list[MemberResult]:
    begin = time.perf_counter()
    with _step(say, "derive in SymPy, lower to CasADi"):
        kernels = [kernel(name) for name in derivations.index()]
        say(f"  {len(kernels)} expressions, {sum(k.function.n_instructions() for k in kernels)} operations")
    with _step(say, "electronic gearbox: compiled integer rule against exact fractions"):
        _say_gearbox(say, *run_gearbox())
    with _step(say, "one truth: SymPy in 50 digits, CasADi, compiled C, at 45 points of the pinion"):
        _say_truth(say, *compare_truths())
    results = []
    for member in MEMBERS:
        with _step(say, f"{member}: program, virtual cutting, measuring, correction, second cut"):
            result = run_closed_loop(member, folder)
            results.append(result)
            figure = member_figure(
                f"{member}: before and after one correction",
                result.before,
                result.after,
                result.pitch_before,
                result.pitch_after,
            )
            save(figure, folder / f"{member}.png")
            say(f"  max profile error {result.profile[0] * 1000:+.2f} -> {result.profile[1] * 1000:+.2f} um")
    with _step(say, "7 x 43: design; its pinion through the same loop; the contact pattern before and after"):
        designed, shifts = run_designed(folder)
        say(f"  max profile error {designed.profile[0] * 1000:+.2f} -> {designed.profile[1] * 1000:+.2f} um")
        for side, (before, after) in shifts.items():
            say(f"  {side}: the pattern's center is off by {before:.1%} -> {after:.1%} of the face width")
    with _step(say, "export C for the Teensy and for the CNC post-processor"):
        teensy = export_teensy(load_hobbing_machine(bundled(HOBBING_MACHINE)), folder / "teensy")
        cnc = export_cnc(folder / "cnc")
        say(f"  teensy: {len(teensy)} files, cnc: {len(cnc)} files")
    say("")
    say(result_table(results))
    say("")
    say(f"all in {time.perf_counter() - begin:.1f} s")
    return results


def run_gearbox() -> tuple[list[tuple[int, float, int]], GearboxPlan, Simulation]:
    """The table of the source text, the plan of a job, and the compiled step rule over two million reversals."""
    ratio = 3.142
    desired, delivered = (kernel(name) for name in ("desired_position", "floor_position"))
    counts = [row[0] for row in gearbox_chapter.PUBLISHED_TABLE]
    rows = [(e, float(desired(e, ratio)[0]), int(delivered(e, ratio)[0])) for e in counts]
    job = plan(load_hobbing_machine(bundled(HOBBING_MACHINE)), HOBBED_TEETH)
    terms = (job.steps_numerator, job.steps_denominator)
    return rows, job, simulate(run_edges, terms, job.first_remainder, "reversals", EDGES)


def compare_truths() -> tuple[float, int, int]:
    """Largest difference of CasADi to SymPy [mm], and of how many numbers the C is bit-equal to CasADi."""
    member = load_pair(bundled(GEAR_SET)).member("pinion")
    points = solve_flank(member, "concave", blank_grid(member))
    settings, side = member.concave.vector, SIDES["concave"]
    arguments = (*points.contact.T, settings, side)
    lowered = np.hstack(kernel("flank_family")(*arguments))
    compiled = np.hstack(compile_kernel(kernel("flank_family"))(*arguments))
    expression = flank_chapter.flank_family()
    exact = [expression.evaluate(*contact, settings, side) for contact in points.contact]
    worst = max(
        abs(value - float(number))
        for row, values in zip(lowered, exact, strict=True)
        for number, value in zip(row, values, strict=True)
    )
    return float(worst), int((lowered == compiled).sum()), lowered.size


def run_designed(folder: Path) -> tuple[MemberResult, dict[str, tuple[float, float]]]:
    """A pair is designed and its pinion cut, measured, corrected and cut again.

    By side, before and after: how far the center of the contact pattern is from where it is on the nominal flanks, in
    parts of the face width.
    """
    pair = design(load_design(bundled(DESIGN))).pair
    source = folder / "designed.toml"
    write_text(source, set_text(pair))
    pair = load_pair(source)
    result = run_closed_loop("pinion", folder, source, "designed_")
    wanted = _pattern_centers(MeasuredPair(pair, {}))
    width, shifts = pair.member("gear").blank.face_width, []
    for file in result.cut:
        found = _pattern_centers(MeasuredPair(pair, flanks_of(pair, "pinion", file)[0]))
        shifts.append({side: float(np.linalg.norm(found[side] - wanted[side])) / width for side in wanted})
    return result, {side: (shifts[0][side], shifts[1][side]) for side in wanted}


def _pattern_centers(pair: MeasuredPair) -> dict[str, np.ndarray]:
    """Cone distance and height (2,) [mm] of the center of the contact pattern, by side."""
    found = {}
    for side in SIDES_OF_CONTACT:
        figures = pattern(mesh(pair.system(side), Assembly())).figures
        found[side] = np.array([figures["center_cone_distance_mm"], figures["center_height_mm"]])
    return found


def run_closed_loop(member: str, folder: Path, source: Path | None = None, prefix: str = "") -> MemberResult:
    """Cut, measure with a noisy probe, correct, cut again; the result is judged without noise.

    ``source`` is the set, by default the bundled one; names of files begin with ``prefix``.
    """
    shop, name = load_simulated_machine(bundled(SHOP)), prefix + member
    source, corrected = source or bundled(GEAR_SET), folder / f"{name}_corrected.toml"
    first, measured = _cut_and_measure(source, member, shop, folder / f"{name.upper()}_1.MPF")
    write_flank_csv(folder / f"{name}_measured.csv", measured)
    spec = load_pair(source).member(member)
    correction = correct(spec, measured)
    save_corrected(
        source,
        corrected,
        member,
        correction.settings,
        correction.index,
        check=check_corrected,
        origin=f"{name}_measured.csv",
    )
    second, again = _cut_and_measure(corrected, member, shop, folder / f"{name.upper()}_2.MPF")
    write_flank_csv(folder / f"{name}_measured_again.csv", again)
    before, after = ({flank: evaluate_topography(file, flank) for flank in FLANKS} for file in (first, second))
    pitch_before, pitch_after = (
        [pitch for flank in FLANKS if (pitch := evaluate_pitch(file, spec.teeth, flank))] for file in (first, second)
    )
    return MemberResult(member, before, after, pitch_before, pitch_after, (first, second))


def _cut_and_measure(gear_set: Path, name: str, shop: SimulatedMachine, program: Path) -> tuple[FlankFile, FlankFile]:
    """The flanks as they are and as the probe sees them, from the program text as written to ``program``."""
    bevel_set, machine = load_pair(gear_set), load_milling_machine(bundled(MILLING_MACHINE))
    member = bevel_set.member(name)
    write_text(program, cutting_program(bevel_set, name, machine, program.stem, CuttingJob(range(member.teeth))))
    path = execute(program.read_text("utf-8"), program.name, Setup.of(machine))
    true = mill_member(path, member, machine, shop.model_copy(update={"probe": Probe()}))
    return true, probed(true, name, shop)


def result_table(results: list[MemberResult]) -> str:
    """The table of the source text, with our figures."""
    rows = [(f"max profile error ({result.member})", result.profile) for result in results]
    rows += [(f"cumulative pitch error ({result.member})", result.cumulative_pitch) for result in results]
    head = f"{'':34}{'initial / um':>14}{'compensated / um':>18}"
    return "\n".join([head, *(f"{name:34}{old * 1000:14.2f}{new * 1000:18.2f}" for name, (old, new) in rows)])


def _say_gearbox(say: Say, rows: list[tuple[int, float, int]], job: GearboxPlan, run: Simulation) -> None:
    say("  N_e  P_desired  N_delivered   (R = 3.142, the table of the source text)")
    for count, desired, delivered in rows:
        say(f"  {count:3d}  {desired:9.3f}  {delivered:11d}")
    say(f"  {job.teeth} teeth on {job.machine}: {job.steps_numerator}/{job.steps_denominator} steps per count")
    verdict = "never more than half a step" if run.worst_error <= Fraction(1, 2) else "MORE THAN HALF A STEP"
    say(f"  {run.edges} edges with reversals: worst error {float(run.worst_error):.6f} steps, {verdict}")
    say(f"  the float rule on the same edges: worst error {float(run.float_worst_error):.1f} steps")


def _say_truth(say: Say, worst: float, equal: int, numbers: int) -> None:
    say(f"  CasADi to SymPy: at most {worst:.1e} mm; C to CasADi: {equal} of {numbers} numbers are bit-equal")


@contextmanager
def _step(say: Say, title: str) -> Iterator[None]:
    say(f"* {title}")
    begin = time.perf_counter()
    yield
    say(f"  ({time.perf_counter() - begin:.1f} s)")
