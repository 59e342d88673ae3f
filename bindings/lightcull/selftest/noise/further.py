"""Kinds that meet: rooms, shades and columns, signs and strips, suns with all of these."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from .far import dome_ways
from .lamps import scattered
from .panels import down, sphere
from .situation import Situation
from .stage import Stage, cut_up


def situations() -> Iterator[Situation]:
    for name, make in _SITUATIONS.items():
        yield Situation(name, "further", make)


def _strip() -> Stage:
    stage = Stage(half=15.0, height=2.9)
    down(stage, (0, 3, 0), 50, 0.05, 20)
    stage.points(scattered(20, 400, (-15, 2.91, -15), (15, 2.99, 15)), 0.02)
    return stage


def _tubes() -> Stage:
    """A sign of 16 upright tubes of 32 triangles each, which face outwards."""
    stage = Stage()
    turn = np.linspace(0, 2 * np.pi, 17)
    around = np.stack([np.cos(turn), np.zeros(17), np.sin(turn)], axis=1) * 0.03
    for x, _, z in scattered(21, 16, (-3.5, 0, -3.5), (3.5, 0, 3.5)):
        low, high = around + [x, 2.4, z], around + [x, 3.4, z]
        quads = zip(low[:-1], low[1:], high[:-1], high[1:], strict=True)
        corners = [[[a, c, d], [a, d, b]] for a, b, c, d in quads]
        stage.triangles(np.concatenate(corners), 10)
    return stage


def _shades() -> Stage:
    """Lamps a centimetre above shades, which leave them a ring of light; a third hang bare."""
    stage = Stage()
    places = scattered(22, 60, (-4, 2.7, -4), (4, 3.5, 4))
    for x, y, z in places[:40]:
        stage.plate((x - 0.01, y - 0.01, z - 0.01), (0.02, 0, 0), (0, 0, 0.02))
    stage.points(places, 1)
    return stage


def _sixteen_rooms() -> Stage:
    """Walls that end below the camera, and lamps in each room but some."""
    stage = Stage()
    for at in (-2.0, 0.0, 2.0):
        stage.plate((at, 0, -4), (0, 0, 8), (0, 2.2, 0))
        stage.plate((-4, 0, at), (8, 0, 0), (0, 2.2, 0))
    for x in (-3, -1, 1, 3):
        for z in (-3, -1, 1, 3):
            middle = np.array([x, 0, z])
            low, high = middle + [-0.8, 0.8, -0.8], middle + [0.8, 2, 0.8]
            stage.points(scattered(23 + 4 * x + z, 10, low, high), 0.3)
    return stage


def _columns() -> Stage:
    """Lamps beside the floor, behind a row of posts."""
    stage = Stage()
    for z in np.linspace(-4, 4, 17):
        stage.plate((4.2, 0, z - 0.1), (0, 0, 0.2), (0, 3, 0))
    stage.points(scattered(24, 150, (4.5, 0.5, -4), (8, 2.5, 4)), 1)
    return stage


def _one_place() -> Stage:
    stage = Stage()
    for _ in range(40):
        down(stage, (0.5, 2.8, 0.5), 0.2, 0.2, 1)
    return stage


def _tiny() -> Stage:
    """Ten triangles of a micrometre, and a panel."""
    stage = Stage()
    for place in scattered(25, 10, (-3, 2.5, -3), (3, 3, 3)):
        down(stage, place, 5e-7, 5e-7, 1e12)
    down(stage, (0, 3, 0), 0.3, 0.3, 3)
    return stage


def _pixels() -> Stage:
    """A wall of 28 x 16 squares beside the floor, each of its own brightness."""
    stage = Stage()
    random = np.random.default_rng(26)
    corners = [
        cut_up((4.2, y, z), (0, 0, 0.13), (0, 0.13, 0), 1)
        for y in 0.3 + 0.28 * np.arange(12)
        for z in -3.78 + 0.28 * np.arange(28)
    ]
    stage.triangles(np.concatenate(corners), np.repeat(random.lognormal(0, 2, 12 * 28), 2))
    return stage


def _sun_and_bulbs() -> Stage:
    stage = Stage()
    stage.suns(np.array([[0.3, 0.9, 0.2]]), 0.1)
    bulbs = [sphere(place, 0.03, 0) for place in scattered(27, 25, (-3, 2.6, -3), (3, 3.4, 3))]
    stage.triangles(np.concatenate(bulbs), 10)
    return stage


def _all_kinds() -> Stage:
    stage = Stage()
    stage.suns(dome_ways(20), 0.01)
    stage.points(scattered(28, 50, (-4, 2.5, -4), (4, 3.5, 4)), 0.1)
    places = scattered(29, 40, (-3, 3, -3), (3, 3.5, 3))
    stage.spots(places, np.tile([0.1, -1, 0.1], (40, 1)), 0.2, 0.3)
    down(stage, (1, 3, -1), 0.3, 0.3, 3, 4)
    stage.triangles(sphere((-1, 3, 1), 0.2, 1), 3)
    return stage


def _narrow() -> Stage:
    """Spots of half a degree."""
    stage = Stage(half=2.0, height=1.9)
    places = scattered(30, 30, (-1.5, 2, -1.5), (1.5, 2.5, 1.5))
    outer = float(np.radians(0.5))
    stage.spots(places, np.tile([0.0, -1, 0], (30, 1)), 0.5 * outer, outer)
    stage.points(scattered(31, 30, (-2, 2, -2), (2, 3, 2)), 0.01)
    return stage


def _far_away() -> Stage:
    """Lamps of a town on the horizon, and a few near ones."""
    stage = Stage()
    angle = np.random.default_rng(32).uniform(0, 2 * np.pi, 300)
    town = np.stack([2000 * np.cos(angle), 20 + 80 * angle, 2000 * np.sin(angle)], axis=1)
    stage.points(town, 3e4)
    stage.points(scattered(33, 6, (-4, 2.5, -4), (4, 3, 4)), 0.05)
    return stage


def _both_sides() -> Stage:
    """Screens that stand upright on end, and emit to both sides."""
    stage = Stage()
    for x, _, z in scattered(34, 30, (-3.8, 0, -3.8), (3.8, 0, 3.8)):
        stage.panel((x, 2.6, z), (0.15, 0, 0.1), (0, 0.1, 0), 5, two_sided=True)
    return stage


def _bulbs_over_a_polished_floor() -> Stage:
    stage = Stage(base_color=(0.5, 0.5, 0.5), roughness=0.35, metallic=0.0)
    bulbs = [sphere(place, 0.004, 0) for place in scattered(35, 40, (-4, 2.5, -4), (4, 3, 4))]
    stage.triangles(np.concatenate(bulbs), 1e4)
    return stage


def _far_and_bright() -> Stage:
    """400 lamps of 12 decades of power, the brighter the farther."""
    stage = Stage()
    decades = np.random.default_rng(36).uniform(0, 6, 400)
    ways = dome_ways(400)[np.random.default_rng(37).permutation(400)]
    stage.points(ways * 3 * 10.0 ** (decades[:, None] / 2), 10.0**decades)
    return stage


_SITUATIONS: dict[str, Callable[[], Stage]] = {
    "a strip of 100 m among lamps": _strip,
    "16 upright tubes of 32 triangles": _tubes,
    "lamps close above shades": _shades,
    "sixteen rooms": _sixteen_rooms,
    "lamps behind columns": _columns,
    "40 panels in one place": _one_place,
    "triangles of a micrometre": _tiny,
    "a wall of squares of all brightness": _pixels,
    "a sun and bulbs of 20 triangles": _sun_and_bulbs,
    "every kind of light": _all_kinds,
    "spots of half a degree": _narrow,
    "a town on the horizon": _far_away,
    "upright screens of two sides": _both_sides,
    "bulbs over a polished floor": _bulbs_over_a_polished_floor,
    "twelve decades, the farther the brighter": _far_and_bright,
}
