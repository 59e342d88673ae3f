"""What a comparison of samplers found."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .figures import ComparisonFigures, figures_of_reference, figures_of_runs
from .runs import Learned, Reference, SamplerRun


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
        for name, run in self.samplers.items():
            if run.learned is not None:
                _check_size(run.learned, name, wanted)
        if not self.samplers:
            raise ValueError("a comparison needs at least one sampler")


def _check_size(learned: Learned, sampler: str, wanted: tuple[int, int, int]) -> None:
    """Raises ValueError if what was learned is not shown by pixels of an image of this shape."""
    shapes = {"cells": wanted[:2], "visibility": wanted[:2], "normals": wanted}
    for what, expected in shapes.items():
        shape = np.shape(getattr(learned, what))
        if shape != expected:
            raise ValueError(f"{what} of sampler {sampler!r}: shape {shape}, expected {expected}")
