"""The edge of a light's range: whether select() and prob() see the same lights in it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .. import _core
from ..sampler import LightSampler
from .model import Case, Cases, Finding
from .some import directions, floats

_SETS = 4096
_ULPS = 76
_DIRECTIONS = 64


def cases() -> Cases:
    yield Case("pairs at the edge of the range (1e8 with 5 instruction sets)", _edges)


def _edges() -> Iterator[Finding]:
    """One light, and in each of many directions and sets the distances around its range, one ulp
    apart: select() must accept it where prob() does. Not accepted, it has a probability below 1 (as
    if it had been); disagreeing, prob() would be infinite, or not that of select().
    """
    light = _core.point_lights(np.zeros((1, 3), np.float32), np.ones(1, np.float32))
    sampler = LightSampler(light, f"culled:error_bound=0.01:sets={_SETS}")
    sets = np.arange(_SETS, dtype=np.uint32)
    wrong = pairs = monotone = 0
    for number, way in enumerate(directions(_DIRECTIONS, 31)):
        sampler.begin_pass(number)
        edge = _range(sampler, way, sets)
        shown = edge < 1e18  # some ranges have no end
        steps = np.arange(-_ULPS // 2, _ULPS // 2, dtype=np.int32)[:, None]
        distances = (edge[shown].view(np.int32) + steps).view(np.float32)
        positions = floats(distances.reshape(-1, 1) * way)
        of_each = np.tile(sets[shown], len(steps))
        accepted = _disagreements(sampler, positions, of_each)
        wrong += accepted[0]
        pairs += len(positions)
        monotone += int(accepted[1].reshape(len(steps), -1).any(axis=0).sum() < shown.sum())
    yield Finding("ranges that are not found", float(monotone), 0)
    yield Finding(f"of {pairs} pairs, on which they disagree", float(wrong), 0)


def _range(sampler: LightSampler, way: np.ndarray, sets: np.ndarray) -> np.ndarray:
    """About the largest distance at which the light is accepted, by set."""
    low, high = np.full(len(sets), -20.0), np.full(len(sets), 62.0)
    u = np.zeros(len(sets), np.float32)
    for _ in range(34):
        middle = (low + high) / 2
        positions = floats(np.exp2(middle)[:, None] * way)
        inside = sampler.select(positions, None, u, sets)["prob"] > 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return floats(np.exp2(low))


def _disagreements(
    sampler: LightSampler, positions: np.ndarray, sets: np.ndarray
) -> tuple[int, np.ndarray]:
    chosen = sampler.select(positions, None, np.zeros(len(sets), np.float32), sets)
    prob = sampler.prob(positions, None, chosen, np.zeros(len(sets), np.uint32))
    accepted = chosen["prob"] > 0
    agree = np.where(accepted, prob == chosen["prob"], (prob > 0) & (prob <= 1))
    return int((~agree).sum()), accepted
