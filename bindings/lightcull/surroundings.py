"""What surrounds a scene: an image, a colour, nothing, or a studio that shows what there is."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TypeAlias

import numpy as np

from ._core import Error
from .camera import Camera
from .images import read_image

Environment: TypeAlias = str | os.PathLike[str] | Sequence[float] | np.ndarray
"""The name of an image, or of one of NAMES; a colour "0.2", "0.2,0.3,0.5" (linear) or "#336699"
(sRGB); linear RGB as numbers; a latitude-longitude map, float32 (H, W, 3).
"""

AUTO, NONE, STUDIO = "auto", "none", "studio"
NAMES = (AUTO, NONE, STUDIO)
"""auto: a studio where a file has no light that shows it, else nothing."""

_ROWS, _COLUMNS = 64, 128
_GROUND, _HORIZON, _ZENITH = 0.1, 0.3, 0.7
"""Radiance of the studio's walls."""
_LAMPS = (
    ((-0.65, 0.75, 0.75), 5.0, 0.35),
    ((0.9, 0.25, 0.5), 0.9, 0.5),
    ((0.6, 0.6, -0.8), 2.5, 0.3),
)
"""Key, fill and rim: where they are as a camera that looks along -Z has it, their radiance, and how
wide they are, radians.
"""


def is_auto(environment: Environment) -> bool:
    """Whether nobody has said what is to surround a scene."""
    return isinstance(environment, str) and environment == AUTO


def texels_of(environment: Environment, camera: Camera) -> np.ndarray | None:
    """The map of what is neither AUTO nor NONE, float32 (H, W, 3); None of NONE. camera: what a
    studio is lit for.
    """
    if isinstance(environment, np.ndarray) and environment.ndim != 1:
        return environment
    if isinstance(environment, str):
        if environment == NONE:
            return None
        if environment == STUDIO:
            return studio(camera)
        rgb = _color(environment)
        return _map(environment) if rgb is None else _constant(rgb)
    if isinstance(environment, os.PathLike):
        return _map(environment)
    return _constant(environment)


def studio(camera: Camera) -> np.ndarray:
    """A grey room that is bright above and dark below, with a large lamp to the left of the camera,
    a weak one to the right and one behind what it sees: float32 (H, W, 3).
    """
    forward = np.subtract(camera.target, camera.origin)
    height = np.pi * (np.arange(_ROWS)[:, None] + 0.5) / _ROWS
    around = 2 * np.pi * (np.arange(_COLUMNS)[None, :] + 0.5) / _COLUMNS - np.pi
    around = around - np.arctan2(forward[0], -forward[2])
    up = np.broadcast_to(np.cos(height), (_ROWS, _COLUMNS))
    directions = np.stack(
        [np.sin(height) * np.sin(around), up, -np.sin(height) * np.cos(around)], axis=-1
    )
    above, below = np.clip(up, 0, 1) ** 0.6, np.clip(-up, 0, 1) ** 0.4
    radiance = _HORIZON + (_ZENITH - _HORIZON) * above + (_GROUND - _HORIZON) * below
    for place, strength, width in _LAMPS:
        cosine = directions @ (np.array(place) / np.linalg.norm(place))
        angle = np.arccos(np.clip(cosine, -1, 1))
        radiance = radiance + strength * np.exp(-((angle / width) ** 4))
    return np.ascontiguousarray(np.repeat(radiance[..., None], 3, axis=2), np.float32)


def _map(path: str | os.PathLike[str]) -> np.ndarray:
    if not Path(path).is_file():
        raise Error(f"environment: {os.fspath(path)!r} is neither a file nor a colour")
    return read_image(path)


def _constant(rgb: Sequence[float] | np.ndarray) -> np.ndarray:
    values = np.asarray(rgb, np.float32)
    if values.shape != (3,) or not (values >= 0).all():
        raise Error(f"environment: wanted three numbers from 0 up, got {rgb!r}")
    return values.reshape(1, 1, 3)


def _color(text: str) -> tuple[float, float, float] | None:
    """The colour that a text is, if it is one."""
    if re.fullmatch(r"#[0-9a-fA-F]{6}", text):
        encoded = np.array([int(text[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
        linear = np.where(
            encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4
        )  # IEC 61966-2-1
        return float(linear[0]), float(linear[1]), float(linear[2])
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        return None
    if len(numbers) == 1:
        numbers *= 3
    if len(numbers) != 3 or not all(0 <= number < np.inf for number in numbers):
        raise Error(f"environment: wanted one number from 0 up, or three, got {text!r}")
    return numbers[0], numbers[1], numbers[2]
