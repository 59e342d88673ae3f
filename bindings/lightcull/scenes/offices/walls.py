"""Walls, floors and ceilings of the `offices` scene: the inner surfaces of its rooms, corridors and
passage, with doorways cut into them."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from ...scene import Scene
from .. import geometry, scene_parts
from ..color import from_srgb
from ..facade import Face
from ..geometry import Shape
from ..random_numbers import Chance, Noise
from . import plan
from .plan import CORRIDOR, DEPTH, DOOR_HEIGHT, HALF_LENGTH, HEIGHT, PASSAGE, WALL, WIDTH, Room

WHITE, CORRIDOR_PAINT = "#d9d5cc", "#cfd2cd"
CARPETS = ("#7d8794", "#94806f", "#74866f", "#9a958b")
BASE = 0.09
"""Height of the skirting."""


def add_walls(scene: Scene, rooms: list[Room]) -> None:
    paints: dict[str, list[np.ndarray]] = defaultdict(list)
    skirting: list[np.ndarray] = []
    for room in rooms:
        for i, face in enumerate(_room_faces(room)):
            opening = room.door.edges if i == 0 else None
            if i == 0:
                # From the room's own x, whose zero is in its middle.
                opening = tuple(edge + WIDTH / 2 for edge in opening)
            paint = room.accent if i == room.accent_wall else WHITE
            paints[paint].append(_wall(face, opening))
            skirting.append(_skirting(face, opening))
        face, opening = _corridor_side(room)
        paints[CORRIDOR_PAINT].append(_wall(face, opening))
        skirting.append(_skirting(face, opening))
    for face in _other_faces():
        paints[CORRIDOR_PAINT].append(_wall(face, None))
        skirting.append(_skirting(face, None))
    for paint, walls in paints.items():
        material = scene_parts.diffuse(scene, from_srgb(paint))
        scene_parts.add(scene, f"walls {paint}", geometry.quads(np.concatenate(walls)), material)
    wood = scene_parts.diffuse(scene, from_srgb("#4a4038"))
    scene_parts.add(scene, "skirting", geometry.quads(np.concatenate(skirting)), wood)


def _room_faces(room: Room) -> list[Face]:
    """The wall of the door, then the others."""
    half = WIDTH / 2
    return [
        room.face((-half, 0, 0), (1, 0, 0), WIDTH),
        room.face((half, 0, DEPTH), (-1, 0, 0), WIDTH),
        room.face((-half, 0, DEPTH), (0, 0, -1), DEPTH),
        room.face((half, 0, 0), (0, 0, 1), DEPTH),
    ]


def _corridor_side(room: Room) -> tuple[Face, tuple[float, float]]:
    """The wall of a room as the corridor has it, and where the doorway is in it."""
    # The last wall of a corridor's side ends where the passage begins, half a wall further on.
    inner = {plan.COLUMNS // 2 - 1: 1, plan.COLUMNS // 2: -1}.get(room.column, 0)
    inner *= 1 if room.yaw == 0 else -1
    low = -plan.COLUMN_PITCH / 2 - (WALL / 2 if inner < 0 else 0.0)
    high = plan.COLUMN_PITCH / 2 + (WALL / 2 if inner > 0 else 0.0)
    left, right = room.door.edges
    face = room.face((high, 0, -WALL), (-1, 0, 0), high - low)
    return face, (high - right, high - left)


def _other_faces() -> list[Face]:
    """Ends of the corridors, sides and ends of the passage."""
    faces = []
    half, reach = CORRIDOR / 2, PASSAGE / 2

    def face(x: float, z: float, right: tuple, width: float) -> None:
        faces.append(Face(np.array((x, 0.0, z)), np.array(right, dtype=float), width, HEIGHT))

    for corridor in range(plan.CORRIDORS):
        z = plan.corridor_z(corridor)
        face(-HALF_LENGTH, z + half, (0, 0, -1), CORRIDOR)
        face(HALF_LENGTH, z - half, (0, 0, 1), CORRIDOR)
    for corridor in range(plan.CORRIDORS - 1):
        (_, _, low), (_, _, high) = plan.passage_bounds(corridor)
        face(-reach, high, (0, 0, -1), high - low)
        face(reach, low, (0, 0, 1), high - low)
    face(-reach, plan.corridor_z(0) - half, (1, 0, 0), PASSAGE)
    face(reach, plan.corridor_z(plan.CORRIDORS - 1) + half, (-1, 0, 0), PASSAGE)
    return faces


def _wall(face: Face, opening: tuple[float, float] | None) -> np.ndarray:
    """(K, 4, 3) quadrilaterals of a wall with or without a doorway."""
    if opening is None:
        return face.rectangles(0.0, face.width, 0.0, face.height)
    left, right = opening
    return face.rectangles(
        np.array((0.0, right, left)),
        np.array((left, face.width, right)),
        np.array((0.0, 0.0, DOOR_HEIGHT)),
        face.height,
    )


def _skirting(face: Face, opening: tuple[float, float] | None) -> np.ndarray:
    """(K, 4, 3): its front and its top."""
    out = 0.014
    left, right = np.array(
        ((0.0, face.width),)
        if opening is None
        else ((0.0, opening[0] - 0.05), (opening[1] + 0.05, face.width))
    ).T
    front = face.rectangles(left, right, 0.0, BASE, out)
    top = face.points(
        np.stack((left, right, right, left), axis=-1), np.full(4, BASE), np.array((out, out, 0, 0))
    )
    return np.concatenate((front, top))


def add_floors_and_ceilings(scene: Scene, chance: Chance, rooms: list[Room]) -> None:
    by_carpet: list[list[Shape]] = [[] for _ in CARPETS]
    for room in rooms:
        floor = plan.floor_quad(room.bounds(), tile=1.0)
        by_carpet[int(chance.uniform(0, len(CARPETS)))].append(floor)
    pile = _carpet(chance)
    for code, floors in zip(CARPETS, by_carpet):
        carpet = scene_parts.diffuse(scene, from_srgb(code), pile)
        scene_parts.add(scene, f"carpets {code}", geometry.merge(floors), carpet)

    halls = [plan.corridor_bounds(i) for i in range(plan.CORRIDORS)]
    halls += [plan.passage_bounds(i) for i in range(plan.CORRIDORS - 1)]
    stone = scene_parts.glossy(scene, from_srgb("#8f8a80"), 0.35, texture=_stone(chance))
    floors = geometry.merge(plan.floor_quad(hall, tile=1.2) for hall in halls)
    scene_parts.add(scene, "corridor floors", floors, stone)

    spaces = [room.bounds() for room in rooms] + halls
    tiles = scene_parts.diffuse(scene, from_srgb("#d2d0ca"), _ceiling_tiles(chance))
    ceilings = geometry.merge(plan.ceiling_quad(space, tile=1.2) for space in spaces)
    scene_parts.add(scene, "ceilings", ceilings, tiles)


def _carpet(chance: Chance) -> np.ndarray:
    """Four tiles of half a metre, laid crosswise."""
    pixels = 64
    y, x = np.mgrid[0:pixels, 0:pixels]
    across = (x // (pixels // 2) + y // (pixels // 2)) % 2 == 0
    rib = np.where(across, x, y) % 4 < 2
    shade = np.where(across, 0.86, 0.78) + 0.08 * rib + chance.uniform(-0.06, 0.06, x.shape)
    return np.repeat(shade[..., None], 3, axis=-1)


def _stone(chance: Chance) -> np.ndarray:
    """Four slabs of 0.6 m with dark joints."""
    pixels = 96
    y, x = np.mgrid[0:pixels, 0:pixels]
    slab = pixels // 2
    shade = 0.82 + 0.1 * Noise(chance)(x / 6.0, y / 6.0, 3) / 1.75
    shade += 0.05 * chance.uniform(-1, 1, (2, 2))[y // slab, x // slab]
    shade[(x % slab == 0) | (y % slab == 0)] = 0.45
    return np.repeat(np.clip(shade, 0, 1)[..., None], 3, axis=-1)


def _ceiling_tiles(chance: Chance) -> np.ndarray:
    """Four mineral tiles of 0.6 m between rails."""
    pixels = 96
    y, x = np.mgrid[0:pixels, 0:pixels]
    shade = np.where(chance.uniform(shape=x.shape) < 0.06, 0.72, 0.92)
    rail = pixels // 2
    shade[(x % rail < 2) | (y % rail < 2)] = 1.0
    shade[(x % rail == 2) | (y % rail == 2)] = 0.6
    return np.repeat(shade[..., None], 3, axis=-1)
