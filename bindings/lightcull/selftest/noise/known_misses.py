"""Where the default sampler is noisier than it may be. In the end nothing stands here."""

from __future__ import annotations

KNOWN_MISSES: dict[str, float] = {}
"""Situations, and their ratios as measured, which are above MOST of measure.py."""

KNOWN_EVEN_MISSES: dict[str, float] = {
    # Cells on both sides of a wall, and edges of shadows within them: what is visible of a light is
    # known from a few rays, and differs from one to the next.
    "two rooms": 7.2,
    "panels between beams": 1.86,
    "in a mirror": 1.7,
}
"""The same by even numbers."""
