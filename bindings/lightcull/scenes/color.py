"""Colours for the example scenes: linear RGB with the sRGB primaries."""

from __future__ import annotations

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])

_XYZ_TO_RGB = np.array(
    [
        [3.2404542, -1.5371385, -0.4985314],
        [-0.9692660, 1.8760108, 0.0415560],
        [0.0556434, -0.2040259, 1.0572252],
    ]
)


def from_srgb(code: str) -> np.ndarray:
    """(3,) from "#rrggbb"."""
    encoded = np.array([int(code[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def with_luminance(colors: np.ndarray, luminance: float | np.ndarray = 1.0) -> np.ndarray:
    """Colours (..., 3) scaled to a luminance, one or (...)."""
    return colors * (np.asarray(luminance) / (colors @ LUMINANCE))[..., None]


def blackbody(kelvin: np.ndarray) -> np.ndarray:
    """Colours (..., 3) of luminance 1 of glowing bodies, what lies outside sRGB cut off.

    Sources: Planck's law; Wyman, Sloan & Shirley 2013, "Simple Analytic Approximations to the CIE
    XYZ Color Matching Functions", the multi-lobe fit.
    """
    nanometres = np.arange(380.0, 781.0, 5.0)
    kelvin = np.asarray(kelvin, dtype=np.float64)[..., None]
    # Divided by its value at 560 nm, so that no temperature runs out of range.
    exponent = 1.4387769e7 * (1 / nanometres - 1 / 560.0) / kelvin
    radiance = (560.0 / nanometres) ** 5 * np.exp(-exponent)
    rgb = radiance @ _matching_functions(nanometres).T @ _XYZ_TO_RGB.T
    return with_luminance(np.maximum(rgb, 0.0))


def _matching_functions(nanometres: np.ndarray) -> np.ndarray:
    def lobe(height: float, peak: float, below: float, above: float) -> np.ndarray:
        slope = np.where(nanometres < peak, below, above)
        return height * np.exp(-0.5 * ((nanometres - peak) * slope) ** 2)

    x = lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(1.056, 599.8, 0.0264, 0.0323)
    x -= lobe(0.065, 501.1, 0.0490, 0.0382)
    y = lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322)
    z = lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725)
    return np.stack((x, y, z))
