"""Triangles and surfaces of a file on their way into a scene."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .._core import Error
from ..scene import Scene
from .unsupported import Notes


@dataclass(frozen=True)
class Surface:
    """What a material of a file became."""

    material: int
    radiance: tuple[float, float, float] = (0.0, 0.0, 0.0)
    emission_texture: int | None = None
    two_sided: bool = False


@dataclass
class Triangles:
    """A mesh as `Scene.add_mesh` takes it."""

    positions: np.ndarray
    indices: np.ndarray
    normals: np.ndarray | None = None
    uvs: np.ndarray | None = None
    colors: np.ndarray | None = None

    def check(self, name: str) -> None:
        """Throws Error for an array that is not of the right shape."""
        count = len(self.positions)
        if self.positions.shape[1:] != (3,) or self.indices.shape[1:] != (3,):
            raise Error(
                f"mesh {name!r}: is not made of triangles and of positions of three coordinates"
            )
        if len(self.indices) and self.indices.max() >= count:
            raise Error(f"mesh {name!r}: has a vertex {self.indices.max()}, and {count} positions")


def add_triangles(
    scene: Scene,
    name: str,
    mesh: Triangles,
    surface: Surface,
    notes: Notes,
    transform: np.ndarray | None = None,
) -> None:
    """Adds a mesh, placed by a 4 x 4 matrix that is applied to columns."""
    if len(mesh.indices) == 0:
        return
    if transform is not None:
        mesh = transformed(mesh, transform)
    shape = {
        "positions": mesh.positions,
        "indices": mesh.indices,
        "normals": mesh.normals,
        "uvs": mesh.uvs,
        "colors": None if mesh.colors is None else np.clip(mesh.colors, 0.0, 1.0),
        "material": surface.material,
        "name": name,
    }
    if any(surface.radiance):
        notes.has_light = True
        scene.add_light_mesh(
            **shape,
            radiance=surface.radiance,
            texture=surface.emission_texture,
            two_sided=surface.two_sided,
        )
    else:
        scene.add_mesh(**shape)


def transformed(mesh: Triangles, transform: np.ndarray) -> Triangles:
    """A mesh in another place; where it is mirrored, its fronts stay fronts."""
    if (transform == np.eye(4)).all():
        return mesh
    linear = transform[:3, :3]
    mirrored = np.linalg.det(linear) < 0
    normals = mesh.normals
    if normals is not None:
        # Cofactors: the inverse transposed but for its length, and there for flat things too.
        cofactors = np.cross(linear[[1, 2, 0]], linear[[2, 0, 1]]) * (-1.0 if mirrored else 1.0)
        turned = np.asarray(normals) @ cofactors.T
        lengths = np.linalg.norm(turned, axis=1, keepdims=True)
        normals = np.divide(turned, lengths, out=np.zeros_like(turned), where=lengths > 0)
    return Triangles(
        mesh.positions @ linear.T + transform[:3, 3],
        mesh.indices[:, ::-1] if mirrored else mesh.indices,
        normals,
        mesh.uvs,
        mesh.colors,
    )


def fan_triangles(counts: np.ndarray, firsts: np.ndarray) -> np.ndarray:
    """Which corners of polygons are the corners of triangles that fan out from the first of each:
    (M, 3), in the order of the polygons. counts, firsts: of the corners of each.
    """
    pieces = np.maximum(counts.astype(np.int64) - 2, 0)
    first = np.repeat(firsts.astype(np.int64), pieces)
    step = np.arange(len(first)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    return np.stack([first, first + step + 1, first + step + 2], axis=1)


def strip_triangles(count: int) -> np.ndarray:
    """The corners of the triangles of a strip of so many vertices: (M, 3)."""
    i = np.arange(max(count - 2, 0))
    odd = i % 2
    return np.stack([i, i + 1 + odd, i + 2 - odd], axis=1)
