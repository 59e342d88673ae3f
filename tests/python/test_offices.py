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


def share_seen(room: Room, triangles: np.ndarray, lamps: np.ndarray) -> float:
    """Of the lamps about a room, those that are seen from any of some points in it."""
    low, high = room.bounds()
    about = np.array((low - 7.0, high + 7.0))
    lamps = lamps[inside(about, lamps) & ~inside(room.bounds(), lamps)]
    near = (triangles.min(axis=1) < about[1]) & (triangles.max(axis=1) > about[0])
    triangles = triangles[near.all(axis=1)]
    centre = room.door.centre
    seen = np.zeros(len(lamps), dtype=bool)
    for x, y, z in ((centre, 1.0, 1.1), (centre, 1.6, 4.0), (-1.8, 2.6, 0.1), (1.8, 0.2, 4.9)):
        seen |= ~blocked(triangles, room.at(x, y, z), lamps)
    return float(seen.mean())


def test_what_is_seen_through_doors(rooms: list[Room]) -> None:
    """Nothing through a closed one: walls, linings and leaves leave no gap. Through one that stands
    wide open something, though most lamps stay hidden."""
    with_doors = occluders(("walls", "lining", "door"))
    walls = occluders(("walls",))
    lamps = all_centroids()[::19]
    for room in rooms:
        place = (room.band, room.column)
        assert share_seen(room, walls, lamps) > 0, place
        share = share_seen(room, with_doors, lamps)
        if room.door.closed:
            assert share == 0, place
        elif max(room.door.angles) > 1.25:
            assert 0 < share < 0.5, place


def test_the_camera_is_in_its_room(rooms: list[Room]) -> None:
    band, column = offices.CAMERA_ROOM
    own = rooms[band * plan.COLUMNS + column]
    assert (own.band, own.column) == offices.CAMERA_ROOM and not own.door.closed
    assert inside(own.bounds(), np.array(recorded("offices").camera["origin"]))
