"""The courtyard of the `lanterns` scene: a paved court with a fountain, in an arcade of columns."""

from __future__ import annotations

import numpy as np

from ..scene import Scene
from . import geometry, scene_parts
from .color import from_srgb
from .geometry import Shape, faceted
from .random_numbers import Chance, Noise

HALF_WIDTH, HALF_LENGTH = 56.0, 40.0
"""Of the court between the columns, along x and z."""
BAY, DEPTH, WALL = 4.0, 4.0, 0.4
"""Width of a bay, depth of the arcade, and of the wall behind it."""
SPRING, CEILING, EAVES = 3.0, 5.0, 5.3
"""Heights that the arches spring from, of the arcade's ceiling, and of the roof's edge."""
COLUMN_RADIUS = 0.24
BASIN = 3.2
"""Radius of the fountain's basin."""


def around(bay: Shape) -> Shape:
    """A bay, built about x = 0 with the court towards +z, set up along all sides of the court."""
    along_x = np.arange(-HALF_WIDTH + BAY / 2, HALF_WIDTH, BAY)
    along_z = np.arange(-HALF_LENGTH + BAY / 2, HALF_LENGTH, BAY)
    places, yaws = [], []
    for side, yaw in ((-1, 0.0), (1, np.pi)):
        places += [(x, 0.0, side * HALF_LENGTH) for x in along_x]
        yaws += [yaw] * len(along_x)
    for side, yaw in ((-1, np.pi / 2), (1, -np.pi / 2)):
        places += [(side * HALF_WIDTH, 0.0, z) for z in along_z]
        yaws += [yaw] * len(along_z)
    return geometry.scatter(bay, np.array(places), yaws=np.array(yaws))


def _arch(spring: float, top: float, thickness: float = 0.44, segments: int = 20) -> Shape:
    """A wall of the width of a bay from z = -thickness / 2 to + thickness / 2, up to `top`, open
    below a half circle that springs at height `spring` from the columns beside it."""
    reach = BAY / 2 - COLUMN_RADIUS
    angles = np.pi * (1 - np.arange(segments + 1) / segments)
    x = np.concatenate(([-BAY / 2], reach * np.cos(angles), [BAY / 2]))
    y = np.concatenate(([spring], spring + 0.9 * reach * np.sin(angles), [spring]))
    front = 0.5 * thickness
    low, high = np.column_stack((x, y)), np.column_stack((x, np.full_like(x, top)))

    def strip(first: np.ndarray, second: np.ndarray, z_first: float, z_second: float) -> Shape:
        rows = [np.column_stack((row, np.full(len(x), z))) for row, z in
                ((first, z_first), (second, z_second))]  # fmt: skip
        return geometry.quads(
            np.stack((rows[0][:-1], rows[0][1:], rows[1][1:], rows[1][:-1]), axis=1)
        )

    return geometry.merge(
        (
            strip(low, high, front, front),
            strip(high, low, -front, -front),
            strip(low, low, -front, front),
            strip(high, high, front, -front),
        )
    )


def _column(bottom: float, top: float) -> Shape:
    """A round column with a moulded base and a capital, at the left end of a bay."""
    r = COLUMN_RADIUS
    base = geometry.box((-1.5 * r, bottom, -1.5 * r), (1.5 * r, bottom + 0.14, 1.5 * r))
    shaft = geometry.lathe(
        [
            (1.4 * r, bottom + 0.14),
            (1.4 * r, bottom + 0.22),
            (1.05 * r, bottom + 0.32),
            (r, bottom + 0.36),
            (0.86 * r, top - 0.42),
            (1.0 * r, top - 0.40),
            (1.0 * r, top - 0.35),
            (0.88 * r, top - 0.33),
            (1.4 * r, top - 0.12),
        ],
        24,
    )
    capital = geometry.box((-1.5 * r, top - 0.12, -1.5 * r), (1.5 * r, top, 1.5 * r))
    flat = geometry.merge((base, capital))
    return geometry.merge((faceted(flat), shaft)).moved(x=-BAY / 2)


def _ring(inner: float, outer: float, bottom: float, top: float) -> Shape:
    """A flat frame about the court, from `inner` to `outer` metres behind the columns."""
    x0, z0 = HALF_WIDTH + inner, HALF_LENGTH + inner
    x1, z1 = HALF_WIDTH + outer, HALF_LENGTH + outer
    return geometry.merge(
        (
            geometry.box((-x1, bottom, -z1), (x1, top, -z0)),
            geometry.box((-x1, bottom, z0), (x1, top, z1)),
            geometry.box((-x1, bottom, -z0), (-x0, top, z0)),
            geometry.box((x0, bottom, -z0), (x1, top, z0)),
        )
    )


def add_architecture(scene: Scene, chance: Chance) -> None:
    stone = scene_parts.diffuse(scene, from_srgb("#dcd6cc"))
    wall = scene_parts.diffuse(scene, from_srgb("#d0b4a0"))
    trim = scene_parts.diffuse(scene, from_srgb("#ece6dc"))
    tiles = scene_parts.diffuse(scene, from_srgb("#a5583a"))
    wood = scene_parts.diffuse(scene, from_srgb("#6b4a33"))

    scene_parts.add(scene, "arches", around(_arch(SPRING, CEILING)), stone)
    scene_parts.add(scene, "columns", around(_column(0.0, SPRING)), trim)
    scene_parts.add(scene, "ceiling", _ring(-0.28, DEPTH, CEILING, EAVES), trim)
    scene_parts.add(scene, "walls", _ring(DEPTH, DEPTH + WALL, 0.0, EAVES), wall)
    scene_parts.add(scene, "doors", around(_door(0.0)), wood)
    scene_parts.add(scene, "roof", _roof(EAVES), tiles)

    across, along = HALF_WIDTH + DEPTH, HALF_LENGTH + DEPTH
    ground = geometry.quad(
        (-across, 0.0, along), (2 * across, 0, 0), (0, 0, -2 * along),
        (across / 2.4, along / 2.4),
    )  # fmt: skip
    scene_parts.add(
        scene, "ground", ground, scene_parts.diffuse(scene, np.ones(3), _paving(chance))
    )


def _door(floor: float) -> Shape:
    """A door of two panelled leaves in a frame."""
    half, top, back = 0.62, floor + 2.3, -DEPTH
    parts = [
        geometry.box((-half - 0.12, floor, back), (-half, top + 0.12, back + 0.1)),
        geometry.box((half, floor, back), (half + 0.12, top + 0.12, back + 0.1)),
        geometry.box((-half, top, back), (half, top + 0.12, back + 0.1)),
    ]
    for left in (-half, 0.01):
        right = left + half - 0.01
        parts.append(geometry.box((left, floor, back), (right, top, back + 0.03)))
        for low, high in ((0.15, 0.95), (1.1, 2.15)):
            parts.append(
                geometry.box(
                    (left + 0.1, floor + low, back), (right - 0.1, floor + high, back + 0.055)
                )
            )
    return geometry.merge(parts)


def _roof(eaves: float) -> Shape:
    """A slope of round tiles towards the court on each side."""
    rise, depth, overhang = 1.5, DEPTH + WALL, 0.5
    tile = 0.3
    columns = 8 * int(round(BAY / tile)) + 1
    x = np.linspace(-BAY / 2, BAY / 2, columns)
    wave = 0.05 * np.abs(np.cos(np.pi * (x + BAY / 2) / tile))
    rows = []
    for forward, height in ((overhang, eaves - 0.12), (-depth, eaves + rise)):
        rows.append(np.column_stack((x, height + wave, np.full(columns, forward))))
    slope = Shape(np.concatenate(rows), geometry.grid_indices(2, columns))
    return around(slope)


def _paving(chance: Chance) -> np.ndarray:
    """Flagstones, 8 x 8 to a texture of 2.4 m times 2: each stone has its own shade."""
    size, stones = 512, 8
    noise = Noise(chance)
    y, x = np.mgrid[0:size, 0:size] * (stones / size)
    shift = 0.5 * (np.floor(y) % 2)
    u, v = (x + shift) % 1.0, y % 1.0
    column = np.floor(x + shift).astype(int) % stones
    shade = chance.uniform(0.8, 1.12, (stones, stones))[np.floor(y).astype(int), column]
    dark = chance.uniform(0.0, 1.0, (stones, stones))[np.floor(y).astype(int), column] < 0.18
    color = np.where(dark[..., None], from_srgb("#b59c86"), from_srgb("#dcd4c8"))
    color = color * shade[..., None] * (1 + 0.12 * noise(6 * x, 6 * y, 3))[..., None]
    edge = np.minimum(np.minimum(u, 1 - u), np.minimum(v, 1 - v))
    grout = np.clip(edge / 0.035, 0.35, 1.0)[..., None]
    return np.clip(color * grout, 0.0, 1.0)


def add_fountain(scene: Scene) -> None:
    marble = scene_parts.diffuse(scene, from_srgb("#e6ddd0"))
    water = scene_parts.glossy(scene, from_srgb("#0d2b33"), roughness=0.22)
    r = BASIN
    wall = [(r, 0), (r, 0.12), (r - 0.2, 0.18), (r - 0.2, 0.55), (r - 0.08, 0.6), (r - 0.08, 0.68),
            (r - 0.4, 0.68)]  # fmt: skip
    stem = [(r - 0.4, 0.1), (0.3, 0.1), (0.22, 0.8), (0.16, 1.3), (0.3, 1.42)]
    bowl = [(0.85, 1.58), (0.9, 1.66), (0.82, 1.66), (0.2, 1.55), (0.1, 1.9), (0.0, 1.95)]
    scene_parts.add(scene, "fountain", geometry.lathe(wall + stem + bowl, 48), marble)
    scene_parts.add(scene, "water", geometry.lathe([(r - 0.4, 0.52), (0.25, 0.52)], 48), water)
