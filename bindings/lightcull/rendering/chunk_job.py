"""Rendering by paths in chunks: here, or shared out."""

from __future__ import annotations

import time
from typing import Protocol

import numpy as np

from .checkpoint import Checkpoint
from .chunk import Chunk, ChunkSums, chunk_after
from .chunk_film import ChunkFilm
from .job import SubjectJob
from .path_job import PathJob
from .settings import RenderSettings
from .statistics import Stats


class ChunkSource(Protocol):
    """Who renders chunks: each once, in their order."""

    def render(self, chunk: Chunk) -> ChunkSums:
        """Gives a chunk, which comes after the last one."""

    def learned(self) -> bytes:
        """What the sampler has learned after the last one."""

    def resume(self, learned: bytes) -> None:
        """Goes on from what was learned. Before the first one."""


class LocalChunks:
    """Renders in this process."""

    def __init__(self, job: PathJob) -> None:
        self._job = job
        self._learned = job.learned()

    @property
    def learning(self) -> bool:
        """Whether passes depend on those before them."""
        return self._job.learning

    def render(self, chunk: Chunk) -> ChunkSums:
        learning = self.learning
        sums = self._job.render_chunk(chunk)
        if learning:
            self._learned = self._job.learned()
        return sums

    def learned(self) -> bytes:
        return self._learned

    def resume(self, learned: bytes) -> None:
        self._job.take_learned(learned)
        self._learned = learned


class ChunkJob(SubjectJob):
    """A render that goes chunk by chunk, and its clock: its image is the same whoever renders."""

    def __init__(
        self,
        sampler: str,
        settings: RenderSettings,
        source: ChunkSource,
        setup_seconds: float,
        size: int,
        limit: int | None,
    ) -> None:
        """size: passes of a chunk; limit: passes of all, None: that depends on time."""
        self.sampler = sampler
        self._source = source
        self._size = size
        self._limit = limit
        self._film = ChunkFilm(settings.size, settings.emission_apart)
        self._seconds = 0.0
        self._setup_seconds = setup_seconds
        self._whole: Checkpoint | None = None
        self._learned = source.learned()

    def render_pass(self) -> None:
        """Adds the next chunk. Ctrl-C drops it."""
        start = time.perf_counter()
        chunk = chunk_after(self._film.passes, self._size, self._limit)
        assert chunk is not None, "there is nothing left to render"
        sums = self._source.render(chunk)
        if chunk.count < self._size:
            # Who goes on from here renders this chunk whole.
            self._whole = self.checkpoint()
        self._film.add(chunk, sums)
        self._learned = self._source.learned()
        self._seconds += time.perf_counter() - start

    def checkpoint(self) -> Checkpoint:
        """All that there is so far, of whole chunks."""
        if self._whole is not None:
            return self._whole
        stats = self._film.stats(self._seconds)
        return Checkpoint(stats, self._setup_seconds, self._film.sums.copy(), self._learned)

    def resume(self, checkpoint: Checkpoint) -> None:
        """Goes on from a checkpoint of the same render. Before the first chunk."""
        self._film.restore(checkpoint.sums, checkpoint.stats)
        self._seconds = checkpoint.stats.seconds
        self._setup_seconds += checkpoint.setup_seconds
        self._learned = checkpoint.learned
        self._source.resume(checkpoint.learned)

    def image(self) -> np.ndarray:
        return self._film.image()

    def lit(self) -> np.ndarray | None:
        return self._film.lit()

    def emission(self) -> np.ndarray | None:
        return self._film.emission()

    def stats(self) -> Stats:
        return Stats.of(self._film.stats(self._seconds), self._setup_seconds)
