"""Shapes for the example scenes: triangle meshes as arrays. Metres, Y up; corners run anticlockwise
when seen from outside."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Shape:
    """A triangle mesh."""

    positions: np.ndarray
    """(N, 3) float64, metres."""
    indices: np.ndarray
    """(M, 3) uint32 into positions."""
    normals: np.ndarray | None = None
    """(N, 3) shading normals, or None: flat."""
    uvs: np.ndarray | None = None
    """(N, 2) texture coordinates, or None."""

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Shape:
        return Shape(self.positions + (x, y, z), self.indices, self.normals, self.uvs)

    def scaled(self, x: float, y: float, z: float) -> Shape:
        """Factors must be positive: a mirror image would turn the triangles inside out."""
        factors = np.array((x, y, z))
        normals = None if self.normals is None else unit(self.normals / factors)
        return Shape(self.positions * factors, self.indices, normals, self.uvs)

    def turned(self, yaw: float) -> Shape:
        """Rotated about +Y by yaw radians: +Z goes towards +X."""
        rotation = yaw_matrix(yaw)
        normals = None if self.normals is None else self.normals @ rotation.T
        return Shape(self.positions @ rotation.T, self.indices, normals, self.uvs)


def unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors (..., 3) scaled to length 1."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def yaw_matrix(yaw: float | np.ndarray) -> np.ndarray:
    """Rotations about +Y by yaw radians: (..., 3, 3)."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    zero, one = np.zeros_like(cos), np.ones_like(cos)
    rows = [[cos, zero, sin], [zero, one, zero], [-sin, zero, cos]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def merge(shapes: Iterable[Shape]) -> Shape:
    """All of them in one; normals and uvs are kept if every shape has them."""
    shapes = list(shapes)
    counts = [len(shape.positions) for shape in shapes]
    offsets = np.concatenate(([0], np.cumsum(counts)[:-1])).astype(np.uint32)
    indices = [shape.indices + offset for shape, offset in zip(shapes, offsets)]

    def joined(arrays: list[np.ndarray | None]) -> np.ndarray | None:
        return None if any(array is None for array in arrays) else np.concatenate(arrays)

    return Shape(
        np.concatenate([shape.positions for shape in shapes]),
        np.concatenate(indices).astype(np.uint32),
        joined([shape.normals for shape in shapes]),
        joined([shape.uvs for shape in shapes]),
    )


def faceted(shape: Shape) -> Shape:
    """The same with a flat normal at each corner, so that it can be merged with smooth shapes."""
    corners = shape.positions[shape.indices]
    normals = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    indices = np.arange(3 * len(corners), dtype=np.uint32).reshape(-1, 3)
    return Shape(corners.reshape(-1, 3), indices, np.repeat(normals, 3, axis=0))


def scatter(
    shape: Shape,
    places: np.ndarray,
    scales: np.ndarray | float = 1.0,
    yaws: np.ndarray | float = 0.0,
) -> Shape:
    """Copies of a shape, one after the other.

    places (K, 3): where its origin goes; scales: factor (K,), factors (K, 3) or one for all;
    yaws: radians, (K,) or one for all.
    """
    places = np.asarray(places, dtype=np.float64)
    count, corners = len(places), len(shape.positions)
    scales = np.asarray(scales, dtype=np.float64)
    scales = np.broadcast_to(scales[:, None] if scales.ndim == 1 else scales, (count, 3))
    rotations = yaw_matrix(np.broadcast_to(np.asarray(yaws, dtype=np.float64), count))
    local = shape.positions[None] * scales[:, None]
    positions = local @ np.swapaxes(rotations, 1, 2) + places[:, None]
    normals = None
    if shape.normals is not None:
        normals = unit(shape.normals[None] / scales[:, None]) @ np.swapaxes(rotations, 1, 2)
        normals = normals.reshape(-1, 3)
    uvs = None if shape.uvs is None else np.tile(shape.uvs, (count, 1))
    first = (np.arange(count, dtype=np.uint32) * np.uint32(corners))[:, None, None]
    return Shape(
        positions.reshape(-1, 3), (shape.indices[None] + first).reshape(-1, 3), normals, uvs
    )


def quad(corner: tuple, along_u: tuple, along_v: tuple, tiles: tuple = (1.0, 1.0)) -> Shape:
    """Two triangles that face u x v, with uvs from 0 to `tiles`."""
    corner, u, v = (np.array(vector, dtype=np.float64) for vector in (corner, along_u, along_v))
    positions = np.array([corner, corner + u, corner + u + v, corner + v])
    uvs = np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) * np.array(tiles)
    return Shape(positions, np.array([(0, 1, 2), (0, 2, 3)], dtype=np.uint32), uvs=uvs)


def quads(corners: np.ndarray, uvs: np.ndarray | None = None) -> Shape:
    """Two triangles for each of (K, 4, 3) planar quadrilaterals, whose corners run anticlockwise;
    uvs: (K, 4, 2), or none."""
    corners = np.asarray(corners, dtype=np.float64)
    first = (4 * np.arange(len(corners), dtype=np.uint32))[:, None, None]
    pair = np.array([(0, 1, 2), (0, 2, 3)], dtype=np.uint32)
    uvs = None if uvs is None else uvs.reshape(-1, 2)
    return Shape(corners.reshape(-1, 3), (first + pair).reshape(-1, 3), uvs=uvs)


def box(low: tuple, high: tuple) -> Shape:
    """12 triangles."""
    return prism(
        np.array([(low[0], low[2]), (low[0], high[2]), (high[0], high[2]), (high[0], low[2])]),
        low[1],
        high[1],
    )


def prism(outline: np.ndarray, bottom: float, top: float, taper: float = 1.0) -> Shape:
    """Walls and caps over a convex outline: (K, 2) of (x, z), anticlockwise seen from above, where
    +X is right and +Z is down the page. The top is `taper` times the outline about its centre."""
    outline = np.asarray(outline, dtype=np.float64)
    count = len(outline)
    centre = outline.mean(axis=0)
    upper = centre + taper * (outline - centre)
    lower_ring = np.column_stack((outline[:, 0], np.full(count, bottom), outline[:, 1]))
    upper_ring = np.column_stack((upper[:, 0], np.full(count, top), upper[:, 1]))
    here, after = np.arange(count), np.roll(np.arange(count), -1)
    walls = quads(
        np.stack((lower_ring[here], lower_ring[after], upper_ring[after], upper_ring[here]), axis=1)
    )
    fan = np.array([(0, i, i + 1) for i in range(1, count - 1)], dtype=np.uint32)
    return merge((walls, Shape(upper_ring, fan), Shape(lower_ring, fan[:, ::-1])))


def lathe(profile: np.ndarray, segments: int) -> Shape:
    """A surface of revolution about +Y: profile (K, 2) of (radius, height), whose outside is on its
    right when it is walked. Shaded smooth around, with an edge at each point of the profile."""
    profile = np.asarray(profile, dtype=np.float64)
    angles = 2 * np.pi * np.arange(segments + 1) / segments
    around = np.column_stack((np.sin(angles), np.zeros(segments + 1), np.cos(angles)))
    up = np.array((0.0, 1.0, 0.0))
    bands = []
    for lower, upper in zip(profile[:-1], profile[1:]):
        radius, height = np.array((lower, upper)).T
        positions = radius[:, None, None] * around + height[:, None, None] * up
        slope = unit(upper - lower)
        normals = np.broadcast_to(slope[1] * around - slope[0] * up, positions.shape)
        pairs = grid_indices(2, segments + 1).reshape(-1, 2, 3)
        # Each cell is two triangles, of which one has no area where a ring is a point.
        keep = [ring for ring in (0, 1) if radius[ring] > 0]
        bands.append(
            Shape(positions.reshape(-1, 3), pairs[:, keep].reshape(-1, 3), normals.reshape(-1, 3))
        )
    return merge(bands)


def grid_indices(rows: int, columns: int) -> np.ndarray:
    """Triangles of a grid of vertices, row after row: two for each cell, the first on the lower
    row's edge. They face columns x rows."""
    start = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1)
    a, b, c, d = start, start + 1, start + columns + 1, start + columns
    return np.stack((a, b, c, a, c, d), axis=1).reshape(-1, 3).astype(np.uint32)


def height_field(x: np.ndarray, z: np.ndarray, heights: np.ndarray) -> Shape:
    """Ground over a grid, smooth: x (W,) and z (H,) ascending, heights (H, W). It faces up."""
    grid_x, grid_z = np.meshgrid(x, z)
    positions = np.stack((grid_x, heights, grid_z), axis=-1)
    slope_z, slope_x = np.gradient(heights, z, x)
    normals = unit(np.stack((-slope_x, np.ones_like(heights), -slope_z), axis=-1))
    indices = grid_indices(*heights.shape)[:, ::-1]
    return Shape(positions.reshape(-1, 3), np.ascontiguousarray(indices), normals.reshape(-1, 3))


def icosahedron() -> Shape:
    """20 triangles, corners at distance 1 from the origin."""
    golden = 0.5 * (1 + np.sqrt(5))
    a, b = np.array((1.0, golden)) / np.hypot(1.0, golden)
    positions = np.array(
        [
            (-a, b, 0), (a, b, 0), (-a, -b, 0), (a, -b, 0),
            (0, -a, b), (0, a, b), (0, -a, -b), (0, a, -b),
            (b, 0, -a), (b, 0, a), (-b, 0, -a), (-b, 0, a),
        ]
    )  # fmt: skip
    return Shape(positions, _outward_hull_faces(positions))


def _outward_hull_faces(positions: np.ndarray) -> np.ndarray:
    """Faces of a convex solid of equal edges about the origin: the triples of corners that are
    mutually nearest, each turned outward."""
    distance = np.linalg.norm(positions[:, None] - positions[None], axis=-1)
    near = np.isclose(distance, distance[distance > 0].min())
    count = len(positions)
    faces = []
    for i in range(count):
        for j in range(i + 1, count):
            for k in range(j + 1, count):
                if near[i, j] and near[j, k] and near[i, k]:
                    a, b, c = positions[[i, j, k]]
                    outward = np.dot(np.cross(b - a, c - a), a) > 0
                    faces.append((i, j, k) if outward else (i, k, j))
    return np.array(faces, dtype=np.uint32)


def icosphere(levels: int) -> Shape:
    """An icosahedron, each triangle cut into four `levels` times, on the unit sphere; smooth."""
    shape = icosahedron()
    positions, indices = shape.positions, shape.indices
    for _ in range(levels):
        edges = np.sort(indices[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        unique, place = np.unique(edges, axis=0, return_inverse=True)
        middle = place.reshape(-1, 3) + len(positions)
        positions = np.concatenate((positions, unit(positions[unique].sum(axis=1))))
        (a, b, c), (ab, bc, ca) = indices.T, middle.T
        corners = np.stack((a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca), axis=1)
        indices = corners.reshape(-1, 3).astype(np.uint32)
    return Shape(positions, indices, positions.copy())


def tubes(paths: np.ndarray, radius: float, sides: int = 3) -> Shape:
    """Open tubes along polylines: paths (P, K, 3), none of which runs along (1, 1, 1) overall."""
    paths = np.asarray(paths, dtype=np.float64)
    count, knots, _ = paths.shape
    along = unit(paths[:, -1] - paths[:, 0])
    across = unit(np.cross(along, unit(np.ones(3))))
    third = np.cross(along, across)
    angles = 2 * np.pi * np.arange(sides + 1) / sides
    ring = np.cos(angles)[:, None] * across[:, None] + np.sin(angles)[:, None] * third[:, None]
    positions = paths[:, :, None] + radius * ring[:, None]
    normals = np.broadcast_to(ring[:, None], positions.shape)
    first = (np.arange(count, dtype=np.uint32) * np.uint32(knots * (sides + 1)))[:, None, None]
    indices = (grid_indices(knots, sides + 1)[None] + first).reshape(-1, 3)
    return Shape(positions.reshape(-1, 3), indices, normals.reshape(-1, 3))
