"""The example scene `offices`: its rooms, where its lamps are, and what walls and doors hide."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from lightcull.scenes import offices
from lightcull.scenes.offices import plan
from lightcull.scenes.offices.lamps import LAMP_SIGMA
from lightcull.scenes.offices.plan import Room
from lightcull.scenes.random_numbers import Chance
from test_scenes import Mesh, assert_closed_bodies_face_out, light_mesh, recorded


@pytest.fixture(scope="module")
def rooms() -> list[Room]:
    return offices.make_rooms(Chance(offices.SEED))


def halls() -> list[np.ndarray]:
    """Bounds of the corridors and of the parts of the passage."""
    return [
        *map(plan.corridor_bounds, range(plan.CORRIDORS)),
        *map(plan.passage_bounds, range(plan.CORRIDORS - 1)),
    ]


def inside(bounds: np.ndarray, points: np.ndarray) -> np.ndarray:
    return ((points > bounds[0]) & (points < bounds[1])).all(axis=-1)


def centroids(mesh: Mesh) -> np.ndarray:
    return mesh.corners().mean(axis=1)


def all_centroids() -> np.ndarray:
    return np.concatenate([centroids(mesh) for mesh in recorded("offices").lights])


def test_rooms_of_every_kind(rooms: list[Room]) -> None:
    assert len(rooms) == 144
    assert set(Counter(room.kind for room in rooms)) == set(offices.KINDS)
    lighting = Counter(room.lighting for room in rooms)
    assert set(lighting) == {"lit", "half", "desk", "dark"} and min(lighting.values()) > 10
    closed = sum(room.door.closed for room in rooms)
    assert 10 < closed < len(rooms) / 3


def test_rooms_and_halls_are_apart(rooms: list[Room]) -> None:
    """By the thickness of a wall, but that the passage runs into the corridors."""
    bounds = np.array([room.bounds() for room in rooms] + halls())
    low, high = bounds[:, 0, [0, 2]], bounds[:, 1, [0, 2]]
    gap = np.maximum(low[:, None] - high, low - high[:, None]).max(axis=-1)
    joined = np.abs(gap) < 1e-9
    first, second = np.nonzero(np.triu(joined))
    assert len(first) == 2 * (plan.CORRIDORS - 1)
    assert (first >= len(rooms)).all() and (second >= len(rooms)).all()
    apart = ~joined & ~np.eye(len(bounds), dtype=bool)
    assert gap[apart].min() > plan.WALL - 1e-9


def test_every_lamp_is_in_a_room_or_hall(rooms: list[Room]) -> None:
    lamps = all_centroids()
    spaces = [room.bounds() for room in rooms] + halls()
    assert (sum(inside(bounds, lamps).astype(int) for bounds in spaces) == 1).all()


def test_kinds_of_lamps() -> None:
    lights = {mesh.name for mesh in recorded("offices").lights}
    assert lights == {
        "globes", "downlights", "pendants", "bulbs", "screens", "projections", "signs", "LEDs"
    }  # fmt: skip
    for name, faces in (("globes", 20), ("bulbs", 20), ("pendants", 80), ("signs", 12)):
        assert_closed_bodies_face_out(light_mesh("offices", name), faces)
    assert (light_mesh("offices", "downlights").face_vectors()[:, 1] < 0).all()


def test_powers_in_a_room_are_log_normal(rooms: list[Room]) -> None:
    globes = light_mesh("offices", "globes")
    places = centroids(globes).reshape(-1, 20, 3).mean(axis=1)
    log_power = np.log(globes.powers().reshape(-1, 20).sum(axis=1))
    deviations, degrees = 0.0, 0
    for room in rooms:
        own = log_power[inside(room.bounds(), places)]
        if len(own):
            deviations += np.sum((own - own.mean()) ** 2)
            degrees += len(own) - 1
    assert degrees > 300
    # The standard error of a deviation is sigma / sqrt(2 n): five of them.
    error = LAMP_SIGMA / np.sqrt(2 * degrees)
    assert abs(np.sqrt(deviations / degrees) - LAMP_SIGMA) < 5 * error


def test_dark_rooms_have_no_lamp_but_leds(rooms: list[Room]) -> None:
    for mesh in recorded("offices").lights:
        if mesh.name != "LEDs":
            lamps = centroids(mesh)
            for room in rooms:
                dark = room.lighting == "dark"
                assert not (dark and inside(room.bounds(), lamps).any()), mesh.name


def occluders(prefixes: tuple[str, ...]) -> np.ndarray:
    """Corners (T, 3, 3) of the meshes whose names begin so."""
    meshes = [mesh for mesh in recorded("offices").meshes if mesh.name.startswith(prefixes)]
    return np.concatenate([mesh.corners() for mesh in meshes])


def blocked(triangles: np.ndarray, eye: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Which of the segments from a point to (N, 3) cross a triangle (Moller & Trumbore 1997)."""
    corner = triangles[:, 0]
    along, across = triangles[:, 1] - corner, triangles[:, 2] - corner
    to_eye = eye - corner
    q = np.cross(to_eye, along)
    directions = ends - eye
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1.0 / (directions @ np.cross(across, along).T)
        u = (directions @ np.cross(across, to_eye).T) * inverse
        v = (directions @ q.T) * inverse
        t = np.einsum("tk,tk->t", q, across) * inverse
        crossed = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0) & (t < 1)
    return crossed.any(axis=1)


def near(triangles: np.ndarray, bounds: np.ndarray) -> np.ndarray:
    """Those that may reach into a box."""
    apart = (triangles.max(axis=1) < bounds[0]) | (triangles.min(axis=1) > bounds[1])
    return triangles[~apart.any(axis=1)]


def grid(room: Room, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """(N, 3) in the world: all of these coordinates of a room with each other."""
    local = np.stack(np.meshgrid(x, y, z), axis=-1).reshape(-1, 3)
    return room.at(0, 0, 0) + local * (room.at(1, 1, 1) - room.at(0, 0, 0))


HEIGHTS = np.arange(0.02, plan.HEIGHT, 0.09)


def in_doorway(room: Room, points: np.ndarray, margin: float) -> np.ndarray:
    across = np.abs(points[:, 0] - room.at(room.door.centre, 0, 0)[0])
    high = points[:, 1] < plan.DOOR_HEIGHT + margin
    return (across < room.door.width / 2 + margin) & high


def test_closed_doors_leave_no_gap(rooms: list[Room]) -> None:
    """What is behind the door's wall is hidden from the middle of the room; without a door it is
    seen through the doorway."""
    with_doors, walls = occluders(("walls", "lining", "door")), occluders(("walls",))
    for room in (room for room in rooms if room.door.closed):
        about = room.bounds() + np.array(((-0.5,), (0.5,)))
        behind = np.array((-plan.WALL - 0.05,))
        ends = grid(room, np.arange(-1.9, 1.9, 0.015), HEIGHTS, behind)
        eye = room.at(0.0, 1.3, 2.5)
        assert blocked(near(with_doors, about), eye, ends).all(), (room.band, room.column)
        doorway = in_doorway(room, ends, 0.0).sum()
        assert 0.6 * doorway < (~blocked(near(walls, about), eye, ends)).sum() < 1.2 * doorway


def test_both_sides_of_a_wall_are_closed(rooms: list[Room]) -> None:
    """Between the surface of a room and that of the corridor or of the next room, nothing is seen
    from either but by the doorway."""
    walls = occluders(("walls",))
    x = np.arange(-1.92, 1.95, 0.06)
    z = np.arange(0.03, plan.DEPTH, 0.06)
    for room in rooms:
        place = (room.band, room.column)
        front = grid(room, x, HEIGHTS, np.array((-0.01,)))
        back = grid(room, x, HEIGHTS, np.array((plan.DEPTH + 0.01,)))
        sides = grid(room, np.array((-1.0, 1.0)) * (plan.WIDTH / 2 + 0.01), HEIGHTS, z)
        ends = np.concatenate((front[~in_doorway(room, front, 0.01)], back, sides))
        about = room.bounds() + np.array(((-0.05,), (0.05,)))
        assert blocked(near(walls, about), room.at(0.0, 1.3, 2.5), ends).all(), place

        # From the corridor, and up to the middle of the walls to the rooms beside.
        x_outside = np.arange(-1.99, 2.0, 0.06)
        ends = grid(room, x_outside, HEIGHTS, np.array((0.01 - plan.WALL,)))
        ends = ends[~in_doorway(room, ends, 0.01)]
        eye = room.at(0.0, 1.3, -plan.WALL - 1.1)
        about = np.stack((np.minimum(ends.min(axis=0), eye), np.maximum(ends.max(axis=0), eye)))
        assert blocked(near(walls, about), eye, ends).all(), place


def test_most_lamps_are_hidden_through_open_doors(rooms: list[Room]) -> None:
    """Of those about a room some are seen through a door that stands wide open."""
    triangles = occluders(("walls", "lining", "door"))
    lamps = all_centroids()[::19]
    for room in rooms:
        if max(room.door.angles) < 1.25:
            continue
        about = room.bounds() + np.array(((-7.0,), (7.0,)))
        own = lamps[inside(about, lamps) & ~inside(room.bounds(), lamps)]
        seen = np.zeros(len(own), dtype=bool)
        for z, y in ((1.1, 1.0), (4.0, 1.6)):
            eye = room.at(room.door.centre, y, z)
            seen |= ~blocked(near(triangles, about), eye, own)
        assert 0 < seen.mean() < 0.5, (room.band, room.column)


def test_the_camera_is_in_its_room(rooms: list[Room]) -> None:
    band, column = offices.CAMERA_ROOM
    own = rooms[band * plan.COLUMNS + column]
    assert (own.band, own.column) == offices.CAMERA_ROOM and not own.door.closed
    assert inside(own.bounds(), np.array(recorded("offices").camera["origin"]))
