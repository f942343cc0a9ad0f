"""``gearmath gearbox``: plan a job of the electronic gearbox, and simulate its compiled rule."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gearmath.cli.common import JSON, echo_json, of, plot, save_plot
from gearmath.cli.gearbox_cut import choose, cut

if TYPE_CHECKING:
    from gearmath.front.hobbing import Job
    from gearmath.gearbox.simulation import Pattern
    from gearmath.specs.hobbing import HobbingMachine

LONG_RUN = 20_000_000  # edges; more of them take over two seconds

_JOB = (
    click.argument("machine"),
    click.option("--teeth", type=int, help="Teeth of the gear to be cut (hobbing machine)."),
    click.option("--pitch", help="Pitch of the thread to be cut, such as 1.25mm or 8tpi (lathe)."),
    click.option("--starts", type=int, help="Starts of the hob, instead of the machine file's; of the thread."),
    click.option("--hand", type=of("hand"), help="Hand of helix or thread; right if left out."),
    click.option("--helix", type=float, help="Helix angle in degrees."),
    click.option("--cut", type=of("cut"), help="Sense of the feed; climb if left out."),
    click.option("--feed", help="Feed in mm per turn of the table, for a helix without an encoder on the feed."),
    click.option("--hob", help="One hob of the machine file, such as 32dp or m1; all of them if left out."),
    click.option("--shift", type=float, help="Profile shift in modules."),
    click.option("--pin", type=float, help="Diameter of the measuring pins in mm; 1.68 modules if left out."),
    click.option("--run-up", type=float, help="Seconds of the hob or spindle from rest to its speed, or to rest."),
    click.option(
        "--rpm", type=float, help="Speed of hob or spindle; 90 % of the highest within the limits if left out."
    ),
)


def _job_options(command: Callable) -> Callable:
    """The arguments of a job, handed over as ``job``: the plan of it."""

    @functools.wraps(command)
    def with_plan(machine: str, **options: Any) -> Any:
        own = {key: options.pop(key) for key in list(options) if key not in _KEYS}
        from gearmath.front.machines import load_hobber

        return command(job=_plan(load_hobber(machine), options), **own)

    for option in reversed(_JOB):
        with_plan = option(with_plan)
    return with_plan


_KEYS = ("teeth", "pitch", "starts", "hand", "helix", "cut", "feed", "hob", "shift", "pin", "run_up", "rpm")
_THREAD_KEYS = ("pitch", "starts", "hand", "run_up", "rpm")


@click.group()
def gearbox() -> None:
    """Electronic gearbox of a hobbing machine or a lathe: plan a job, simulate the rule, cut a gear virtually.

    MACHINE is a TOML file, or the name of one that comes with the package, such as hobbing_plewes.toml. Every key of it
    is in docs/gearbox_file.md.
    """


gearbox.add_command(cut)
gearbox.add_command(choose)


@gearbox.command("plan")
@_job_options
@JSON
def plan_job(job: Job, as_json: bool) -> None:
    """Exact ratio, rates against the limits, and what to set and measure."""
    from gearmath.cli.gearbox_text import plan_text

    if as_json:
        echo_json(job.to_dict())
    else:
        click.echo(plan_text(job.plan, job.machine))


@gearbox.command("simulate")
@_job_options
@click.option("--pattern", type=of("pattern"), required=True)
@click.option("--edges", type=click.IntRange(min=1), required=True, help="Encoder edges to run through.")
@click.option("--start", type=click.IntRange(min=0), default=0, show_default=True, help="Count before the first edge.")
@click.option("--seed", type=of("seed"), default=0, show_default=True, help="Seed of the random reversals.")
@plot("the errors over time")
@JSON
def simulate(
    job: Job,
    pattern: Pattern,
    edges: int,
    start: int,
    seed: int,
    picture: Path | None,
    as_json: bool,
) -> None:
    """Run the compiled step rule, and the floating rule of the source text beside it; worst errors in steps."""
    from tqdm import tqdm

    from gearmath.cli.gearbox_text import simulation_text
    from gearmath.front.hobbing import plain_numbers
    from gearmath.gearbox.simulation import Trace

    trace, plan = Trace(edges), job.plan
    with tqdm(total=edges, unit="edge", unit_scale=True, disable=edges < LONG_RUN or None) as bar:
        result = job.simulate(pattern, edges, seed, start, trace, bar.update)
    if picture is not None:
        save_plot(job.plot(trace=trace), picture, as_json)
    if as_json:
        terms = ("steps_numerator", "steps_denominator", "feed_numerator")
        echo_json(plain_numbers({key: getattr(plan, key) for key in terms} | asdict(result)))
    else:
        click.echo(simulation_text(result, plan))


def _plan(machine: HobbingMachine, options: dict[str, Any]) -> Job:
    """The plan of a gear or of a thread, by the machine's profile."""
    from gearmath.front.hobbing import plan

    given = {key: value for key, value in options.items() if value is not None}
    needed, other = ("pitch", "teeth") if machine.profile == "lathe" else ("teeth", "pitch")
    if needed not in given or other in given:
        kind = "lathe" if machine.profile == "lathe" else "hobbing machine"
        raise click.UsageError(f"{machine.name} is a {kind}: give --{needed}, and no --{other}")
    if machine.profile == "lathe":
        unfit = sorted(set(given) - set(_THREAD_KEYS))
        if unfit:
            raise click.UsageError(f"--{unfit[0]} has no meaning for a thread")
    elif "helix" not in given:
        for key in ("hand", "cut", "feed"):
            if key in given:
                raise click.UsageError(f"--{key} has no meaning without --helix")
    return plan(machine, **given)
