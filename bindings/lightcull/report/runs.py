"""What samplers rendered, before any figure is worked out from it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ..field_docs import with_field_docs
from . import metrics


@with_field_docs
@dataclass
class Reference:
    """The image that the samplers are measured against."""

    halves: np.ndarray
    """(2, H, W, 3) float32, linear RGB, row 0 at the top: two independent halves of it."""
    sampler: str
    """Description of the sampler, or of the samplers, that rendered it."""
    spp: int
    """Samples per pixel, of both halves together."""
    lit: np.ndarray | None = None
    """(2, H, W, 3) float32: the light in `halves` that falls on surfaces. None: `halves`, of a
    renderer that does not keep emission apart.
    """
    emission: np.ndarray | None = None
    """(2, H, W, 3) float32: the rest of `halves`, what the camera sees of emitters directly."""

    @property
    def image(self) -> np.ndarray:
        """(H, W, 3) float32: the mean of the halves, all light."""
        return _mean(self.halves)

    @property
    def lit_halves(self) -> np.ndarray:
        """(2, H, W, 3) float32: `lit`, or `halves` where that is None."""
        return self.halves if self.lit is None else self.lit

    @property
    def lit_image(self) -> np.ndarray:
        """(H, W, 3) float32: the mean of `lit_halves`, against which samplers are measured."""
        return _mean(self.lit_halves)

    @property
    def relmse_of_itself(self) -> float:
        """Estimate of the relMSE of `lit_image`; see `metrics.relmse_of_mean`."""
        return metrics.relmse_of_mean(*self.lit_halves)


def _mean(halves: np.ndarray) -> np.ndarray:
    return np.asarray(np.mean(halves, axis=0, dtype=np.float64), np.float32)


@with_field_docs
@dataclass
class Moment:
    """The error of a render on its way."""

    spp: int
    """Samples per pixel by then."""
    seconds: float
    """Render time by then, set-up included."""
    relmse: float
    """As `SamplerFigures.relmse`."""


@with_field_docs
@dataclass
class Slice:
    """The samples of a part of a render."""

    image: np.ndarray
    """(H, W, 3) float32: their mean, all light."""
    spp: int
    """Their number per pixel."""
    seconds: float
    """Render time at their end, set-up included."""


@with_field_docs
@dataclass
class Learned:
    """What a sampler has learned of what is hidden from where, as the image's pixels see it."""

    cells: np.ndarray
    """int32 (H, W): the cell that the pixel's point lies in; -1 where there is none."""
    visibility: np.ndarray
    """float32 (H, W): the share of shadow rays to the cluster of `light` that is taken to arrive,
    [0, 1]; not a number where nothing is known.
    """
    normals: np.ndarray
    """float32 (H, W, 3): of what the pixels show, unit length, towards the camera; 0 for nothing."""
    light: int
    """Index of a light whose visibility differs much from pixel to pixel."""
    light_position: tuple[float, float, float] | None
    """Metres; None for a directional light."""
    cell_count: int
    """Cells that there are, seen or not."""
    memory_size: int
    """Bytes that cells take."""


@with_field_docs
@dataclass
class SamplerRun:
    """What one sampler rendered with one seed. All times are in seconds of wall time, unless said."""

    image: np.ndarray
    """(H, W, 3) float32, linear RGB, row 0 at the top."""
    spp: int
    """Samples per pixel."""
    seconds: float
    """Time that the sampler had, `setup_seconds` included."""
    setup_seconds: float
    """Time before the first sample: builds, pilots."""
    selection_seconds: float
    """Time spent choosing lights, summed over threads; not a number where a host does not tell."""
    sampler_seconds: float
    """Time that the passes spent on refits and on choosing lights."""
    selections: int
    """How often a light was chosen."""
    rays: int
    """Camera, shadow and scattered rays; 0 where a host does not tell."""
    accepted_per_point: float
    """Lights weighed with a weight above 0, mean over shading points."""
    nodes_per_point: float
    """Tree nodes visited, mean over shading points."""
    lights_tested_per_point: float
    """Lights whose range or importance was computed, mean over shading points."""
    lit: np.ndarray | None = None
    """(H, W, 3) float32: the light in `image` that falls on surfaces. None: `image`, of a renderer
    that does not keep emission apart.
    """
    emission: np.ndarray | None = None
    """(H, W, 3) float32: the rest of `image`, what the camera sees of emitters directly, which no
    choice of lights changes.
    """
    own_seconds: float = math.nan
    """Time inside the calls of a sampler of one's own; not a number where there is none."""
    curve: list[Moment] = field(default_factory=list)
    """The error as the image converged."""
    learned: Learned | None = None
    """None where the sampler has learned nothing, or the host does not tell."""
    slices: list[Slice] = field(default_factory=list)
    """Its samples in parts, one after the other, if that was asked for."""

    @property
    def lit_image(self) -> np.ndarray:
        """(H, W, 3) float32: `lit`, or `image` where that is None."""
        return self.image if self.lit is None else self.lit
