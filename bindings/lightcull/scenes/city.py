"""A street at night in a town of 36 blocks: lit windows, shops, neon signs, street lamps, cars.

Nearly all of the lights are in other streets than the camera.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from . import filling, geometry, interiors
from .chance import Chance
from .color import blackbody, from_srgb, with_luminance
from .facade import Face, Grid, pierced_wall
from .geometry import Shape
from .plants import leafy_balls

if TYPE_CHECKING:
    from lightcull import Scene

BLOCKS = 6
BLOCK, STREET = 54.0, 18.0
PITCH = BLOCK + STREET
LOTS = 3
LOT = BLOCK / LOTS
ROAD = 11.0
"""Width of the carriageway; what is left of the street is pavement."""
KERB = 0.15
VISTA = -82.0
"""z of the front of the tower that closes the camera's street."""
LAMPS_PER_BLOCK = 5
"""On each side of a street."""
SHOP_HEIGHT, FLOOR_HEIGHT = 4.6, 3.3
REVEAL = 0.22
LIT_WINDOWS = 0.34

BRICKS = ("#9c7263", "#b09480", "#c4b196", "#8a8078", "#cfc6b6", "#7d858f", "#a87a68", "#b5b0a8")
NEON = ("#ff2d6f", "#19d3ff", "#ff3b1f", "#29ff8a", "#b04bff", "#ffd21f", "#ff6a00", "#4d7dff")


@dataclass
class Panes:
    """Lit panes: quadrilaterals (K, 4, 3), radiance (K, 3), texture coordinates (K, 4, 2)."""

    corners: list[np.ndarray] = field(default_factory=list)
    radiance: list[np.ndarray] = field(default_factory=list)
    uvs: list[np.ndarray] = field(default_factory=list)

    def add(self, corners: np.ndarray, radiance: np.ndarray, uvs: np.ndarray) -> None:
        self.corners.append(corners)
        self.radiance.append(radiance)
        self.uvs.append(uvs)

    def add_to(self, scene: Scene, name: str, texture: np.ndarray) -> None:
        filling.add_lights(
            scene,
            name,
            geometry.quads(np.concatenate(self.corners), np.concatenate(self.uvs)),
            np.repeat(np.concatenate(self.radiance), 2, axis=0),
            texture=texture,
        )


@dataclass
class Town:
    """What has been built so far, quadrilaterals (K, 4, 3) by what they become."""

    rooms: interiors.Sheet
    goods: interiors.Sheet
    walls: list[list[np.ndarray]] = field(default_factory=lambda: [[] for _ in BRICKS])
    glass: list[np.ndarray] = field(default_factory=list)
    windows: Panes = field(default_factory=Panes)
    shops: Panes = field(default_factory=Panes)
    bodies: list[list[Shape]] = field(default_factory=lambda: [[] for _ in BRICKS])
    signs: list[Shape] = field(default_factory=list)
    sign_radiance: list[np.ndarray] = field(default_factory=list)
    awnings: list[np.ndarray] = field(default_factory=list)


def fill(scene: Scene) -> None:
    chance = Chance(1928)
    town = Town(interiors.rooms(chance), interiors.shops(chance))
    centres = (np.arange(BLOCKS) + 0.5 - BLOCKS / 2) * PITCH
    for z in centres:
        for x in centres:
            _build_block(town, chance, x, z)
    _build_house(town, chance, np.array((-LOT / 2, VISTA - LOT)), 17, ["south"])
    _add_town(scene, town)
    _add_ground(scene, centres)
    _add_lamps(scene, chance, centres)
    _add_cars(scene, chance)
    _add_trees(scene, chance)
    scene.set_camera(
        origin=(-2.6, 2.6, 97.0), target=(1.2, 8.2, 40.0), vertical_fov=np.radians(58.0)
    )


def _build_block(town: Town, chance: Chance, x: float, z: float) -> None:
    """Houses along the four sides of a block; its middle is a yard."""
    storeys = chance.uniform(3.0, 9.0, (LOTS, LOTS)) ** 1.25
    towers = chance.uniform(shape=(LOTS, LOTS)) < 0.16
    storeys = np.floor(np.where(towers, 1.7 * storeys + 4, storeys)).astype(int)
    for row in range(LOTS):
        for column in range(LOTS):
            if row == 1 and column == 1:
                continue
            low = np.array((x - BLOCK / 2 + column * LOT, z - BLOCK / 2 + row * LOT))
            sides = [
                side
                for side, outside in (
                    ("west", column == 0),
                    ("east", column == LOTS - 1),
                    ("north", row == 0),
                    ("south", row == LOTS - 1),
                )
                if outside
            ]
            _build_house(town, chance, low, int(storeys[row, column]), sides)


def _face(side: str, low: np.ndarray, height: float) -> Face:
    """A side of the lot whose lowest corner is `low` (x, z)."""
    (x0, z0), (x1, z1) = low, low + LOT
    corner, right = {
        "south": ((x0, z1), (1, 0)),
        "north": ((x1, z0), (-1, 0)),
        "east": ((x1, z1), (0, -1)),
        "west": ((x0, z0), (0, 1)),
    }[side]
    return Face(
        np.array((corner[0], KERB, corner[1])), np.array((right[0], 0.0, right[1])), LOT, height
    )


def _build_house(
    town: Town, chance: Chance, low: np.ndarray, storeys: int, sides: list[str]
) -> None:
    brick = int(chance.uniform(0, len(BRICKS)))
    columns = int(chance.uniform(5, 8))
    height = SHOP_HEIGHT + storeys * FLOOR_HEIGHT
    shops = Grid(0.0, SHOP_HEIGHT, 1, 3, 4.7, 3.0, 0.45)
    windows = Grid(
        SHOP_HEIGHT, FLOOR_HEIGHT, storeys, columns, chance.uniform(0.5, 0.62) * LOT / columns,
        chance.uniform(1.7, 2.2), 0.75,
    )  # fmt: skip
    for side in sides:
        face = _face(side, low, height)
        for grid in (shops, windows):
            town.walls[brick].append(pierced_wall(face, grid, REVEAL))
        _glaze_windows(town, chance, face, windows)
        _glaze_shops(town, chance, face, shops)
        if chance.uniform() < 0.5:
            _hang_sign(town, chance, face)
    _add_body(town, brick, low, height, sides)
    _furnish_roof(town, chance, brick, low, height)


def _glaze_windows(town: Town, chance: Chance, face: Face, grid: Grid) -> None:
    """Two sashes to a window, which show the two halves of one room."""
    left, right, low, high = grid.openings(face)
    middle = 0.5 * (low + high)
    lit = chance.uniform(shape=len(left)) < LIT_WINDOWS * chance.uniform(0.5, 1.5)
    bar = 0.05
    upper = face.rectangles(left, right, middle + bar, high, 0.04 - REVEAL)
    lower = face.rectangles(left, right, low, middle - bar, 0.04 - REVEAL)
    frame = face.rectangles(left, right, middle - bar, middle + bar, 0.06 - REVEAL)
    town.walls[-1].append(frame)
    town.glass += [upper[~lit], lower[~lit]]

    count = int(lit.sum())
    color = blackbody(chance.uniform(2300.0, 3900.0, count))
    cool = chance.uniform(shape=count) < 0.12
    color[cool] = blackbody(chance.uniform(5000.0, 7500.0, int(cool.sum())))
    radiance = with_luminance(color, 1.5 * chance.log_normal(0.8, count))
    room = chance.pick(np.arange(town.rooms.count), count)
    town.windows.add(upper[lit], radiance, town.rooms.uvs(room, 0.5, 1.0))
    town.windows.add(lower[lit], radiance, town.rooms.uvs(room, 0.0, 0.5))


def _glaze_shops(town: Town, chance: Chance, face: Face, grid: Grid) -> None:
    left, right, low, high = grid.openings(face)
    lit = chance.uniform(shape=len(left)) < 0.6
    panes = face.rectangles(left, right, low, high, 0.04 - REVEAL)
    count = int(lit.sum())
    color = blackbody(chance.uniform(2500.0, 5200.0, count))
    radiance = with_luminance(color, 1.9 * chance.log_normal(0.5, count))
    goods = chance.pick(np.arange(town.goods.count), count)
    town.glass.append(panes[~lit])
    town.shops.add(panes[lit], radiance, town.goods.uvs(goods))
    for i in np.flatnonzero(chance.uniform(shape=len(left)) < 0.5):
        a, b, top = left[i] - 0.3, right[i] + 0.3, high[i] + 0.55
        slope = face.points(
            np.array((a, b, b, a)),
            np.array((top - 0.8, top - 0.8, top, top)),
            np.array((1.4, 1.4, 0.0, 0.0)),
        )
        town.awnings.append(slope[None])


def _hang_sign(town: Town, chance: Chance, face: Face) -> None:
    """A neon sign that stands out from the wall, box-shaped, all of its sides glowing."""
    across = chance.uniform(0.12, 0.88) * face.width
    bottom = chance.uniform(4.2, 6.0)
    height = min(chance.uniform(2.2, 5.5), face.height - bottom - 0.5)
    out = chance.uniform(0.9, 1.3)
    thickness = 0.14
    outline = face.points(
        np.array((-1, 1, 1, -1)) * thickness + across, np.zeros(4), np.array((0.25, 0.25, out, out))
    )[:, [0, 2]]
    # prism() wants the outline anticlockwise as seen from above, on a page whose z runs down.
    if _signed_area(outline) > 0:
        outline = outline[::-1]
    town.signs.append(geometry.prism(outline, KERB + bottom, KERB + bottom + height))
    color = from_srgb(NEON[int(chance.uniform(0, len(NEON)))])
    town.sign_radiance.append(with_luminance(color, chance.uniform(1.2, 3.6)))


def _signed_area(outline: np.ndarray) -> float:
    x, z = outline.T
    return 0.5 * float(np.sum(x * np.roll(z, -1) - np.roll(x, -1) * z))


def _add_body(town: Town, brick: int, low: np.ndarray, height: float, sides: list[str]) -> None:
    """What is behind the walls, up to the roof, set back by the reveals on the street sides."""
    back = {side: (REVEAL if side in sides else 0.0) for side in ("west", "east", "north", "south")}
    (x0, z0), (x1, z1) = low, low + LOT
    town.bodies[brick].append(
        geometry.box(
            (x0 + back["west"], KERB, z0 + back["north"]),
            (x1 - back["east"], KERB + height - 0.1, z1 - back["south"]),
        )
    )
    town.bodies[brick].append(
        geometry.box(
            (x0 - 2 * back["west"], KERB + height - 0.1, z0 - 2 * back["north"]),
            (x1 + 2 * back["east"], KERB + height + 0.55, z1 + 2 * back["south"]),
        )
    )


def _furnish_roof(
    town: Town, chance: Chance, brick: int, low: np.ndarray, height: float
) -> None:
    """A stair head, and on some a water tank on legs."""
    top = KERB + height + 0.55
    x, z = low + chance.uniform(0.3, 0.6, 2) * LOT
    town.bodies[brick].append(geometry.box((x, top, z), (x + 3.5, top + 2.6, z + 4.5)))
    if chance.uniform() < 0.4:
        angles = 2 * np.pi * np.arange(10) / 10
        circle = np.column_stack((np.cos(-angles), np.sin(-angles)))
        x, z = low + chance.uniform(0.2, 0.8, 2) * LOT
        town.bodies[3].append(geometry.prism((x, z) + 1.7 * circle, top + 2.2, top + 5.6))
        town.bodies[3].append(geometry.prism((x, z) + 1.9 * circle, top + 5.6, top + 6.9, 0.05))
        for dx, dz in ((-1, -1), (1, -1), (-1, 1), (1, 1)):
            leg = (x + 1.05 * dx, z + 1.05 * dz)
            town.bodies[3].append(
                geometry.box((leg[0] - 0.1, top, leg[1] - 0.1), (leg[0] + 0.1, top + 2.2, leg[1] + 0.1))
            )


def _add_town(scene: Scene, town: Town) -> None:
    for code, walls, bodies in zip(BRICKS, town.walls, town.bodies):
        shape = geometry.merge((geometry.quads(np.concatenate(walls)), *bodies))
        filling.add(scene, f"houses {code}", shape, filling.diffuse(scene, from_srgb(code)))
    glass = filling.glossy(scene, np.full(3, 0.02), roughness=0.03)
    filling.add(scene, "dark windows", geometry.quads(np.concatenate(town.glass)), glass)
    cloth = filling.diffuse(scene, from_srgb("#7d2f2a"))
    filling.add(scene, "awnings", geometry.quads(np.concatenate(town.awnings)), cloth)
    town.windows.add_to(scene, "lit windows", town.rooms.texels)
    town.shops.add_to(scene, "shop windows", town.goods.texels)
    filling.add_lights(
        scene,
        "signs",
        geometry.merge(town.signs),
        np.repeat(np.array(town.sign_radiance), len(town.signs[0].indices), axis=0),
    )


def _add_ground(scene: Scene, centres: np.ndarray) -> None:
    reach = BLOCKS * PITCH / 2 + STREET
    asphalt = filling.diffuse(scene, from_srgb("#5c5d61"))
    road = geometry.quad((-reach, 0, reach), (2 * reach, 0, 0), (0, 0, -2 * reach))
    filling.add(scene, "road", road, asphalt)

    half = BLOCK / 2 + (STREET - ROAD) / 2
    pavements = [
        geometry.box((x - half, -0.1, z - half), (x + half, KERB, z + half))
        for x in centres
        for z in centres
    ]
    paving = filling.diffuse(scene, from_srgb("#8d8a85"))
    filling.add(scene, "pavements", geometry.merge(pavements), paving)

    paint = filling.diffuse(scene, from_srgb("#d8d6cc"))
    filling.add(scene, "markings", _markings(), paint)


def _markings() -> Shape:
    """Dashes along the camera's street, and zebra crossings at its corners."""
    corner_z = (np.arange(BLOCKS + 1) - BLOCKS / 2) * PITCH
    marks = []
    for z in np.arange(VISTA + 1, BLOCKS * PITCH / 2, 6.0):
        if np.abs(corner_z - (z + 1.5)).min() > STREET / 2 + 3.5:
            marks.append(_mark(0.0, z + 1.5, 0.08, 1.5))
    for z in corner_z:
        for side in (-1, 1):
            for x in np.arange(-ROAD / 2 + 0.6, ROAD / 2, 1.1):
                marks.append(_mark(x, z + side * (STREET / 2 + 1.2), 0.28, 1.5))
    return geometry.merge(marks)


def _mark(x: float, z: float, half_width: float, half_length: float) -> Shape:
    return geometry.quad(
        (x - half_width, 0.012, z + half_length), (2 * half_width, 0, 0), (0, 0, -2 * half_length)
    )


def _add_lamps(scene: Scene, chance: Chance, centres: np.ndarray) -> None:
    """Globes on posts along both sides of every street between the blocks."""
    along = (np.arange(LAMPS_PER_BLOCK) + 0.5) * BLOCK / LAMPS_PER_BLOCK - BLOCK / 2
    streets = (np.arange(BLOCKS - 1) + 1 - BLOCKS / 2) * PITCH
    offset = ROAD / 2 + 0.5
    places = []
    for street in streets:
        for block in centres:
            for step in along:
                for side in (-offset, offset):
                    places.append((street + side, KERB, block + step))
                    places.append((block + step, KERB, street + side))
    places = np.array(places)
    in_tower = (np.abs(places[:, 0]) < LOT / 2) & (np.abs(places[:, 2] - VISTA + LOT / 2) < LOT / 2 + 1)
    places = places[~in_tower]

    radius, top = 0.27, 4.0
    post = [(0.2, 0.0), (0.2, 0.25), (0.1, 0.4), (0.07, 0.9), (0.05, top - 0.2), (0.12, top - 0.1),
            (0.12, top - 0.02), (0.0, top)]  # fmt: skip
    iron = filling.diffuse(scene, np.full(3, 0.05))
    filling.add(scene, "lamp posts", geometry.scatter(geometry.lathe(post, 10), places), iron)
    globes = geometry.scatter(
        geometry.icosahedron(), places + (0.0, top + radius, 0.0), radius,
        chance.uniform(0, 2 * np.pi, len(places)),
    )  # fmt: skip
    color = blackbody(np.where(chance.uniform(shape=len(places)) < 0.8, 2600.0, 3900.0))
    radiance = with_luminance(color, 120.0 * chance.log_normal(0.4, len(places)))
    filling.add_lights(scene, "lamps", globes, np.repeat(radiance, 20, axis=0))


def _add_cars(scene: Scene, chance: Chance) -> None:
    """Cars parked along the camera's street, and some that drive there with their lights on."""
    parked_z = np.arange(VISTA + 10, 210.0, 7.5)
    corner_z = (np.arange(BLOCKS + 1) - BLOCKS / 2) * PITCH
    clear = np.abs(parked_z[:, None] - corner_z).min(axis=1) > STREET / 2 + 6
    cars = []
    for side in (-1.0, 1.0):
        z = parked_z[clear & (chance.uniform(shape=len(parked_z)) < 0.7)]
        cars += [(side * (ROAD / 2 - 1.15), 0.0, at + chance.uniform(-0.8, 0.8)) for at in z]
    # None where the camera would look through it.
    parked = np.array([car for car in cars if car[0] > 0 or not 84.0 < car[2] < 102.0])
    driving = np.array([(1.75, 0.0, 79.0), (1.75, 0.0, 24.0), (1.8, 0.0, -41.0),
                        (-1.7, 0.0, 58.0), (-1.75, 0.0, -15.0), (-1.7, 0.0, -60.0)])  # fmt: skip
    places = np.concatenate((parked, driving))
    # Those on the right go away from the camera, towards -Z; they are built facing +Z.
    yaws = np.where(places[:, 0] > 0, np.pi, 0.0)

    paints = ("#23272e", "#7c1d1f", "#c9ccd1", "#27415f", "#4e5a4a")
    body = geometry.merge(
        (
            geometry.prism([(-0.86, -2.15), (-0.86, 2.2), (0.86, 2.2), (0.86, -2.15)], 0.32, 0.62),
            geometry.prism([(-0.86, -2.15), (-0.86, 2.2), (0.86, 2.2), (0.86, -2.15)], 0.62, 0.92, 0.95),
        )
    )  # fmt: skip
    cabin = geometry.prism([(-0.78, -1.8), (-0.78, 0.75), (0.78, 0.75), (0.78, -1.8)], 0.92, 1.42, 0.76)
    wheel = geometry.lathe([(0.0, -0.11), (0.31, -0.11), (0.31, 0.11), (0.0, 0.11)], 16)
    wheel = Shape(wheel.positions[:, [1, 2, 0]], wheel.indices, wheel.normals[:, [1, 2, 0]])
    wheels = geometry.scatter(
        wheel, [(x, 0.31, z) for x in (-0.78, 0.78) for z in (-1.35, 1.4)]
    )
    which = chance.pick(np.arange(len(paints)), len(places))
    for i, code in enumerate(paints):
        own = which == i
        shape = geometry.scatter(body, places[own], yaws=yaws[own])
        filling.add(scene, f"cars {code}", shape, filling.glossy(scene, from_srgb(code), 0.3))
    glass = filling.glossy(scene, np.full(3, 0.015), roughness=0.1)
    filling.add(scene, "car windows", geometry.scatter(cabin, places, yaws=yaws), glass)
    rubber = filling.diffuse(scene, np.full(3, 0.03))
    filling.add(scene, "wheels", geometry.scatter(wheels, places, yaws=yaws), rubber)

    turns = yaws[len(parked) :]
    for name, z, facing, color, luminance in (
        ("headlamps", 2.22, 1.0, blackbody(np.array(4300.0)), 60.0),
        ("tail lamps", -2.17, -1.0, from_srgb("#ff1a10"), 9.0),
    ):
        lamp = geometry.merge(
            [geometry.quad((x - 0.17 * facing, 0.5, z), (0.34 * facing, 0, 0), (0, 0.14, 0))
             for x in (-0.62, 0.62)]
        )  # fmt: skip
        lamps = geometry.scatter(lamp, driving, yaws=turns)
        filling.add_lights(scene, name, lamps, with_luminance(color, luminance))


def _add_trees(scene: Scene, chance: Chance) -> None:
    z = np.concatenate([(np.arange(3) + 0.5) * 14.0 - 21.0 + block for block in (-36, 36, 108)])
    places = np.array([(side * (ROAD / 2 + 0.9), KERB, at + 3.4) for at in z for side in (-1, 1)])
    trunk = geometry.lathe([(0.14, 0.0), (0.09, 3.4)], 8)
    bark = filling.diffuse(scene, from_srgb("#4b3d33"))
    filling.add(scene, "trunks", geometry.scatter(trunk, places), bark)
    crowns = places + (0.0, 4.3, 0.0)
    leaf = filling.diffuse(scene, from_srgb("#56733c"))
    filling.add(scene, "leaves", leafy_balls(chance, crowns, (0.7, 1.6), 700, 0.13), leaf)
