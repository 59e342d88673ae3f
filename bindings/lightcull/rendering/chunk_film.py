"""The sums of a render by chunks."""

from __future__ import annotations

import numpy as np

from .. import _core
from .chunk import Chunk, ChunkSums


class ChunkFilm:
    """Adds up chunks, in double precision and in their order."""

    def __init__(self, size: tuple[int, int], emission_apart: bool) -> None:
        width, height = size
        self.sums = np.zeros((height, width, 3))
        """float64 (H, W, 3)."""
        self._emission = np.zeros((height, width, 3)) if emission_apart else None
        self.passes = 0
        self._sampler_seconds = self._selection_seconds = 0.0
        self._selections = self._rays = 0

    def add(self, chunk: Chunk, sums: ChunkSums) -> None:
        """Adds the next chunk."""
        assert chunk.first == self.passes
        self.sums += sums.sums
        if self._emission is not None and sums.emission is not None:
            self._emission += sums.emission
        self.passes = chunk.end
        self._count(sums.stats)

    def restore(self, sums: np.ndarray, stats: _core.RenderStats) -> None:
        """Goes on from sums that were saved. Before the first chunk."""
        self.sums = sums.copy()
        self.passes = stats.passes
        self._count(stats)

    def image(self) -> np.ndarray:
        """The mean of the passes: float32 (H, W, 3)."""
        return self._mean(self.sums)

    def emission(self) -> np.ndarray | None:
        """The part of it that is kept apart, if it is."""
        return None if self._emission is None else self._mean(self._emission)

    def lit(self) -> np.ndarray | None:
        """The rest."""
        return None if self._emission is None else self._mean(self.sums - self._emission)

    def stats(self, seconds: float) -> _core.RenderStats:
        """What it took, in so many seconds of wall time."""
        return _core.RenderStats(
            self.passes, seconds, self._sampler_seconds, self._selection_seconds,
            self._selections, self._rays,
        )  # fmt: skip

    def _mean(self, sums: np.ndarray) -> np.ndarray:
        mean: np.ndarray = (sums * (1.0 / max(self.passes, 1))).astype(np.float32)
        return mean

    def _count(self, stats: _core.RenderStats) -> None:
        self._sampler_seconds += stats.sampler_seconds
        self._selection_seconds += stats.selection_seconds
        self._selections += stats.selections
        self._rays += stats.rays
