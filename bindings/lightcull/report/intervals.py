"""Estimates from a few independent repeats, and 95 % intervals about them.

The intervals are Student's: of means of repeats that are about normal, which means over the pixels
of an image are.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

Interval: TypeAlias = tuple[float, float]
"""Its lower and its upper end."""

_T = (
    12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
    2.201, 2.179, 2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086,
)  # fmt: skip
"""The 0.975 quantile of Student's t for 1, 2, ... degrees of freedom."""
_Z = 1.959964


def t_quantile(freedom: int) -> float:
    """The 0.975 quantile of Student's t, to 3 decimals."""
    if freedom <= len(_T):
        return _T[freedom - 1]
    z, n = _Z, freedom  # Abramowitz & Stegun 26.7.5
    return (
        z
        + (z**3 + z) / (4 * n)
        + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * n**2)
        + (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / (384 * n**3)
    )


def half_width(values: Sequence[float]) -> float | None:
    """Of the interval about the mean of the values; None where there are fewer than two."""
    count = len(values)
    if count < 2:
        return None
    return t_quantile(count - 1) * float(np.std(values, ddof=1)) / math.sqrt(count)


def of_mean(values: Sequence[float]) -> Interval | None:
    """About the mean of independent values."""
    half = half_width(values)
    return None if half is None else (float(np.mean(values)) - half, float(np.mean(values)) + half)


def of_product(value: float, factors: Sequence[tuple[Sequence[float], int]]) -> Interval | None:
    """About a product of means, each to a power.

    factors: the values of each mean, one for each repeat, and its power. Repeats of one number
    belong together, so that what they share cancels. By the delta method on the logarithm.
    """
    count = min(len(values) for values, _ in factors)
    relative = np.zeros(count)
    for values, power in factors:
        used = np.asarray(values[:count], np.float64)
        relative += power * (used / used.mean() - 1)
    half = half_width(list(relative))
    if half is None or not math.isfinite(half):
        return None
    half = min(half, 700.0)  # an exponential that is still a number
    return value * math.exp(-half), value * math.exp(half)


def by_jackknife(count: int, estimate: Callable[[list[int]], float]) -> Interval | None:
    """About an estimate from so many repeats; None where there are fewer than three.

    estimate: gives it from some of the repeats, two at least.
    """
    if count < 3:
        return None
    everything = list(range(count))
    whole = estimate(everything)
    pseudo = [
        count * whole - (count - 1) * estimate(everything[:i] + everything[i + 1 :])
        for i in range(count)
    ]
    return of_mean(pseudo)
