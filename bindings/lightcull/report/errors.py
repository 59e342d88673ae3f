"""The errors of one run, and of the runs of one sampler together."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from .._core import Error
from ..field_docs import with_field_docs
from . import metrics
from .runs import Reference, SamplerRun

Metric: TypeAlias = Callable[[np.ndarray, np.ndarray], np.ndarray | float]
"""Of an image and a reference, float32 (H, W, 3), linear RGB, emission that is seen directly left
out where that is known: an error map, (H, W) or (H, W, C), whose mean is the figure, or the figure."""

METRICS: Mapping[str, Metric] = {
    "relmse": metrics.relative_squared_error,
    "mape": metrics.relative_error,
    "smape": metrics.symmetric_error,
    "flip": metrics.flip_map,
}
"""Metrics by name: as published, with the noise of the reference in them."""


def metrics_by_name(
    wanted: Sequence[str | Metric], size: tuple[int, int]
) -> dict[str, Metric]:
    """Metrics by their names, those of functions being theirs. Each has been found to work for images
    of this size (width, height).
    """
    found: dict[str, Metric] = {}
    width, height = size
    grey = np.full((height, width, 3), 0.5, np.float32)
    for metric in wanted:
        if isinstance(metric, str) and metric not in METRICS:
            raise Error(f"metrics: {metric!r} is unknown; there are {', '.join(METRICS)}")
        if not isinstance(metric, str) and not callable(metric):
            raise TypeError(f"metrics: wanted names and functions, got {metric!r}")
        name = metric if isinstance(metric, str) else getattr(metric, "__name__", repr(metric))
        if name in found:
            raise Error(f"metrics: there are two of the name {name!r}")
        found[name] = METRICS[metric] if isinstance(metric, str) else metric
        as_map(name, found[name](grey, grey), (height, width))
    return found


def as_map(name: str, error: np.ndarray | float, shape: tuple[int, int]) -> np.ndarray:
    """What a metric gave as an error map, (H, W): the mean over channels; a number everywhere."""
    values = np.asarray(error, np.float64)
    if values.ndim == 3 and values.shape[:2] == shape:
        values = values.mean(axis=2)
    if values.shape not in ((), shape):
        raise Error(
            f"metrics: {name} gave an array of shape {values.shape}, wanted {shape}, "
            "with channels or without, or a number"
        )
    return np.broadcast_to(values, shape)


@with_field_docs
@dataclass(frozen=True)
class Measure:
    """How images are measured against a reference."""

    reference: Reference
    """Against which."""
    mask: np.ndarray | None = None
    """bool (H, W): the pixels that count; None: all."""
    _flip_maps: dict[int, np.ndarray] = field(default_factory=dict, compare=False, repr=False)
    """By run: they take long."""

    def errors(self, run: SamplerRun) -> dict[str, float]:
        """The errors of a run, by the names of `SamplerFigures`; not a number or infinite where
        there is none.
        """
        lit, halves = run.lit_image, self.reference.lit_halves
        reference = self.reference.lit_image
        measured = metrics.relative_squared_error(lit, reference).mean(axis=2)
        unbiased = self._unbiased(lit, halves).mean(axis=2)
        counted = measured if self.mask is None else measured[self.mask]
        squared = metrics.mean_of(metrics.squared_error(lit, halves), self.mask)
        found = {
            "rmse": math.sqrt(max(squared, 0.0)),
            "relmse": self.relmse(lit),
            "relmse_measured": metrics.mean_of(measured, self.mask),
            "relmse_median": float(np.median(counted)),
            "relmse_trimmed": metrics.trimmed_mean(unbiased, measured, self.mask),
            "flip": metrics.mean_of(self.flip_map(run), self.mask),
            "relmse_blurred": self._blurred(lit, metrics.BLUR_SIZE),
            "relmse_blurred31": self._blurred(lit, metrics.WIDE_BLUR_SIZE),
            "relmse_image": metrics.mean_of(
                self._unbiased(run.image, self.reference.halves), self.mask
            ),
            "relmse_emission": math.nan,
        }
        if run.emission is not None and self.reference.emission is not None:
            squared_emission = metrics.squared_error(run.emission, self.reference.emission)
            scale = metrics.scale_of(self.reference.image)
            found["relmse_emission"] = metrics.mean_of(
                metrics.over(squared_emission, scale), self.mask
            )
        return found

    def flip_map(self, run: SamplerRun) -> np.ndarray:
        """`metrics.flip_map` of the whole image: (H, W) float32."""
        if id(run) not in self._flip_maps:
            self._flip_maps[id(run)] = metrics.flip_map(run.image, self.reference.image)
        return self._flip_maps[id(run)]

    def relmse(self, lit: np.ndarray) -> float:
        """`relmse` of the errors, of an image without emission that is seen directly."""
        return metrics.mean_of(self._unbiased(lit, self.reference.lit_halves), self.mask)

    def by(self, metric: Metric, run: SamplerRun) -> float:
        """The error of a run by a metric of one's own."""
        return metrics.mean_of(self.map_by(metric, run), self.mask)

    def map_by(self, metric: Metric, run: SamplerRun) -> np.ndarray:
        """The error map by a metric, (H, W); of one that gives no map, that value everywhere."""
        if metric is metrics.flip_map:
            return self.flip_map(run)
        error = metric(run.lit_image, self.reference.lit_image)
        height, width = run.image.shape[:2]
        return as_map(getattr(metric, "__name__", repr(metric)), error, (height, width))

    def bias(self, runs: Sequence[np.ndarray]) -> float:
        """Relative squared bias of the mean of so many images as there could be, from two or more
        that differ in their seeds: the mean of (x_i - a)(x_j - b) over all pairs of different images
        and the halves of the reference, which has no noise of either in it.
        """
        count = len(runs)
        mean = np.asarray(np.mean(runs, axis=0, dtype=np.float64))
        of_mean = metrics.squared_error(mean, self.reference.lit_halves)
        squared = of_mean - np.var(runs, axis=0, ddof=1, dtype=np.float64) / count
        return self._relative(squared)

    def variance(self, runs: Sequence[np.ndarray]) -> float:
        """Relative variance of one image, from two or more that differ in their seeds."""
        return self._relative(np.var(runs, axis=0, ddof=1, dtype=np.float64))

    def _relative(self, squared: np.ndarray) -> float:
        return metrics.mean_of(
            metrics.over(squared, metrics.scale_of(self.reference.lit_image)), self.mask
        )

    def _unbiased(self, image: np.ndarray, halves: np.ndarray) -> np.ndarray:
        scale = metrics.scale_of(np.asarray(np.mean(halves, axis=0, dtype=np.float64)))
        return metrics.over(metrics.squared_error(image, halves), scale)

    def _blurred(self, lit: np.ndarray, size: int) -> float:
        halves = np.stack([metrics.box_blur(half, size) for half in self.reference.lit_halves])
        return metrics.mean_of(self._unbiased(metrics.box_blur(lit, size), halves), self.mask)
