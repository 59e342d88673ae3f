"""Triangles: panels, ceilings, tubes, walls, and lamps of many of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import combinations, product
from typing import Any

import numpy as np

from .lamps import scattered
from .situation import Situation
from .stage import Stage


def situations() -> Iterator[Situation]:
    for name, make in _SITUATIONS.items():
        yield Situation(name, "panels", make)


def down(
    stage: Stage, middle: Any, half_x: float, half_z: float, radiance: float, cut: int = 1
) -> None:
    """A panel that faces down."""
    stage.panel(middle, (half_x, 0, 0), (0, 0, half_z), radiance, cut)


def sphere(middle: Any, radius: float, subdivisions: int) -> np.ndarray:
    """The triangles (N, 3, 3) of an icosahedron, each cut in four so many times, facing out."""
    golden = (1 + 5**0.5) / 2
    corners = np.array(
        [(0, a, b * golden) for a in (-1, 1) for b in (-1, 1)]
        + [(a, b * golden, 0) for a in (-1, 1) for b in (-1, 1)]
        + [(b * golden, 0, a) for a in (-1, 1) for b in (-1, 1)]
    )
    near = np.isclose(np.linalg.norm(corners[:, None] - corners[None], axis=2), 2)
    three = combinations(range(12), 3)
    faces = [(i, j, k) for i, j, k in three if near[i, j] and near[j, k] and near[i, k]]
    triangles = corners[np.array(faces)]
    inward = np.linalg.det(triangles) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    for _ in range(subdivisions):
        a, b, c = (triangles[:, i] for i in range(3))
        d, e, f = (a + b) / 2, (b + c) / 2, (c + a) / 2
        parts = ((a, d, f), (d, b, e), (f, e, c), (d, e, f))
        triangles = np.concatenate([np.stack(part, axis=1) for part in parts])
    triangles /= np.linalg.norm(triangles, axis=2, keepdims=True)
    return triangles * radius + np.float64(middle)


def _lamp(cut: int) -> Stage:
    stage = Stage()
    down(stage, (0, 3, 0), 0.5, 0.5, 20, cut)
    return stage


def _lamp_in_view() -> Stage:
    """From so high above that the lamp's dark back is in the image."""
    stage = Stage(height=60.0)
    down(stage, (0, 3, 0), 0.5, 0.5, 20, 16)
    stage.unseen(0.5 * 60 / 57)
    return stage


def _nested() -> Stage:
    """Each hides a part of the next."""
    stage = Stage()
    for size, parts in ((0.1, 4), (0.2, 8), (0.4, 16)):
        stage.panel((0, 3 + size, 0), (size, 0, 0), (0, 0, size), 10, parts=parts, hides=True)
    return stage


def _globe() -> Stage:
    stage = Stage()
    stage.triangles(sphere((0, 3, 0), 0.5, 3), 20)
    return stage


def _chandeliers() -> Stage:
    """Of bulbs that do not hide each other from the floor."""
    stage = Stage()
    bulbs = [
        sphere((x + 0.4 * np.cos(a), y, z + 0.4 * np.sin(a)), 0.02, 0)
        for x, y, z in ((-2, 3, -2), (2, 3, 2), (-2, 3, 2))
        for a in 2 * np.pi * np.arange(16) / 16
    ]
    stage.triangles(np.concatenate(bulbs), 100)
    return stage


def _ceiling_of_panels() -> Stage:
    stage = Stage()
    for x in np.linspace(-3.5, 3.5, 8):
        for z in np.linspace(-3.5, 3.5, 8):
            down(stage, (x, 3, z), 0.3, 0.3, 2)
    return stage


def _ceiling() -> Stage:
    stage = Stage()
    down(stage, (0, 2.5, 0), 4, 4, 1)
    return stage


def _low_panel() -> Stage:
    stage = Stage(height=0.2)
    down(stage, (0, 0.3, 0), 3.9, 3.9, 1)
    return stage


def _long_tube() -> Stage:
    stage = Stage(half=15.0, height=2.9)
    down(stage, (0, 3, 0), 15, 0.05, 20)
    stage.points(scattered(0, 400, (-15, 2.91, -15), (15, 2.99, 15)), 0.02)
    return stage


def _rows_of_tubes() -> Stage:
    stage = Stage(half=8.0, height=2.9)
    for z in np.linspace(-7, 7, 15):
        down(stage, (0, 3, z), 8, 0.03, 20)
    return stage


def _video_wall(cut: int) -> Stage:
    stage = Stage()
    stage.panel((4.2, 2, 0), (0, 0, 4.0), (0, 1.5, 0), 2, cut)
    return stage


def _two_sided() -> Stage:
    stage = Stage()
    line = np.linspace(-3, 3, 5)
    for i, (x, z) in enumerate(product(line, line)):
        stage.panel((x, 3, z), (0.2, 0, 0), (0, 0, 0.2), 5, two_sided=i % 2 == 0)
        stage.panel((x, 3.01, z), (0, 0, 0.2), (0.2, 0, 0), 5)  # which faces up
    return stage


def _grazing() -> Stage:
    """Small ones that look across the floor."""
    stage = Stage()
    for place in scattered(12, 40, (4.2, 0.3, -4), (4.2, 0.8, 4)):
        stage.panel(place, (0, 0, 0.05), (0, 0.05, 0), 50)
    return stage


def _letters() -> Stage:
    """A sign of 400 tiny panels that face all ways below the horizon."""
    stage = Stage()
    random = np.random.default_rng(7)
    for place in scattered(8, 400, (-4, 2.6, -4), (4, 3.6, 4)):
        u = np.cross(random.normal(0, 1, 3) + [0, -1, 0], random.normal(0, 1, 3))
        u *= 0.002 / np.linalg.norm(u)
        v = np.cross(random.normal(0, 1, 3), u)
        v *= 0.002 / np.linalg.norm(v)
        stage.panel(place, u, v, 12500)
    return stage


def _mixed() -> Stage:
    """A panel of many triangles, one of two, and lamps."""
    stage = Stage()
    down(stage, (-2, 3, -2), 0.4, 0.4, 20, 24)
    down(stage, (2, 3, 2), 0.4, 0.4, 20)
    stage.points(scattered(11, 100, (-4, 2.5, -4), (4, 2.9, 4)), 0.1)
    return stage


_SITUATIONS: dict[str, Callable[[], Stage]] = {
    "one panel": partial(_lamp, 1),
    "a panel of 512 triangles": partial(_lamp, 16),
    "a panel of 2,048 triangles": partial(_lamp, 32),
    "a panel of 512, from above": _lamp_in_view,
    "nested panels": _nested,
    "a globe of 1,280 triangles": _globe,
    "chandeliers": _chandeliers,
    "a ceiling of panels": _ceiling_of_panels,
    "a ceiling": _ceiling,
    "a large panel low above the floor": _low_panel,
    "a tube of 30 m among lamps": _long_tube,
    "rows of tubes": _rows_of_tubes,
    "a video wall": partial(_video_wall, 20),
    "a wall of 2 triangles": partial(_video_wall, 1),
    "two-sided panels": _two_sided,
    "panels at grazing angles": _grazing,
    "400 tiny panels that face all ways": _letters,
    "panels, coarse and fine, and lamps": _mixed,
}
