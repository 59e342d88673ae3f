"""Points: few, many, near, strong and weak ones, together and apart."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from .situation import Situation
from .stage import Stage


def situations() -> Iterator[Situation]:
    def points(name: str, places: Any, intensity: Any = 1.0) -> Situation:
        def make() -> Stage:
            stage = Stage()
            stage.points(places, intensity)
            return stage

        return Situation(name, "lamps", make)

    over = ((-4, 2.5, -4), (4, 4, 4))
    yield points("one lamp", [(0, 3, 0)])
    yield points("two lamps", [(-2, 3, 0), (2, 3, 0)])
    yield points("100 lamps", scattered(0, 100, *over))
    yield points("1,000 lamps", scattered(3, 1000, *over))
    yield points("lamps near the floor", scattered(0, 100, (-4, 0.02, -4), (4, 0.3, 4)), 0.1)
    decades = 10.0 ** np.random.default_rng(1).uniform(-6, 2, 200)
    yield points("eight decades of power", scattered(0, 200, *over), decades)
    yield points("64 in one place", [(1, 3, 1)] * 64)
    cluster = scattered(0, 500, (-3.1, 3, -3.1), (-3, 3.1, -3))
    yield points(
        "a cluster and one lamp", [*cluster, (3, 3, 3)], np.append(np.full(500, 0.01), 5.0)
    )
    buried = scattered(0, 50, (-4, -1, -4), (4, -0.1, 4))
    yield points(
        "strong ones below the floor",
        [*buried, *scattered(1, 20, (-4, 2.5, -4), (4, 3, 4))],
        np.append(np.full(50, 100.0), np.ones(20)),
    )
    line = [(x, 2.6, 0.3) for x in np.linspace(-4, 4, 300)]
    yield points("a string of lights", line, 0.1)
    middles = np.repeat(scattered(50, 12, (-3.5, 2.8, -3.5), (3.5, 2.8, 3.5)), 80, axis=0)
    yield points("twelve clusters", middles + scattered(51, 960, (-0.2,) * 3, (0.2,) * 3), 0.05)


def scattered(seed: int, count: int, low: Any, high: Any) -> np.ndarray:
    """Places (count, 3) anywhere in a box."""
    return np.random.default_rng(seed).uniform(low, high, (count, 3))
