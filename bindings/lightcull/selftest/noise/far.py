"""Suns, domes and fields of lamps: lights at distances of very different sizes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .lamps import scattered
from .situation import Situation
from .stage import Stage, cut_up


def situations() -> Iterator[Situation]:
    yield Situation("a sun and lamps", "far", lambda: _sun(1e4))
    yield Situation("a sun at 1.5e11 m and lamps", "far", lambda: _sun(1.5e11))
    yield Situation("a directional light and lamps", "far", lambda: _directional(1))
    yield Situation("60 directional lights and lamps", "far", lambda: _directional(60))
    yield Situation("300 directional lights and lamps", "far", lambda: _directional(300))
    yield Situation("a dome of 500 lamps", "far", _dome)
    yield Situation("a dome of 800 triangles and lamps", "far", _dome_of_triangles)
    yield Situation("a field of lamps, and some near ones", "far", _field)


def _sun(distance: float) -> Stage:
    """As large as the sun looks, and half of the light."""
    stage = Stage()
    way = np.array([0.3, 0.9, 0.1]) / np.linalg.norm([0.3, 0.9, 0.1])
    u = np.cross(way, [1.0, 0, 0])
    u /= np.linalg.norm(u)
    v = np.cross(u, way)  # so that u x v looks back
    radius = 0.00465 * distance
    stage.panel(way * distance, u * radius, v * radius, 0.05 / (4 * 0.00465**2))
    stage.points(scattered(0, 100, (-4, 2.5, -4), (4, 3, 4)), 0.02)
    return stage


def _directional(count: int) -> Stage:
    """Half of the light; some are below the horizon."""
    stage = Stage()
    ways = np.random.default_rng(9).normal(0, 1, (count, 3)) + [0.0, 1.0, 0.0]
    stage.suns(ways, 0.5 * np.random.default_rng(10).lognormal(0, 1.5, count) / count)
    stage.points(scattered(0, 100, (-4, 2.5, -4), (4, 3, 4)), 0.02)
    return stage


def _dome_ways(count: int) -> np.ndarray:
    """Evenly spread over the upper hemisphere, down to 6 degrees above the horizon."""
    index = np.arange(count) + 0.5
    y = 0.1 + 0.9 * index / count
    angle = index * np.pi * (3 - 5**0.5)
    r = np.sqrt(1 - y * y)
    return np.stack([r * np.cos(angle), y, r * np.sin(angle)], axis=1)


def _dome() -> Stage:
    stage = Stage()
    power = np.random.default_rng(5).lognormal(0, 1.5, 500)
    stage.points(_dome_ways(500) * 400, 500 * power)
    return stage


def _dome_of_triangles() -> Stage:
    stage = Stage()
    random = np.random.default_rng(6)
    panels = []
    for way in _dome_ways(400):
        u = np.cross(way, random.normal(0, 1, 3))
        u *= 2 / np.linalg.norm(u)
        panels.append(cut_up(way * 100, u, np.cross(u, way), 1))
    stage.triangles(np.concatenate(panels), np.repeat(random.lognormal(0, 1.5, 400), 2))
    stage.points(scattered(1, 20, (-4, 2.5, -4), (4, 3, 4)), 0.05)
    return stage


def _field() -> Stage:
    stage = Stage()
    stage.points(scattered(0, 100, (-400, 20, -400), (400, 40, 400)), 300)
    stage.points(scattered(1, 10, (-4, 2.5, -4), (4, 3, 4)), 1)
    return stage
