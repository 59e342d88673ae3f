"""What a comparison of samplers found."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .figures import ComparisonFigures, figures_of_reference, figures_of_runs
from .runs import Reference, SamplerRun


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

    @cached_property
    def figures(self) -> ComparisonFigures:
        """The figures that it comes to, which the report shows: worked out when first asked for."""
        return ComparisonFigures(
            scene=self.scene,
            width=self.width,
            height=self.height,
            max_depth=self.max_depth,
            threads=self.threads,
            seconds=self.seconds,
            command=self.command,
            machine=dict(self.machine),
            reference=figures_of_reference(self.reference),
            samplers=figures_of_runs(self.samplers, self.reference.image),
        )

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
