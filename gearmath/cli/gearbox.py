"""``gearmath gearbox``: plan a job of the electronic gearbox, and simulate its compiled rule."""

from __future__ import annotations

import json
from dataclasses import asdict
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from gearmath.gearbox.simulation import Pattern, Simulation
    from gearmath.gearbox.train import GearboxPlan
    from gearmath.specs.hobbing import HobbingMachine

LONG_RUN = 20_000_000  # edges; more of them take over two seconds


@click.group()
def gearbox() -> None:
    """Electronic gearbox of a hobbing machine: plan a job, simulate the rule.

    MACHINE is a TOML file, or the name of one that comes with the package, such as hobbing_plewes.toml.
    """


@gearbox.command("plan")
@click.argument("machine")
@click.option("--teeth", type=int, required=True, help="Teeth of the gear to be cut.")
@click.option("--starts", type=int, help="Starts of the hob, instead of those in the machine file.")
@click.option("--hob", help="One hob of the machine file, such as 32dp or m1; all of them if left out.")
@click.option("--rpm", type=float, help="Speed of the hob; the highest within the limits if left out.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def plan_job(
    machine: str, teeth: int, starts: int | None, hob: str | None, rpm: float | None, as_json: bool
) -> None:  # fmt: skip
    """Exact ratio, rates against the limits, blank and depth of one job."""
    from gearmath.gearbox.train import plan

    job = plan(_machine(machine), teeth, starts, hob, rpm)
    click.echo(json.dumps(asdict(job), indent=2) if as_json else _plan_text(job))


@gearbox.command("simulate")
@click.argument("machine")
@click.option("--teeth", type=int, required=True, help="Teeth of the gear to be cut.")
@click.option("--starts", type=int, help="Starts of the hob, instead of those in the machine file.")
@click.option("--pattern", type=click.Choice(["forward", "dither", "reversals"]), required=True)
@click.option("--edges", type=click.IntRange(min=1), required=True, help="Encoder edges to run through.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the random reversals.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def simulate_job(
    machine: str, teeth: int, starts: int | None, pattern: Pattern, edges: int, seed: int, as_json: bool
) -> None:
    """Run the compiled step rule, and the floating rule of the source text beside it; worst errors in steps."""
    from tqdm import tqdm

    from gearmath.export.host import run_edges
    from gearmath.gearbox.simulation import simulate
    from gearmath.gearbox.train import plan

    job = plan(_machine(machine), teeth, starts)
    ratio = (job.steps_numerator, job.steps_denominator)
    with tqdm(total=edges, unit="edge", unit_scale=True, disable=edges < LONG_RUN or None) as bar:
        result = simulate(run_edges, ratio, job.first_remainder, pattern, edges, seed, bar.update)
    click.echo(json.dumps(_simulation_values(result, ratio), indent=2) if as_json else _simulation_text(result, ratio))


def _machine(name: str) -> HobbingMachine:
    """A machine file by its path, or by the name of a bundled one."""
    from gearmath.specs.hobbing import load_hobbing_machine
    from gearmath.specs.toml import find

    return load_hobbing_machine(find(name))


def _plan_text(job: GearboxPlan) -> str:
    from gearmath.specs.hobbing import INCH

    rows = [
        f"{job.machine}: {job.teeth} teeth, {job.hob_starts}-start hob",
        f"  R = {job.exact_pulse_ratio} = {job.pulse_ratio:.9g} encoder counts per motor step",
        f"  hob    {job.rpm:9.1f} rpm   {job.hob_rpm_percent:5.1f} % of the limit ({job.highest_rpm:.1f} rpm at most)",
        f"  edges  {job.edge_rate_hz:9.0f} Hz",
        f"  steps  {job.step_rate_hz:9.0f} Hz    {job.step_rate_percent:5.1f} % of the limit",
        "  hob        blank diameter        depth of cut",
    ]
    for blank in job.blanks:
        diameter, depth = blank.blank_diameter, blank.cut_depth
        rows.append(
            f"  {blank.hob:8s} {diameter:9.3f} mm {diameter / INCH:7.4f} in "
            f"{depth:7.3f} mm {depth / INCH:7.4f} in  ({blank.depth_rule})"
        )
    return "\n".join(rows)


def _simulation_values(result: Simulation, ratio: tuple[int, int]) -> dict[str, Any]:
    values = {"steps_numerator": ratio[0], "steps_denominator": ratio[1]} | asdict(result)
    exact = {f"{key}_exact": str(value) for key, value in values.items() if isinstance(value, Fraction)}
    return {key: float(value) if isinstance(value, Fraction) else value for key, value in values.items()} | exact


def _simulation_text(result: Simulation, ratio: tuple[int, int]) -> str:
    return "\n".join([
        f"{result.edges} edges, {result.pattern}, {ratio[0]}/{ratio[1]} steps per count; the hob ends at count "
        f"{result.encoder_position}",
        f"  compiled integer rule    worst error {float(result.worst_error):10.4f} steps, "
        f"exactly {result.worst_error}; the table ends at step {result.position}",
        f"  float32 rule             worst error {float(result.float_worst_error):10.4f} steps; "
        f"the table ends at step {result.float_position}",
    ])  # fmt: skip
