"""What samplers make of a situation: their variances, and whether their means are right."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from os import cpu_count

import numpy as np

from .situation import Estimate, Situation, Subject

DEFAULT = "learned"
OTHERS = ("uniform", "power", "light_bvh", "light_bvh:importance=means", "exhaustive")
SEEDS = 4
PASSES = 64

MOST = 1.25
"""How many times the variance of the best other the default's may be."""
NEGLIGIBLE = 1e-3
"""Variances of a sample, relative to the square of its mean, below which all are alike: after 64
samples the error is 0.4 % of a pixel, less than a step of an 8-bit image. The places of samples in
pixels alone make up to a tenth of it."""
_DARK = 0.05
"""Of the mean of all: darker places do not count, since few samples tell their variance."""
_MOST_Z = 5.0
"""A mean that is right is as far off once in 500,000 times (Student's t of 127 degrees of freedom):
one of a battery of 60 once in 9,000 runs with other seeds."""
_ROUNDING = 1e-4
"""Of single precision, and of the sums that the closed forms are."""


@dataclass(frozen=True)
class Figures:
    """Of a sampler in a situation."""

    sampler: str
    variance: float
    """Of one sample over the square of the mean, on average over places: of independent numbers."""
    even_variance: float
    """The same of numbers that are even from pass to pass, as renders have them: PASSES times that
    of so many samples. NaN where it was not measured."""
    mean: float
    """Over what is right."""
    z: float
    """How many of its standard deviations the mean is off."""

    @property
    def right(self) -> bool:
        return abs(self.z) <= _MOST_Z


@dataclass(frozen=True)
class Row:
    """A line of the table."""

    situation: str
    kind: str
    default: Figures
    others: tuple[Figures, ...]

    @property
    def best(self) -> Figures:
        """Of those whose means are right, if any: one that never finds some lights has little
        variance.
        """
        return min(self._right_others(), key=lambda figures: figures.variance)

    @property
    def best_even(self) -> Figures:
        """Of the same, by even numbers."""
        return min(self._right_others(), key=lambda figures: figures.even_variance)

    @property
    def ratio(self) -> float:
        """The default's variance over that of the best, both at least NEGLIGIBLE."""
        return max(self.default.variance, NEGLIGIBLE) / max(self.best.variance, NEGLIGIBLE)

    @property
    def even_ratio(self) -> float:
        """The same by even numbers."""
        best = self.best_even.even_variance
        return max(self.default.even_variance, NEGLIGIBLE) / max(best, NEGLIGIBLE)

    @property
    def no_worse(self) -> bool:
        return self.ratio <= MOST

    @property
    def no_worse_by_even(self) -> bool:
        return self.even_ratio <= MOST

    @property
    def right(self) -> bool:
        return self.default.right

    def _right_others(self) -> Sequence[Figures]:
        return [figures for figures in self.others if figures.right] or self.others


def measure(
    situation: Situation,
    default: str = DEFAULT,
    others: Iterable[str] = OTHERS,
    *,
    by_even: bool = True,
) -> Row:
    """Estimates by each sampler, of which each seed gives one; by_even: by even numbers, too."""
    subject = situation.make()
    names = (default, *others)
    kinds = (False, True) if by_even else (False,)
    keys = [(name, even) for even in kinds for name in names]
    with ThreadPoolExecutor(cpu_count()) as pool:
        jobs = {key: pool.map(partial(_estimate, subject, *key), range(SEEDS)) for key in keys}
        truth = subject.mean()
        estimates = {key: list(found) for key, found in jobs.items()}
    places = {key: np.array([e.places for e in found]) for key, found in estimates.items()}
    usual = _usual(places.values())
    variances = {key: _variance(found, usual) for key, found in places.items()}
    figures = [
        Figures(
            name, variances[name, False], variances.get((name, True), np.nan),
            *_mean(estimates[name, False], truth),
        )
        for name in names
    ]  # fmt: skip
    return Row(situation.name, situation.kind, figures[0], tuple(figures[1:]))


def _estimate(subject: Subject, sampler: str, even: bool, seed: int) -> Estimate:
    return subject.estimate(sampler, seed, PASSES, even)


def _usual(all_places: Iterable[np.ndarray]) -> np.ndarray:
    """The mean at each place (P,), of the sampler whose seeds differ least; 0 where it is dark."""
    means = [(places.var(axis=0).mean(), places.mean(axis=0)) for places in all_places]
    mean = min(means, key=lambda pair: pair[0])[1]
    return np.where(mean > _DARK * mean.mean(), mean, 0.0)


def _variance(places: np.ndarray, usual: np.ndarray) -> float:
    """Of one sample, from how the seeds (S, P) differ."""
    lit = usual > 0
    return PASSES * float((places.var(axis=0, ddof=1)[lit] / usual[lit] ** 2).mean())


def _mean(estimates: list[Estimate], truth: float) -> tuple[float, float]:
    """Over the truth, and how many standard deviations that is off. Passes may depend on earlier
    ones, but each is right in the mean whatever those were: their errors are not correlated.
    """
    passes = np.concatenate([e.passes for e in estimates]) / truth
    noise = passes.std(ddof=1) / np.sqrt(len(passes))
    mean = float(passes.mean())
    return mean, (mean - 1) / float(np.hypot(noise, _ROUNDING))
