"""A floor of 144 offices at night, on four corridors: most of its lamps are behind walls.

The camera is in one of the offices and looks through its open door.
"""

from __future__ import annotations

import numpy as np

from ...scene import Scene
from ..random_numbers import Chance
from . import corridors, kinds, walls
from .fittings import DOUBLE, SINGLE
from .furniture import Furniture
from .lamps import Lamps
from .plan import BANDS, COLUMNS, Door, Room

SEED = 144
KINDS = (
    *("office",) * 7, *("shared",) * 4, *("meeting",) * 4, *("lounge", "archive") * 2, "servers"
)  # fmt: skip
"""What a room is for, any of them alike."""
ACCENTS = ("#b4553f", "#3f6f7d", "#c79a45", "#5f7a55", "#7a5872", "#38506e")
KELVINS = (2700.0, 3000.0, 3500.0, 4200.0, 5200.0, 6500.0)
LEVEL_SIGMA = 1.0
"""Deviation of the logarithm of the power of lamps between rooms."""
CAMERA_ROOM, OPPOSITE_ROOM = (3, 6), (2, 6)
"""Band and column."""


def fill(scene: Scene) -> None:
    chance = Chance(SEED)
    rooms = make_rooms(chance)
    furniture, lamps = Furniture(chance), Lamps(chance)
    for room in rooms:
        kinds.furnish(room, furniture, lamps, chance)
    corridors.furnish(furniture, lamps, chance)
    walls.add_walls(scene, rooms)
    walls.add_floors_and_ceilings(scene, chance, rooms)
    furniture.add_to(scene)
    lamps.add_to(scene)
    own = next(room for room in rooms if (room.band, room.column) == CAMERA_ROOM)
    scene.set_camera(
        origin=tuple(own.at(-1.0, 1.6, 4.5)),
        target=tuple(own.at(0.2, 1.25, 0.0)),
        vertical_fov=np.radians(55.0),
    )


def make_rooms(chance: Chance) -> list[Room]:
    """All rooms, band after band."""
    return [_room(chance, band, column) for band in range(BANDS) for column in range(COLUMNS)]


def _room(chance: Chance, band: int, column: int) -> Room:
    kind = KINDS[int(chance.uniform(0, len(KINDS)))]
    lighting = _lighting(kind, chance.uniform())
    door = _door(chance, DOUBLE if kind in ("meeting", "lounge") else SINGLE)
    level, kelvin = float(chance.log_normal(LEVEL_SIGMA)), float(chance.pick(np.array(KELVINS)))
    accent = ACCENTS[int(chance.uniform(0, len(ACCENTS)))], int(chance.uniform(0, 6))
    if (band, column) == CAMERA_ROOM:
        kind, lighting, level, kelvin = "office", "half", 0.4, 3300.0
        door, accent = Door(0.4, DOUBLE, (1.5, 1.3)), ("#3f6f7d", 2)
    elif (band, column) == OPPOSITE_ROOM:
        kind, lighting, level, kelvin = "meeting", "lit", 1.2, 3000.0
        door, accent = Door(-0.5, DOUBLE, (1.4, 1.5)), ("#c79a45", 1)
    return Room(band, column, kind, lighting, level, kelvin, door, *accent)


def _lighting(kind: str, chance: float) -> str:
    if kind in ("archive", "servers"):
        return "dark" if chance < 0.7 else "lit"
    kinds = ((0.5, "lit"), (0.66, "half"), (0.82, "desk"), (1.0, "dark"))
    return next(lighting for limit, lighting in kinds if chance < limit)


def _door(chance: Chance, width: float) -> Door:
    """Most doors stand open, or ajar."""
    farthest = 0.85 if width == SINGLE else 0.5
    centre = float(chance.uniform(0.2, farthest) * chance.pick(np.array((-1.0, 1.0))))
    state = chance.uniform()
    low, high = (0.0, 0.0) if state < 0.2 else (0.15, 0.6) if state < 0.45 else (0.9, 1.6)
    angles = [float(angle) for angle in chance.uniform(low, high, 2)]
    if width == SINGLE:
        # The leaf opens towards the nearer wall.
        angles[0 if centre > 0 else 1] = 0.0
    return Door(centre, width, (angles[0], angles[1]))
