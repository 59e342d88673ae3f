"""What a render took."""

from __future__ import annotations

from dataclasses import dataclass

from .. import _core


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
