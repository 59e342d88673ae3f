"""What a comparison of samplers found."""

from __future__ import annotations

from dataclasses import astuple, dataclass, field, fields
from functools import cached_property

import numpy as np

from .._core import Error
from ..field_docs import with_field_docs
from .errors import Measure, Metric, metrics_by_name
from .figures import ComparisonFigures, CurvePoint, figures_of_reference, figures_of_samplers
from .runs import Learned, Reference, SamplerRun


@with_field_docs
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
    """Threads that each run had."""
    seconds: float
    """Time that each run was to have."""
    machine: dict[str, str]
    """What ran it, for people to read: processor, compiler, versions, number of lights..."""
    reference: Reference
    """The image that samplers are measured against."""
    samplers: dict[str, tuple[SamplerRun, ...]]
    """The runs of each, by name, in the order in which they are to be shown: runs differ in their
    seeds, and those of one number have the same seed.
    """
    command: str = ""
    """Command line or Python call that made it; empty if not known."""
    interrupted: bool = False
    """Ctrl-C came before all had their time."""
    mask: np.ndarray | None = None
    """bool (H, W): the pixels that errors are means over; None: all."""
    metrics: dict[str, Metric] = field(default_factory=dict)
    """Metrics that were asked for, by name."""

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
            measured="image" if self.reference.lit is None else "lit",
            pixels=self.width * self.height if self.mask is None else int(self.mask.sum()),
            reference=figures_of_reference(self.reference),
            samplers=figures_of_samplers(self.samplers, self.measure, self.metrics),
        )

    @cached_property
    def measure(self) -> Measure:
        """How images are measured, and what was measured of them so far."""
        return Measure(self.reference, self.mask)

    def error_map(self, sampler: str, metric: str | Metric = "relmse") -> np.ndarray:
        """Errors by pixel of a sampler, the mean over its runs: float32 (H, W), with the noise of the
        reference in them. The mask is not applied.

        metric: one of `lightcull.report.METRICS` by name, or a function like them.
        """
        if sampler not in self.samplers:
            raise Error(f"sampler {sampler!r}: there are {', '.join(self.samplers)}")
        size = (self.width, self.height)
        ((_, chosen),) = metrics_by_name([metric], size).items()
        maps = [self.measure.map_by(chosen, run) for run in self.samplers[sampler]]
        return np.asarray(np.mean(maps, axis=0), np.float32)

    def curve(self, sampler: str) -> np.ndarray:
        """The error of a sampler as the image converged: float64 (N,), with the fields of
        `lightcull.report.CurvePoint`, spp, seconds, relmse, low and high; not a number where there
        is none.
        """
        if sampler not in self.samplers:
            raise Error(f"sampler {sampler!r}: there are {', '.join(self.samplers)}")
        points = self.figures.samplers[sampler].error_curve
        dtype = [(field.name, np.float64) for field in fields(CurvePoint)]
        rows = [tuple(np.nan if x is None else x for x in astuple(point)) for point in points]
        return np.array(rows, dtype)

    def __post_init__(self) -> None:
        if not self.samplers:
            raise ValueError("a comparison needs at least one sampler")
        wanted = (self.height, self.width, 3)
        _check_image(self.reference.halves, "the reference", (2, *wanted))
        for name, runs in self.samplers.items():
            if not runs:
                raise ValueError(f"sampler {name!r}: has no run")
            for run in runs:
                _check_image(run.image, f"sampler {name!r}", wanted)
                if (run.lit is None) != (self.reference.lit is None):
                    raise ValueError(f"sampler {name!r}: lit, of it or of the reference, is missing")
                if run.learned is not None:
                    _check_size(run.learned, name, wanted)
        if self.mask is not None and np.shape(self.mask) != wanted[:2]:
            raise ValueError(f"mask: shape {np.shape(self.mask)}, expected {wanted[:2]}")


def _check_image(image: np.ndarray, owner: str, wanted: tuple[int, ...]) -> None:
    if np.shape(image) != wanted:
        raise ValueError(f"image of {owner}: shape {np.shape(image)}, expected {wanted}")
    if not np.isfinite(image).all():
        raise ValueError(f"image of {owner}: has pixels that are not finite")


def _check_size(learned: Learned, sampler: str, wanted: tuple[int, int, int]) -> None:
    """Raises ValueError if what was learned is not shown by pixels of an image of this shape."""
    shapes = {"cells": wanted[:2], "visibility": wanted[:2], "normals": wanted}
    for what, expected in shapes.items():
        shape = np.shape(getattr(learned, what))
        if shape != expected:
            raise ValueError(f"{what} of sampler {sampler!r}: shape {shape}, expected {expected}")
