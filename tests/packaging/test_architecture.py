"""The rooms of core: who may include whom stands in core/README.md and core/lights/README.md."""

import re
from collections import Counter
from pathlib import Path

import pytest

CORE = Path(__file__).parents[2] / "core"
PLUGIN = CORE.parent / "plugin"
SOURCES = (".h", ".cpp")
ROW = re.compile(r"^\| `(\w+)` \|[^|]*\|([^|]*)\|$", re.M)


def declared(folder):
    """By room, in the order of the table: the rooms that it may include."""
    rows = ROW.findall((folder / "README.md").read_text())
    assert rows, f"no table of rooms in {folder}/README.md"
    return {room: set(re.findall(r"`([\w/]+)`", rooms)) for room, rooms in rows}


def room_of(path, depth):
    """Of a path relative to core: "lights/bvh" at depth 2; "lights" at depth 1."""
    return "/".join(Path(path).parts[:-1][:depth])


def private_includes():
    """Pairs of paths relative to core: who includes what."""
    for path in sorted(CORE.rglob("*")):
        if path.suffix not in SOURCES:
            continue
        for included in re.findall(r'^#include "(.*)"', path.read_text(), re.M):
            if (CORE / included).exists():
                yield path.relative_to(CORE).as_posix(), included


def used_by_rooms_of_core():
    """By room, with the rooms of lights that other rooms of core use told apart."""
    used = {room: set() for room in declared(CORE)}
    for path, included in private_includes():
        room = room_of(path, 1)
        if room_of(included, 1) != room:
            used.setdefault(room, set()).add(room_of(included, 2))
    return used


def used_by_rooms_of_lights():
    used = {room: set() for room in declared(CORE / "lights")}
    for path, included in private_includes():
        if not (path.startswith("lights/") and included.startswith("lights/")):
            continue
        room, other = (room_of(p, 2).removeprefix("lights/") for p in (path, included))
        if other != room:
            used.setdefault(room, set()).add(other)
    return used


TABLES = [
    pytest.param(CORE, used_by_rooms_of_core, id="core"),
    pytest.param(CORE / "lights", used_by_rooms_of_lights, id="lights"),
]


@pytest.mark.parametrize("folder, used", TABLES)
def test_each_room_has_its_line(folder, used):
    files = (path.relative_to(folder) for path in folder.rglob("*") if path.suffix in SOURCES)
    folders = {path.parts[0] for path in files if len(path.parts) > 1}
    assert set(declared(folder)) == folders - {"include"}


@pytest.mark.parametrize("folder, used", TABLES)
def test_rooms_include_what_their_lines_name(folder, used):
    assert used() == declared(folder)


@pytest.mark.parametrize("folder, used", TABLES)
def test_rooms_stand_below_what_they_include(folder, used):
    """So that there is no circle."""
    above = set()
    for room, included in declared(folder).items():
        assert {name.split("/")[0] for name in included} <= above, room
        above.add(room)


def test_public_headers_include_no_private_ones():
    assert not [path for path, _ in private_includes() if path.startswith("include/")]


def test_no_two_files_have_one_name():
    names = Counter(
        path.name
        for folder in (CORE, PLUGIN)
        for path in folder.rglob("*")
        if path.is_file() and path.suffix != ".pyc"
    )
    del names["CMakeLists.txt"], names["README.md"]
    assert not [name for name, count in names.items() if count > 1]
