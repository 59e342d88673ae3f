"""What the package's modules import of each other: no circle, and none hidden by a late import."""

from __future__ import annotations

import ast
import importlib.util
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import lightcull

PACKAGE = Path(lightcull.__file__).parent

Graph = dict[str, set[str]]


def modules(folder: Path) -> dict[str, Path]:
    """The files of a package by the names of their modules; of a compiled one the stub."""
    found = {}
    for file in (*folder.rglob("*.py"), *folder.rglob("*.pyi")):
        parts = (folder.name, *file.relative_to(folder).with_suffix("").parts)
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = file
    return found


def imported_names(module: str, file: Path) -> Iterator[tuple[str, str]]:
    """Every import in a file, wherever it stands (in functions and `if TYPE_CHECKING` too): what it
    is from, and the name that it takes, which is empty for a plain import.
    """
    package = module if file.name == "__init__.py" else module.rpartition(".")[0]
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            name = "." * node.level + (node.module or "")
            source = importlib.util.resolve_name(name, package)
            yield from ((source, alias.name) for alias in node.names)
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith("import_module"):
            assert isinstance(node.args[0], ast.Constant), f"{file}:{node.lineno}: which module?"
            yield importlib.util.resolve_name(node.args[0].value, package), ""


def module_graph(folder: Path) -> Graph:
    """Which modules each module makes Python import: those it names, and the packages that they are
    in, but for those that it is in itself.
    """
    files = modules(folder)
    graph: Graph = {}
    for module, file in files.items():
        graph[module] = set()
        for source, name in imported_names(module, file):
            target = f"{source}.{name}" if f"{source}.{name}" in files else source
            if target not in files or target == module:
                continue
            graph[module].add(target)
            graph[module].update(_packages_of(target) - {module} - _packages_of(module))
    return graph


def _packages_of(module: str) -> set[str]:
    parts = module.split(".")
    return {".".join(parts[:count]) for count in range(1, len(parts))}


def room_graph(graph: Graph) -> Graph:
    """The same between files and folders at the top of the package."""
    rooms: Graph = {}
    for module, targets in graph.items():
        room = rooms.setdefault(_room(module), set())
        room.update(_room(target) for target in targets)
    return {room: targets - {room} for room, targets in rooms.items()}


def _room(module: str) -> str:
    return ".".join(module.split(".")[:2])


def circle(graph: Graph) -> list[str]:
    """The modules along a circle, each of which imports the next; empty if there is none."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(reversed(error.args[1]))
    return []


def test_modules_import_each_other_in_no_circle() -> None:
    found = circle(module_graph(PACKAGE))
    assert not found, " imports ".join(found)


def test_folders_import_each_other_in_no_circle() -> None:
    found = circle(room_graph(module_graph(PACKAGE)))
    assert not found, " imports ".join(found)


@pytest.mark.parametrize(
    "late_import",
    [
        "from .above import work",
        "from . import above",
        "from thing import above",
        "import thing.above",
        "from .part.inside import work",
        "import thing",
        "def work():\n    from .above import work as better",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from .above import work",
        "import importlib\nimportlib.import_module('.above', __name__)",
    ],
)
def test_a_circle_is_found(tmp_path: Path, late_import: str) -> None:
    thing = tmp_path / "thing"
    (thing / "part").mkdir(parents=True)
    (thing / "__init__.py").write_text("from .above import work\n")
    (thing / "above.py").write_text("from .below import work\n")
    (thing / "part" / "__init__.py").write_text("from ..above import work\n")
    (thing / "part" / "inside.py").write_text("")
    (thing / "below.py").write_text("import os\n")
    assert not circle(module_graph(thing))
    (thing / "below.py").write_text(f"{late_import}\n")
    assert "thing.below" in circle(module_graph(thing))


def test_a_circle_of_folders_is_found() -> None:
    graph: Graph = {"a.one.x": {"a.two.x"}, "a.two.x": set(), "a.two.y": {"a.one.y"}, "a.one.y": set()}
    assert not circle(graph)
    assert circle(room_graph(graph))
