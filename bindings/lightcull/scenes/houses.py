"""The houses of the `city` scene: blocks of lots, fronts with windows, shops and signs."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..scene import Scene
from . import geometry, interiors, scene_parts
from .color import blackbody, from_srgb, with_luminance
from .facade import Face, Grid, pierced_wall
from .geometry import Shape
from .random_numbers import Chance

BLOCK = 54.0
"""Side of a block, metres."""
LOTS = 3
LOT = BLOCK / LOTS
KERB = 0.15
"""Height of the pavement, on which houses stand."""
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
        scene_parts.add_lights(
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


def build_block(town: Town, chance: Chance, x: float, z: float) -> None:
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
            build_house(town, chance, low, int(storeys[row, column]), sides)


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


def build_house(
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


def _furnish_roof(town: Town, chance: Chance, brick: int, low: np.ndarray, height: float) -> None:
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
                geometry.box(
                    (leg[0] - 0.1, top, leg[1] - 0.1), (leg[0] + 0.1, top + 2.2, leg[1] + 0.1)
                )
            )


def add_town(scene: Scene, town: Town) -> None:
    for code, walls, bodies in zip(BRICKS, town.walls, town.bodies):
        shape = geometry.merge((geometry.quads(np.concatenate(walls)), *bodies))
        scene_parts.add(scene, f"houses {code}", shape, scene_parts.diffuse(scene, from_srgb(code)))
    glass = scene_parts.glossy(scene, np.full(3, 0.02), roughness=0.03)
    scene_parts.add(scene, "dark windows", geometry.quads(np.concatenate(town.glass)), glass)
    cloth = scene_parts.diffuse(scene, from_srgb("#7d2f2a"))
    scene_parts.add(scene, "awnings", geometry.quads(np.concatenate(town.awnings)), cloth)
    town.windows.add_to(scene, "lit windows", town.rooms.texels)
    town.shops.add_to(scene, "shop windows", town.goods.texels)
    scene_parts.add_lights(
        scene,
        "signs",
        geometry.merge(town.signs),
        np.repeat(np.array(town.sign_radiance), len(town.signs[0].indices), axis=0),
    )
