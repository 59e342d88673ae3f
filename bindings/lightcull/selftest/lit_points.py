"""Lights and the points that they light: what cases begin with, all from fixed seeds."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from .. import _core
from ..sampler import LightSampler


@dataclass(frozen=True, eq=False)
class Setting:
    """Lights, and points that are lit by them."""

    lights: np.ndarray
    """(N,) of dtype LIGHT."""
    positions: np.ndarray
    """float32 (M, 3), metres."""
    normals: np.ndarray
    """float32 (M, 3)."""

    @cache  # noqa: B019 - as long as the setting
    def sampler(self, description: str) -> LightSampler:
        return LightSampler(self.lights, description)

    def numbers(self, seed: int) -> np.ndarray:
        """A random number for each point."""
        return np.random.default_rng(seed).random(len(self.positions), np.float32)


def floats(values: np.ndarray) -> np.ndarray:
    """Rounded to single precision."""
    return np.ascontiguousarray(values, np.float32)


def directions(count: int, seed: int) -> np.ndarray:
    """Unit vectors, float32 (count, 3)."""
    vectors = np.random.default_rng(seed).normal(size=(count, 3))
    return floats(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def points_setting() -> Setting:
    """Point lights in a cube of 2 m, powers over three decades, and points among them."""
    random = np.random.default_rng(11)
    centers = floats(random.uniform(-1, 1, (100, 3)))
    lights = _core.point_lights(centers, floats(10 ** random.uniform(-1.5, 1.5, 100)))
    return Setting(lights, floats(random.uniform(-0.8, 0.8, (24, 3))), directions(24, 12))


def mixed_lights(count: int, seed: int) -> np.ndarray:
    """Points, triangles on one side and on both, and spots."""
    random = np.random.default_rng(seed)
    corners = random.uniform(-1, 1, (count, 1, 3)) + random.normal(scale=0.05, size=(count, 3, 3))
    lights = _core.triangle_lights(floats(corners), floats(10 ** random.uniform(1, 4, count)))
    lights["two_sided"][1::4] = True
    lights["radius"][2::4] = 0
    lights["cos_theta_o"][2::4] = -1
    lights["radius"][3::4] = 0
    lights["cos_theta_o"][3::4], lights["cos_theta_e"][3::4] = 0.9, 0.7
    return lights


def mixed_setting() -> Setting:
    """All kinds of lights in a cube of 2 m, and points in it and around it."""
    random = np.random.default_rng(13)
    return Setting(
        mixed_lights(200, 14), floats(random.uniform(-1.3, 1.3, (64, 3))), directions(64, 15)
    )
