"""Figures of error of an image x against a reference r: (H, W, 3) float arrays, linear RGB.

A reference has noise of its own, which adds to every error that is taken against it. Where its two
independent halves a and b are at hand, r being their mean, (x - a)(x - b) is in the mean the square
of x's error against the truth: (x - r)^2 with the noise of r taken off, ((a - b) / 2)^2. It may come
out below 0. What it is divided by, r^2 + ..., keeps that noise, which matters to second order only.
"""

from __future__ import annotations

import math

import numpy as np

BLUR_SIZE = 7
"""Side of the box filter of `relmse_blurred`, pixels."""
WIDE_BLUR_SIZE = 31
"""And of one that leaves only what is shared far and wide: bands, blobs, flicker."""
TRIMMED = 0.001
"""The share of pixels that a trimmed mean leaves out: the worst ones."""


def _pair(image: np.ndarray, reference: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    x = np.asarray(image, dtype=np.float64)
    r = np.asarray(reference, dtype=np.float64)
    if x.ndim != 3 or x.shape[2] != 3 or x.shape != r.shape:
        raise ValueError(f"expected two (H, W, 3) images of one size, got {x.shape} and {r.shape}")
    return x, r


def rmse(image: np.ndarray, reference: np.ndarray) -> float:
    """Square root of the mean of (x - r)^2 over pixels and channels."""
    x, r = _pair(image, reference)
    return float(np.sqrt(np.mean((x - r) ** 2)))


def relative_squared_error(image: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """(x - r)^2 / (r^2 + 0.01 mean(r)^2), with the mean over all of r: (H, W, 3) float64.

    Where the reference is black everywhere, it is 0 where x is black too, infinite elsewhere.
    """
    x, r = _pair(image, reference)
    return over((x - r) ** 2, scale_of(r))


def relative_error(image: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """|x - r| / (|r| + 0.01 mean(r)), with the mean over all of r: (H, W, 3) float64. MAPE is its mean."""
    x, r = _pair(image, reference)
    return over(np.abs(x - r), np.abs(r) + 0.01 * np.mean(r))


def symmetric_error(image: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """2 |x - r| / (|x| + |r| + 0.01 mean(r)), (H, W, 3) float64, [0, 2). SMAPE is its mean."""
    x, r = _pair(image, reference)
    return over(2 * np.abs(x - r), np.abs(x) + np.abs(r) + 0.01 * np.mean(r))


def scale_of(reference: np.ndarray) -> np.ndarray:
    """What squared errors are divided by: r^2 + 0.01 mean(r)^2, with the mean over all of r."""
    r = np.asarray(reference, dtype=np.float64)
    return r**2 + 0.01 * np.mean(r) ** 2


def over(squared: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """squared / scale; where the scale is 0, 0 over it is 0 and all else infinite."""
    blank = np.where(squared != 0, np.copysign(np.inf, squared), 0.0)
    return np.divide(squared, scale, out=blank, where=scale > 0)


def squared_error(image: np.ndarray, halves: np.ndarray) -> np.ndarray:
    """(x - a)(x - b): the squared error with the noise of the reference taken off, (H, W, 3)."""
    x, a, b = (np.asarray(each, np.float64) for each in (image, *halves))
    return (x - a) * (x - b)


def mean_of(values: np.ndarray, mask: np.ndarray | None = None) -> float:
    """The mean of (H, W) or (H, W, C) values over the pixels of a mask: bool (H, W), True for those
    that count; None: all.
    """
    counted: np.ndarray = values if mask is None else values[mask]
    return float(np.mean(counted, dtype=np.float64))


def trimmed_mean(
    values: np.ndarray, order: np.ndarray, mask: np.ndarray | None = None, share: float = TRIMMED
) -> float:
    """The mean of (H, W) values without the share of pixels whose `order`, (H, W), is the largest."""
    counted, by = (a.ravel() if mask is None else a[mask] for a in (values, order))
    kept = len(by) - int(np.ceil(share * len(by)))
    return float(np.mean(counted[np.argsort(by, kind="stable")[:kept]])) if kept else math.nan


def relmse(image: np.ndarray, reference: np.ndarray) -> float:
    """Mean of `relative_squared_error`."""
    return float(np.mean(relative_squared_error(image, reference)))


def box_blur(image: np.ndarray, size: int = BLUR_SIZE) -> np.ndarray:
    """Mean over `size` x `size` pixels (odd) about each pixel: (H, W, C) float64.

    At the border the mean is over those that lie in the image.
    """
    if size < 1 or size % 2 == 0:
        raise ValueError(f"size of a box blur must be odd and positive, got {size}")
    blurred = np.asarray(image, dtype=np.float64)
    for axis in (0, 1):
        blurred = _mean_along(blurred, axis, size // 2)
    return blurred


def _mean_along(values: np.ndarray, axis: int, reach: int) -> np.ndarray:
    length = values.shape[axis]
    sums = np.insert(np.cumsum(values, axis=axis), 0, 0.0, axis=axis)
    first = np.maximum(np.arange(length) - reach, 0)
    last = np.minimum(np.arange(length) + reach + 1, length)
    shape = [1] * values.ndim
    shape[axis] = length
    count = (last - first).reshape(shape)
    return (np.take(sums, last, axis=axis) - np.take(sums, first, axis=axis)) / count


def relmse_blurred(image: np.ndarray, reference: np.ndarray, size: int = BLUR_SIZE) -> float:
    """relMSE of the two images after a box blur of both by `size` x `size` pixels.

    Error that is independent from pixel to pixel falls to about 1/size^2; error that neighbours
    share, such as banding, stays.
    """
    x, r = _pair(image, reference)
    return relmse(box_blur(x, size), box_blur(r, size))


def relmse_of_mean(half_a: np.ndarray, half_b: np.ndarray) -> float:
    """Estimate of the relMSE of (a + b) / 2, from two independent images of equal cost.

    Either differs from the mean by half of their difference, whose square is in the mean the
    variance of the mean.
    """
    a, b = _pair(half_a, half_b)
    return relmse(a, 0.5 * (a + b))


def flip_map(image: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """HDR-FLIP error of each pixel, [0, 1]: (H, W) float32.

    HDR, not LDR: it reads the linear images and takes its exposures from the reference, so that it
    depends neither on the view nor on the exposure that a report happens to show. Viewing distance
    is the package's default, 67 pixels per degree.
    Source: Andersson et al., "Visualizing Errors in Rendered High Dynamic Range Images", 2021.
    """
    import flip_evaluator

    x, r = _pair(image, reference)
    if not r.any():
        raise ValueError("FLIP has no exposures to look at: the reference is black")
    errors, _, _ = flip_evaluator.evaluate(
        np.ascontiguousarray(r, dtype=np.float32),
        np.ascontiguousarray(x, dtype=np.float32),
        "HDR",
        applyMagma=False,
        computeMeanError=False,
    )
    return errors[..., 0]


def flip(image: np.ndarray, reference: np.ndarray) -> float:
    """Mean of `flip_map`, [0, 1]."""
    return float(np.mean(flip_map(image, reference), dtype=np.float64))


def efficiency(error: float, seconds: float) -> float:
    """1 / (relMSE x seconds), in 1/s; infinite where there is no error."""
    return np.inf if error == 0 else 1.0 / (error * seconds)
