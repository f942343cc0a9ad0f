"""The repository itself: layers, what may be committed, and that the documents say what is there."""

from __future__ import annotations

import ast
import importlib
import json
import math
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from gearmath.cli import VERBS
from tests.arrows import arrows_of, circles

ROOT = Path(__file__).parents[2]
TOP_LEVEL = {
    ".ci",
    ".editorconfig",
    ".github",
    ".gitignore",
    ".pre-commit-config.yaml",
    "CHANGELOG.md",
    "CITATION.cff",
    "CONTRIBUTING.md",
    "LICENSE",
    "Makefile",
    "README.md",
    "derivations",
    "docs",
    "gearmath",
    "notebooks",
    "pyproject.toml",
    "tests",
}
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))


def git(*arguments: str) -> list[str]:
    """The files that git names; a copy without git cannot tell what is committed."""
    if not (ROOT / ".git").exists():
        pytest.skip("needs a git checkout")
    command = ["git", "-c", f"safe.directory={ROOT}", "ls-files", "-z", *arguments]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return [name for name in listed.split("\0") if name and (ROOT / name).is_file()]


def of_the_project() -> list[str]:
    """Committed files, and those that would be."""
    return git("--cached", "--others", "--exclude-standard")


def texts() -> list[tuple[str, str]]:
    found = []
    for name in of_the_project():
        content = (ROOT / name).read_bytes()
        if b"\0" not in content:
            found.append((name, content.decode("utf-8")))
    return found


def pyproject() -> dict:
    return tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))


def test_layers_hold() -> None:
    command = [str(Path(sys.executable).with_name("lint-imports")), "--no-cache"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_no_folder_imports_in_a_circle() -> None:
    _, arrows, upward = arrows_of()
    assert not circles(arrows)
    assert not upward


def test_walks_of_contributing_have_at_most_eight_stations_and_all_of_them_exist() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text("utf-8").split("## Three walks")[1].split("\n## ")[0]
    walks = [walk for walk in text.split("\n\n") if "→" in walk]
    assert len(walks) == 3
    for walk in walks:
        stations = re.findall(r"`((?:\w+\.)+\w+)`", walk)
        assert 5 <= len(stations) <= 8
        for station in stations:
            module, _, name = (station if station.startswith("derivations.") else f"gearmath.{station}").rpartition(".")
            assert hasattr(importlib.import_module(module), name), station


def test_contributing_shows_the_layers_of_the_contract() -> None:
    layers = next(c["layers"] for c in pyproject()["tool"]["importlinter"]["contracts"] if c["type"] == "layers")
    drawn = "\n".join(line.removeprefix("gearmath.").replace(" | gearmath.", " | ") for line in layers)
    text = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
    assert drawn in "\n".join(line.strip() for line in text.splitlines())


@pytest.mark.parametrize("package", ["gearmath", "gearmath.cli"])
def test_import_loads_nothing_heavy(package: str) -> None:
    code = (
        f"import sys, {package}\n"
        "print(*(n for n in ('casadi', 'sympy', 'numpy', 'matplotlib', 'pydantic') if n in sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


#: Where degrees become radians, and which: keys of files in their models, else what no file holds.
DEGREES_ARE_READ = {
    "specs/": "keys of files",
    "machine/control/": "words of NC programs",
    "machine/judging/trajectory.py": "the tolerance of a turn that G642 of a program states",
    "front/contact.py": "arguments",
    "cli/contact.py": "arguments",
    "bevel/pair.py": "the shaft angle, which refusals print as the file has it",
    "bevel/check_blank.py": "the shaft angle, which refusals print as the file has it",
    "bevel/design/request.py": "the shaft angle, which refusals print as the file has it",
}


def test_degrees_become_radians_in_specs_and_few_places_that_are_known() -> None:
    """A constant, literal or in capitals, may be written in degrees anywhere. A place that is gone leaves the list."""
    used, elsewhere = set(), []
    for path in sorted((ROOT / "gearmath").rglob("*.py")):
        name = path.relative_to(ROOT / "gearmath").as_posix()
        known = [place for place in DEGREES_ARE_READ if name.startswith(place)]
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if not (isinstance(node, ast.Call) and _called(node) in ("radians", "deg2rad")):
                continue
            inner = list(ast.walk(node.args[0]))
            names = [one.id for one in inner if isinstance(one, ast.Name)]
            names += [one.attr for one in inner if isinstance(one, ast.Attribute)]
            if all(one.isupper() for one in names):
                continue
            used.update(known)
            if not known:
                elsewhere.append(f"{name}:{node.lineno}: {ast.unparse(node)}")
    assert elsewhere == []
    assert used == set(DEGREES_ARE_READ)


def test_the_number_of_a_degree_is_typed_once() -> None:
    """However it is spelled: pi over 180, its inverse, or their digits. Words of NC programs are texts, not numbers."""
    typed = set()
    for path in sorted((ROOT / "gearmath").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div):
                ends = {ast.unparse(end).rsplit(".", 1)[-1] for end in (node.left, node.right)}
                halves = {str(end.value) for end in (node.left, node.right) if isinstance(end, ast.Constant)}
                spelled = "pi" in ends and bool(halves & {"180", "180.0"})
            else:
                number = node.value if isinstance(node, ast.Constant) and isinstance(node.value, float) else 0.0
                spelled = math.isclose(number, math.pi / 180, rel_tol=1e-4)
                spelled |= math.isclose(number, 180 / math.pi, rel_tol=1e-4)
            if spelled or (isinstance(node, ast.Attribute | ast.Name) and _last(node) in ("deg2rad", "rad2deg")):
                typed.add(path.relative_to(ROOT / "gearmath").as_posix())
    assert typed == {"specs/ratio.py"}


def _last(node: ast.Attribute | ast.Name) -> str:
    return node.attr if isinstance(node, ast.Attribute) else node.id


def _called(node: ast.Call) -> str:
    """The name of what is called, with or without its module."""
    return node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")


def test_top_level_is_what_the_architecture_says() -> None:
    assert {name.split("/")[0] for name in of_the_project()} == TOP_LEVEL


def test_nothing_ignored_is_committed() -> None:
    assert git("--cached", "--ignored", "--exclude-standard") == []


def test_generated_files_are_committed_nowhere_but_in_golden() -> None:
    marked = [name for name, text in texts() if not name.endswith(".py") and "generated, do not edit" in text.lower()]
    built = [name for name in of_the_project() if re.search(r"\.(so|o|a|dll|pyc|MPF|stl|whl)$", name)]
    assert [name for name in marked + built if not name.startswith("tests/golden/")] == []


def test_nothing_is_left_to_do_in_a_comment() -> None:
    marks = re.compile(r"\b(?:TO" + r"DO|FIX" + r"ME)\b")
    assert [name for name, text in texts() if marks.search(text)] == []


def test_no_file_names_a_path_of_one_machine() -> None:
    paths = re.compile(r"(?<![\w.~])/(?:home|root|work|Users)/\w")
    assert [name for name, text in texts() if paths.search(text)] == []


def test_there_are_notebooks_and_none_stores_an_output() -> None:
    assert NOTEBOOKS
    for path in NOTEBOOKS:
        cells = json.loads(path.read_text("utf-8"))["cells"]
        stored = [c for c in cells if c.get("outputs") or c.get("execution_count") is not None]
        assert stored == [], path.name


def test_every_notebook_opens_with_words_and_closes_with_an_assertion() -> None:
    for path in NOTEBOOKS:
        assert re.fullmatch(r"\d\d_[a-z0-9_]+\.ipynb", path.name)
        cells = json.loads(path.read_text("utf-8"))["cells"]
        assert cells[0]["cell_type"] == "markdown", path.name
        code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
        assert any(isinstance(node, ast.Assert) for node in ast.walk(ast.parse(code[-1]))), path.name


def test_functions_of_notebooks_have_at_most_ten_lines() -> None:
    for path in NOTEBOOKS:
        for cell in json.loads(path.read_text("utf-8"))["cells"]:
            tree = ast.parse("".join(cell["source"])) if cell["cell_type"] == "code" else ast.Module([], [])
            functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
            long = [f.name for f in functions if (f.end_lineno or f.lineno) - f.lineno >= 10]
            assert long == [], path.name


def test_cells_of_notebooks_have_at_most_25_lines() -> None:
    for path in NOTEBOOKS:
        cells = [cell for cell in json.loads(path.read_text("utf-8"))["cells"] if cell["cell_type"] == "code"]
        long = ["".join(cell["source"])[:60] for cell in cells if len("".join(cell["source"]).splitlines()) > 25]
        assert long == [], path.name


def test_links_of_the_documents_lead_somewhere() -> None:
    for document in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md"):
        targets = re.findall(r"\]\(([^)#]+)[^)]*\)", (ROOT / document).read_text("utf-8"))
        local = [target for target in targets if "://" not in target]
        assert [target for target in local if not (ROOT / target).exists()] == [], document


def test_readme_asks_what_the_notebooks_ask() -> None:
    rows = re.findall(
        r"^\| (.+\?) \| \[\w+\]\(notebooks/(\w+\.ipynb)\) \|$", (ROOT / "README.md").read_text("utf-8"), re.M
    )
    first = {path.name: json.loads(path.read_text("utf-8"))["cells"][0]["source"] for path in NOTEBOOKS}
    assert [(name, f"# {question}") for question, name in rows] == [  # by number, as the site has them, too
        (name, "".join(source).splitlines()[0]) for name, source in first.items()
    ]


def test_readme_shows_every_verb() -> None:
    text = (ROOT / "README.md").read_text("utf-8")
    assert [verb for verb in VERBS if f"`gearmath {verb}" not in text] == []


def test_changelog_knows_the_version() -> None:
    assert f"## {pyproject()['project']['version']}" in (ROOT / "CHANGELOG.md").read_text("utf-8")


def test_ci_calls_make_test() -> None:
    script = ROOT / ".ci" / "run"
    assert script.stat().st_mode & 0o111
    assert "make test" in script.read_text("utf-8")
