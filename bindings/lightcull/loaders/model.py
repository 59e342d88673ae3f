"""Triangles and surfaces of a file on their way into a scene."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any

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

    def digest(self) -> bytes:
        """Tells its arrays from others."""
        arrays = (self.positions, self.indices, self.normals, self.uvs, self.colors)
        told = hashlib.blake2b(digest_size=16)
        for array in arrays:
            told.update(b"none" if array is None else repr((array.dtype, array.shape)).encode())
            told.update(b"" if array is None else np.ascontiguousarray(array).data)
        return told.digest()

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
    shape = _arguments(name, mesh, surface)
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


def _arguments(name: str, mesh: Triangles, surface: Surface) -> dict[str, Any]:
    """What `Scene.add_mesh` is given."""
    return {
        "positions": mesh.positions,
        "indices": mesh.indices,
        "normals": mesh.normals,
        "uvs": mesh.uvs,
        "colors": None if mesh.colors is None else np.clip(mesh.colors, 0.0, 1.0),
        "material": surface.material,
        "name": name,
    }


class PlacedMeshes:
    """Adds meshes that may stand in several places: those are kept once, unless they emit or are so
    small that a copy is less than an instance.
    """

    _SMALL = 64
    """Triangles."""

    def __init__(self, scene: Scene, notes: Notes, uses: Counter[Any]) -> None:
        """uses: how many places each mesh has, by what tells it from others."""
        self._scene = scene
        self._notes = notes
        self._uses = uses
        self._shared: dict[tuple[Hashable, Hashable], int] = {}

    def is_repeated(self, key: Hashable) -> bool:
        """Whether a mesh has more places than one."""
        return self._uses[key] > 1

    def add(
        self,
        key: Hashable,
        part: Hashable,
        name: str,
        mesh: Triangles,
        surface: Surface,
        transform: np.ndarray,
    ) -> None:
        """Adds a part of a mesh in one of its places, by a 4 x 4 matrix that is applied to columns. part:
        what tells it from others of the mesh.
        """
        is_flat = abs(np.linalg.det(transform[:3, :3])) < 1e-30
        is_small = len(mesh.indices) < self._SMALL
        if not self.is_repeated(key) or is_small or is_flat or any(surface.radiance):
            add_triangles(self._scene, name, mesh, surface, self._notes, transform)
            return
        if (key, part) not in self._shared:
            shared = self._scene.add_shared_mesh(**_arguments(name, mesh, surface))
            self._shared[key, part] = shared
        self._scene.add_instance(self._shared[key, part], transform)


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
