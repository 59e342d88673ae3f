"""Rendering by paths, with a light sampler: the renderer that this project has of its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .. import _core, checks
from ..scene import Scene
from .checkpoint import Checkpoint
from .chunk import Chunk, ChunkSums
from .own_sampler import GuardedSampler, SamplerChoice, SamplerLibrary
from .settings import RenderSettings
from .statistics import Stats


class PathJob:
    """A render that goes pass by pass, and its clock: set-up and passes, nothing else."""

    def __init__(
        self, scene: Scene, sampler: SamplerChoice, settings: RenderSettings, name: str = ""
    ) -> None:
        """name: of a sampler of one's own, for errors."""
        self._given = scene
        self._scene = scene.closed()
        self._own: GuardedSampler | None = None
        chosen: str | _core.SamplerLibrary | GuardedSampler
        if isinstance(sampler, SamplerLibrary):
            chosen = _core.SamplerLibrary(sampler.path, sampler.description)
        elif callable(sampler):
            chosen = self._own = GuardedSampler(name, sampler, scene)
        else:
            chosen = checks.text("sampler", sampler)
        self.sampler = chosen if isinstance(chosen, str) else name
        self._renderer = _core.Renderer(
            self._scene, chosen, *settings.size, settings.max_depth, settings.seed,
            settings.threads, settings.rr_depth, settings.direct_light, settings.emission_apart,
            settings.even_numbers,
            settings.hide_emitters,
        )  # fmt: skip
        self._setup_seconds = self._renderer.setup_seconds()
        if self._own is not None:
            self._setup_seconds += self._own.setup_seconds
        self._emission_apart = settings.emission_apart

    def render_pass(self) -> None:
        """Adds one sample to every pixel. Ctrl-C drops the pass."""
        self._renderer.render_pass()
        if self._own is not None:
            self._own.raise_error()

    def restart(self, seed: int) -> bool:
        """Begins another image, of the scene as it is now, with another seed. Whether the sampler's
        tree was built anew.
        """
        self._given.closed()
        self._setup_seconds = 0.0
        rebuilt, _ = self._renderer.restart(seed)
        return rebuilt

    def checkpoint(self) -> Checkpoint:
        """All that there is so far."""
        renderer = self._renderer
        return Checkpoint(renderer.stats(), self._setup_seconds, renderer.sums(), renderer.learned())

    def resume(self, checkpoint: Checkpoint) -> None:
        """Goes on from a checkpoint of the same render. Before the first pass."""
        self._renderer.restore(checkpoint.stats, checkpoint.sums, checkpoint.learned)
        self._setup_seconds = checkpoint.setup_seconds + self._renderer.setup_seconds()

    def render_chunk(self, chunk: Chunk) -> ChunkSums:
        """Renders some passes alone. Ctrl-C drops them."""
        self._renderer.begin_part(chunk.first, b"")
        for _ in range(chunk.count):
            self._renderer.render_pass()
        emission = self._renderer.emission_sums() if self._emission_apart else None
        return ChunkSums(self._renderer.sums(), emission, self._renderer.stats())

    @property
    def learning(self) -> bool:
        """Whether passes depend on those before them."""
        return self._renderer.learning()

    def learned(self) -> bytes:
        """What the sampler has learned; empty if it does not."""
        return self._renderer.learned()

    def take_learned(self, learned: bytes) -> None:
        """Knows from now on what another sampler of this render has learned."""
        self._renderer.begin_part(0, learned)

    @property
    def setup_seconds(self) -> float:
        """What came before the first pass."""
        return self._setup_seconds

    def image(self) -> np.ndarray:
        """The mean of the passes so far: float32 (H, W, 3)."""
        return self._renderer.image()

    def lit(self) -> np.ndarray | None:
        """The part of it that is not emission; None unless the settings keep that apart."""
        return self._renderer.lit() if self._emission_apart else None

    def emission(self) -> np.ndarray | None:
        """The part of it that the camera sees of emitters directly; None as of `lit`."""
        return self._renderer.emission() if self._emission_apart else None

    def mean_counts(self) -> _core.MeanCounts | None:
        """Mean cost of one selection at camera points; None where the sampler does not tell. After
        the first pass.
        """
        return self._renderer.mean_counts()

    def learned_view(self) -> _core.LearnedView | None:
        """What the sampler has learned, at camera points; None if it has not."""
        return self._renderer.learned_view()

    def memory_size(self) -> tuple[_core.SceneMemory, _core.RendererMemory, int, int]:
        """Bytes, of the scene, of paths, of virtual lights, and of those what is there already."""
        return self._scene.memory_size(), self._renderer.memory_size(), 0, 0

    def stats(self) -> Stats:
        stats = Stats.of(self._renderer.stats(), self._setup_seconds)
        return stats if self._own is None else replace(stats, own_seconds=self._own.seconds)
