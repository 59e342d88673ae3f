"""Foliage for the example scenes."""

from __future__ import annotations

import numpy as np

from . import geometry
from .geometry import Shape
from .random_numbers import Chance


def leafy_balls(
    chance: Chance, crowns: np.ndarray, reach: tuple[float, float], count: int, size: float = 0.085
) -> Shape:
    """Balls of leaves, a rhomb of two triangles each.

    crowns (K, 3): centres; reach: nearest and farthest leaf from the centre, metres; count: leaves
    to a ball; size: half the length of a leaf, metres.
    """
    total = len(crowns) * count
    out = chance.directions(total)
    centre = np.repeat(crowns, count, axis=0) + out * chance.uniform(*reach, total)[:, None]
    along = geometry.unit(chance.directions(total) + 0.4 * out) * size
    across = geometry.unit(np.cross(along, out + 0.3 * chance.directions(total))) * (0.47 * size)
    return geometry.quads(
        np.stack((centre - along, centre + across, centre + along, centre - across), axis=1)
    )
