"""Options alike across verbs: --set wherever a gear set is read, --member only where no file tells it."""

from __future__ import annotations

import click
import pytest

from gearmath import cli
from gearmath.specs.toml import bundled

SET = "nasa_tp3096_12x36.toml"


def verbs() -> dict[str, click.Command]:
    """Every command with its whole name."""
    found: dict[str, click.Command] = {}

    def walk(group: click.Group, before: str) -> None:
        context = click.Context(group)
        for name in group.list_commands(context):
            command = group.get_command(context, name)
            if isinstance(command, click.Group):
                walk(command, f"{before}{name} ")
            elif command is not None:
                found[before + name] = command

    walk(cli.gearmath, "")
    return found


def options(command: click.Command) -> dict[str, click.Parameter]:
    return {text: parameter for parameter in command.params for text in parameter.opts}


READ_A_SET = [
    "flank",
    "tooth",
    "nc cut",
    "nc probe",
    "mill",
    "probe",
    "touches",
    "points",
    "evaluate",
    "compensate",
    "stock",
    "report",
    "uncertainty",
    "contact",
    "control measure",
    "control simulate",
    "export points",
    "export rexs",
    "export step",
    "export stl",
    "export summary",
]


@pytest.mark.parametrize("verb", READ_A_SET)
def test_a_gear_set_is_always_named_by_set(verb):
    parameter = options(verbs()[verb])["--set"]
    assert isinstance(parameter, click.Option)
    assert not parameter.is_flag


def test_set_and_member_mean_the_same_wherever_they_stand():
    for verb, command in verbs().items():
        for text in ("--set", "--member"):
            if text in options(command):
                assert verb in READ_A_SET, f"{verb} has {text}"


@pytest.mark.parametrize("text", ["-o", "--plot"])
def test_output_and_plot_name_a_file_or_folder_to_write(text):
    for verb, command in verbs().items():
        parameter = options(command).get(text)
        assert parameter is None or isinstance(parameter.type, click.Path), f"{verb} {text}"


def test_a_set_may_be_named_either_way_but_once(command, refused, tmp_path):
    outputs = []
    for given in ((SET,), ("--set", SET)):
        target = tmp_path / "f.csv"
        assert command("flank", *given, "--member", "gear", "--flank", "convex", "-o", target)[0] == 0
        outputs.append(target.read_bytes())
    assert outputs[0] == outputs[1]
    rest = ("--member", "gear", "--flank", "convex", "-o", tmp_path / "g.csv")
    refused("the gear set must be named once", "flank", SET, "--set", SET, *rest)
    refused("the gear set must be named once", "flank", *rest)
    assert not (tmp_path / "g.csv").exists()


def test_member_is_asked_for_only_where_nothing_tells_it(command, refused, tmp_path):
    """A set of both members needs --member; a set of one does not, nor a program, nor a measured file."""
    rest = ("--flank", "concave", "-o", tmp_path / "f.csv")
    refused("--member is missing: the set has both", "flank", SET, *rest)
    text = bundled(SET).read_text("utf-8")
    alone = tmp_path / "pinion.toml"
    alone.write_text(text[: text.index("[gear]")], "utf-8")
    assert command("flank", alone, *rest)[0] == 0
    program, metal = tmp_path / "GEAR.MPF", tmp_path / "m.csv"
    assert command("nc", "cut", SET, "--member", "gear", "--spaces", "0", "--tolerance-um", "5", "-o", program)[0] == 0
    status, _, err = command("mill", SET, "--program", program, "-o", metal)
    assert status == 0, err
    status, _, err = command("compensate", SET, "--measured", metal, "-o", tmp_path / "new.toml")
    assert status == 0, err
    refused("member = 'gear'", "compensate", SET, "--member", "pinion", "--measured", metal, "-o", tmp_path / "n.toml")


def test_two_files_of_one_command_must_differ(refused, tmp_path):
    """The report would replace the measured flanks."""
    target = tmp_path / "m.csv"
    rest = ("--program", tmp_path / "CUT.MPF", "--report", target, "-o", target)
    refused("-o .*m.csv: --report is written there already", "mill", SET, *rest)
    assert not target.exists()
