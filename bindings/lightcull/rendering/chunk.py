"""Passes that are added up apart, and then as one to the others, so that the sums have the same bits
wherever they were rendered.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import _core

CLUSTER_CHUNK = 16
"""Passes of a chunk on a cluster, unless told."""


@dataclass(frozen=True)
class Chunk:
    """Passes, by their numbers."""

    first: int
    count: int

    @property
    def end(self) -> int:
        """The number of the first pass after it."""
        return self.first + self.count


def chunk_after(passes: int, size: int, limit: int | None) -> Chunk | None:
    """What comes after so many passes: chunks of `size`, of which the last may be shorter if there is a
    limit. None: nothing.
    """
    count = size if limit is None else min(size, limit - passes)
    return Chunk(passes, count) if count > 0 else None


@dataclass(frozen=True)
class ChunkSums:
    """What the passes of a chunk came to."""

    sums: np.ndarray
    """float64 (H, W, 3)."""
    emission: np.ndarray | None
    """The part of it that the camera sees of emitters directly, where that is kept apart."""
    stats: _core.RenderStats
    """Of the chunk alone, but for the number of passes."""
