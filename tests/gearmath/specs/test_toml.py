"""TOML that is wrong is refused in one line that names file, key, value and limit."""

from __future__ import annotations

import datetime
import importlib
import pkgutil
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from pydantic import Field, model_validator

from gearmath import specs
from gearmath.errors import InputError
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.calibration import load_calibration
from gearmath.specs.design import load_design
from gearmath.specs.hobbing import load_hobbing_machine
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.simulated_machine import load_simulated_machine
from gearmath.specs.toml import Spec, bundled, checked, load, parse, rechecked


class Blade(Spec):
    angle_deg: float = Field(gt=0, lt=45)
    side: str = "outer"


class Job(Spec):
    teeth: int = Field(ge=1, le=999)
    blade: Blade
    heights: tuple[float, ...] = Field(default=(), strict=False)

    @model_validator(mode="after")
    def _few_heights(self) -> Job:
        if len(self.heights) > 3:
            raise ValueError(f"heights has {len(self.heights)} entries, at most 3 are allowed")
        return self


GOOD = "teeth = 12\nheights = [1.0, 2.5]\n[blade]\nangle_deg = 20.0\n"


def test_good_file_becomes_the_model(tmp_path: Path) -> None:
    path = tmp_path / "job.toml"
    path.write_text(GOOD)
    assert load(path, Job) == Job(teeth=12, blade=Blade(angle_deg=20.0), heights=(1.0, 2.5))


@pytest.mark.parametrize(
    ("change", "parts"),
    [
        (("teeth = 12\n", ""), ["teeth", "missing"]),
        (("teeth = 12\n", "teeth = 12\nteehts = 13\n"), ["teehts: no such key; did you mean teeth?"]),
        (("angle_deg = 20.0", "angle_deg = 95.0"), ["blade.angle_deg = 95.0", "less than 45"]),
        (("angle_deg = 20.0", "angle_deg = nan"), ["blade.angle_deg = nan", "finite"]),
        (("angle_deg = 20.0", "angle_deg = inf"), ["blade.angle_deg = inf", "finite"]),
        (("angle_deg = 20.0", 'angle_deg = "20"'), ["blade.angle_deg = '20'", "number"]),
        (("angle_deg = 20.0", "angle_deg = true"), ["blade.angle_deg = true", "number"]),
        (("teeth = 12", "teeth = 1000"), ["teeth = 1000", "999"]),
        (("teeth = 12", "teeth = 12.5"), ["teeth = 12.5", "whole number"]),
        (("[1.0, 2.5]", "[1, 2, 3, 4]"), ["heights has 4 entries, at most 3"]),
        (("[1.0, 2.5]", "[1.0, nan]"), ["heights #2 = nan", "finite"]),
        (("[blade]\nangle_deg = 20.0\n", ""), ["blade", "missing"]),
        (("[blade]", "[blade"), ["is no TOML", "line 3"]),
        (("teeth = 12", "teeth = 12\nteeth = 13"), ["is no TOML", "line 2"]),
    ],
)
def test_bad_file_is_refused_by_file_key_value_and_limit(change: tuple[str, str], parts: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        parse(GOOD.replace(*change), Job, "job.toml")
    message = str(caught.value)
    assert message.startswith("job.toml: ")
    assert "\n" not in message
    assert [part for part in parts if part not in message] == []


def test_further_faults_are_counted() -> None:
    with pytest.raises(InputError, match=r"\(and 2 more\)"):
        parse("teeth = 0\nspare = 1\n[blade]\nangle_deg = 0.0\n", Job, "job.toml")


def test_missing_file_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"absent\.toml: cannot be read: No such file"):
        load(tmp_path / "absent.toml", Job)


def test_unknown_bundled_file_is_refused_with_the_list_of_those_there_are() -> None:
    with pytest.raises(InputError, match=r"absent\.toml: cannot be read: .* bundled are .*nasa_tp3096_12x36\.toml"):
        bundled("absent.toml")
    assert bundled("nasa_tp3096_12x36.toml").is_file()


def test_models_cannot_be_changed_afterwards() -> None:
    with pytest.raises(ValueError, match="frozen"):
        parse(GOOD, Job, "job.toml").teeth = 13  # type: ignore[misc]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (("teeth = 12", "teth = 12"), r"teth: no such key; did you mean teeth\?$"),
        (("angle_deg = 20.0", "angel_deg = 20.0"), r"blade\.angel_deg: no such key; did you mean angle_deg\?$"),
        (("[blade]", "[balde]"), r"balde: no such key; did you mean blade\?$"),
        (("angle_deg = 20.0", "angle_dag = 20.0\nside = 3"), r"blade\.angle_dag: .* angle_deg\? \(and 1 more\)$"),
        (
            ("angle_deg = 20.0", "width = 20.0"),
            r"blade\.width = 20\.0: no such key .*; blade\.angle_deg is missing \(and 1 more\)$",
        ),
    ],
)
def test_misspelt_key_is_named_before_the_key_that_is_missing_for_it(change: tuple[str, str], sentence: str) -> None:
    with pytest.raises(InputError, match=r"^job\.toml: " + sentence):
        parse(GOOD.replace(*change), Job, "job.toml")


class Shop(Spec):
    jobs: tuple[Job, ...] = Field(strict=False)
    spare: Blade | None = None


def test_misspelt_key_is_sought_among_the_keys_of_its_own_table() -> None:
    with pytest.raises(InputError, match=r"^shop\.toml: jobs #1\.teetj: no such key; did you mean teeth\?"):
        parse("[[jobs]]\nteetj = 1\n", Shop, "shop.toml")
    with pytest.raises(InputError, match=r"^shop\.toml: spare\.teetj = 1: no such key is known here"):
        parse("jobs = []\n[spare]\nteetj = 1\n", Shop, "shop.toml")


def models(base: type[Spec] = Spec) -> Iterator[type[Spec]]:
    """Every file model of the package."""
    for model in base.__subclasses__():
        yield from models(model)
        if model.__module__.startswith("gearmath."):
            yield model


#: A value of each kind that TOML has, some beyond all limits.
KINDS = (
    True,
    -1,
    10**400,
    12.5,
    -1e300,
    float("nan"),
    "",
    "abc",
    "12.5",
    "x" * 2000,
    [],
    [1.0, "a"],
    [[1]],
    [0.0] * 99,
    {},
    {"foo": 1},
    datetime.date(2026, 1, 2),
    datetime.time(3, 4),
    datetime.datetime(2026, 1, 2, 3, 4),
)
#: Words of pydantic and of Python.
FOREIGN = re.compile(
    r"Input|should|valid\b|parse|instance|tuple|dict|float|integer|permitted|Field|True|False|datetime|\bNone\b|literal"
)


def test_whatever_stands_at_a_key_is_refused_in_words_of_our_own() -> None:
    for module in pkgutil.iter_modules(specs.__path__):
        importlib.import_module(f"gearmath.specs.{module.name}")
    said = 0
    for model in set(models()):
        for key, field in model.model_fields.items():
            for value in KINDS:
                try:
                    checked(
                        {field.validation_alias if isinstance(field.validation_alias, str) else key: value}, model, "f"
                    )
                except InputError as error:
                    sentence = str(error)
                    said += f"{key} = " in sentence or f"{key}: " in sentence
                    assert "\n" not in sentence
                    assert len(sentence) < 400
                    assert not FOREIGN.search(re.sub(r"'[^']*'", "", sentence)), sentence
    assert said > 1000


@pytest.mark.parametrize(
    "load_file",
    [
        load_bevel_set,
        load_calibration,
        load_design,
        load_hobbing_machine,
        load_milling_machine,
        load_simulated_machine,
    ],
)
def test_what_a_bundled_file_holds_is_accepted_when_it_is_checked_again(load_file: Callable[[Path], Spec]) -> None:
    """Fractions, pitches and angles were text in the file and are none in the record."""
    checked_again = 0
    for path in sorted(bundled("probe.toml").parent.glob("*.toml")):
        try:
            spec = load_file(path)
        except InputError:
            continue  # a file of another kind
        assert rechecked(spec, "again") is spec
        checked_again += 1
    assert checked_again
