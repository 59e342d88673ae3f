"""The triangles of Mitsuba's shapes, in world space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .host import mitsuba

_STEPS, _STEPS_OF_LAMP = 64, 32
"""Around a round shape. Those of a lamp are fewer: each of its triangles is a light."""


@dataclass(frozen=True)
class Geometry:
    """Triangles in world space."""

    positions: np.ndarray
    """float32 (N, 3)."""
    indices: np.ndarray
    """uint32 (M, 3), anticlockwise as seen from the front."""
    normals: np.ndarray | None = None
    """float32 (N, 3)."""
    uvs: np.ndarray | None = None
    """float32 (N, 2)."""
    is_round: bool = False
    """Whether the shape itself has no corners; the triangles have its area."""


def geometry_of(shape: Any) -> Geometry | None:
    """None for a shape that does not become triangles."""
    values = mitsuba().traverse(shape)
    flipped, steps = shape.has_flipped_normals(), _STEPS
    if shape.is_emitter():
        steps = _STEPS_OF_LAMP
    match shape.class_name():
        case "Rectangle":
            return _placed(_rectangle(), values, flipped)
        case "Sphere":
            return _placed(_sphere(steps), values, flipped)
        case "Disk":
            return _placed(_disk(steps), values, flipped)
        case "Cylinder":
            return _placed(_cylinder(steps), values, flipped)
    return _mesh(shape, values, flipped) if "faces" in values else None


def matrix_of(transform: Any, rows: int = 4) -> np.ndarray:
    """A transform as float64 (rows, rows)."""
    numbers = np.array(transform.matrix, np.float64).reshape(-1)
    return numbers[: rows * rows].reshape(rows, rows)


def _mesh(shape: Any, values: Any, flipped: bool) -> Geometry:
    normals = uvs = None
    if shape.has_vertex_normals():
        normals = np.array(values["vertex_normals"], np.float32).reshape(-1, 3)
    if shape.has_vertex_texcoords():
        uvs = np.array(values["vertex_texcoords"], np.float32).reshape(-1, 2)
    indices = np.array(values["faces"], np.uint32).reshape(-1, 3)
    if flipped:
        indices = np.ascontiguousarray(indices[:, ::-1])
        normals = None if normals is None else -normals
    positions = np.array(values["vertex_positions"], np.float32).reshape(-1, 3)
    return Geometry(positions, indices, normals, uvs)


def _placed(shape: Geometry, values: Any, flipped: bool) -> Geometry:
    """A shape of the unit size as its transform has it."""
    matrix = matrix_of(values["to_world"])
    linear, indices, normals = matrix[:3, :3], shape.indices, shape.normals
    # Mitsuba transforms normals as such, so that they do not turn round in a mirror.
    if (np.linalg.det(linear) < 0) != flipped:
        indices = indices[:, ::-1]
    if normals is not None:
        normals = (normals @ np.linalg.inv(linear)) * (-1 if flipped else 1)
        normals = np.ascontiguousarray(normals, np.float32)
    return Geometry(
        np.ascontiguousarray(shape.positions @ linear.T + matrix[:3, 3], np.float32),
        np.ascontiguousarray(indices, np.uint32),
        normals,
        shape.uvs,
        shape.is_round,
    )


def _rectangle() -> Geometry:
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    uvs = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)
    return Geometry(corners, np.array([[0, 1, 2], [0, 2, 3]]), uvs=uvs)


def _sphere(steps: int) -> Geometry:
    v, u = np.meshgrid(np.linspace(0, 1, steps // 2 + 1), np.linspace(0, 1, steps + 1),
                       indexing="ij")  # fmt: skip
    around, down = 2 * np.pi * u, np.pi * v
    level = np.sin(down)
    places = np.stack([level * np.cos(around), level * np.sin(around), np.cos(down)], axis=-1)
    normals = places.reshape(-1, 3)
    indices = _of_grid(steps // 2, steps)
    area = _area(normals, indices)
    # At the poles quads are triangles.
    indices = indices[_areas(normals, indices) > 1e-9]
    return Geometry(
        normals * np.sqrt(4 * np.pi / area), indices, normals, _uvs(u, v), is_round=True
    )


def _disk(steps: int) -> Geometry:
    around = 2 * np.pi * np.arange(steps) / steps
    rim = np.stack([np.cos(around), np.sin(around), np.zeros(steps)], axis=1)
    rim *= np.sqrt(np.pi / (0.5 * steps * np.sin(2 * np.pi / steps)))
    places = np.concatenate([rim, np.zeros((1, 3))])
    number = np.arange(steps)
    indices = np.stack([number, (number + 1) % steps, np.full(steps, steps)], axis=1)
    return Geometry(places, indices, is_round=True)


def _cylinder(steps: int) -> Geometry:
    u, v = np.meshgrid(np.linspace(0, 1, steps + 1), np.linspace(0, 1, 2), indexing="xy")
    around = 2 * np.pi * u
    normals = np.stack([np.cos(around), np.sin(around), np.zeros_like(u)], axis=-1).reshape(-1, 3)
    widened = normals * (np.pi / steps / np.sin(np.pi / steps))
    places = widened + np.stack([0 * v, 0 * v, v], axis=-1).reshape(-1, 3)
    return Geometry(places, _of_grid(1, steps)[:, ::-1], normals, _uvs(u, v), is_round=True)


def _of_grid(rows: int, columns: int) -> np.ndarray:
    """Triangles of a grid of (rows + 1) x (columns + 1) places, row by row."""
    row, column = (grid.ravel() for grid in np.mgrid[:rows, :columns])
    a = row * (columns + 1) + column
    b, c, d = a + columns + 1, a + columns + 2, a + 1
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def _areas(positions: np.ndarray, indices: np.ndarray) -> np.ndarray:
    a, b, c = (positions[indices[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def _area(positions: np.ndarray, indices: np.ndarray) -> float:
    return float(_areas(positions, indices).sum())


def _uvs(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.stack([u, v], axis=-1).reshape(-1, 2).astype(np.float32)
