"""How far a call is, for callbacks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from ..field_docs import with_field_docs


@with_field_docs
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
