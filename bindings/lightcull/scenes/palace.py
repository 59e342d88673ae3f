"""The palace of the `lanterns` scene: courtyards of equal shape between two storeys of arcades."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import filling, geometry
from .chance import Chance, Noise
from .color import from_srgb
from .geometry import Shape, faceted
from .plants import leafy_balls

if TYPE_CHECKING:
    from lightcull import Scene

HALF_WIDTH, HALF_LENGTH = 12.0, 9.0
"""Of a court between the columns, along x and z."""
BAY, DEPTH, WALL = 3.0, 3.2, 0.4
"""Width of a bay, depth of the arcades, and of the wall behind them."""
STOREYS = ((0.0, 4.4), (4.7, 8.2))
"""Floor and ceiling of each."""
COLUMN_RADIUS = 0.2
COURTS = np.array(
    [(x, 0.0, z) for x in (0.0, 2 * (HALF_WIDTH + DEPTH + WALL))
     for z in (0.0, -2 * (HALF_LENGTH + DEPTH + WALL))]
)  # fmt: skip
"""Their centres; the camera is in the first."""


def in_courts(shape: Shape) -> Shape:
    return geometry.scatter(shape, COURTS)


def around_courts(bay: Shape) -> Shape:
    """A bay, built about x = 0 with the court towards +z, set up along all sides of all courts."""
    along_x = np.arange(-HALF_WIDTH + BAY / 2, HALF_WIDTH, BAY)
    along_z = np.arange(-HALF_LENGTH + BAY / 2, HALF_LENGTH, BAY)
    places, yaws = [], []
    for side, yaw in ((-1, 0.0), (1, np.pi)):
        places += [(x, 0.0, side * HALF_LENGTH) for x in along_x]
        yaws += [yaw] * len(along_x)
    for side, yaw in ((-1, np.pi / 2), (1, -np.pi / 2)):
        places += [(side * HALF_WIDTH, 0.0, z) for z in along_z]
        yaws += [yaw] * len(along_z)
    return in_courts(geometry.scatter(bay, np.array(places), yaws=np.array(yaws)))


def places_around_courts(x: float, y: float, z: float) -> np.ndarray:
    """(K, 3): a point of a bay, in every bay of a storey."""
    return around_courts(Shape(np.array([(x, y, z)]), np.zeros((0, 3), dtype=np.uint32))).positions


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


def _balustrade(floor: float) -> Shape:
    reach = BAY / 2 - COLUMN_RADIUS
    rail = geometry.box((-reach, floor + 0.86, -0.1), (reach, floor + 0.98, 0.1))
    foot = geometry.box((-reach, floor, -0.1), (reach, floor + 0.1, 0.1))
    post = geometry.lathe(
        [(0.055, 0.1), (0.075, 0.3), (0.035, 0.5), (0.035, 0.72), (0.055, 0.86)], 8
    )
    x = np.linspace(-reach + 0.15, reach - 0.15, 9)
    posts = geometry.scatter(post, np.column_stack((x, np.full(9, floor), np.zeros(9))))
    return geometry.merge((faceted(rail), faceted(foot), posts))


def _ring(inner: float, outer: float, bottom: float, top: float) -> Shape:
    """A flat frame about each court, from `inner` to `outer` metres behind the columns."""
    x0, z0 = HALF_WIDTH + inner, HALF_LENGTH + inner
    x1, z1 = HALF_WIDTH + outer, HALF_LENGTH + outer
    return in_courts(
        geometry.merge(
            (
                geometry.box((-x1, bottom, -z1), (x1, top, -z0)),
                geometry.box((-x1, bottom, z0), (x1, top, z1)),
                geometry.box((-x1, bottom, -z0), (-x0, top, z0)),
                geometry.box((x0, bottom, -z0), (x1, top, z0)),
            )
        )
    )


def add_architecture(scene: Scene, chance: Chance) -> None:
    stone = filling.diffuse(scene, from_srgb("#dcd6cc"))
    wall = filling.diffuse(scene, from_srgb("#d0b4a0"))
    trim = filling.diffuse(scene, from_srgb("#ece6dc"))
    tiles = filling.diffuse(scene, from_srgb("#a5583a"))
    wood = filling.diffuse(scene, from_srgb("#6b4a33"))

    (low, ceiling), (gallery, eaves) = STOREYS
    arches = [_arch(2.9, ceiling), _arch(gallery + 2.1, eaves)]
    columns = [_column(low, 2.9), _column(gallery, gallery + 2.1)]
    filling.add(scene, "arches", around_courts(geometry.merge(arches)), stone)
    filling.add(scene, "columns", around_courts(geometry.merge(columns)), trim)
    filling.add(scene, "balustrade", around_courts(_balustrade(gallery)), trim)

    floors = [_ring(-0.28, DEPTH, ceiling, gallery), _ring(-0.28, DEPTH, eaves, eaves + 0.3)]
    filling.add(scene, "floors", geometry.merge(floors), trim)
    filling.add(scene, "walls", _ring(DEPTH, DEPTH + WALL, 0.0, eaves + 0.3), wall)
    doors = geometry.merge((_door(low), _door(gallery)))
    filling.add(scene, "doors", around_courts(doors), wood)
    filling.add(scene, "roof", _roof(eaves + 0.3), tiles)

    across, along = HALF_WIDTH + DEPTH, HALF_LENGTH + DEPTH
    ground = geometry.quad(
        (-across, 0.0, along), (2 * across, 0, 0), (0, 0, -2 * along),
        (across / 2.4, along / 2.4),
    )  # fmt: skip
    filling.add(
        scene, "ground", in_courts(ground), filling.diffuse(scene, np.ones(3), _paving(chance))
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
    return around_courts(slope)


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
    color = np.where(dark[..., None], from_srgb("#857468"), from_srgb("#b8aea2"))
    color = color * shade[..., None] * (1 + 0.12 * noise(6 * x, 6 * y, 3))[..., None]
    edge = np.minimum(np.minimum(u, 1 - u), np.minimum(v, 1 - v))
    grout = np.clip(edge / 0.035, 0.35, 1.0)[..., None]
    return np.clip(color * grout, 0.0, 1.0)


def add_fountains(scene: Scene) -> None:
    marble = filling.diffuse(scene, from_srgb("#e6ddd0"))
    water = filling.glossy(scene, from_srgb("#0d2b33"), roughness=0.22)
    wall = [(2.3, 0), (2.3, 0.12), (2.1, 0.18), (2.1, 0.55), (2.22, 0.6), (2.22, 0.68), (1.9, 0.68)]
    stem = [(1.9, 0.1), (0.3, 0.1), (0.22, 0.8), (0.16, 1.3), (0.3, 1.42)]
    bowl = [(0.85, 1.58), (0.9, 1.66), (0.82, 1.66), (0.2, 1.55), (0.1, 1.9), (0.0, 1.95)]
    filling.add(scene, "fountains", in_courts(geometry.lathe(wall + stem + bowl, 48)), marble)
    surface = [(1.9, 0.52), (0.25, 0.52)]
    filling.add(scene, "water", in_courts(geometry.lathe(surface, 48)), water)


def add_trees(scene: Scene, chance: Chance) -> np.ndarray:
    """Trees in pots; returns the centres of their crowns, (K, 3)."""
    clay = filling.diffuse(scene, from_srgb("#b4623f"))
    bark = filling.diffuse(scene, from_srgb("#5a4433"))
    leaf = filling.diffuse(scene, from_srgb("#5d7d3a"))
    feet = np.concatenate(
        [court + [(x, 0.0, z) for x in (-4.5, 4.5) for z in (-5.2, 5.2)] for court in COURTS]
    )
    pot = geometry.lathe(
        [(0.36, 0), (0.52, 0.62), (0.6, 0.62), (0.6, 0.74), (0.5, 0.74), (0.46, 0.62), (0, 0.62)],
        24,
    )
    trunk = geometry.lathe([(0.08, 0.6), (0.05, 2.0)], 10)
    filling.add(scene, "pots", geometry.scatter(pot, feet), clay)
    filling.add(scene, "trunks", geometry.scatter(trunk, feet), bark)
    crowns = feet + (0.0, 2.25, 0.0)
    filling.add(scene, "leaves", leafy_balls(chance, crowns, (0.4, 0.72), 900), leaf)
    return crowns
