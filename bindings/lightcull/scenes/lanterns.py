"""A courtyard with columns at night, lit by 2,736 lanterns.

They stand on stakes all over the court and its arcade, in the spiral of a sunflower's seeds about
the fountain. Each is an icosahedron of 20 lights; its power is log-normal, and the stronger are
larger. The same court can be lit by more and dimmer lanterns, or by fewer and brighter ones.
"""

from __future__ import annotations

import numpy as np

from .._core import Error
from ..scene import Scene
from . import courtyard, geometry, scene_parts
from .color import from_srgb, with_luminance
from .courtyard import BASIN, BAY, DEPTH, HALF_LENGTH, HALF_WIDTH
from .random_numbers import Chance

LANTERNS = 2736
LIGHTS = 20 * LANTERNS
RADIUS, SMALLEST, LARGEST = 0.09, 0.06, 0.26
"""Of a lantern of median power, of the weakest and of the strongest, metres."""
POWER_SIGMA = 2.0
"""Deviation of the logarithm of a lantern's power."""
TOTAL_POWER = 40_000.0
"""Of all lanterns together, in watts, whatever their number."""
PAPERS = ("#ffb25c", "#ffac54", "#ffb866", "#ffbe70")


def fill(scene: Scene, lights: int = LIGHTS) -> None:
    """lights: a multiple of 20. Places for `LANTERNS` of them are filled in part where they are
    fewer, and are taken closer together where they are more, for lanterns that are smaller in
    proportion and nearer to the ground. The power of all together stays.
    """
    if lights < 20 or lights % 20 != 0:
        raise Error(f"lanterns: lights must be a multiple of 20, got {lights}")
    chance = Chance(2736)
    courtyard.add_architecture(scene, chance)
    courtyard.add_fountain(scene)
    _add_lanterns(scene, chance, lights // 20)
    scene.set_camera(
        origin=(50.0, 2.4, 36.9), target=(20.0, 1.4, 36.0), vertical_fov=np.radians(50.0)
    )


def _add_lanterns(scene: Scene, chance: Chance, count: int) -> None:
    crowding = -(-count // LANTERNS)
    places = crowding * LANTERNS
    power = chance.log_normal(POWER_SIGMA, places)
    # `crowding` times as many on the same ground: distances shrink with the root.
    shrink = 1 / np.sqrt(crowding)
    radii = shrink * np.clip(RADIUS * power**0.35, SMALLEST, LARGEST)
    tops = _spiral(places)
    tops[:, 1] = 3.5 * radii + shrink * chance.uniform(0.1, 0.25, places)

    taken = _taken(chance, places, count)
    tops, radii, power = tops[taken], radii[taken], power[taken]
    turns = chance.uniform(0, 2 * np.pi, count)
    lanterns = geometry.scatter(geometry.icosahedron(), tops, radii, turns)
    radiance = _radiance(chance, power * TOTAL_POWER / power.sum(), radii)
    scene_parts.add_lights(scene, "lanterns", lanterns, np.repeat(radiance, 20, axis=0))
    stakes = np.stack((tops * (1.0, 0.0, 1.0), tops), axis=1)
    bamboo = scene_parts.diffuse(scene, from_srgb("#c8b48c"))
    scene_parts.add(scene, "stakes", geometry.tubes(stakes, 0.006 * shrink), bamboo)


def _taken(chance: Chance, places: int, count: int) -> np.ndarray:
    """Which of the places have a lantern: (count,) ascending."""
    if count == places:
        return np.arange(places)
    return np.sort(np.argsort(chance.uniform(shape=places), kind="stable")[:count])


def _radiance(chance: Chance, power: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """(N, 3) for N lanterns: their power, spread over their surface."""
    tint = chance.pick(np.array([from_srgb(code) for code in PAPERS]), len(radii))
    # A sphere's M = pi L over its area; the icosahedron has four fifths of it.
    return with_luminance(tint, power / (np.pi * 4 * np.pi * radii**2))


def _spiral(count: int) -> np.ndarray:
    """(count, 3) places on the ground, from the fountain to the walls: each at the golden angle
    from the one before, as far out as gives all the same room; none in a column."""
    half_x, half_z, hole = HALF_WIDTH + DEPTH - 0.5, HALF_LENGTH + DEPTH - 0.5, BASIN + 0.5
    room = 0.97 * (4 * half_x * half_z - np.pi * hole**2) / count
    n = np.arange(3 * count)
    away, angle = np.sqrt(hole**2 + n * room / np.pi), n * np.pi * (3 - np.sqrt(5))
    x, z = away * np.cos(angle), away * np.sin(angle)
    free = (np.abs(x) < half_x) & (np.abs(z) < half_z) & ~_in_column(x, z)
    x, z = x[free][:count], z[free][:count]
    return np.column_stack((x, np.zeros(count), z))


def _in_column(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Whether points on the ground are in a column, or so near that a lantern would touch it."""
    from_row = np.minimum(np.abs(np.abs(x) - HALF_WIDTH), np.abs(np.abs(z) - HALF_LENGTH))
    along = [np.abs((p + BAY / 2) % BAY - BAY / 2) for p in (x, z)]
    return (from_row < 0.6) & (np.maximum(*along) < 0.6)
