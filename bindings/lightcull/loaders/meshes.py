"""Meshes that trimesh has read, into scenes."""

from __future__ import annotations

import io
import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import trimesh
from PIL import Image

from .._core import Error
from ..scene import Scene
from .unsupported import Notes

# Where nobody listens, Python prints what it warns of, with a traceback; we say it ourselves.
logging.getLogger("trimesh").addHandler(logging.NullHandler())


@dataclass(frozen=True)
class Surface:
    """What a material of a file became."""

    material: int
    radiance: tuple[float, float, float] = (0.0, 0.0, 0.0)
    emission_texture: int | None = None
    two_sided: bool = False


class NotingResolver(trimesh.resolvers.FilePathResolver):
    """Finds the files that a file refers to, and notes those that are not there, not readable or
    should be images and are none; trimesh goes on without them and says nothing.
    """

    def __init__(self, path: Path, notes: Notes) -> None:
        super().__init__(str(path))
        self._folder = path.parent
        self._refers_to_images = path.suffix.lower() in (".obj", ".ply")
        self._notes = notes

    def get(self, name: str) -> bytes:
        data = self._read(name)
        if name.lower().endswith(".mtl"):
            return data.decode("utf-8", errors="replace").encode()
        if self._refers_to_images and not _is_image(data):
            self._notes.left_out(f"image {name!r} that cannot be read")
        return data

    def _read(self, name: str) -> bytes:
        place = self._folder / name
        try:
            if place.exists() and not place.is_file():  # a pipe may never end
                raise FileNotFoundError(name)
            return bytes(super().get(name))
        except OSError:
            self._notes.left_out(f"missing file {name!r}")
            raise
        except ValueError:
            self._notes.left_out(f"file {name!r}, which is outside of the scene's folder")
            raise


def _is_image(data: bytes) -> bool:
    try:
        Image.open(io.BytesIO(data)).close()
    except Exception:  # PIL lets through what its decoders meet
        return False
    return True


def parse(path: Path, stream: BinaryIO, notes: Notes) -> trimesh.Scene:
    """What trimesh makes of a file; its vertices are neither merged nor moved."""
    try:
        return trimesh.load_scene(
            stream,
            file_type=path.suffix[1:].lower(),
            resolver=NotingResolver(path, notes),
            process=False,
        )
    except Error:
        raise
    except Exception as error:  # trimesh lets through whatever its parsers meet
        reason = " ".join(str(error).split()) or f"its data make no sense ({type(error).__name__})"
        raise Error(f"cannot be read: {reason}") from error


def add_geometry(
    scene: Scene, name: str, geometry: Any, transform: np.ndarray, surface: Surface, notes: Notes
) -> None:
    """Adds one of a trimesh.Scene's geometries as its node places it."""
    if not isinstance(geometry, trimesh.Trimesh):  # points, of a file that has nothing else
        return
    faces = np.asarray(geometry.faces)
    if faces.size == 0:
        return
    if faces.shape[1:] != (3,) or np.shape(geometry.vertices)[1:] != (3,):
        raise Error(f"mesh {name!r}: is not made of triangles and of positions of three coordinates")
    if np.linalg.det(transform[:3, :3]) < 0:
        faces = faces[:, ::-1]
    shape: dict[str, Any] = {
        "positions": _floats(geometry.vertices @ transform[:3, :3].T + transform[:3, 3]),
        "indices": np.ascontiguousarray(faces, dtype=np.uint32),
        "normals": normals_of(geometry, transform),
        "uvs": uvs_of(geometry),
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


def uvs_of(geometry: Any) -> np.ndarray | None:
    """Texture coordinates, v upwards: float32 (N, 2), or None."""
    uvs = getattr(geometry.visual, "uv", None)
    if uvs is None or len(uvs) != len(geometry.vertices) or np.shape(uvs)[1:] not in ((2,), (3,)):
        return None
    return _floats(np.asarray(uvs)[:, :2])


def normals_of(geometry: trimesh.Trimesh, transform: np.ndarray) -> np.ndarray | None:
    """The normals of the file. trimesh would make up some where there are none; those are its
    cache's business, and flat shading is ours.
    """
    normals = geometry._cache.cache.get("vertex_normals")
    if normals is None or len(normals) != len(geometry.vertices):
        return None
    # Cofactors: the inverse transposed but for its length, and there for flat things too.
    linear = transform[:3, :3]
    cofactors = np.cross(linear[[1, 2, 0]], linear[[2, 0, 1]])
    side = -1.0 if np.linalg.det(linear) < 0 else 1.0
    turned = side * np.asarray(normals) @ cofactors.T
    lengths = np.linalg.norm(turned, axis=1, keepdims=True)
    return _floats(np.divide(turned, lengths, out=np.zeros_like(turned), where=lengths > 0))


def _floats(values: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(values, dtype=np.float32)
