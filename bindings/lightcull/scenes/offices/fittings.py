"""Doors, what is fixed to walls and ceilings, and what holds lamps, in the `offices` scene. A piece
has its origin where it is fixed, and shows its front towards +z."""

from __future__ import annotations

import numpy as np

from .. import geometry
from ..geometry import box, lathe, merge
from .pieces import Piece
from .plan import DOOR_HEIGHT, LINING, WALL

SINGLE, DOUBLE = 1.0, 1.6
"""Widths of doorways."""
GLOBE_RADIUS = 0.065


def build() -> dict[str, Piece]:
    """The pieces by name."""
    made = {
        "whiteboard": _board("white", 0.85, 1.0),
        "picture 0": _board("blue", 0.45, 0.6),
        "picture 1": _board("red", 0.35, 0.5),
        "window": _window(),
        "reader": {"black": box((-0.04, 1.05, 0.0), (0.04, 1.2, 0.02))},
        "extinguisher": _extinguisher(),
        "desk lamp": _desk_lamp(),
        "stem": {"metal": lathe([(0.012, -0.16), (0.012, -0.02), (0.05, -0.02), (0.05, 0.0)], 8)},
        "rod": {"metal": lathe([(0.006, -0.75), (0.006, -0.02), (0.05, -0.02), (0.05, 0.0)], 6)},
        "ring": {"white": lathe([(0.085, 0.0), (0.075, -0.014), (0.085, -0.014), (0.11, 0.0)], 10)},
        "unlit globe": {"opal": geometry.icosahedron().scaled(*(3 * (GLOBE_RADIUS,)))},
    }
    for width, name in ((SINGLE, "single"), (DOUBLE, "double")):
        leaves = 2 if width == DOUBLE else 1
        made[f"lining {name}"] = _lining(width)
        made[f"leaf {name}"] = _leaf((width - 2 * LINING) / leaves)
    return made


def _board(material: str, half_width: float, height: float) -> Piece:
    """Hung on a wall behind it."""
    low, high = 1.45 - height / 2, 1.45 + height / 2
    rim = 0.03
    return {
        "metal": box(
            (-half_width - rim, low - rim, -0.01), (half_width + rim, high + rim, 0.02)
        ),
        material: box((-half_width, low, 0.0), (half_width, high, 0.024)),
    }


def _window() -> Piece:
    """At night, seen from inside: black glass with a bar in the middle and a sill."""
    frame = [
        box((-1.4, 0.85, -0.01), (1.4, 0.93, 0.04)),
        box((-1.4, 2.37, -0.01), (1.4, 2.45, 0.04)),
        *(box((x - 0.04, 0.86, -0.01), (x + 0.04, 2.44, 0.035)) for x in (-1.36, 0.0, 1.36)),
        box((-1.45, 0.8, -0.01), (1.45, 0.85, 0.16)),
    ]
    return {"white": merge(frame), "glass": box((-1.38, 0.87, -0.01), (1.38, 2.43, 0.012))}


def _extinguisher() -> Piece:
    body = lathe([(0.0, 0.5), (0.07, 0.5), (0.07, 0.95), (0.03, 1.02), (0.0, 1.02)], 10)
    return {"red": body, "black": box((-0.03, 1.0, -0.03), (0.03, 1.09, 0.03))}


def _desk_lamp() -> Piece:
    """The bulb hangs at (0, 0.36, 0.22), in a shade that is open below."""
    foot = lathe([(0.09, 0.0), (0.09, 0.015), (0.0, 0.02)], 10)
    arms = np.array([[(0, 0.015, 0), (0, 0.3, -0.1)]]), np.array([[(0, 0.3, -0.1), (0, 0.45, 0.2)]])
    shade = lathe([(0.11, 0.33), (0.035, 0.46), (0.0, 0.47)], 10)
    return {
        "metal": merge((foot, *(geometry.tubes(arm, 0.01, 4) for arm in arms))),
        "shade": shade.moved(z=0.22),
    }


def _lining(width: float) -> Piece:
    """The frame in a doorway whose middle is at x = 0, through the wall at -WALL < z < 0."""
    half, top = width / 2, DOOR_HEIGHT
    low, high = -WALL - 0.015, 0.015
    casing = 0.06
    return {
        "lining": merge(
            (
                box((-half - casing, -0.01, low), (-half + LINING, top + casing, high)),
                box((half - LINING, -0.01, low), (half + casing, top + casing, high)),
                box((-half + 0.01, top - LINING, low), (half - 0.01, top + casing, high)),
                box((-half, -0.01, low + 0.01), (half, 0.004, high - 0.01)),
            )
        )
    }


def _leaf(width: float) -> Piece:
    """Hung at x = 0, reaching to +x. It is a little larger than the opening, into the lining."""
    over, thick = 0.012, 0.02
    top = DOOR_HEIGHT - LINING + 0.01
    handles = [
        box((width - 0.16, 1.02, z - 0.012), (width - 0.05, 1.04, z + 0.012)) for z in (-0.06, 0.06)
    ]
    pins = [box((width - 0.08, 1.02, -0.06), (width - 0.06, 1.04, 0.06))]
    return {
        "door": box((-over, -0.005, -thick), (width + over, top, thick)),
        "metal": merge(handles + pins),
    }
