"""The frame of the command: exit status, one sentence, never a traceback."""

from __future__ import annotations

import subprocess
import sys
import types

import click
import pytest

from gearmath import cli
from gearmath.errors import ComputationError, InputError
from gearmath.version import __version__


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    status = 0
    try:
        cli.main(list(arguments))
    except SystemExit as stop:
        status = stop.code if isinstance(stop.code, int) else 1
    captured = capsys.readouterr()
    return status, captured.out, captured.err


@pytest.fixture
def raising(monkeypatch: pytest.MonkeyPatch) -> list[BaseException]:
    """A verb ``try`` that raises what the test puts into the list."""
    errors: list[BaseException] = []

    @click.command("try")
    @click.option("--count", type=int)
    def attempt(count: int | None) -> None:
        if errors:
            raise errors[0]
        click.echo("done")

    module = types.ModuleType("gearmath.cli.tried")
    setattr(module, "try", attempt)
    monkeypatch.setitem(sys.modules, module.__name__, module)
    monkeypatch.setitem(cli.VERBS, "try", ("tried", "A verb of this test."))
    return errors


def test_success_is_status_0(capsys: pytest.CaptureFixture[str], raising: list[BaseException]) -> None:
    assert run(capsys, "try") == (0, "done\n", "")


@pytest.mark.parametrize(
    ("error", "status", "sentence"),
    [
        (InputError("job.toml: teeth = 0:\n  must be at least 1"), 2, "job.toml: teeth = 0: must be at least 1"),
        (ComputationError("pinion, concave, row 3:\nno convergence"), 1, "pinion, concave, row 3: no convergence"),
        (KeyboardInterrupt(), 1, "interrupted"),
    ],
)
def test_bad_news_is_one_line_with_its_status(
    capsys: pytest.CaptureFixture[str],
    raising: list[BaseException],
    error: BaseException,
    status: int,
    sentence: str,
) -> None:
    raising.append(error)
    found, out, err = run(capsys, "try")
    assert (found, out) == (status, "")
    assert err.strip() == f"gearmath: {sentence}"


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["gearbocks"], "gearbocks"),
        (["--fast"], "--fast"),
        (["try", "--count", "many"], "many"),
        (["try", "--size", "3"], "--size"),
        (["try", "more"], "more"),
    ],
)
def test_bad_arguments_are_status_2_and_one_line(
    capsys: pytest.CaptureFixture[str], raising: list[BaseException], arguments: list[str], part: str
) -> None:
    status, out, err = run(capsys, *arguments)
    assert (status, out) == (2, "")
    assert len(err.strip().splitlines()) == 1
    assert part in err


def test_a_slip_in_the_name_of_a_verb_is_answered_with_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(capsys, "evalute", "x.csv") == (2, "", "gearmath: No such command 'evalute'. Did you mean 'evaluate'?\n")
    assert run(capsys, "zzzz") == (2, "", "gearmath: No such command 'zzzz'.\n")


def test_help_lists_every_verb_with_its_line(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = run(capsys, "--help")
    assert (status, err) == (0, "")
    for verb, (_, line) in cli.VERBS.items():
        assert verb in out
        assert line.split()[0] in out


def test_no_verb_at_all_shows_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, _ = run(capsys)
    assert status == 2
    assert "demo" in out


def test_version_is_that_of_the_package(capsys: pytest.CaptureFixture[str]) -> None:
    assert __version__ in run(capsys, "--version")[1]


@pytest.mark.parametrize("verb", list(cli.VERBS))
def test_every_verb_has_help(capsys: pytest.CaptureFixture[str], verb: str) -> None:
    status, out, err = run(capsys, verb, "--help")
    assert (status, err) == (0, "")
    assert out.startswith(f"Usage: gearmath {verb}")


def test_help_loads_nothing_that_computes() -> None:
    code = (
        "import sys\nfrom gearmath.cli import main\n"
        "try: main(['--help'])\n"
        "finally: print('loaded:', *(n for n in ('casadi', 'sympy', 'numpy', 'matplotlib') if n in sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stdout.splitlines()[-1] == "loaded:"


def test_command_of_the_shell_shows_no_traceback() -> None:
    done = subprocess.run(
        [sys.executable, "-c", "from gearmath.cli import main; main()", "gearbocks"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.startswith("gearmath: ")
    assert "Traceback" not in done.stderr
