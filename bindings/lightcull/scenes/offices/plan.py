"""The plan of the `offices` scene: rooms on both sides of corridors, which one passage joins.

Bands of rooms and corridors run along x: a band, a corridor, two bands back to back, a corridor and
so on. The passage runs along z through the middle of them all.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import geometry
from ..facade import Face

CORRIDORS = 4
BANDS = 2 * CORRIDORS
COLUMNS = 18
"""Rooms in a band, half of them on either side of the passage."""
HEIGHT = 2.75
WALL = 0.14
"""Thickness of all walls."""
WIDTH, DEPTH = 3.86, 5.0
"""Of a room, metres: along x and z."""
CORRIDOR, PASSAGE = 2.2, 2.4
"""Widths."""
COLUMN_PITCH = WIDTH + WALL
CORRIDOR_PITCH = CORRIDOR + 2 * DEPTH + 3 * WALL
HALF_LENGTH = PASSAGE / 2 + WALL / 2 + COLUMNS / 2 * COLUMN_PITCH
"""Of a corridor."""
DOOR_HEIGHT = 2.12
"""Of the opening in the wall; the lining takes `LINING` of it on each side and above."""
LINING = 0.02


@dataclass(frozen=True)
class Door:
    """The doorway of a room, and its leaves."""

    centre: float
    """x of its middle in the room."""
    width: float
    """Of the opening in the wall: one leaf, or two where it is wider than 1.2 m."""
    angles: tuple[float, float]
    """By which the leaves at its left and right jamb, seen from the corridor, stand open, radians.
    A single leaf hangs at the left jamb if `angles[1]` is 0, else at the right one."""

    @property
    def edges(self) -> tuple[float, float]:
        return self.centre - self.width / 2, self.centre + self.width / 2

    @property
    def double(self) -> bool:
        return self.width > 1.2

    @property
    def closed(self) -> bool:
        return max(self.angles) == 0


@dataclass(frozen=True)
class Room:
    """A room. Its own coordinates have the middle of the foot of its door's wall as the origin, and
    z runs into the room."""

    band: int
    column: int
    kind: str
    lighting: str
    """ "lit", "half", "desk" or "dark"."""
    level: float
    """Factor of its lamps' power."""
    kelvin: float
    """Of its lamps."""
    door: Door
    accent: str
    """The colour of one of its walls."""
    accent_wall: int
    """0: the wall of the door, 1: opposite, 2: left of the door, 3: right; others: none."""

    @property
    def yaw(self) -> float:
        """Of its coordinates in the world: rooms north of their corridor are turned around."""
        return np.pi if self.band % 2 == 0 else 0.0

    @property
    def origin(self) -> np.ndarray:
        side = -1 if self.band % 2 == 0 else 1
        z = corridor_z(self.band // 2) + side * (CORRIDOR / 2 + WALL)
        return np.array((column_x(self.column), 0.0, z))

    def at(self, x: float, y: float, z: float) -> np.ndarray:
        """(3,) where a point of the room is in the world."""
        return self.origin + _turn(self.yaw, (x, y, z))

    def face(self, corner: tuple, right: tuple, width: float) -> Face:
        """A wall from its lower left corner to the right, in the room's coordinates."""
        return Face(self.at(*corner), _turn(self.yaw, right), width, HEIGHT)

    def bounds(self) -> np.ndarray:
        """(2, 3) its smallest and largest corner in the world."""
        return np.sort([self.at(-WIDTH / 2, 0.0, 0.0), self.at(WIDTH / 2, HEIGHT, DEPTH)], axis=0)


def _turn(yaw: float, vector: tuple) -> np.ndarray:
    # Exactly: walls that meet must have the very same edges.
    sign = 1.0 if yaw == 0 else -1.0
    return np.array(vector) * (sign, 1.0, sign)


def corridor_z(corridor: int) -> float:
    """z of the middle of a corridor."""
    return (corridor - (CORRIDORS - 1) / 2) * CORRIDOR_PITCH


def column_x(column: int) -> float:
    """x of the middle of the rooms of a column."""
    side = -1 if column < COLUMNS // 2 else 1
    from_passage = column - COLUMNS // 2 if side > 0 else COLUMNS // 2 - 1 - column
    return side * ((PASSAGE + WALL) / 2 + (from_passage + 0.5) * COLUMN_PITCH)


def corridor_bounds(corridor: int) -> np.ndarray:
    """(2, 3)"""
    z = corridor_z(corridor)
    return np.array(
        ((-HALF_LENGTH, 0.0, z - CORRIDOR / 2), (HALF_LENGTH, HEIGHT, z + CORRIDOR / 2))
    )


def passage_bounds(corridor: int) -> np.ndarray:
    """(2, 3) of the part of the passage between a corridor and the next."""
    low, high = corridor_z(corridor) + CORRIDOR / 2, corridor_z(corridor + 1) - CORRIDOR / 2
    return np.array(((-PASSAGE / 2, 0.0, low), (PASSAGE / 2, HEIGHT, high)))


def floor_quad(bounds: np.ndarray, tile: float) -> geometry.Shape:
    """The floor of a space, its texture repeated every `tile` metres."""
    (x0, y, z0), (x1, _, z1) = bounds
    tiles = ((x1 - x0) / tile, (z1 - z0) / tile)
    return geometry.quad((x0, y, z1), (x1 - x0, 0, 0), (0, 0, z0 - z1), tiles)


def ceiling_quad(bounds: np.ndarray, tile: float) -> geometry.Shape:
    (x0, _, z0), (x1, y, z1) = bounds
    tiles = ((x1 - x0) / tile, (z1 - z0) / tile)
    return geometry.quad((x0, y, z0), (x1 - x0, 0, 0), (0, 0, z1 - z0), tiles)
