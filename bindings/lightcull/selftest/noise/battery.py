"""All situations."""

from __future__ import annotations

from . import cameras, far, glossy, hidden, lamps, panels, spots, textures, volumes
from .situation import Situation


def all_situations() -> list[Situation]:
    """In the order in which they are shown."""
    kinds = (lamps, panels, spots, far, hidden, glossy, textures, cameras, volumes)
    return [situation for kind in kinds for situation in kind.situations()]
