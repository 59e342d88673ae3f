"""Lights behind walls and plates."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .lamps import scattered
from .situation import Situation
from .stage import Stage


def situations() -> Iterator[Situation]:
    yield Situation("two rooms", "hidden", _two_rooms)
    yield Situation("300 lamps behind a wall", "hidden", _behind_a_wall)
    yield Situation("lamps beyond a door", "hidden", _door)
    yield Situation("lamps above a ceiling with a slit", "hidden", _slit)
    yield Situation("panels between beams", "hidden", _beams)


def _two_rooms() -> Stage:
    stage = Stage()
    stage.points(scattered(0, 100, (0.2, 1, -4), (4, 2, 4)), 1)
    stage.points(scattered(1, 100, (-4, 1, -4), (-0.2, 2, 4)), 1)
    stage.plate((0, 0, -4), (0, 0, 8), (0, 2.2, 0))
    return stage


def _behind_a_wall() -> Stage:
    """All of them hidden, and bright beside the ten that are not."""
    stage = Stage()
    stage.plate((4.1, 0, -30), (0, 0, 60), (0, 10, 0))
    stage.points(scattered(2, 300, (4.3, 1, -4), (8, 3, 4)), 1)
    stage.points(scattered(3, 10, (-4, 2.5, -4), (4, 3, 4)), 0.2)
    return stage


def _door() -> Stage:
    """A wall with a door of 1 m; lamps beyond it, and two on this side."""
    stage = Stage()
    for corner, along in (((4.1, 0, -30), 29.5), ((4.1, 0, 0.5), 29.5)):
        stage.plate(corner, (0, 0, along), (0, 10, 0))
    stage.plate((4.1, 2, -0.5), (0, 0, 1), (0, 8, 0))
    stage.points(scattered(4, 300, (4.5, 0.5, -6), (10, 3, 6)), 3)
    stage.points([(-2, 2.6, -2), (2, 2.6, 2)], 0.3)
    return stage


def _slit() -> Stage:
    stage = Stage()
    stage.plate((-8, 2.4, -8), (7.8, 0, 0), (0, 0, 16))
    stage.plate((0.2, 2.4, -8), (7.8, 0, 0), (0, 0, 16))
    stage.points(scattered(5, 300, (-4, 2.6, -4), (4, 3.5, 4)), 1)
    stage.points(scattered(6, 5, (-4, 2.2, -4), (4, 2.35, 4)), 0.02)
    return stage


def _beams() -> Stage:
    """Panels above a row of beams, each of which hides some of them from most places."""
    stage = Stage()
    for x in np.linspace(-3.5, 3.5, 8):
        stage.plate((x - 0.2, 2.5, -4), (0.4, 0, 0), (0, 0, 8))
    for place in scattered(7, 128, (-4, 2.9, -4), (4, 3.1, 4)):
        stage.panel(place, (0.005, 0, 0), (0, 0, 0.005), 5000)
    return stage
