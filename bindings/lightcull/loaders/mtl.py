"""MTL, the materials of OBJ files."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

_OPTIONS = {
    "-blendu": 1, "-blendv": 1, "-bm": 1, "-boost": 1, "-cc": 1, "-clamp": 1, "-imfchan": 1,
    "-mm": 2, "-o": 3, "-s": 3, "-t": 3, "-texres": 1, "-type": 1,
}  # fmt: skip
"""How many words may follow each option of a map; of -o, -s and -t, as many of them as are numbers."""
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")


@dataclass(frozen=True)
class Map:
    """An image by its name, and how its texture coordinates are stretched and moved."""

    name: str
    scale: tuple[float, float] = (1.0, 1.0)
    offset: tuple[float, float] = (0.0, 0.0)


@dataclass
class MtlMaterial:
    """A material's numbers and maps by their statements, in small letters."""

    numbers: dict[str, tuple[float, ...]] = field(default_factory=dict)
    maps: dict[str, Map] = field(default_factory=dict)
    others: list[str] = field(default_factory=list)
    """Statements that are neither."""

    def number(self, statement: str, default: float) -> float:
        """The last of a statement's numbers: of `d -halo 0.5` there is one."""
        return self.numbers.get(statement, (default,))[-1]

    def color(self, statement: str, default: float) -> tuple[float, float, float]:
        """A statement's colour; one number is grey."""
        values = self.numbers.get(statement, (default,))
        r, g, b = values[:3] if len(values) >= 3 else [values[0]] * 3
        return r, g, b


def read_mtl(text: str) -> dict[str, MtlMaterial]:
    """The materials of a file by their names."""
    materials: dict[str, MtlMaterial] = {}
    material = MtlMaterial()  # for statements before the first name, which are nobody's
    for line in re.sub(r"\\\r?\n", " ", text).splitlines():
        statement, _, rest = line.strip().partition("#")[0].replace("\t", " ").partition(" ")
        statement, rest = statement.lower(), rest.strip()
        if statement == "newmtl":
            material = materials.setdefault(rest, MtlMaterial())
        elif statement.startswith("map_") or statement in ("bump", "norm", "disp", "decal", "refl"):
            # A name may have # in it.
            material.maps[statement] = _map_of(line.strip().split(None, 1)[1:])
        elif statement:
            _add_numbers(material, statement, rest.split())
    return materials


def _add_numbers(material: MtlMaterial, statement: str, words: list[str]) -> None:
    numbers = tuple(float(word) for word in words if _NUMBER.match(word))
    if numbers:
        material.numbers[statement] = numbers
    elif statement not in material.others:
        material.others.append(statement)


def _map_of(rest: list[str]) -> Map:
    """From what follows a statement: options, each with its words, and a name with maybe blanks."""
    text = rest[0] if rest else ""
    scale, offset = (1.0, 1.0), (0.0, 0.0)
    while (words := text.split(None, 1)) and words[0].lower() in _OPTIONS:
        option = words[0].lower()
        text = words[1] if len(words) > 1 else ""
        taken: list[str] = []
        while len(taken) < _OPTIONS[option] and (words := text.split(None, 1)):
            if option in ("-o", "-s", "-t", "-mm") and not _NUMBER.match(words[0]):
                break
            taken.append(words[0])
            text = words[1] if len(words) > 1 else ""
        numbers = [float(word) for word in taken if _NUMBER.match(word)]
        if option == "-s" and numbers:
            scale = (numbers[0], numbers[1] if len(numbers) > 1 else 1.0)
        elif option == "-o" and numbers:
            offset = (numbers[0], numbers[1] if len(numbers) > 1 else 0.0)
    return Map(text.strip().strip('"'), scale, offset)
