"""What several verbs share: the same options, tables and progress bars everywhere."""

from __future__ import annotations

import functools
import json
import os
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gearmath.arguments import kinds
from gearmath.arguments.known import KNOWN, MOST_POINTS
from gearmath.cli.waiting import hidden
from gearmath.errors import InputError
from gearmath.errors import about as about

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gearmath.front.member import Member
    from gearmath.front.sets import GearSet

#: The gear set of a verb whose first argument is another file.
SET_OPTION = click.option(
    "--set", "gear_set", metavar="SET.toml", required=True, help="Gear set: a file, or a bundled one."
)
MEMBER = click.option(
    "--member",
    type=click.Choice(["pinion", "gear"]),
    help="Member of the pair; may be left out where the set has one only, or a file says it.",
)
MACHINE = click.option(
    "--machine", default="vertical_5axis.toml", show_default=True, help="Milling machine: a file, or a bundled one."
)
#: The layouts of files in short, for the end of --help.
FLANK_CSV = (
    "Flank CSV, mm: lines '# key: value', then member, flank, tooth, row, col, x, y, z, nx, ny, nz, deviation_um, "
    "u_um; frame and keys: docs/files.md."
)
TOUCH_CSV = (
    "Touches, mm and degrees: run, point, member, flank, tooth, row, col, X, Y, Z, A, B, triggered; docs/files.md."
)
CALIBRATION_CSV = "Touches, mm and degrees: run, point, target, X, Y, Z, A, B, triggered; docs/files.md."
REGISTER = click.option(
    "--register/--no-register",
    "registered",
    default=True,
    show_default=True,
    help="Take out the clamping (eccentricity, tilt), where the points determine it.",
)
JSON = click.option("--json", "as_json", is_flag=True, help="Print JSON.")


def of(name: str, um: bool = False) -> click.ParamType:
    """What an option may be: the same as the argument of that name in Python, which has mm where it has ``um`` here."""
    kind = KNOWN[name]
    if isinstance(kind, kinds.OneOf):
        return click.Choice([str(one) for one in kind.choices])
    if isinstance(kind, kinds.Whole):
        return click.IntRange(kind.low, kind.high)
    assert isinstance(kind, kinds.Number)
    low, high, unit = (1000 * kind.low, 1000 * kind.high, "um") if um else (kind.low, kind.high, kind.unit)
    return Number(low, high, unit, kind.above)


class Number(click.FloatRange):
    """A number within limits, which nan is not. What is wrong with it is said before any work is done."""

    def __init__(self, low: float, high: float, unit: str = "", above: bool = False) -> None:
        least, most = (int(limit) if limit == int(limit) else limit for limit in (low, high))
        super().__init__(least, most, min_open=above)
        words = f"be greater than {low:g} and at most {high:g}" if above else f"lie between {low:g} and {high:g}"
        self.words = f"must {words} {unit}".rstrip()

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        number = float(click.FLOAT.convert(value, param, ctx))
        low, high = float(self.min or 0), float(self.max or 0)
        if not low <= number <= high or (self.min_open and number == low):
            name = param.opts[0] if param is not None else "value"
            raise InputError(f"{name} = {number:g}: {self.words}")
        return number


class NewFile(click.Path):
    """A file to write: that it can be written there, by no other option too, is checked before any work is done.

    ``suffixes``: how its name ends, where other programs know the file by that; a name that ends as those of another
    kind of file do is refused.
    """

    #: How names of files end that gearmath reads or writes, and of plain text.
    KINDS = frozenset(
        {
            ".csv",
            ".dfq",
            ".htm",
            ".html",
            ".json",
            ".mpf",
            ".ngc",
            ".npz",
            ".pdf",
            ".png",
            ".rexs",
            ".spf",
            ".step",
            ".stl",
            ".stp",
            ".svg",
            ".toml",
            ".txt",
            ".xml",
            ".zip",
        }
    )

    def __init__(self, *suffixes: str) -> None:
        super().__init__(path_type=Path, dir_okay=False)
        self.suffixes = suffixes

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        from gearmath.files import check_place

        path = Path(os.fsdecode(super().convert(value, param, ctx)))
        if self.suffixes and path.suffix.lower() in self.KINDS.difference(self.suffixes):
            option = f"{param.opts[0]} " if param is not None else ""
            raise InputError(f"{option}{path}: the name must end in {' or '.join(self.suffixes)}")
        check_place(path)
        if ctx is not None and param is not None:
            taken = ctx.meta.setdefault(f"{__name__}.written", {})
            first = taken.setdefault(path.resolve(), param.opts[0])
            if first != param.opts[0]:
                raise InputError(f"{param.opts[0]} {path}: {first} is written there already, they must differ")
        return path


def SET(command: Callable[..., Any]) -> Callable[..., Any]:
    """The gear set of a verb as its argument or, as all verbs have it, by --set; the verb gets ``gear_set``."""

    @click.argument("set_argument", metavar="SET.toml", required=False)
    @click.option("--set", "set_option", metavar="SET.toml", help="The gear set, in place of the argument.")
    @functools.wraps(command)
    def with_set(set_argument: str | None, set_option: str | None, **values: Any) -> Any:
        given = [one for one in (set_argument, set_option) if one is not None]
        if len(given) != 1:
            raise click.UsageError(
                "the gear set must be named once, as SET.toml or with --set: a file, or a bundled one"
            )
        return command(gear_set=given[0], **values)

    return with_set


def member_of(pair: GearSet, given: str | None, stated: str | None = None) -> Member:
    """A member: ``given`` by --member, ``stated`` by a file, or the only one of the set.

    Raises InputError where none of these tells it.
    """
    members = list(pair.spec.members)
    name = given or stated or (members[0] if len(members) == 1 else None)
    if name is None:
        raise InputError("--member is missing: the set has both, so it must be pinion or gear")
    return pair.member(name)


def grid_of(size: str) -> tuple[int, int]:
    """Rows and columns of the option --grid. Raises InputError."""
    match = re.fullmatch(r"(\d{1,6})x(\d{1,6})", size)
    rows, columns = (int(part) for part in match.groups()) if match else (0, 0)
    if not (rows >= 2 and columns >= 2 and rows * columns <= MOST_POINTS):
        raise InputError(f"--grid {size}: must read like 5x9, two or more each way, at most {MOST_POINTS} points")
    return rows, columns


def nominal_words(member: Member, flank: str) -> str:
    """What to add where nominal points of a flank are written that is cut with other settings; else nothing."""
    changed = member.spec.flank(flank).design is not None
    return ": the nominal flank, by the settings under 'design', not what the corrected ones cut" if changed else ""


def plot(what: str) -> Any:
    """The option --plot for one picture."""
    return click.option(
        "--plot",
        "picture",
        type=NewFile(".png"),
        metavar="PICTURE.png",
        help=f"Picture to write (PNG): {what}.",
    )


def save_plot(figure: Figure, path: Path, as_json: bool) -> None:
    """Write a picture and say so, on standard error where JSON is printed."""
    from gearmath.plot import save

    save(figure, path)
    click.echo(f"picture: {path}", err=as_json)


#: How names of pages end.
HTML = (".html", ".htm")
#: The option --sheet of programs.
SHEET = click.option(
    "--sheet",
    type=NewFile(*HTML),
    metavar="SETUP.html",
    help="Also write the set-up sheet of the program: a page that prints on A4.",
)


def output(kind: str, *suffixes: str) -> Any:
    """The option -o for one output file, its kind as the help has it, and how its name must end (default: any)."""
    return click.option(
        "-o",
        "--output",
        "target",
        type=NewFile(*suffixes),
        required=True,
        help=f"File to write ({kind}).",
    )


def echo_json(values: Any) -> None:
    """Print a result for programs."""
    click.echo(json.dumps(values, indent=2))


def table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Columns as wide as their widest cell, numbers to the right."""
    cells = [[str(cell) for cell in row] for row in (head, *rows)]
    widths = [max(len(row[k]) for row in cells) for k in range(len(head))]
    left = [not isinstance(rows[0][k], int | float) and not _is_number(cells[1][k]) for k in range(len(head))]
    lines = []
    for row in cells:
        padded = (
            cell.ljust(width) if is_left else cell.rjust(width)
            for cell, width, is_left in zip(row, widths, left, strict=True)
        )
        lines.append("  ".join(padded).rstrip())
    return "\n".join(lines)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


@contextmanager
def bar(total: int, unit: str, quiet: bool = False) -> Iterator[Any]:
    """A progress bar on standard error, only where somebody looks at it."""
    from tqdm import tqdm

    with hidden(), tqdm(total=total, unit=unit, disable=True if quiet else None, leave=False) as progress:
        yield progress.update


@contextmanager
def bars(quiet: bool = False) -> Iterator[Callable[[int, str], Any]]:
    """Progress bars one after the other: each begins, with its total and unit, when the one before ends."""
    with ExitStack() as stack:

        def begin(total: int, unit: str) -> Any:
            stack.close()
            return stack.enter_context(bar(total, unit, quiet))

        yield begin
