"""Furniture of the `offices` scene. A piece has its origin on the floor in its middle, and shows
its front towards +z."""

from __future__ import annotations

import numpy as np

from .. import geometry
from ..geometry import Shape, box, faceted, lathe, merge
from ..plants import leafy_balls
from ..random_numbers import Chance

Piece = dict[str, Shape]
"""Shapes by their materials."""
BOOKS = ("red", "blue", "grey", "yellow")
"""Materials of books and binders."""
SHELVES = 4
"""Kinds of them, which differ in their books."""
FABRICS = ("fabric black", "fabric blue", "fabric green")


def build(chance: Chance) -> dict[str, Piece]:
    """The pieces by name."""
    made = {
        "desk": _desk(),
        "table": _table(2.4, 1.05, 0.74),
        "low table": _table(1.0, 0.55, 0.4),
        "cabinet": _cabinet(),
        "monitor": _monitor(),
        "keyboard": {"black": box((-0.22, 0.0, -0.07), (0.22, 0.018, 0.07))},
        "papers": _papers(),
        "divider": {"divider": box((-0.8, 0.3, -0.02), (0.8, 1.25, 0.02))},
        "rack": _rack(),
        "plant": _plant(chance),
        "bin": _bin(),
        "copier": _copier(),
        "cooler": _cooler(),
    }
    for i, fabric in enumerate(FABRICS):
        made[f"chair {i}"] = _office_chair(fabric)
        made[f"seat {i}"] = _seat(fabric)
        made[f"sofa {i}"] = _sofa(fabric)
    for i in range(SHELVES):
        made[f"shelf {i}"] = _shelf(chance)
    return made


def _legs(half_x: float, half_z: float, top: float, thick: float = 0.025) -> list[Shape]:
    return [
        box((x - thick, 0.0, z - thick), (x + thick, top, z + thick))
        for x in (-half_x, half_x)
        for z in (-half_z, half_z)
    ]


def _desk() -> Piece:
    drawers = [box((0.36, 0.12 + 0.18 * i, -0.33), (0.72, 0.28 + 0.18 * i, 0.34)) for i in range(3)]
    return {
        "wood": box((-0.8, 0.71, -0.4), (0.8, 0.74, 0.4)),
        "metal": merge(_legs(0.75, 0.35, 0.72)),
        "white": merge([*drawers, box((-0.7, 0.35, -0.36), (0.35, 0.7, -0.34))]),
    }


def _table(width: float, depth: float, height: float) -> Piece:
    half_x, half_z = width / 2, depth / 2
    top = box((-half_x, height - 0.035, -half_z), (half_x, height, half_z))
    return {
        "wood": top,
        "metal": merge(_legs(half_x - 0.1, half_z - 0.08, height - 0.03)),
    }


def _office_chair(fabric: str) -> Piece:
    foot = box((-0.025, 0.04, 0.0), (0.025, 0.09, 0.29))
    star = geometry.scatter(foot, np.zeros((5, 3)), yaws=2 * np.pi * np.arange(5) / 5)
    column = faceted(geometry.prism(_circle(0.03, 6), 0.08, 0.45))
    back = box((-0.22, 0.62, -0.27), (0.22, 1.05, -0.22))
    arms = [box((x - 0.025, 0.62, -0.18), (x + 0.025, 0.65, 0.12)) for x in (-0.28, 0.28)]
    posts = [box((x - 0.015, 0.42, -0.05), (x + 0.015, 0.63, -0.01)) for x in (-0.28, 0.28)]
    spine = box((-0.03, 0.42, -0.29), (0.03, 0.8, -0.26))
    return {
        fabric: merge((box((-0.25, 0.44, -0.24), (0.25, 0.51, 0.25)), back)),
        "black": merge((faceted(star), column, *map(faceted, (*arms, *posts, spine)))),
    }


def _seat(fabric: str) -> Piece:
    back = box((-0.21, 0.55, -0.23), (0.21, 0.88, -0.2))
    return {
        fabric: merge((box((-0.22, 0.43, -0.2), (0.22, 0.47, 0.22)), back)),
        "metal": merge(
            [*_legs(0.2, 0.19, 0.43, 0.012)]
            + [box((x - 0.012, 0.43, -0.226), (x + 0.012, 0.6, -0.202)) for x in (-0.19, 0.19)]
        ),
    }


def _sofa(fabric: str) -> Piece:
    parts = [
        box((-0.9, 0.12, -0.42), (0.9, 0.42, 0.42)),
        box((-0.9, 0.4, -0.42), (0.9, 0.82, -0.2)),
        box((-0.98, 0.1, -0.42), (-0.84, 0.6, 0.42)),
        box((0.84, 0.1, -0.42), (0.98, 0.6, 0.42)),
    ]
    cushions = [box((x - 0.4, 0.42, -0.18), (x + 0.4, 0.5, 0.4)) for x in (-0.42, 0.42)]
    return {fabric: merge(parts + cushions), "black": merge(_legs(0.85, 0.36, 0.11))}


def _cabinet() -> Piece:
    doors = [box((x + 0.01, 0.06, 0.2), (x + 0.43, 0.72, 0.215)) for x in (-0.44, 0.0)]
    knobs = [box((x, 0.36, 0.21), (x + 0.02, 0.46, 0.24)) for x in (-0.06, 0.04)]
    return {
        "wood": box((-0.45, 0.0, -0.2), (0.45, 0.75, 0.205)),
        "white": merge(doors),
        "metal": merge(knobs),
    }


def _shelf(chance: Chance) -> Piece:
    """0.9 m wide, 1.95 m high, with books and binders on five boards."""
    boards = [box((-0.44, y, -0.15), (0.44, y + 0.02, 0.15)) for y in np.linspace(0.05, 1.93, 6)]
    sides = [box((x, 0.0, -0.16), (x + 0.02, 1.95, 0.16)) for x in (-0.46, 0.44)]
    books: dict[str, list[Shape]] = {kind: [] for kind in BOOKS}
    for bottom in np.linspace(0.05, 1.93, 6)[:-1] + 0.02:
        x, end = -0.43, chance.uniform(-0.1, 0.42)
        while x < end:
            width, height = chance.uniform(0.06, 0.13), chance.uniform(0.2, 0.31)
            kind = BOOKS[int(chance.uniform(0, len(BOOKS)))]
            books[kind].append(
                box((x, bottom, -0.12), (x + width - 0.003, bottom + height, 0.1))
            )
            x += width
    piece = {kind: merge(shapes) for kind, shapes in books.items() if shapes}
    back = box((-0.45, 0.02, -0.16), (0.45, 1.94, -0.145))
    return piece | {"wood": merge((*boards, *sides, back))}


def _monitor() -> Piece:
    """Its screen is a light, or dark glass; see `lamps`."""
    return {
        "black": merge(
            (
                box((-0.29, 0.14, -0.03), (0.29, 0.5, 0.0)),
                box((-0.03, 0.0, -0.05), (0.03, 0.25, -0.03)),
                box((-0.12, 0.0, -0.1), (0.12, 0.012, 0.08)),
            )
        )
    }


def _papers() -> Piece:
    sheets = [
        box((-0.105, 0.0, -0.15), (0.105, 0.012, 0.15)).turned(0.2).moved(0.1),
        box((-0.105, 0.0, -0.15), (0.105, 0.02, 0.15)).turned(-0.3).moved(-0.16),
    ]
    return {"white": merge(sheets)}


def _rack() -> Piece:
    """A frame for servers; their LEDs are lights."""
    units = [box((-0.27, y, 0.44), (0.27, y + 0.1, 0.46)) for y in np.arange(0.1, 1.9, 0.13)]
    return {"black": box((-0.3, 0.0, -0.45), (0.3, 2.05, 0.445)), "metal": merge(units)}


def _bin() -> Piece:
    profile = [(0.11, 0.0), (0.13, 0.3), (0.12, 0.3), (0.1, 0.02), (0.0, 0.02)]
    return {"black": lathe(profile, 10)}


def _plant(chance: Chance) -> Piece:
    pot = lathe([(0.13, 0.0), (0.18, 0.34), (0.15, 0.34), (0.0, 0.33)], 12)
    ends = ((0.1, 0.02), (-0.06, 0.1), (0.0, -0.1))
    stems = np.array([[(0, 0.3, 0), (x, 0.9, z)] for x, z in ends])
    crown = leafy_balls(chance, np.array([(0.0, 0.95, 0.0)]), (0.08, 0.38), 160, 0.075)
    return {"white": pot, "leaf": crown, "wood": geometry.tubes(stems, 0.008)}


def _copier() -> Piece:
    return {
        "white": merge(
            (
                box((-0.35, 0.0, -0.32), (0.35, 0.95, 0.32)),
                box((-0.5, 0.6, -0.2), (-0.34, 0.63, 0.2)),
            )
        ),
        "black": merge(
            (box((-0.3, 0.94, -0.28), (0.3, 1.08, 0.2)), box((0.05, 1.0, 0.2), (0.3, 1.04, 0.34)))
        ),
    }


def _cooler() -> Piece:
    bottle = lathe([(0.05, 0.98), (0.14, 1.08), (0.14, 1.38), (0.0, 1.42)], 12)
    return {"white": box((-0.16, 0.0, -0.16), (0.16, 1.0, 0.16)), "water": bottle}


def _circle(radius: float, sides: int) -> np.ndarray:
    angles = -2 * np.pi * np.arange(sides) / sides
    return radius * np.column_stack((np.cos(angles), np.sin(angles)))
