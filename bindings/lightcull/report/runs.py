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
    light_position: tuple[float, float, float]
    """Metres."""
    cell_count: int
    """Cells that there are, seen or not."""
    memory_size: int
    """Bytes that cells take."""


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
    learned: Learned | None = None
    """None where the sampler has learned nothing, or the host does not tell."""
