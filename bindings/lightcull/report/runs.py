"""What samplers rendered, before any figure is worked out from it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass
class Reference:
    """The image that the samplers are measured against."""

    image: np.ndarray
    """(H, W, 3) float32, linear RGB, row 0 at the top."""
    sampler: str
    """Description of the sampler, or of the samplers, that rendered it."""
    spp: int
    """Samples per pixel."""
    relmse_of_itself: float
    """Estimate of the relMSE of `image`; see `metrics.relmse_of_mean`."""


@dataclass
class SamplerRun:
    """One sampler's share of a comparison. All times are in seconds of wall time, unless said."""

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
    curve: list[tuple[float, float]] = field(default_factory=list)
    """(seconds, relMSE) as the image converged; seconds as above, set-up included."""
