"""Images that trimesh has read, as textures."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._core import Error


def texels_of(name: str, image: Any, linear_data: bool = False) -> np.ndarray:
    """A PIL image as float32 (H, W, 3), decoded from sRGB unless it is linear data. name: for errors."""
    try:
        image.load()
    except Exception as error:  # PIL reads pixels late, and lets through what its decoders meet
        raise Error(f"{name}: cannot read: {' '.join(str(error).split())}") from error
    if image.mode.startswith("I"):
        values = np.asarray(image, dtype=np.float32)[..., None] / 65535.0
    else:
        values = np.asarray(image.convert("RGB"), dtype=np.float32) / 255.0
    if not linear_data:
        values = _from_srgb(values)
    return np.ascontiguousarray(np.broadcast_to(values, (*values.shape[:2], 3)), np.float32)


def _from_srgb(encoded: np.ndarray) -> np.ndarray:
    """IEC 61966-2-1."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
