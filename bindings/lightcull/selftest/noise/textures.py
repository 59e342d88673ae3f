"""Panels with images on them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .situation import Situation
from .stage import Stage


def situations() -> Iterator[Situation]:
    one = np.zeros((64, 64))
    one[20, 33] = 1
    yield Situation("one bright texel of 4,096", "textures", lambda: _over(one, 1000))
    some = np.zeros((64, 64))
    some[::4, ::4] = 1
    yield Situation("256 bright texels", "textures", lambda: _over(some, 20))
    picture = np.random.default_rng(0).lognormal(0, 2, (16, 16))
    picture /= picture.max()
    yield Situation("a screen of 16 x 16 texels", "textures", lambda: _screen(picture))


def _over(texels: np.ndarray, radiance: float) -> Stage:
    stage = Stage()
    stage.textured((0, 3, 0), (2.0, 0, 0), (0, 0, 2.0), radiance, texels)
    return stage


def _screen(texels: np.ndarray) -> Stage:
    """A wall beside the floor."""
    stage = Stage()
    stage.textured((4.2, 2, 0), (0, 0, 4.0), (0, 1.5, 0), 50, texels)
    return stage
