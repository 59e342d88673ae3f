"""What a comparison of samplers found, before any figure is worked out from it."""

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


@dataclass
class Comparison:
    """Samplers that rendered one scene, each for the same time."""

    scene: str
    """Name or path of the scene."""
    width: int
    """Pixels."""
    height: int
    """Pixels."""
    max_depth: int
    """Longest path, in edges: 2 is direct light only."""
    threads: int
    """Threads that each sampler had."""
    seconds: float
    """Time that each sampler was to have."""
    machine: dict[str, str]
    """What ran it, for people to read: processor, compiler, versions, number of lights..."""
    reference: Reference
    samplers: dict[str, SamplerRun]
    """By description, in the order in which they are to be shown."""
    command: str = ""
    """Command line or Python call that made it; empty if not known."""
    interrupted: bool = False
    """Ctrl-C came before all had their time."""

    def __post_init__(self) -> None:
        wanted = (self.height, self.width, 3)
        images = {f"sampler {name!r}": run.image for name, run in self.samplers.items()}
        images["the reference"] = self.reference.image
        for owner, image in images.items():
            if np.shape(image) != wanted:
                raise ValueError(f"image of {owner}: shape {np.shape(image)}, expected {wanted}")
            if not np.isfinite(image).all():
                raise ValueError(f"image of {owner}: has pixels that are not finite")
        if not self.samplers:
            raise ValueError("a comparison needs at least one sampler")
