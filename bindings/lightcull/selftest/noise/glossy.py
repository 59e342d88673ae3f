"""Floors that shine."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .lamps import scattered
from .situation import Situation
from .stage import Stage


def situations() -> Iterator[Situation]:
    yield Situation("lamps over metal of roughness 0.2", "glossy", lambda: _lamps(0.2, 1.0))
    yield Situation("lamps over a polished floor", "glossy", lambda: _lamps(0.3, 0.0))
    yield Situation("panels over metal of roughness 0.5", "glossy", lambda: _panels(0.5, 1.0))
    yield Situation("panels over a polished floor", "glossy", lambda: _panels(0.3, 0.0))
    yield Situation("panels over metal of roughness 0.2", "glossy", lambda: _panels(0.2, 1.0))


def _floor(roughness: float, metallic: float) -> Stage:
    return Stage(base_color=(0.5, 0.5, 0.5), roughness=roughness, metallic=metallic)


def _lamps(roughness: float, metallic: float) -> Stage:
    stage = _floor(roughness, metallic)
    stage.points(scattered(0, 300, (-4, 2.4, -4), (4, 3, 4)), 1)
    return stage


def _panels(roughness: float, metallic: float) -> Stage:
    """That do not hide each other."""
    stage = _floor(roughness, metallic)
    for x in np.linspace(-3.5, 3.5, 8):
        for z in np.linspace(-3.5, 3.5, 8):
            stage.panel((x, 3, z), (0.1, 0, 0), (0, 0, 0.1), 20)
    return stage
