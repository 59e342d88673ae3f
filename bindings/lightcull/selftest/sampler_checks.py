"""What has to hold for samplers, whatever the lights and the points."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .. import _core
from ..sampler import LightSampler
from .case import Finding
from .lit_points import Setting

EPSILON = float(np.finfo(np.float32).eps) / 2
"""By which rounding a number to single precision may change it, relatively."""
UNBIASED = ("culled", "light_bvh", "light_bvh:importance=means", "exhaustive", "power", "uniform")
TREES = ("light_bvh", "light_bvh:importance=means")
_NOISE = 6.0
"""Standard deviations of a mean. With 31 degrees of freedom it is passed once in 10^6 times."""
_FIRST, _PASSES = 16, 32
_OFTEN = 32
"""Times that a light must have been chosen in the first passes."""
_RARE = 8
"""Events that may be missing where they are so rare that the noise does not show them."""
_LEAST_SHARE = 0.01
_ABSENT = 0.03
"""Share of the light at a point that may be absent from thousands of samples."""
_POINTS = 12


def probs_of_all(sampler: LightSampler, setting: Setting) -> np.ndarray:
    """The probability of every light at every point: float64 (M, N)."""
    points, count = len(setting.positions), len(setting.lights)
    chosen = sampler.select(setting.positions, setting.normals, setting.numbers(1))
    rows = []
    for i in range(points):
        once = [np.repeat(a[i : i + 1], count, 0) for a in (setting.positions, setting.normals)]
        ids = np.arange(count, dtype=np.uint32)
        rows.append(sampler.prob(*once, np.repeat(chosen[i : i + 1], count), ids))
    return np.array(rows, np.float64).reshape(points, count)


def all_of(setting: Setting) -> Iterator[Finding]:
    """Everything that can be checked for any setting."""
    yield from choices(setting)
    yield from totals(setting)
    yield from means(setting)


def choices(setting: Setting, samplers: tuple[str, ...] = UNBIASED) -> Iterator[Finding]:
    """That single points and batches give the same bits as the scalar path, that probabilities are
    some, and that prob() agrees with select().
    """
    u = setting.numbers(2)
    target = _core.instruction_set()
    points = (setting.positions, setting.normals)
    for description in samplers:
        sampler = setting.sampler(description)
        sets = (np.arange(len(u)) % sampler.set_count).astype(np.uint32)
        batch = sampler.select(*points, u, sets)
        single = sampler._core.select_single(*points, u, sets, None, None)
        _core.use_instruction_set("scalar")
        sampler.begin_pass(0)  # ranges are refitted by it, too
        scalar = sampler.select(*points, u, sets)
        _core.use_instruction_set(target)
        sampler.begin_pass(0)
        yield Finding(f"{description}: a batch is not as single points", _differ(batch, single), 0)
        yield Finding(f"{description}: not as the scalar path", _differ(batch, scalar), 0)
        prob = batch["prob"]
        nonsense = ~np.isfinite(prob) | (prob < 0) | (prob > 1 + 4 * EPSILON)
        yield Finding(f"{description}: probabilities that are none", float(nonsense.sum()), 0)
        if len(setting.lights):
            again = sampler.prob(*points, batch, np.where(prob > 0, batch["light"], 0))
            wrong = (prob > 0) & (again != batch["mis_prob"])
            yield Finding(f"{description}: prob() is not that of select()", float(wrong.sum()), 0)


def _differ(a: np.ndarray, b: np.ndarray) -> float:
    """How many records are not the same; what was not chosen has no bits to speak of."""
    chosen = (a["prob"] > 0) | (b["prob"] > 0)
    return float(sum(a[i].tobytes() != b[i].tobytes() for i in np.flatnonzero(chosen)))


def totals(setting: Setting, trees: tuple[str, ...] = TREES) -> Iterator[Finding]:
    """That the probabilities of all lights together are 1, and none is left out that gives light.
    The exhaustive answer is exact but for rounding, of which a sum has one for each term.
    """
    truth = probs_of_all(setting.sampler("exhaustive"), setting)
    lit = np.isfinite(truth).all(axis=1) & (truth.sum(axis=1) > 0)
    if not lit.any():
        return
    count = len(setting.lights)
    allowed = EPSILON * (16 + count)
    off = float(np.abs(truth[lit].sum(axis=1) - 1).max())
    yield Finding("exhaustive: sum of probabilities", off, allowed)
    for description in trees:
        probs = probs_of_all(setting.sampler(description), setting)[lit]
        levels = np.log2(count + 1)
        # Less than 1 is no error: where all of a cluster turns out not to matter, none is chosen.
        above = float((probs.sum(axis=1) - 1).max())
        yield Finding(f"{description}: sum of probabilities", max(above, 0.0),
                      EPSILON * (32 + 32 * levels))  # fmt: skip
        missed = float(np.where(probs > 0, 0.0, truth[lit]).sum(axis=1).max())
        yield Finding(f"{description}: light that is never chosen", missed, 8 * EPSILON)


def means(setting: Setting, samplers: tuple[str, ...] = ("culled:sets=64", *TREES)) -> Iterator[Finding]:
    """That choices are right in the mean, at some of the points: divided by their probability they
    give the exhaustive answer, and a light of some weight does not stay away for thousands of them.
    """
    truth = probs_of_all(setting.sampler("exhaustive"), setting)
    lit = np.flatnonzero(np.isfinite(truth).all(axis=1) & (truth.sum(axis=1) > 0))
    for description in samplers:
        sampler = setting.sampler(description)
        for i in lit[:_POINTS]:
            yield from _mean(setting, sampler, int(i), truth[i])


def _mean(
    setting: Setting, sampler: LightSampler, point: int, truth: np.ndarray
) -> Iterator[Finding]:
    """Of lights that are chosen often enough for the noise to be known; some passes say which those
    are, others are averaged.
    """
    name = f"{sampler.description}: point {point}"
    lights, probs = _choices_of_passes(setting, sampler, point)
    if sampler.description not in TREES:  # of which totals() knows what they never choose
        ever = np.bincount(lights[probs > 0], minlength=len(truth)) > 0
        missed = float(np.where(ever, 0.0, truth).max())
        yield Finding(f"{name}: light of which {probs.size} samples have none", missed, _ABSENT)
    often = np.bincount(lights[:_FIRST][probs[:_FIRST] > 0], minlength=len(truth)) >= _OFTEN
    share = truth[often].sum()
    if share < _LEAST_SHARE:
        return
    lights, probs = lights[_FIRST:], probs[_FIRST:]
    taken = (probs > 0) & often[lights]
    values = np.divide(truth[lights], probs, out=np.zeros_like(probs), where=taken)
    samples = values.mean(axis=1) / share
    noise = float(np.std(samples, ddof=1)) / np.sqrt(len(samples))
    rounding = EPSILON * (64 + len(truth))
    allowed = _NOISE * noise + _RARE / probs.size + rounding
    yield Finding(f"{name}: mean", abs(float(samples.mean()) - 1), allowed)


def _choices_of_passes(
    setting: Setting, sampler: LightSampler, point: int
) -> tuple[np.ndarray, np.ndarray]:
    """Lights and their probabilities, some of every set in each of many passes."""
    sets = np.tile(np.arange(sampler.set_count, dtype=np.uint32), 256 // sampler.set_count)
    points = [
        np.repeat(a[point : point + 1], len(sets), 0) for a in (setting.positions, setting.normals)
    ]
    random = np.random.default_rng(3)
    chosen = []
    for number in range(_FIRST + _PASSES):
        sampler.begin_pass(number)
        chosen.append(sampler.select(*points, random.random(len(sets), np.float32), sets))
    sampler.begin_pass(0)
    all_chosen = np.array(chosen)
    return all_chosen["light"], all_chosen["prob"].astype(np.float64)
