"""What is seen through lit windows in the `city` scene: sheets of small pictures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .random_numbers import Chance


@dataclass(frozen=True)
class Sheet:
    """A texture of `count` square pictures side by side, `pixels` wide each."""

    texels: np.ndarray
    """(pixels, count * pixels, 3) in [0, 1]."""
    count: int
    pixels: int

    def uvs(self, picture: np.ndarray, low: float = 0.0, high: float = 1.0) -> np.ndarray:
        """(K, 4, 2) texture coordinates of rectangles that show pictures (K,), or the part of them
        from height `low` to `high`; corners anticlockwise from the lower left."""
        # Half a texel in, so that no neighbour shines through.
        margin = 0.5 / self.pixels
        left, right = (picture + margin) / self.count, (picture + 1 - margin) / self.count
        bottom, top = np.clip((low, high), margin, 1 - margin)
        u = np.stack((left, right, right, left), axis=-1)
        v = np.broadcast_to((bottom, bottom, top, top), u.shape)
        return np.stack((u, v), axis=-1)


def rooms(chance: Chance) -> Sheet:
    """Rooms behind curtains and blinds. Few pixels: a light's mean is taken over them."""
    return _sheet([(lambda x, y, kind=i % 3: _room(chance, x, y, kind)) for i in range(12)], 24)


def shops(chance: Chance) -> Sheet:
    """Shelves of goods."""
    return _sheet([lambda x, y: _shop(chance, x, y)] * 4, 96)


def _sheet(painters: list, pixels: int) -> Sheet:
    y, x = (np.mgrid[0:pixels, 0:pixels] + 0.5) / pixels
    pictures = [paint(x, 1 - y) for paint in painters]
    texels = np.clip(np.concatenate(pictures, axis=1), 0.0, 1.0)
    return Sheet(texels, len(painters), pixels)


def _room(chance: Chance, x: np.ndarray, y: np.ndarray, kind: int) -> np.ndarray:
    lamp_x, lamp_y = chance.uniform(0.25, 0.75), chance.uniform(0.6, 0.95)
    light = 0.35 + 0.25 * y
    light = light + 0.5 * np.exp(-((x - lamp_x) ** 2 + (y - lamp_y) ** 2) / 0.06)
    start = chance.uniform(0.0, 0.7)
    furniture = (y < chance.uniform(0.1, 0.32)) & (x > start) & (x < start + 0.35)
    light = np.where(furniture, 0.3 * light, light)
    if kind == 0:  # curtains drawn aside
        width = chance.uniform(0.14, 0.3)
        folds = 0.4 + 0.12 * np.sin(2 * np.pi * x / 0.12)
        light = np.where((x < width) | (x > 1 - width), folds, light)
    elif kind == 1:  # a thin curtain before everything
        folds = 0.8 + 0.12 * np.sin(2 * np.pi * x / 0.17)
        light = (0.35 + 0.5 * light) * folds
    else:  # a blind, half down
        slats = 0.55 + 0.2 * np.sin(2 * np.pi * y / 0.11)
        light = np.where(y > chance.uniform(0.3, 0.8), slats, light)
    return np.repeat(light[..., None], 3, axis=-1)


def _shop(chance: Chance, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    light = np.repeat((0.6 + 0.3 * y)[..., None], 3, axis=-1)
    for shelf in range(3):
        low = 0.06 + 0.27 * shelf
        left = 0.02
        while left < 0.94:
            width, height = chance.uniform(0.025, 0.08), chance.uniform(0.08, 0.2)
            goods = (x > left) & (x < left + width) & (y > low) & (y < low + height)
            light[goods] = chance.uniform(0.12, 0.75, 3)
            left += width + chance.uniform(0.005, 0.05)
        light[(y > low - 0.025) & (y <= low)] = 0.2
    return light
