"""Rendering: one image by one sampler."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from . import _core, checks, machine, memory
from ._core import Error
from .checkpoint import Checkpoint, Keeper, RenderKey
from .images import save_image
from .interruption import Interruption
from .scene import Scene
from .virtual_lights import PATH, VirtualLightJob, check_method

if TYPE_CHECKING:
    from .subject import Job, Subject


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

    @classmethod
    def of(cls, core: _core.RenderStats, setup_seconds: float) -> Stats:
        """What the core counted, and what came before."""
        return cls(
            spp=core.passes,
            seconds=setup_seconds + core.seconds,
            setup_seconds=setup_seconds,
            selection_seconds=core.selection_seconds,
            selections=core.selections,
            rays=core.rays,
            sampler_seconds=core.sampler_seconds,
        )


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
    method: str = PATH
    """Description of the method; see `render`."""

    def metadata(self) -> dict[str, str]:
        """What made the image, in words, for an image file."""
        return {
            "scene": self.scene,
            "method": self.method,
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
        checked = {
            "size": checks.size(self.size),
            "max_depth": checks.whole_number("max_depth", self.max_depth, 1),
            "seed": checks.whole_number("seed", self.seed, most=checks.MOST_64_BITS),
            "threads": checks.whole_number("threads", self.threads),
        }
        for name, value in checked.items():  # numbers of any kind become Python's
            object.__setattr__(self, name, value)
        memory.check_image(self.size)


class RenderJob:
    """A render that goes pass by pass, and its clock: set-up and passes, nothing else."""

    def __init__(self, scene: Scene, sampler: str, settings: RenderSettings) -> None:
        self.sampler = checks.text("sampler", sampler)
        self._setup_seconds_before = 0.0
        self._scene = scene.closed()
        self._renderer = _core.Renderer(
            self._scene, sampler, *settings.size, settings.max_depth, settings.seed,
            settings.threads,
        )  # fmt: skip

    def render_pass(self) -> None:
        """Adds one sample to every pixel. Ctrl-C drops the pass."""
        self._renderer.render_pass()

    def checkpoint(self) -> Checkpoint:
        """All that there is so far."""
        renderer = self._renderer
        return Checkpoint(renderer.stats(), self._setup_seconds(), renderer.sums())

    def resume(self, checkpoint: Checkpoint) -> None:
        """Goes on from a checkpoint of the same render. Before the first pass."""
        self._renderer.restore(checkpoint.stats, checkpoint.sums)
        self._setup_seconds_before = checkpoint.setup_seconds

    def image(self) -> np.ndarray:
        """The mean of the passes so far: float32 (H, W, 3)."""
        return self._renderer.image()

    def mean_counts(self) -> _core.MeanCounts:
        """Mean cost of one selection at camera points. After the first pass."""
        return self._renderer.mean_counts()

    def memory_size(self) -> tuple[_core.SceneMemory, _core.RendererMemory, int]:
        """Bytes, of the scene, of paths and of virtual lights."""
        return self._scene.memory_size(), self._renderer.memory_size(), 0

    def stats(self) -> Stats:
        return Stats.of(self._renderer.stats(), self._setup_seconds())

    def _setup_seconds(self) -> float:
        return self._setup_seconds_before + self._renderer.setup_seconds()


@dataclass(frozen=True)
class Budget:
    """When a render is done: after `spp` samples per pixel, or else after `seconds`."""

    spp: int | None
    seconds: float | None

    def __post_init__(self) -> None:
        if (self.spp is None) == (self.seconds is None):
            raise Error("give either seconds=... or spp=...")
        if self.spp is not None and checks.whole_number("spp", self.spp, 0, checks.MOST_64_BITS) < 1:
            raise Error(f"spp: wanted at least 1, got {self.spp}")
        if self.seconds is not None and not checks.number("seconds", self.seconds) > 0:
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
    scene: Scene | Subject,
    sampler: str = "culled",
    *,
    method: str = PATH,
    seconds: float | None = None,
    spp: int | None = None,
    size: tuple[int, int] = (320, 240),
    max_depth: int = 2,
    seed: int = 0,
    threads: int = 0,
    progress: ProgressCallback | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    every: float | None = None,
    resume: str | os.PathLike[str] | None = None,
) -> RenderResult:
    """Renders a scene, for `seconds` of wall time (at least one sample) or `spp` samples per pixel.

    scene: ours, or a `lightcull.mitsuba.MitsubaScene`. sampler: a description as in `LightSampler`.
    size: width and height, pixels. max_depth: longest path, in edges: 1 sees emitters only, 2
    direct light. method: how light that bounces is found: "path" by paths; "vpl_all", "vpl_culled",
    "vpl_clamped" and "vpl_grid" by virtual lights where light paths meet surfaces, which wants a
    max_depth of 3 to 5 (`lightcull render --help` has their options); the sampler is then for
    direct light. threads: 0 for all; the image does not depend on it. progress: called between
    passes; what it raises ends the render.

    checkpoint: a file to which the render is saved every `every` seconds (60 unless told) and at
    its end, from which it can go on; whatever happens, the old one or the new one is there whole. It
    must not be there before. resume: such a file to go on from, and to save to where checkpoint
    names no other. The image has the same bits as if it had never stopped; seconds and spp count
    from the first start. A file of another scene, sampler, size, max_depth, seed or build of
    lightcull is an Error.

    Ctrl-C ends the render after the pass under way, and what there is is saved and returned. One
    more, before that pass is over, is a KeyboardInterrupt.
    """
    budget = Budget(spp, seconds)
    settings = RenderSettings(size, max_depth, seed, threads)
    if every is not None and checkpoint is None and resume is None:
        raise Error("every: only with checkpoint or resume")
    if check_method(method) != PATH:
        return _render_virtual_lights(
            scene, method, sampler, budget, settings, progress, (checkpoint, resume)
        )
    if not isinstance(scene, Scene):
        if not hasattr(scene, "new_job"):
            raise TypeError(f"scene: wanted a lightcull.Scene, got {scene!r}")
        if checkpoint is not None or resume is not None:
            raise Error("checkpoint and resume: not for a scene of another renderer")
        job = scene.new_job(sampler, settings, spp)
        interrupted = _run(job, budget, progress, None)
    else:
        version = machine.build_id()
        key = RenderKey(
            scene.name, scene.digest(), checks.text("sampler", sampler), settings.size,
            settings.max_depth, settings.seed, version,
        )  # fmt: skip
        keeper = Keeper(key, checkpoint=checkpoint, every=every, resume=resume)
        if keeper.before is not None and spp is not None and keeper.before.stats.passes > spp:
            passes = keeper.before.stats.passes
            raise Error(f"{resume}: has {passes} samples per pixel already, and {spp} were wanted")
        job = RenderJob(scene, sampler, settings)
        if keeper.before is not None:
            job.resume(keeper.before)
        interrupted = _run(job, budget, progress, lambda: keeper.after_pass(job.checkpoint))
        keeper.save(job.checkpoint)
    image = job.image()
    _warn_of_nonsense(scene.name, image)
    return RenderResult(image, job.stats(), scene.name, sampler, max_depth, seed, interrupted)


def _render_virtual_lights(
    scene: Scene | Subject,
    method: str,
    sampler: str,
    budget: Budget,
    settings: RenderSettings,
    progress: ProgressCallback | None,
    files: tuple[str | os.PathLike[str] | None, ...],
) -> RenderResult:
    if not isinstance(scene, Scene):
        raise Error(f"{method}: not for a scene of another renderer")
    if any(file is not None for file in files):
        raise Error(f"checkpoint and resume: not for {method}")
    job = VirtualLightJob(scene, method, sampler, settings)
    interrupted = _run(job, budget, progress, None)
    image = job.image()
    _warn_of_nonsense(scene.name, image)
    return RenderResult(
        image, job.stats(), scene.name, sampler, settings.max_depth, settings.seed, interrupted,
        method,
    )  # fmt: skip


def _warn_of_nonsense(scene: str, image: np.ndarray) -> None:
    if not image.any():
        warnings.warn(f"{scene}: the image is black: no light is seen", stacklevel=3)
    elif not np.isfinite(image).all():
        count = np.count_nonzero(~np.isfinite(image).all(axis=2))
        warnings.warn(f"{scene}: {count} pixels are not finite", stacklevel=3)


def _run(
    job: Job | VirtualLightJob,
    budget: Budget,
    progress: ProgressCallback | None,
    keep: Callable[[], None] | None,
) -> bool:
    """Renders pass by pass until the budget is used up. True if Ctrl-C came before that."""
    with Interruption() as interruption:
        try:
            while not interruption.asked and not budget.is_used(job.stats()):
                job.render_pass()
                if keep is not None:
                    keep()
                if progress is not None:
                    stats = job.stats()
                    left = budget.seconds_left(stats)
                    progress(Progress(job.sampler, budget.fraction(stats), stats.spp, left))
        except KeyboardInterrupt:
            if interruption.asked or job.stats().spp == 0:
                raise
            return True
        return interruption.asked
