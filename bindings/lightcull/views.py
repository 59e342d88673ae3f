"""A camera where a file has none: outside of a thing, or within a room."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from .camera import Camera

Distances: TypeAlias = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""From where and which way, float32 (N, 3) each, to what rays meet first, in lengths of them:
infinite where that is nothing, negative where it is the back of a surface.
"""

_UP = (0.0, 1.0, 0.0)
_FROM = np.array([0.5, 0.4, 1.0]) / np.linalg.norm([0.5, 0.4, 1.0])
"""Where it looks from at a thing: from the front, a little from the right and from above."""
_FOV_OUTSIDE, _FOV_INSIDE = 0.8, 1.1
"""Radians."""
_MARGIN, _ROWS, _STEPS = 1.08, 96, 4
_ACROSS, _HEIGHTS = (0.1, 0.3, 0.5, 0.7, 0.9), (0.4, 0.6)
"""Where a room is looked at from, as parts of its size."""
_DIRECTIONS = 256
_IN_ROOM, _WALLS, _FRONTS = 0.5, 0.75, 0.6
"""A room is what has from half of the places walls three quarters of the way round, most of them
with their front towards it: within a thing that is closed they show their backs.
"""
_CLOSE = 0.03
"""Of the room's half diagonal: nearer than that a camera does not come to a wall."""
_SEEN = 0.85
"""Cosine of the angle about the view within which distances count."""


def automatic_camera(bounds: np.ndarray, distances: Distances) -> tuple[Camera, str]:
    """A camera for what is within bounds, float32 (2, 3), and what it is."""
    camera = _inside(bounds, distances)
    if camera is not None:
        return camera, "no camera: one is placed that looks across the room"
    return outside(bounds, distances), "no camera: one is placed that sees everything"


def outside(bounds: np.ndarray, distances: Distances) -> Camera:
    """As near as everything is seen from, in pictures that are wider than high."""
    right = np.cross(_UP, _FROM)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(_FROM, right), _FROM])
    corners = np.array([[x, y, z] for x in bounds[:, 0] for y in bounds[:, 1]
                        for z in bounds[:, 2]], np.float64) @ axes.T  # fmt: skip
    around = _fit(corners)
    # What rays from there meet fits more closely than the corners of the bounds.
    steps = np.tan(_FOV_OUTSIDE / 2) * np.linspace(-1, 1, _ROWS)
    across, up = (grid.ravel() for grid in np.meshgrid(steps, steps))
    ways = (np.stack([across, up, np.full(across.size, -1.0)], axis=1) @ axes).astype(np.float32)
    origins = np.tile((around @ axes).astype(np.float32), (len(ways), 1))
    found = abs(distances(origins, ways))
    met = np.isfinite(found)
    if met.any():
        points = origins[met] + found[met, None] * ways[met]
        around = _fit(points.astype(np.float64) @ axes.T)
    origin = around @ axes
    distance = max(float(np.ptp(bounds, axis=0).max()), 1e-3)
    return _camera(origin, origin - distance * _FROM, _FOV_OUTSIDE)


def _fit(points: np.ndarray) -> np.ndarray:
    """From where points, in axes to the right, up and towards the camera, fill the picture."""
    slope = np.tan(_FOV_OUTSIDE / 2) / _MARGIN
    # Both sides of the picture pass by all points: the place is where they meet, or further back.
    low = (slope * points[:, 2:] - points[:, :2]).max(axis=0)
    high = (slope * points[:, 2:] + points[:, :2]).max(axis=0)
    aside = (high - low) / 2
    back = max(float((high + low).max()) / (2 * slope), float(points[:, 2].max()) + 1e-3)
    for _ in range(_STEPS):  # where there is room, what is seen comes to the middle
        seen = (points[:, :2] - aside) / (back - points[:, 2:])
        aside = aside + (seen.max(axis=0) + seen.min(axis=0)) / 2 * (back - points[:, 2].mean())
    return np.array([*aside, back])


def openness(camera: Camera, distances: Distances) -> float:
    """The part of all directions in which a camera has no walls."""
    directions = _sphere(_DIRECTIONS)
    origins = np.tile(np.array(camera.origin, np.float32), (len(directions), 1))
    return 1.0 - float(np.isfinite(distances(origins, directions)).mean())


def _inside(bounds: np.ndarray, distances: Distances) -> Camera | None:
    """None where there is no room."""
    size = bounds[1] - bounds[0]
    parts = np.array([[x, y, z] for x in _ACROSS for y in _HEIGHTS for z in _ACROSS])
    places = (bounds[0] + parts * size).astype(np.float32)
    directions = _sphere(_DIRECTIONS)
    found = distances(
        np.repeat(places, len(directions), axis=0), np.tile(directions, (len(places), 1))
    ).reshape(len(places), len(directions))
    walls = np.isfinite(found)
    fronts = (walls & (found > 0)).sum(axis=1) / np.maximum(walls.sum(axis=1), 1)
    within = (walls.mean(axis=1) >= _WALLS) & (fronts >= _FRONTS)
    if within.mean() < _IN_ROOM:
        return None
    radius = float(np.linalg.norm(size)) / 2
    # What is far counts, and most of all that nothing is close; the sky says little.
    far = np.where(walls, np.minimum(abs(found), 2 * radius), 0.25 * radius)
    free = within & (far.min(axis=1) > _CLOSE * radius)
    views = _views()
    seen = directions @ views.T > _SEEN
    depth = np.log(np.maximum(far, 1e-3 * radius)) @ seen / seen.sum(axis=0)
    depth[~free] = -np.inf
    place, view = np.unravel_index(int(depth.argmax()), depth.shape)
    if not np.isfinite(depth[place, view]):
        return None
    origin = places[place].astype(np.float64)
    return _camera(origin, origin + radius * views[view], _FOV_INSIDE)


def _camera(origin: np.ndarray, target: np.ndarray, vertical_fov: float) -> Camera:
    (x, y, z), (u, v, w) = origin, target
    return Camera(
        (float(x), float(y), float(z)), (float(u), float(v), float(w)), _UP, vertical_fov
    )


def _sphere(count: int) -> np.ndarray:
    """Directions all around, evenly (a Fibonacci lattice): float32 (count, 3)."""
    number = np.arange(count) + 0.5
    up = 1 - 2 * number / count
    around = np.pi * (1 + np.sqrt(5)) * number
    level = np.sqrt(1 - up**2)
    directions = np.stack([level * np.cos(around), up, level * np.sin(around)], axis=1)
    return directions.astype(np.float32)


def _views() -> np.ndarray:
    """Directions of view: all around, and a little downwards."""
    around = 2 * np.pi * np.arange(24) / 24
    views = np.stack([np.cos(around), np.full(24, -0.12), np.sin(around)], axis=1)
    return views / np.linalg.norm(views, axis=1, keepdims=True)
