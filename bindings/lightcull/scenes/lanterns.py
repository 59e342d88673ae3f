"""A palace of four courtyards at night, hung with 2,736 lanterns; the camera is in one of them.

Each lantern is an icosahedron of 20 lights; its power is log-normal.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import filling, geometry
from .chance import Chance, Noise
from .color import from_srgb, with_luminance
from .geometry import Shape, faceted
from .plants import leafy_balls

if TYPE_CHECKING:
    from lightcull import Scene

STRINGS, PER_STRING = 2, 12
"""In each court."""
LANTERNS = 2736
POWER_SIGMA = 1.5

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


def fill(scene: Scene) -> None:
    chance = Chance(2736)
    _add_architecture(scene, chance)
    _add_fountains(scene)
    crowns = _add_trees(scene, chance)
    _add_lanterns(scene, chance, crowns)
    scene.set_camera(
        origin=(8.0, 1.7, 8.6), target=(10.0, 2.95, -6.0), vertical_fov=np.radians(58.0)
    )


def _in_courts(shape: Shape) -> Shape:
    return geometry.scatter(shape, COURTS)


def _around_courts(bay: Shape) -> Shape:
    """A bay, built about x = 0 with the court towards +z, set up along all sides of both courts."""
    along_x = np.arange(-HALF_WIDTH + BAY / 2, HALF_WIDTH, BAY)
    along_z = np.arange(-HALF_LENGTH + BAY / 2, HALF_LENGTH, BAY)
    places, yaws = [], []
    for side, yaw in ((-1, 0.0), (1, np.pi)):
        places += [(x, 0.0, side * HALF_LENGTH) for x in along_x]
        yaws += [yaw] * len(along_x)
    for side, yaw in ((-1, np.pi / 2), (1, -np.pi / 2)):
        places += [(side * HALF_WIDTH, 0.0, z) for z in along_z]
        yaws += [yaw] * len(along_z)
    return _in_courts(geometry.scatter(bay, np.array(places), yaws=np.array(yaws)))


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
    return _in_courts(
        geometry.merge(
            (
                geometry.box((-x1, bottom, -z1), (x1, top, -z0)),
                geometry.box((-x1, bottom, z0), (x1, top, z1)),
                geometry.box((-x1, bottom, -z0), (-x0, top, z0)),
                geometry.box((x0, bottom, -z0), (x1, top, z0)),
            )
        )
    )


def _add_architecture(scene: Scene, chance: Chance) -> None:
    stone = filling.diffuse(scene, from_srgb("#dcd6cc"))
    wall = filling.diffuse(scene, from_srgb("#d0b4a0"))
    trim = filling.diffuse(scene, from_srgb("#ece6dc"))
    tiles = filling.diffuse(scene, from_srgb("#a5583a"))
    wood = filling.diffuse(scene, from_srgb("#6b4a33"))

    (low, ceiling), (gallery, eaves) = STOREYS
    arches = [_arch(2.9, ceiling), _arch(gallery + 2.1, eaves)]
    columns = [_column(low, 2.9), _column(gallery, gallery + 2.1)]
    filling.add(scene, "arches", _around_courts(geometry.merge(arches)), stone)
    filling.add(scene, "columns", _around_courts(geometry.merge(columns)), trim)
    filling.add(scene, "balustrade", _around_courts(_balustrade(gallery)), trim)

    floors = [_ring(-0.28, DEPTH, ceiling, gallery), _ring(-0.28, DEPTH, eaves, eaves + 0.3)]
    filling.add(scene, "floors", geometry.merge(floors), trim)
    filling.add(scene, "walls", _ring(DEPTH, DEPTH + WALL, 0.0, eaves + 0.3), wall)
    doors = geometry.merge((_door(low), _door(gallery)))
    filling.add(scene, "doors", _around_courts(doors), wood)
    filling.add(scene, "roof", _roof(eaves + 0.3), tiles)

    across, along = HALF_WIDTH + DEPTH, HALF_LENGTH + DEPTH
    ground = geometry.quad(
        (-across, 0.0, along), (2 * across, 0, 0), (0, 0, -2 * along),
        (across / 2.4, along / 2.4),
    )  # fmt: skip
    filling.add(scene, "ground", _in_courts(ground), filling.diffuse(scene, np.ones(3), _paving(chance)))


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
    return _around_courts(slope)


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


def _add_fountains(scene: Scene) -> None:
    marble = filling.diffuse(scene, from_srgb("#e6ddd0"))
    water = filling.glossy(scene, from_srgb("#0d2b33"), roughness=0.22)
    basin = [(2.3, 0), (2.3, 0.12), (2.1, 0.18), (2.1, 0.55), (2.22, 0.6), (2.22, 0.68),
             (1.9, 0.68), (1.9, 0.1), (0.3, 0.1), (0.22, 0.8), (0.16, 1.3), (0.3, 1.42),
             (0.85, 1.58), (0.9, 1.66), (0.82, 1.66), (0.2, 1.55), (0.1, 1.9), (0.0, 1.95)]  # fmt: skip
    filling.add(scene, "fountains", _in_courts(geometry.lathe(basin, 48)), marble)
    surface = [(1.9, 0.52), (0.25, 0.52)]
    filling.add(scene, "water", _in_courts(geometry.lathe(surface, 48)), water)


def _add_trees(scene: Scene, chance: Chance) -> np.ndarray:
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


def _add_lanterns(scene: Scene, chance: Chance, crowns: np.ndarray) -> None:
    radii = chance.uniform(0.06, 0.11, LANTERNS)
    over_court, strings = _strings(chance)
    in_bays = _in_bays(chance)
    hung = np.concatenate((over_court, in_bays))
    drop = np.zeros_like(hung)
    drop[:, 1] = np.concatenate(
        (chance.uniform(0.2, 0.5, len(over_court)), chance.uniform(0.2, 1.3, len(in_bays)))
    )
    centres = [hung - drop, _on_columns(chance), _on_arches(), _on_balustrade()]
    centres.append(_in_trees(chance, crowns))
    standing = LANTERNS - sum(map(len, centres))
    centres.append(_on_the_ground(chance, radii[-standing:]))

    lanterns = geometry.scatter(
        geometry.icosahedron(), np.concatenate(centres), radii, chance.uniform(0, 2 * np.pi, LANTERNS)
    )
    filling.add_lights(scene, "lanterns", lanterns, np.repeat(_radiance(chance, radii), 20, axis=0))
    cord = filling.diffuse(scene, np.full(3, 0.03))
    filling.add(scene, "strings", geometry.tubes(strings, 0.006), cord)
    filling.add(scene, "hangers", geometry.tubes(np.stack((hung, hung - drop), axis=1), 0.003), cord)


def _radiance(chance: Chance, radii: np.ndarray) -> np.ndarray:
    """(LANTERNS, 3): log-normal power, spread over the lantern's surface."""
    papers = np.array([from_srgb(code) for code in
                       ("#ffa640", "#ff9438", "#ffbf5c", "#ff7a3a", "#ff5a36", "#ffd48a")])  # fmt: skip
    tint = chance.pick(papers, LANTERNS)
    odd = chance.uniform(shape=LANTERNS) < 0.06
    tint[odd] = chance.pick(
        np.array([from_srgb("#ff4f86"), from_srgb("#58d0c0"), from_srgb("#9d7bff")]), odd.sum()
    )
    power = 1.6 * chance.log_normal(POWER_SIGMA, LANTERNS)
    # A sphere's M = pi L over its area; the icosahedron has four fifths of it.
    return with_luminance(tint, power / (np.pi * 4 * np.pi * radii**2))


def _strings(chance: Chance) -> tuple[np.ndarray, np.ndarray]:
    """Points that lanterns hang from (K, 3), and the strings across the courts (S, P, 3)."""
    count = STRINGS * len(COURTS)
    middle_z = np.linspace(-0.5, 0.5, STRINGS) * HALF_LENGTH
    x = np.repeat(COURTS[:, 0], STRINGS)
    z = (COURTS[:, 2:] + middle_z).ravel()
    slant = np.where(np.arange(count) % 2, 1.0, -1.0) * chance.uniform(0.5, 3.0, count)
    ends_z = np.stack((z - slant, z + slant))
    ends_y = chance.uniform(5.4, 6.8, (2, count))
    sag = chance.uniform(1.0, 2.0, count)

    def along(s: np.ndarray) -> np.ndarray:
        across = x[:, None] + HALF_WIDTH * (2 * s - 1)
        y = ends_y[0][:, None] * (1 - s) + ends_y[1][:, None] * s
        y = y - 4 * sag[:, None] * s * (1 - s)
        return np.stack((across, y, ends_z[0][:, None] * (1 - s) + ends_z[1][:, None] * s), axis=-1)

    places = along((np.arange(PER_STRING) + 0.5) / PER_STRING)
    return places.reshape(-1, 3), along(np.linspace(0, 1, 25))


def _around(chance: Chance, middle: np.ndarray, each: int, near: float, far: float) -> np.ndarray:
    """`each` points about each of (K, 3), at a level distance between near and far metres."""
    count = len(middle) * each
    angle = chance.uniform(0, 2 * np.pi, count)
    away = np.sqrt(chance.uniform(near**2, far**2, count))
    offset = np.column_stack((away * np.cos(angle), np.zeros(count), away * np.sin(angle)))
    return np.repeat(middle, each, axis=0) + offset


def _places_around_courts(x: float, y: float, z: float) -> np.ndarray:
    """(K, 3): a point of a bay, in every bay of a storey."""
    return _around_courts(Shape(np.array([(x, y, z)]), np.zeros((0, 3), dtype=np.uint32))).positions


def _in_bays(chance: Chance) -> np.ndarray:
    """Points on the ceilings of the arcades."""
    middles = [_places_around_courts(0.0, ceiling, -DEPTH / 2) for _, ceiling in STOREYS]
    return _around(chance, np.concatenate(middles), 1, 0.0, 1.0)


def _on_columns(chance: Chance) -> np.ndarray:
    """Garlands wound around the columns of the ground floor."""
    feet = _places_around_courts(-BAY / 2, 0.0, 0.0)
    each = 6
    turn = np.tile(np.arange(each) / each, len(feet))
    angle = 2 * np.pi * 2.0 * turn + np.repeat(chance.uniform(0, 2 * np.pi, len(feet)), each)
    height = 0.55 + 2.0 * turn
    offset = 0.34 * np.column_stack((np.cos(angle), np.zeros_like(angle), np.sin(angle)))
    offset[:, 1] = height
    return np.repeat(feet, each, axis=0) + offset


def _on_arches() -> np.ndarray:
    """Lanterns along the edges of the arches, on the side of the court."""
    angle = np.pi * (np.arange(4) + 0.5) / 4
    reach = BAY / 2 - COLUMN_RADIUS + 0.16
    rows = []
    for spring in (STOREYS[0][0] + 2.9, STOREYS[1][0] + 2.1):
        for x, y in zip(reach * np.cos(angle), spring + 0.9 * reach * np.sin(angle)):
            rows.append(_places_around_courts(x, y, 0.36))
    return np.concatenate(rows)


def _on_balustrade() -> np.ndarray:
    """Lanterns along the rail of the gallery, in swags on the side of the court."""
    x = np.linspace(-0.8, 0.8, 2)
    heights = STOREYS[1][0] + 0.5 + 0.2 * (x / 1.2) ** 2
    return np.concatenate([_places_around_courts(a, b, 0.26) for a, b in zip(x, heights)])


def _in_trees(chance: Chance, crowns: np.ndarray) -> np.ndarray:
    out = chance.directions(4 * len(crowns))
    return np.repeat(crowns, 4, axis=0) + out * chance.uniform(0.75, 0.95, len(out))[:, None]


def _on_the_ground(chance: Chance, radii: np.ndarray) -> np.ndarray:
    """Lanterns that stand at the feet of the columns, about the fountains and along a path."""
    feet = _places_around_courts(-BAY / 2, 0.0, 0.35)
    at_columns = _around(chance, feet, 1, 0.25, 0.75)
    each = (len(radii) - len(at_columns)) // len(COURTS)
    ring = each // 3
    angle = 2 * np.pi * np.arange(ring) / ring
    about_fountain = 2.8 * np.column_stack((np.cos(angle), np.zeros(ring), np.sin(angle)))
    step = np.arange(each - ring)
    side = np.where(step % 2, 1.2, -1.2)
    away = 3.6 + (HALF_WIDTH - 4.2) * (step // 4) / (len(step) // 4)
    along_path = np.column_stack((np.where(step % 4 < 2, away, -away), np.zeros(len(step)), side))
    in_courts = [court + np.concatenate((about_fountain, along_path)) for court in COURTS]
    places = np.concatenate((at_columns, *in_courts))
    return places + np.column_stack((np.zeros(len(radii)), radii, np.zeros(len(radii))))
