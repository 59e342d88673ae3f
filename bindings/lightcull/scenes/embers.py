"""250,000 embers that wind blows out of a bowl and low over a wide polished floor.

The camera looks down at the floor between two of the stones that stand about the bowl. An ember is
one small triangle that glows on both sides. Powers are spread evenly over six decades, colours are
those of glowing coal, the stronger the hotter.
"""

from __future__ import annotations

import numpy as np

from ..scene import Scene
from . import geometry, scene_parts
from .color import blackbody, from_srgb, with_luminance
from .geometry import Shape
from .random_numbers import Chance, Noise

EMBERS = 250_000
DECADES = 6.0
STRONGEST = 0.4
"""Power of the strongest ember, W, weighted by luminance."""
BOWL_TOP = 1.05
REACH = 28.0
"""Of the wind, metres from the bowl."""


def fill(scene: Scene) -> None:
    chance = Chance(451)
    _add_floor(scene, chance)
    _add_stones(scene, chance)
    _add_bowl(scene)
    _add_embers(scene, chance)
    scene.set_camera(origin=(7.4, 1.3, 2.6), target=(6.0, 0.1, 1.2), vertical_fov=np.radians(40.0))


def _add_floor(scene: Scene, chance: Chance) -> None:
    floor = geometry.quad((-30, 0, 30), (60, 0, 0), (0, 0, -60), (15, 15))
    material = scene_parts.glossy(scene, np.ones(3), 0.26, texture=_slabs(chance))
    scene_parts.add(scene, "floor", floor, material)


def _slabs(chance: Chance) -> np.ndarray:
    """Dark slabs, 4 x 4 to a texture of 4 m."""
    size, slabs = 512, 4
    noise = Noise(chance)
    y, x = np.mgrid[0:size, 0:size] * (slabs / size)
    shade = chance.uniform(0.75, 1.25, (slabs, slabs))[y.astype(int), x.astype(int)]
    veins = 1 + 0.3 * noise(8 * x, 8 * y, 4)
    edge = np.minimum(np.minimum(x % 1, 1 - x % 1), np.minimum(y % 1, 1 - y % 1))
    joint = np.clip(edge / 0.015, 0.3, 1.0)
    return (shade * veins * joint)[..., None] * from_srgb("#54504e")


def _add_stones(scene: Scene, chance: Chance) -> None:
    """Rough monoliths in a ring, open towards the camera."""
    noise = Noise(chance)
    granite = scene_parts.diffuse(scene, from_srgb("#a39b92"))
    count = 13
    angles = np.pi / 2 + 2 * np.pi * (np.arange(count) + 0.5) / count
    stones = []
    for angle in angles[2:-2]:
        size = chance.uniform(0.5, 0.8), chance.uniform(1.5, 2.4), chance.uniform(0.32, 0.48)
        stone = _monolith(noise, size, 20 * float(chance.uniform()))
        stone = stone.turned(np.pi / 2 - angle + float(chance.uniform(-0.25, 0.25)))
        radius = chance.uniform(4.7, 5.4)
        stones.append(stone.moved(radius * np.cos(angle), size[1] - 0.1, radius * np.sin(angle)))
    scene_parts.add(scene, "stones", geometry.merge(stones), granite)


def _monolith(noise: Noise, size: tuple, seed: float) -> Shape:
    """A ball pressed towards a box, then roughened; half sizes in metres."""
    ball = geometry.icosphere(4)
    p = ball.positions
    p = p / (np.abs(p) ** 5).sum(axis=1, keepdims=True) ** 0.2
    p[:, [0, 2]] *= 1.0 - 0.12 * p[:, 1:2]
    rough = noise(1.3 * p[:, 0] + seed + 1.7 * p[:, 2], 2.2 * p[:, 1] + seed, 3)
    p = p * (1 + 0.07 * rough[:, None]) * np.array(size)
    return Shape(p, ball.indices, _smooth_normals(p, ball.indices))


def _smooth_normals(positions: np.ndarray, indices: np.ndarray) -> np.ndarray:
    corners = positions[indices]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(positions)
    for corner in indices.T:
        np.add.at(normals, corner, faces)
    return geometry.unit(normals)


def _add_bowl(scene: Scene) -> None:
    iron = scene_parts.glossy(scene, from_srgb("#6a5f58"), roughness=0.35, metallic=1.0)
    foot = [(0.0, 0.0), (0.62, 0.0), (0.62, 0.1), (0.2, 0.22), (0.16, 0.55), (0.5, 0.68)]
    basin = [(0.88, 0.9), (0.98, BOWL_TOP), (0.92, BOWL_TOP), (0.8, 0.92), (0.0, 0.72)]
    scene_parts.add(scene, "bowl", geometry.lathe(foot + basin, 64), iron)


def _add_embers(scene: Scene, chance: Chance) -> None:
    in_whirl, blown = 30_000, 212_000
    on_floor = EMBERS - in_whirl - blown
    centres = np.concatenate(
        (_whirl(chance, in_whirl), _blown(chance, blown), _fallen(chance, on_floor))
    )
    exponent = chance.uniform(shape=EMBERS)
    exponent = (exponent - exponent.min()) / (exponent.max() - exponent.min())
    power = STRONGEST * 10.0 ** (-DECADES * exponent)
    size = (0.008 + 0.012 * (1 - exponent)) * chance.uniform(0.7, 1.3, EMBERS)

    lying = np.arange(EMBERS) >= in_whirl + blown
    triangles = _triangles(chance, centres, size, lying)
    corners = triangles.positions[triangles.indices]
    area = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    color = blackbody(np.linspace(2150.0, 1900.0, 256))[np.round(255 * exponent).astype(int)]
    radiance = with_luminance(color, power / (2 * np.pi * area))
    scene_parts.add_lights(scene, "embers", triangles, radiance, two_sided=True)


def _whirl(chance: Chance, count: int) -> np.ndarray:
    """Ribbons that wind up out of the bowl and widen."""
    t = chance.uniform(shape=count) ** 1.35
    ribbon = np.floor(chance.uniform(0, 5, count))
    spread = chance.normal((3, count)) * (0.05 + 0.26 * t)
    angle = 2 * np.pi * (ribbon / 5 + 1.15 * t**0.8) + 0.35 * np.sin(9 * t + ribbon)
    radius = 0.3 + 1.7 * t**1.2 * (0.75 + 0.12 * ribbon)
    height = BOWL_TOP - 0.2 + 6.6 * t
    lean = 0.5 * t**2
    return np.column_stack(
        (
            radius * np.cos(angle) + spread[0] + lean,
            height + 0.6 * spread[1] * t,
            radius * np.sin(angle) + spread[2],
        )
    )


def _blown(chance: Chance, count: int) -> np.ndarray:
    """Embers blown about, knee-high at most."""
    angle = chance.uniform(0, 2 * np.pi, count)
    radius = REACH * np.sqrt(chance.uniform(shape=count))
    height = 0.04 + 0.3 * chance.uniform(shape=count) ** 1.7
    return np.column_stack((radius * np.cos(angle), height, radius * np.sin(angle)))


def _fallen(chance: Chance, count: int) -> np.ndarray:
    """Embers that lie about the bowl."""
    angle = chance.uniform(0, 2 * np.pi, count)
    radius = 0.66 + 1.1 * np.abs(chance.normal(count))
    height = 0.004 + 0.012 * chance.uniform(shape=count)
    return np.column_stack((radius * np.cos(angle), height, radius * np.sin(angle)))


def _triangles(chance: Chance, centres: np.ndarray, size: np.ndarray, lying: np.ndarray) -> Shape:
    """One triangle about each centre, of circumradius `size`; those that lie are nearly level."""
    count = len(centres)
    normal = chance.directions(count)
    normal[lying] = geometry.unit(normal[lying] * 0.1 + (0.0, 1.0, 0.0))
    helper = np.where(np.abs(normal[:, :1]) < 0.6, (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    across = geometry.unit(np.cross(normal, helper))
    along = np.cross(normal, across)
    turn = chance.uniform(0, 2 * np.pi, count)
    corners = []
    for third in range(3):
        angle = (turn + 2 * np.pi * third / 3)[:, None]
        corners.append(centres + size[:, None] * (np.cos(angle) * across + np.sin(angle) * along))
    indices = np.arange(3 * count, dtype=np.uint32).reshape(-1, 3)
    return Shape(np.stack(corners, axis=1).reshape(-1, 3), indices)
