"""Images and error maps as 8-bit pixels and PNG."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..images import apply_view
from . import metrics
from .errors import Measure
from .runs import SamplerRun

BRIGHTNESS = 0.11
"""Log-average that pictures are brought to: below middle grey, scenes full of lights are night."""
COLOR_MAP = "magma"
SHADE_DIRECTION = (0.36, 0.8, 0.48)
"""The side from which surfaces in the picture of cells are brightest."""
UNKNOWN = (112, 112, 112)
"""Grey of pixels of which nothing was learned: no colour of the map is like it."""


@dataclass(frozen=True)
class ErrorMap:
    """A kind of error map, and the scale that all maps of that kind share."""

    key: str
    title: str
    figure: str
    """What the mean of the map is called."""
    figure_key: str
    low: float
    high: float
    logarithmic: bool


ERROR_MAPS = (
    ErrorMap("error", "Relative squared error", "relMSE", "relmse_measured", 1e-4, 1e1, True),
    ErrorMap("blurred", "After 7 × 7 blur", "blurred relMSE", "relmse_blurred", 1e-5, 1e0, True),
    ErrorMap("flip", "FLIP", "FLIP", "flip", 0.0, 1.0, False),
)


def exposure_for(reference: np.ndarray) -> float:
    """Stops that bring the log-average luminance of what is not near black to BRIGHTNESS.

    At most 3 stops either way from the scene's own exposure: a night is to stay a night.
    """
    luminance = reference @ np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)
    lit = luminance[luminance > 0.01 * luminance.mean()]
    if lit.size == 0:
        return 0.0
    stops = np.log2(BRIGHTNESS) - np.mean(np.log2(lit), dtype=np.float64)
    return float(np.clip(np.round(stops, 1), -3.0, 3.0)) + 0.0  # no -0


def display(image: np.ndarray, view: str, exposure: float) -> np.ndarray:
    """What the view shows of a linear image: (H, W, 3) uint8; exposure in stops."""
    shown = apply_view(np.ascontiguousarray(image, dtype=np.float32), view, exposure)
    return np.round(255.0 * np.clip(shown, 0.0, 1.0)).astype(np.uint8)


def error_values(
    kind: ErrorMap, runs: Sequence[SamplerRun], measure: Measure
) -> np.ndarray:
    """The error that a map of that kind shows: (H, W), mean over channels and runs. The noise of
    the reference is in it. Of FLIP it is that of the whole image, of the others without emission
    that is seen directly.
    """
    return np.asarray(np.mean([_error_of_run(kind, run, measure) for run in runs], axis=0))


def _error_of_run(kind: ErrorMap, run: SamplerRun, measure: Measure) -> np.ndarray:
    if kind.key == "flip":
        return measure.flip_map(run)
    image, against = run.lit_image, measure.reference.lit_image
    if kind.key == "blurred":
        image, against = metrics.box_blur(image), metrics.box_blur(against)
    return metrics.relative_squared_error(image, against).mean(axis=2)


def to_palette(kind: ErrorMap, values: np.ndarray) -> np.ndarray:
    """Index into the 256 colours of the map for each value: (H, W) uint8."""
    low, high = kind.low, kind.high
    clipped = np.clip(values, low, high)
    if kind.logarithmic:
        clipped, low, high = np.log(clipped), np.log(low), np.log(high)
    return np.round(255.0 * (clipped - low) / (high - low)).astype(np.uint8)


def palette() -> np.ndarray:
    """The colours of error maps, dark to bright: (256, 3) uint8."""
    import matplotlib

    colors = matplotlib.colormaps[COLOR_MAP](np.arange(256))[:, :3]
    return np.round(255.0 * colors).astype(np.uint8)


def cell_picture(cells: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """A colour for each cell, shaded by the normals: (H, W, 3) uint8, black without a cell.

    cells, normals: as in `Learned`.
    """
    import matplotlib.colors

    number = np.maximum(cells, 0).astype(np.uint64)
    # Hues of cells that were made one after the other, which are often neighbours, lie far apart.
    hue = number * 0x9E3779B1 % 2**32 / 2**32
    saturation = 0.3 + 0.4 * (number * 0x85EBCA77 % 2**32 / 2**32)
    brightness = np.clip(0.7 + 0.3 * (normals @ np.array(SHADE_DIRECTION)), 0.0, 1.0)
    colors = matplotlib.colors.hsv_to_rgb(np.stack((hue, saturation, brightness), axis=-1))
    colors[cells < 0] = 0.0
    return np.round(255.0 * colors).astype(np.uint8)


def visibility_picture(visibility: np.ndarray) -> np.ndarray:
    """The colours of error maps for 0 to 1, UNKNOWN for what is not a number: (H, W, 3) uint8."""
    known = np.isfinite(visibility)
    index = np.round(255.0 * np.where(known, visibility, 0.0)).astype(np.uint8)
    picture: np.ndarray = palette()[index]
    picture[~known] = UNKNOWN
    return picture


def encode_png(pixels: np.ndarray) -> bytes:
    """PNG of (H, W, 3) uint8, or of (H, W) uint8 that index into `palette`."""
    from PIL import Image

    picture = Image.fromarray(pixels)
    if pixels.ndim == 2:
        picture.putpalette(palette().tobytes())
    stream = io.BytesIO()
    picture.save(stream, format="PNG", optimize=True)
    return stream.getvalue()
