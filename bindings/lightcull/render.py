"""Rendering: one image by one sampler."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from . import _core
from ._core import Error
from .images import save_image
from .scene import Scene


@dataclass(frozen=True)
class Progress:
    """How far a render is; callbacks get one between passes."""

    stage: str
    """What is being rendered: the sampler, or "reference"."""
    fraction: float
    """Of the stage, [0, 1]."""
    spp: int
    """Samples per pixel so far."""
    seconds_left: float
    """Estimate for the whole call, in seconds."""


ProgressCallback: TypeAlias = Callable[[Progress], None]


@dataclass(frozen=True)
class Stats:
    """What a render took."""

    spp: int
    """Samples per pixel."""
    seconds: float
    """Wall time, set-up included."""
    setup_seconds: float
    """Wall time before the first sample: the sampler's builds and pilots."""
    selection_seconds: float
    """Time spent choosing lights, summed over threads."""
    selections: int
    """How often a light was chosen."""
    rays: int
    """Camera, shadow and scattered rays."""
    sampler_seconds: float
    """Wall time of the passes that went to refits and to choosing lights."""


@dataclass(frozen=True)
class RenderResult:
    """An image and what made it."""

    image: np.ndarray
    """float32 (H, W, 3), linear RGB, row 0 at the top."""
    stats: Stats
    scene: str
    sampler: str
    max_depth: int
    seed: int
    interrupted: bool
    """Ctrl-C came before it was done; the image is what there was by then."""

    def metadata(self) -> dict[str, str]:
        """What made the image, in words, for an image file."""
        return {
            "scene": self.scene,
            "sampler": self.sampler,
            "seed": str(self.seed),
            "samples": str(self.stats.spp),
            "seconds": f"{self.stats.seconds:.3f}",
            "max_depth": str(self.max_depth),
            "software": f"lightcull {_core.VERSION}",
        }

    def save(
        self, path: str | os.PathLike[str], view: str | None = None, exposure: float = 0.0
    ) -> None:
        """Writes an .exr (float32, linear) or, through a view, a .png.

        view: one of `view_names()`; None: the first. exposure: stops. Of a .png only.
        """
        save_image(path, self.image, self.metadata(), view, exposure)


@dataclass(frozen=True)
class RenderSettings:
    """What `render` and `compare` have in common, as they document it."""

    size: tuple[int, int]
    max_depth: int
    seed: int
    threads: int

    def __post_init__(self) -> None:
        least = {"width": 1, "height": 1, "max_depth": 1, "seed": 0, "threads": 0}
        given = (*self.size, self.max_depth, self.seed, self.threads)
        for (name, minimum), value in zip(least.items(), given, strict=True):
            if not isinstance(value, int) or value < minimum:
                raise Error(f"{name}: wanted a whole number from {minimum} up, got {value!r}")


class RenderJob:
    """A render that goes pass by pass, and its clock: set-up and passes, nothing else."""

    def __init__(self, scene: Scene, sampler: str, settings: RenderSettings) -> None:
        self.sampler = sampler
        self._renderer = _core.Renderer(
            scene.closed(), sampler, *settings.size, settings.max_depth, settings.seed,
            settings.threads,
        )  # fmt: skip

    def render_pass(self) -> None:
        """Adds one sample to every pixel. Ctrl-C drops the pass."""
        self._renderer.render_pass()

    def image(self) -> np.ndarray:
        """The mean of the passes so far: float32 (H, W, 3)."""
        return self._renderer.image()

    def mean_counts(self) -> _core.MeanCounts:
        """Mean cost of one selection at camera points. After the first pass."""
        return self._renderer.mean_counts()

    def stats(self) -> Stats:
        core = self._renderer.stats()
        setup = self._renderer.setup_seconds()
        return Stats(
            spp=core.passes,
            seconds=setup + core.seconds,
            setup_seconds=setup,
            selection_seconds=core.selection_seconds,
            selections=core.selections,
            rays=core.rays,
            sampler_seconds=core.sampler_seconds,
        )


@dataclass(frozen=True)
class Budget:
    """When a render is done: after `spp` samples per pixel, or else after `seconds`."""

    spp: int | None
    seconds: float | None

    def __post_init__(self) -> None:
        if (self.spp is None) == (self.seconds is None):
            raise Error("give either seconds=... or spp=...")
        if self.spp is not None and self.spp < 1:
            raise Error(f"spp: wanted at least 1, got {self.spp}")
        if self.seconds is not None and not self.seconds > 0:
            raise Error(f"seconds: wanted more than 0, got {self.seconds}")

    @property
    def total(self) -> float:
        """In samples per pixel or in seconds, as `used` is."""
        return float(self.spp or self.seconds or 0.0)

    def times(self, factor: float) -> Budget:
        """So many times as much."""
        if self.spp is not None:
            return Budget(max(round(factor * self.spp), 1), None)
        return Budget(None, factor * self.total)

    def used(self, stats: Stats) -> float:
        """How much of the total a render has had."""
        return float(stats.spp) if self.spp is not None else stats.seconds

    def is_used(self, stats: Stats) -> bool:
        """Whether a render is done. It has one sample at least."""
        return stats.spp > 0 and self.used(stats) >= self.total

    def fraction(self, stats: Stats) -> float:
        """How much of it is used, [0, 1]."""
        return min(self.used(stats) / self.total, 1.0)

    def seconds_left(self, stats: Stats, until: float | None = None) -> float:
        """Estimated wall time until the total, or `until`, is used."""
        left = max((until or self.total) - self.used(stats), 0.0)
        if self.spp is None:
            return left
        return left * stats.seconds / max(stats.spp, 1)

    def seconds_needed(self, stats: Stats) -> float:
        """Estimated wall time of it all, for another render like this."""
        if self.seconds is not None:
            return self.seconds
        return self.total * stats.seconds / max(stats.spp, 1)


def render(
    scene: Scene,
    sampler: str = "culled",
    *,
    seconds: float | None = None,
    spp: int | None = None,
    size: tuple[int, int] = (320, 240),
    max_depth: int = 2,
    seed: int = 0,
    threads: int = 0,
    progress: ProgressCallback | None = None,
) -> RenderResult:
    """Renders a scene, for `seconds` of wall time (at least one sample) or `spp` samples per pixel.

    sampler: a description as in `LightSampler`. size: width and height, pixels. max_depth: longest
    path, in edges: 1 sees emitters only, 2 direct light. threads: 0 for all; the image does not
    depend on it. progress: called between passes; what it raises ends the render.

    Ctrl-C after the first pass ends the render too, and what there is is returned.
    """
    budget = Budget(spp, seconds)
    job = RenderJob(scene, sampler, RenderSettings(size, max_depth, seed, threads))
    interrupted = False
    try:
        while not budget.is_used(job.stats()):
            job.render_pass()
            if progress is not None:
                stats = job.stats()
                left = budget.seconds_left(stats)
                progress(Progress(sampler, budget.fraction(stats), stats.spp, left))
    except KeyboardInterrupt:
        if job.stats().spp == 0:
            raise
        interrupted = True
    return RenderResult(
        job.image(), job.stats(), scene.name, sampler, max_depth, seed, interrupted
    )
