"""Snowy hills at nightfall, planted with 51,200 glowing bulbs: 1,024,000 triangle lights."""

from __future__ import annotations

import numpy as np

from ..scene import Scene
from . import geometry, scene_parts
from .color import from_srgb
from .plants import leafy_balls
from .random_numbers import Chance, Noise

BULBS = 51_200
HALF = 130.0
"""Half the side of the planted ground, metres."""
PALETTE = ("#7a3cff", "#2f6bff", "#19c8d8", "#3cff9a", "#ffd23c", "#ff7a2a", "#ff3f6e", "#c43cff")


class Ground:
    """Height of the hills, metres."""

    def __init__(self, chance: Chance) -> None:
        self._noise = Noise(chance)

    def __call__(self, x: np.ndarray, z: np.ndarray) -> np.ndarray:
        rolling = 7.0 * self._noise(x / 45.0 + 3.7, z / 45.0 + 8.2, 2)
        # Rises away from the camera, so that the far hills show their faces.
        return rolling + 11.0 * np.clip(-z / HALF, -0.3, 1.0) ** 2 * np.sign(np.maximum(-z, 0))


def fill(scene: Scene) -> None:
    chance = Chance(1_024_000)
    ground = Ground(chance)
    _add_ground(scene, ground)
    _add_bulbs(scene, chance, ground)
    _add_trees(scene, chance, ground)
    scene_parts.sky(
        scene,
        zenith=0.030 * from_srgb("#24429a"),
        horizon=0.15 * from_srgb("#7f8cc4"),
        ground=np.full(3, 0.002),
    )
    eye = (6.0, float(ground(np.array(6.0), np.array(92.0))) + 6.5, 92.0)
    scene.set_camera(origin=eye, target=(-4.0, 2.0, 10.0), vertical_fov=np.radians(48.0))


def _add_ground(scene: Scene, ground: Ground) -> None:
    reach = 1.6 * HALF
    axis = np.linspace(-reach, reach, 401)
    heights = ground(*np.meshgrid(axis, axis))
    snow = scene_parts.diffuse(scene, from_srgb("#dfe2e6"))
    scene_parts.add(scene, "ground", geometry.height_field(axis, axis, heights), snow)


def _path(z: np.ndarray) -> np.ndarray:
    """x of the middle of the path that winds through the field."""
    return 10.0 * np.sin(z / 23.0) + 5.0 * np.sin(z / 9.0 + 1.0)


def _add_bulbs(scene: Scene, chance: Chance, ground: Ground) -> None:
    candidates = chance.uniform(-HALF, HALF, (int(1.25 * BULBS), 2))
    on_path = np.abs(candidates[:, 0] - _path(candidates[:, 1])) < 1.6
    x, z = candidates[~on_path][:BULBS].T
    radius = chance.uniform(0.11, 0.19, BULBS)
    stalk = chance.uniform(0.35, 0.75, BULBS)
    foot = ground(x, z)
    centres = np.column_stack((x, foot + stalk + radius, z))

    bulbs = geometry.scatter(
        geometry.icosahedron(), centres, radius, chance.uniform(0, 2 * np.pi, BULBS)
    )
    radiance = _radiance(chance, x, z)
    scene_parts.add_lights(scene, "bulbs", bulbs, np.repeat(radiance, 20, axis=0))

    feet = np.column_stack((x, foot - 0.05, z))
    stalks = geometry.tubes(np.stack((feet, centres), axis=1), 0.012)
    scene_parts.add(scene, "stalks", stalks, scene_parts.diffuse(scene, from_srgb("#7d8a72")))


def _radiance(chance: Chance, x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """(BULBS, 3): waves of colour over the hills, log-normal radiance."""
    noise = Noise(chance)
    hue = 1.9 * noise(x / 60.0, z / 60.0, 2) + 0.02 * z + 0.18 * chance.normal(len(x))
    colors = np.array([from_srgb(code) for code in PALETTE])
    place = np.mod(hue * len(colors) / 2.4, len(colors))
    lower = np.floor(place).astype(int) % len(colors)
    share = (place - np.floor(place))[:, None]
    color = colors[lower] * (1 - share) + colors[(lower + 1) % len(colors)] * share
    color = color / color.max(axis=1, keepdims=True)
    return color * (2.2 * chance.log_normal(0.6, len(x)))[:, None]


def _add_trees(scene: Scene, chance: Chance, ground: Ground) -> None:
    x, z = np.array(
        [(-26, 38), (34, 18), (-52, -6), (14, -22), (-12, -52), (58, -34), (-70, -60)]
    ).T
    x, z = x.astype(float), z.astype(float)
    foot = np.column_stack((x, ground(x, z), z))
    scale = chance.uniform(0.8, 1.4, len(x))
    trunk = geometry.lathe([(0.55, -0.5), (0.38, 0.6), (0.28, 5.0)], 12)
    bark = scene_parts.diffuse(scene, from_srgb("#4e4036"))
    scene_parts.add(scene, "trunks", geometry.scatter(trunk, foot, scale), bark)
    crowns = []
    for place, size in zip(foot, scale):
        for _ in range(7):
            offset = chance.normal(3) * (1.3, 0.6, 1.3) * size
            crowns.append(place + (0.0, 5.6 * size, 0.0) + offset)
    leaf = scene_parts.diffuse(scene, from_srgb("#5f7a48"))
    scene_parts.add(
        scene, "leaves", leafy_balls(chance, np.array(crowns), (0.8, 1.9), 1500, 0.16), leaf
    )
