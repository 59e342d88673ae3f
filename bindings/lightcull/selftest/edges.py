"""The edge of a light's range: whether select() and prob() see the same lights in it."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from .. import _core
from ..sampler import LightSampler
from .case import Case, Cases, Finding
from .lit_points import directions, floats

_SETS = 4096
_ULPS = 76
_DIRECTIONS = 16
_ERROR_BOUND = 0.01
_LEAST_P = 1e-4
_ROUNDING = 1e-6
"""Of the sum of probabilities. Disagreements change it by p / 6 at least."""


def cases() -> Cases:
    yield Case("pairs at the edge of the range (5e6)", _edges)


def _edges() -> Iterator[Finding]:
    """Two equal lights in one place, and in each of many directions and sets the distances around
    the shorter one of their ranges, one ulp apart. Both have the acceptance probability p of
    [TH16] Eq. 1. Where select() accepts both, prob() of the two must sum to p; where it accepts
    one, to p / 2 of the other and, since it is alone, p + (1 - p) / 2; where none, to twice that.
    """
    lights = _core.point_lights(np.zeros((2, 3), np.float32), np.ones(2, np.float32))
    sampler = LightSampler(lights, f"culled:error_bound={_ERROR_BOUND}:sets={_SETS}")
    sets = np.arange(_SETS, dtype=np.uint32)
    wrong = pairs = lost = 0
    for number, way in enumerate(directions(_DIRECTIONS, 31)):
        sampler.begin_pass(number)
        edge = _range(sampler, way, sets)
        shown = edge < _certain() / math.sqrt(_LEAST_P)
        steps = np.arange(-_ULPS // 2, _ULPS // 2, dtype=np.int32)[:, None]
        distances = (edge[shown].view(np.int32) + steps).view(np.float32)
        positions = floats(distances.reshape(-1, 1) * way)
        of_each = np.tile(sets[shown], len(steps))
        both, disagree = _disagreements(sampler, positions, of_each)
        wrong += int(disagree.sum())
        pairs += len(positions)
        seen = both.reshape(len(steps), -1)
        lost += int((~seen.any(axis=0)).sum())
    yield Finding("ranges that are not found", float(lost), 0)
    yield Finding(f"of {pairs} pairs, on which they disagree", float(wrong), 0)


def _range(sampler: LightSampler, way: np.ndarray, sets: np.ndarray) -> np.ndarray:
    """About the largest distance at which both lights are accepted, by set."""
    low, high = np.full(len(sets), math.log2(_certain() * 0.999)), np.full(len(sets), 62.0)
    for _ in range(34):
        middle = (low + high) / 2
        positions = floats(np.exp2(middle)[:, None] * way)
        inside = _both_accepted(_chosen(sampler, positions, sets))
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return floats(np.exp2(low))


def _certain() -> float:
    """The distance up to which p is 1."""
    return math.sqrt(1 / (2 * math.pi * _ERROR_BOUND))


def _chosen(sampler: LightSampler, positions: np.ndarray, sets: np.ndarray) -> np.ndarray:
    return sampler.select(positions, None, np.zeros(len(sets), np.float32), sets)


def _both_accepted(chosen: np.ndarray) -> np.ndarray:
    """The weight of one alone is negative."""
    return chosen["weight_sum"] > 0


def _disagreements(
    sampler: LightSampler, positions: np.ndarray, sets: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Where both were accepted, and where prob() sees it otherwise."""
    chosen = _chosen(sampler, positions, sets)
    probs = [
        sampler.prob(positions, None, chosen, np.full(len(sets), light, np.uint32)).astype(float)
        for light in (0, 1)
    ]
    distance2 = (positions.astype(float) ** 2).sum(axis=1)
    p = np.minimum(1.0, _certain() ** 2 / distance2)
    both, alone = chosen["weight_sum"] > 0, chosen["weight_sum"] < 0
    expected = np.where(both, p, np.where(alone, p + 0.5, p + 1))
    disagree = np.abs(sum(probs) - expected) > _ROUNDING
    own = np.take_along_axis(np.array(probs), chosen["light"][None].astype(np.intp), axis=0)[0]
    return both, disagree | (own != chosen["prob"])
