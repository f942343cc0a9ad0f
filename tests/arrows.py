"""Print the folders of both packages, the import arrows between them, those that go up a layer, and circles.

python tests/arrows.py
"""

from __future__ import annotations

import tomllib
from collections import Counter
from pathlib import Path

import grimp

ROOT = Path(__file__).parents[1]


def folder(module: str) -> str:
    """Where a module lives: the folder of its file; a module beside the folders counts by itself."""
    if (ROOT / module.replace(".", "/")).is_dir() or (module.count(".") == 1 and module.startswith("gearmath.")):
        return module
    return module.rpartition(".")[0]


def layers() -> list[list[str]]:
    """The layers of the contracts in pyproject.toml, top first, as names of modules."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]["contracts"]
    found = []
    for contract in contracts:
        if contract["type"] == "layers":
            inside = contract.get("containers", [""])[0]
            found.append([f"{inside}.{layer}" if inside else layer for layer in contract["layers"]])
    return found


def level(module: str, names: list[str]) -> int | None:
    """The number of the layer that holds a module, None if none does."""
    for number, layer in enumerate(names):
        for one in layer.split("|"):
            name = one.strip()
            name = name if name.startswith(("gearmath", "derivations")) else f"{names[0].rpartition('.')[0]}.{name}"
            if module == name or module.startswith(name + "."):
                return number
    return None


def circles(arrows: Counter[tuple[str, str]]) -> list[set[str]]:
    """Folders that reach each other along arrows: the strongly connected ones."""
    after: dict[str, set[str]] = {}
    for start, end in arrows:
        after.setdefault(start, set()).add(end)

    def reached(start: str) -> set[str]:
        seen, todo = set(), [start]
        while todo:
            for end in after.get(todo.pop(), ()):
                if end not in seen:
                    seen.add(end)
                    todo.append(end)
        return seen

    reach = {start: reached(start) for start in after}
    found = []
    for start, ends in reach.items():
        together = {end for end in ends if start in reach.get(end, ())}
        if together and together not in found:
            found.append(together)
    return found


def arrows_of(
    packages: tuple[str, ...] = ("gearmath", "derivations"),
) -> tuple[Counter[str], Counter[tuple[str, str]], list[str]]:
    """How many files each folder has, how many imports run between folders, and those that go up a layer."""
    graph = grimp.build_graph(*packages, include_external_packages=False, cache_dir=None)
    modules = sorted(graph.modules)
    inside = Counter(folder(module) for module in modules)
    arrows: Counter[tuple[str, str]] = Counter()
    upward = []
    for module in modules:
        for imported in graph.find_modules_directly_imported_by(module):
            if folder(module) != folder(imported):
                arrows[folder(module), folder(imported)] += 1
            for names in layers():
                here, there = level(module, names), level(imported, names)
                if here is not None and there is not None and there < here:
                    upward.append(f"{module} -> {imported}")
    return inside, arrows, upward


def main() -> None:
    inside, arrows, upward = arrows_of()
    print(f"{inside.total()} files in {len(inside)} folders, {len(arrows)} arrows between folders")
    for name, files in sorted(inside.items()):
        ends = [f"{end.removeprefix('gearmath.')} {n}" for (start, end), n in sorted(arrows.items()) if start == name]
        print(f"  {name} ({files}) -> {', '.join(ends) or 'nothing'}")
    print(f"upward: {'; '.join(upward) or 'none'}")
    print(f"circles: {'; '.join(', '.join(sorted(one)) for one in circles(arrows)) or 'none'}")


if __name__ == "__main__":
    main()
