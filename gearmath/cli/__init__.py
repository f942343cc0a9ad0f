"""The command ``gearmath``: one sentence and status 2 on bad input, 1 on failure, never a traceback.

Each verb lives in the module of its group and loads what it computes with when it runs, so that ``--help`` is quick.
"""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Sequence

import click

from gearmath.cli.waiting import waiting
from gearmath.errors import ComputationError, InputError

#: verb -> (module, its one-line help; kept here so that the list of verbs needs no import)
VERBS = {
    "demo": ("demo", "The whole closed loop on a bundled gear set and a bundled hobbing machine."),
    "gearbox": ("gearbox", "Electronic gearbox of a hobbing machine: plan a job, simulate the rule."),
    "blank": ("blank", "The blank of a pair from its design data, as table, JSON or part of a gear set."),
    "design": ("design", "A pair from a few design data: blank and settings that run as asked."),
    "flank": ("bevel", "Nominal points and outward normals of one flank."),
    "tooth": ("bevel", "Whole teeth of a member: figures, and an STL of a space or of the whole member."),
    "contact": ("contact", "How a pair runs: path of contact, transmission error, V-H check."),
    "nc": ("machine", "NC programs for the vertical 5-axis machine."),
    "mill": ("mill", "Virtual milling from the program text."),
    "probe": ("probe_run", "Run a program of 'nc probe' or 'nc calibrate' on the machine model: raw touches."),
    "touches": ("probe", "Raw touches of a probe to measured points."),
    "calibrate": ("probe", "The tip of the probe from its touches on ring and sphere."),
    "points": ("points", "Points of another measuring machine, as text, to measured points."),
    "evaluate": ("quality", "Pitch, profile and topography of a measured member."),
    "compensate": ("compensate", "Corrected machine settings from a measurement."),
    "stock": ("compensate", "How a precut blank must stand so that both flanks share its stock."),
    "report": ("report", "The inspection sheet of a measured member, or of both: charts, figures, settings."),
    "uncertainty": ("uncertainty", "How sure the figures of a measured member are."),
    "control": ("control", "The machine control over OPC UA: state, files, alarms, measuring; a simulated one."),
    "runs": ("runs", "The measurement store: list, show, export, compare and resume runs."),
    "hmi": ("hmi", "The operator's page: the loop from a browser."),
    "rexs": ("rexs", "A gear set out of a REXS file."),
    "export": ("export", "C for the machines; STEP, STL, REXS and points for other programs."),
}


class _LazyGroup(click.Group):
    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(VERBS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name not in VERBS:
            if not (name.startswith("-") or ctx.resilient_parsing):
                from difflib import get_close_matches

                # click itself looks among commands that are loaded, of which there are none
                near = get_close_matches(name, VERBS, 1)
                ctx.fail(f"No such command {name!r}." + "".join(f" Did you mean {one!r}?" for one in near))
            return None
        module = importlib.import_module(f"gearmath.cli.{VERBS[name][0]}")
        return getattr(module, name)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl([(name, text) for name, (_, text) in VERBS.items()])


def _version(context: click.Context, _: click.Parameter, wanted: bool) -> None:
    """Print the version, which is looked for where somebody asks: that takes a tenth of the start."""
    if wanted:
        from gearmath.version import __version__

        click.echo(f"gearmath, version {__version__}")
        context.exit()


@click.group(cls=_LazyGroup)
@click.option(
    "--version", is_flag=True, is_eager=True, expose_value=False, callback=_version, help="Show the version and exit."
)
def gearmath() -> None:
    """Gear cutting from first principles to metal."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command and exit with its status."""
    # before anything heavy is loaded: small matrices on several threads of the BLAS wait more than they compute, and
    # looking for plugins of pydantic, which no model here has, takes a tenth of a short command
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    try:
        with waiting("gearmath"):
            gearmath.main(args=arguments, prog_name="gearmath", standalone_mode=False)
    except InputError as error:
        sys.exit(_say(str(error), 2))
    except ComputationError as error:
        sys.exit(_say(str(error), 1))
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.ctx.get_help())
        sys.exit(2)
    except click.ClickException as error:
        sys.exit(_say(error.format_message(), 2))
    except click.Abort:
        sys.exit(_say("interrupted", 1))


def _say(sentence: str, status: int) -> int:
    click.echo(f"gearmath: {' '.join(sentence.split())}", err=True)
    return status
