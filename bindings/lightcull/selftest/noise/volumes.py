"""Places in the air, which have no normal: as a renderer of fog asks for lights."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ... import _core
from ...sampler import LightSampler
from .lamps import scattered
from .situation import Estimate, Situation

_GOLDEN = (5**0.5 - 1) / 2
"""Of which the multiples' fractions are even (Weyl 1916)."""
_BELOW_ONE = 1 - 2.0**-24


def situations() -> Iterator[Situation]:
    anywhere = ((-4, 0, -4), (4, 4, 4))
    yield Situation("300 bulbs in fog", "volumes", lambda: _Air(scattered(0, 300, *anywhere)))
    yield Situation("clusters in fog", "volumes", lambda: _Air(_clusters()))
    yield Situation(
        "bulbs in fog, half of them shut in", "volumes",
        lambda: _Air(scattered(0, 300, *anywhere), walled=True),
    )  # fmt: skip


def _clusters() -> np.ndarray:
    middles = scattered(1, 10, (-4, 0, -4), (4, 4, 4))
    return np.repeat(middles, 40, axis=0) + scattered(2, 400, (-0.1,) * 3, (0.1,) * 3)


class _Air:
    """Scattering at places in a box, of light from points of intensity 1.

    walled: a wall at x = 0 hides from each half of the box what is in the other.
    """

    _PLACES = 48 * 48

    def __init__(self, bulbs: np.ndarray, walled: bool = False) -> None:
        bulbs = bulbs.astype(np.float32)
        places = scattered(9, self._PLACES, (-4, 0, -4), (4, 4, 4))
        self._places = places.astype(np.float32)
        self._lights = _core.point_lights(bulbs, np.ones(len(bulbs), np.float32))
        way = bulbs[None].astype(float) - self._places[:, None]
        same_half = (bulbs[None, :, 0] > 0) == (self._places[:, None, 0] > 0)
        self._seen = same_half | (not walled)
        self._value = self._seen / (way * way).sum(axis=2)

    def mean(self) -> float:
        return float(self._value.sum(axis=1).mean())

    def estimate(self, sampler: str, seed: int, passes: int, even: bool) -> Estimate:
        normals = np.zeros_like(self._places)
        chooser = LightSampler(self._lights, sampler, calibration=(self._places, normals))
        random = np.random.default_rng(seed)
        row = np.arange(self._PLACES)
        shift = random.random(self._PLACES)
        total, means = np.zeros(self._PLACES), []
        for number in range(passes):
            chooser.begin_pass(seed * passes + number)
            sets = random.integers(0, chooser.set_count, self._PLACES, np.uint32)
            trial = random.random(self._PLACES, np.float32)
            u = np.float32((shift + number * _GOLDEN) % 1 * _BELOW_ONE) if even else trial
            chosen = chooser.select(self._places, normals, u, sets)
            prob, light = chosen["prob"].astype(float), chosen["light"]
            taken = prob > 0
            light = np.where(taken, light, 0)
            value = np.divide(self._value[row, light], prob, out=np.zeros_like(prob), where=taken)
            total += value
            means.append(value.mean())
            # What is learned may not depend on even numbers.
            told = chooser.select(self._places, normals, trial, sets) if even else chosen
            seen = self._seen[row, np.where(told["prob"] > 0, told["light"], 0)]
            chooser.report(self._places, normals, told, seen.astype(np.float32))
        return Estimate(total / passes, np.array(means))
