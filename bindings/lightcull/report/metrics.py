"""Figures of error of an image x against a reference r: (H, W, 3) float arrays, linear RGB."""

from __future__ import annotations

import flip_evaluator
import numpy as np

BLUR_SIZE = 7
"""Side of the box filter of `relmse_blurred`, pixels."""
WIDE_BLUR_SIZE = 31
"""And of one that leaves only what is shared far and wide: bands, blobs, flicker."""


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
    squared = (x - r) ** 2
    scale = r**2 + 0.01 * np.mean(r) ** 2
    blank = np.where(squared > 0, np.inf, 0.0)
    return np.divide(squared, scale, out=blank, where=scale > 0)


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
