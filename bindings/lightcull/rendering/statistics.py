"""What a render took."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .. import _core
from ..field_docs import with_field_docs


@with_field_docs
@dataclass(frozen=True)
class Stats:
    """What a render took."""

    spp: int
    """Samples per pixel."""
    seconds: float
    """Wall time, set-up included."""
    setup_seconds: float = 0.0
    """Wall time before the first sample: the sampler's builds and pilots."""
    selection_seconds: float = math.nan
    """Time spent choosing lights, summed over threads; not a number where a host does not tell."""
    selections: int = 0
    """How often a light was chosen; 0 where a host does not tell."""
    rays: int = 0
    """Camera, shadow and scattered rays; 0 where a host does not tell."""
    sampler_seconds: float = math.nan
    """Wall time of the passes that went to refits and to choosing lights; not a number where a host
    does not tell.
    """
    own_seconds: float = math.nan
    """Wall time inside the calls of a sampler of one's own, its making included, which is part of
    `seconds`; not a number where there is none.
    """

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
