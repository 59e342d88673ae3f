"""Spots: over a stage, of every width, alone and among others."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from .lamps import scattered
from .situation import Situation
from .stage import Stage


def situations() -> Iterator[Situation]:
    for name, make in _SITUATIONS.items():
        yield Situation(name, "spots", make)


def _spots(
    count: int, degrees: float, *, half: float = 4.0, height: float = 10.0, tilt: float = 0.2
) -> Stage:
    """Above the floor, tilted by chance; half of the ramp in the angle."""
    stage = Stage(half=half, height=min(2.3, 0.9 * height) if half == 4 else 0.9 * height)
    random = np.random.default_rng(0)
    places = scattered(1, count, (-half, height, -half), (half, height + 1, half))
    ways = random.normal(0, tilt, (count, 3)) * [1, 0, 1] - [0, 1, 0]
    outer = float(np.radians(degrees))
    stage.spots(places, ways, 0.8 * outer, outer)
    return stage


def _aimed(count: int, half: float) -> Stage:
    """Spots of 5 degrees that all end on the floor."""
    stage = Stage(half=half, height=9.5)
    places = scattered(2, count, (-half, 10, -half), (half, 11, half))
    targets = scattered(3, count, (1 - half, 0, 1 - half), (half - 1, 0, half - 1))
    near = places + np.clip(targets - places, -3, 3) * [1, 0, 1] * 0.9
    ends = np.clip(near * [1, 0, 1], 1.5 - half, half - 1.5)
    outer = float(np.radians(5))
    stage.spots(places, ends - places, 0.8 * outer, outer)
    return stage


def _among_lamps() -> Stage:
    """Half spots of 20 degrees, half lamps."""
    stage = Stage()
    places = scattered(4, 100, (-4, 3, -4), (4, 4, 4))
    stage.spots(places, np.tile([0.1, -1, 0], (100, 1)), 0.2, float(np.radians(20)))
    stage.points(scattered(5, 100, (-4, 2.5, -4), (4, 4, 4)), 0.5)
    return stage


def _hard_edges() -> Stage:
    """Whose inner angle is all but the outer one."""
    stage = Stage()
    places = scattered(6, 60, (-3, 3, -3), (3, 4, 3))
    inner, outer = (float(np.radians(angle)) for angle in (14.99, 15))
    stage.spots(places, np.tile([0, -1, 0], (60, 1)), inner, outer)
    return stage


def _beams() -> Stage:
    """From the corners, all to the middle."""
    stage = Stage()
    corners = np.array([(x, 3.5, z) for x in (-3.5, 3.5) for z in (-3.5, 3.5)])
    places = np.repeat(corners, 25, axis=0) + scattered(0, 100, (-0.3,) * 3, (0.3,) * 3)
    outer = float(np.radians(12))
    stage.spots(places, -places, 0.5 * outer, outer)
    return stage


_SITUATIONS: dict[str, Callable[[], Stage]] = {
    "400 spots of 5 degrees": partial(_spots, 400, 5),
    "2,000 spots of 5 degrees": partial(_aimed, 2000, 20.0),
    "200 spots of 30 degrees": partial(_spots, 200, 30),
    "200 spots of 60 degrees, low": partial(_spots, 200, 60, height=3.0, tilt=0.4),
    "spots among lamps": _among_lamps,
    "spots of hard edges": _hard_edges,
    "beams from four corners": _beams,
}
