"""The triangles of glTF primitives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .._core import Error
from .gltf_data import GltfData, normalized
from .gltf_document import Json
from .model import Triangles, strip_triangles
from .unsupported import Notes

_TRIANGLES, _STRIP, _FAN = 4, 5, 6


@dataclass
class Primitive:
    """The attributes of a primitive; its texture coordinates by number, as glTF has them."""

    triangles: Triangles
    uvs: dict[int, np.ndarray]
    has_alpha: bool
    """Whether the colours of its vertices had an alpha below 1."""


def read_primitive(data: GltfData, name: str, primitive: Json, notes: Notes) -> Primitive | None:
    """A primitive's triangles; None, with a note, if it has none."""
    mode = primitive.get("mode", _TRIANGLES)
    if mode not in (_TRIANGLES, _STRIP, _FAN):
        notes.left_out("primitives that are not triangles")
        return None
    draco = primitive.get("extensions", {}).get("KHR_draco_mesh_compression")
    attributes = _Attributes(data, primitive, draco)
    positions = attributes.get("POSITION")
    if positions is None:
        notes.left_out("primitives without positions")
        return None
    if positions.ndim != 2 or positions.shape[1] != 3:
        raise Error(
            f"mesh {name!r}: is not made of triangles and of positions of three coordinates"
        )
    count = len(positions)
    if draco is not None:
        indices = data.draco(draco).faces.reshape(-1).astype(np.int64)
    elif "indices" in primitive:
        indices = data.indices(primitive["indices"])
    else:
        indices = np.arange(count)
    mesh = Triangles(positions, _triangles_of(mode, indices))
    mesh.check(name)
    mesh.normals = _normals(attributes.get("NORMAL"), count, notes)
    mesh.colors, has_alpha = _colors(attributes.get("COLOR_0"), count, notes)
    uvs = {}
    for number in attributes.uv_numbers():
        found = attributes.get(f"TEXCOORD_{number}")
        if found is not None and found.shape == (count, 2):
            uvs[number] = found
    return Primitive(mesh, uvs, has_alpha)


def _triangles_of(mode: int, indices: np.ndarray) -> np.ndarray:
    if mode == _STRIP:
        return indices[strip_triangles(len(indices))]
    if mode == _FAN:
        i = np.arange(max(len(indices) - 2, 0))
        return np.stack([indices[i + 1], indices[i + 2], indices[i * 0]], axis=1)
    return indices[: len(indices) // 3 * 3].reshape(-1, 3)


class _Attributes:
    """The attributes of a primitive, compressed by Draco or not, as floats."""

    def __init__(self, data: GltfData, primitive: Json, draco: Json | None) -> None:
        self._data = data
        self._given: Json = primitive["attributes"]
        self._draco = draco

    def uv_numbers(self) -> list[int]:
        """The sets of texture coordinates there are."""
        names = [name.partition("TEXCOORD_")[2] for name in self._given]
        return sorted(int(name) for name in names if name.isdigit())

    def get(self, name: str) -> np.ndarray | None:
        """(N, columns), or None."""
        if name not in self._given:
            return None
        if self._draco is None or name not in self._draco["attributes"]:
            return self._data.accessor(self._given[name]).astype(np.float32, copy=False)
        values = self._decoded(self._draco["attributes"][name])
        accessor = self._data.describe(self._given[name])
        return (normalized(values) if accessor.get("normalized") else values).astype(np.float32)

    def _decoded(self, unique_id: int) -> np.ndarray:
        assert self._draco is not None
        for attribute in self._data.draco(self._draco).attributes:
            if attribute["unique_id"] == unique_id:
                return np.asarray(attribute["data"])
        raise Error(f"a mesh that Draco has compressed has no attribute {unique_id}")


def _normals(normals: np.ndarray | None, count: int, notes: Notes) -> np.ndarray | None:
    if normals is None or normals.shape == (count, 3):
        return normals
    notes.left_out("normals that are not one for each position")
    return None


def _colors(
    colors: np.ndarray | None, count: int, notes: Notes
) -> tuple[np.ndarray | None, bool]:
    if colors is None:
        return None, False
    if colors.shape not in ((count, 3), (count, 4)):
        notes.left_out("vertex colours that are not one for each position")
        return None, False
    has_alpha = colors.shape[1] == 4 and bool((colors[:, 3] < 1.0).any())
    rgb = np.ascontiguousarray(colors[:, :3])
    return (None if (rgb == 1.0).all() else rgb), has_alpha
