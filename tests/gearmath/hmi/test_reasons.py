"""What the library says of a failure, in German on a German page: what an operator meets, and the rest."""

from __future__ import annotations

import ast
import functools
import re
from pathlib import Path

import pytest

import gearmath
from gearmath.bevel.pair import load_pair
from gearmath.control.store import MeasurementStore
from gearmath.errors import ComputationError, InputError
from gearmath.hmi.language_files import language_file
from gearmath.hmi.messages import Text
from gearmath.hmi.reasons import english as of_page
from gearmath.hmi.reasons import german
from gearmath.machine.control.file_names import control_name
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.planning.limits import check_spindle_speed
from gearmath.machine.writing.words import check_name
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled, find

PACKAGE = Path(gearmath.__file__).parent
#: What the eight pages call: settings, programs, the control, stored runs, correction, hobbing.
REACHED = (
    "bevel/check_",
    "control/",
    "files.py",
    "front/contact",
    "front/hobbing",
    "gearbox/helix",
    "gearbox/job",
    "gearbox/motion",
    "gearbox/train",
    "gearbox/hobbed/",
    "hmi/",
    "machine/control/file_names",
    "machine/measuring/checked",
    "machine/milling/",
    "machine/planning/",
    "machine/writing/words",
    "quality/contact/",
    "quality/correction/",
    "quality/evaluation/",
)
#: Words of an English sentence that no name or number of a German one is.
ENGLISH = re.compile(r"\b(the|must|is|are|of the|with|which|there|has|were|lies|be)\b")


def _english(sentence: str) -> str:
    """English words in what is shown of a sentence, but for what is quoted and for names."""
    shown = Text("de").quoted(sentence)
    return " ".join(ENGLISH.findall(re.sub(r"'[^']*'|\"[^\"]*\"", "", shown)))


@functools.cache
def _raised() -> dict[str, str]:
    """Where a sentence is raised, and the sentence with a 7 for each of its values."""
    found: dict[str, str] = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        place = path.relative_to(PACKAGE).as_posix()
        if not place.startswith(REACHED):
            continue
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if (
                isinstance(node, ast.Raise)
                and isinstance(node.exc, ast.Call)
                and isinstance(node.exc.func, ast.Name)
                and node.exc.func.id in (InputError.__name__, ComputationError.__name__)
                and isinstance(node.exc.args[0], ast.JoinedStr)
            ):
                parts = (part.value if isinstance(part, ast.Constant) else "7" for part in node.exc.args[0].values)
                found[f"{place}:{node.lineno}"] = "".join(map(str, parts))
    return found


def test_most_sentences_of_the_library_that_the_pages_can_meet_are_known() -> None:
    """The rest is shown in English, and said to be English; a new sentence needs no German on the same day."""
    found = _raised()
    unknown = [f"{place}: {sentence}" for place, sentence in found.items() if german(sentence) is None]
    assert len(found) > 200
    assert len(unknown) <= 0.15 * len(found), "\n".join(unknown)


def test_nothing_english_is_left_in_a_sentence_that_is_known() -> None:
    known = [sentence for sentence in _raised().values() if german(sentence) is not None]
    assert {sentence: words for sentence in known if (words := _english(sentence))} == {}


@pytest.mark.parametrize(
    ("act", "said"),
    [
        (
            lambda: find("missing.toml"),
            "missing.toml: kann nicht gelesen werden: die Datei gibt es nicht; mitgeliefert",
        ),
        (lambda: check_name("CON"), "Programmname 'CON': ist ein reservierter Name des Betriebssystems"),
        (lambda: check_name("A" * 40), "Programmname 'A+': hat 40 Zeichen, erlaubt sind 24"),
        (lambda: control_name("../A.MPF"), "Dateiname '../A.MPF': muss wie PROBE.MPF lauten: 1 bis 24 von"),
        (
            lambda: CuttingJob(roughing_stock=0.1, finishing_stock=0.2),
            "roughing_stock = 0.1 mm: muss mehr sein als das",
        ),
        (
            lambda: check_spindle_speed("CUT", load_milling_machine(bundled("vertical_5axis.toml")), 9e9),
            "CUT: Drehzahl = 9000000000.0 1/min: .* hat .* bis .* 1/min",
        ),
        (
            lambda: MeasurementStore.open(Path("no/where.db"), create=False),
            "no/where.db: diesen Messspeicher gibt es n",
        ),
        (lambda: load_pair(find("/no/such.toml")), "such.toml: kann nicht gelesen werden: die Datei"),
    ],
)
def test_what_an_operator_does_wrong_is_said_in_german(act: object, said: str) -> None:
    with pytest.raises((InputError, ComputationError)) as refused:
        act()  # type: ignore[operator]
    shown = Text("de").quoted(refused.value)
    assert re.search(said, shown), (str(refused.value), shown)
    assert _english(str(refused.value)) == ""


def test_settings_are_called_as_their_fields_are() -> None:
    sentence = "pinion.concave.blade_point_radius = 3: the slot is 0.9 mm wide at the toe, the cutter must be no wider"
    shown = german(sentence)
    assert shown is not None
    assert shown.startswith(
        f"{language_file('messages.toml')['gear']['blade_point_radius']['de']}, Ritzel, konkav = 3: "
    )
    assert shown.endswith("die Lücke ist an der Stelle Zehe 0.9 mm breit, breiter darf der Messerkopf nicht sein")


def test_what_is_not_known_stays_english_as_a_whole_and_is_said_to_be_english() -> None:
    sentence = "simulated control: alarm 65001: coolant pump is out of order"
    assert Text("de").quoted(sentence) == f"Auf Englisch: {sentence}"
    assert Text("en").quoted(sentence) == sentence
    assert Text("de").quoted("") == ""


def test_names_numbers_and_quoted_words_stay_as_they_are() -> None:
    assert german("'the one': must lie between 1.5 and 3 mm") == "'the one': muss zwischen 1.5 und 3 mm liegen"
    assert german("<b>x</b>: must be at most 7") == "<b>x</b>: darf höchstens 7 sein"


def test_every_part_has_the_same_values_in_both_languages() -> None:
    for english, translated in language_file("reasons.toml")["reasons"].items():
        values = [sorted(set(re.findall(r"\{(\w+)\}", words))) for words in (english, translated)]
        assert values[0] == values[1], english


def test_each_part_is_one_that_the_library_says() -> None:
    """A sentence that was reworded shows itself here; a few may be out of date for a while, and cost nothing."""
    said = " ".join(
        str(node.value)
        for path in PACKAGE.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    )
    lost = []
    for english in language_file("reasons.toml")["reasons"]:
        longest = max(re.split(r"\{\w\}|: |; ", english), key=len).strip()
        if len(longest) > 12 and longest not in said:
            lost.append(english)
    assert len(lost) <= 15, "\n".join(lost)


def test_no_sentence_that_a_page_can_meet_names_an_option_of_a_command() -> None:
    found = {place: of_page(re.sub("'gearmath .*?'", "", sentence)) for place, sentence in _raised().items()}
    of_the_command = "hmi/app.py"  # which has no page yet
    named = {place: words for place, words in found.items() if re.search(r"(^|[ ('])--[a-z]", words)}
    assert {place: words for place, words in named.items() if not place.startswith(of_the_command)} == {}


@pytest.mark.parametrize(
    ("sentence", "word"),
    [
        ("mill: ready for PROBE.MPF, 1 touch: start it on the control", "1 Antastung:"),
        ("mill: ready for PROBE.MPF, 1 touch, 3 in later starts: start it on the control", "1 Antastung, 3"),
        ("mill: no program is selected, must be PROBE.MPF: select it at the machine", "kein Programm"),
        ("mill: OTHER.MPF is selected, must be PROBE.MPF: select it at the machine", "OTHER.MPF ist angewählt"),
        ("mill: point 5 is offered, the first one that is missing is 4", "Punkt 5"),
    ],
)
def test_what_a_control_has_of_a_run_is_said_in_german_for_one_touch_and_none_selected(
    sentence: str, word: str
) -> None:
    said = Text("de").quoted(sentence)
    assert word in said
    assert "Englisch" not in said
    assert not _english(sentence)
