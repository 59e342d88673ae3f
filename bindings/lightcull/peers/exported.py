"""A scene as other renderers want it: few large arrays."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import _core
from .._core import Error
from ..camera import Camera, triple
from ..scene import Scene


@dataclass(frozen=True)
class Surface:
    """What triangles have in common, but for where they are."""

    material: int
    """Index into `Exported.materials`."""
    radiance: tuple[float, float, float] | None
    """Linear RGB, W/(m^2 sr), texture aside; None: it does not emit."""
    emission_texture: int | None
    """Index into `Exported.textures`, which multiplies the radiance."""
    two_sided: bool
    """Whether it emits from the back, too."""


@dataclass(frozen=True)
class Exported:
    """All that is in a scene, as it is now, its meshes made one."""

    positions: np.ndarray
    """float32 (N, 3), metres."""
    normals: np.ndarray
    """float32 (N, 3), for shading, unit length; of what is flat 0."""
    uvs: np.ndarray
    """float32 (N, 2); 0 where there are none."""
    indices: np.ndarray
    """uint32 (M, 3)."""
    smooth: np.ndarray
    """bool (M,): whether the normals count."""
    surface: np.ndarray
    """int32 (M,): index into `surfaces`."""
    surfaces: tuple[Surface, ...]
    materials: tuple[dict[str, Any], ...]
    """As `_core.Scene.contents` has them; a texture that there is none of is None."""
    textures: tuple[np.ndarray, ...]
    """float32 (H, W, 3), linear RGB, row 0 at the top, v = 1."""
    points: tuple[dict[str, Any], ...]
    spots: tuple[dict[str, Any], ...]
    directional_lights: tuple[dict[str, Any], ...]
    environment: dict[str, Any] | None
    """map, scale and rotation, as `Scene.set_environment` has them."""
    camera: Camera


def export(scene: Scene) -> Exported:
    """Throws Error for a scene with what is ours alone: virtual lights, and what is not handed on:
    opacities, colours of vertices, orthographic cameras.
    """
    contents = scene.closed().contents()
    _check(contents, scene.camera)
    surfaces = _Surfaces()
    positions, normals, uvs, indices, smooth, surface = [], [], [], [], [], []
    first = 0
    for mesh in contents["meshes"]:
        if mesh["indices"] is None:
            continue
        count = len(mesh["positions"])
        positions.append(mesh["positions"])
        normals.append(_normalized(_or_zeros(mesh["normals"], (count, 3))))
        uvs.append(_or_zeros(mesh["uvs"], (count, 2)))
        indices.append(mesh["indices"] + np.uint32(first))
        smooth.append(np.full(len(mesh["indices"]), mesh["normals"] is not None))
        surface.append(surfaces.of(mesh))
        first += count
    return Exported(
        positions=_joined(positions, (0, 3), np.float32),
        normals=_joined(normals, (0, 3), np.float32),
        uvs=_joined(uvs, (0, 2), np.float32),
        indices=_joined(indices, (0, 3), np.uint32),
        smooth=_joined(smooth, (0,), np.bool_),
        surface=_joined(surface, (0,), np.int32),
        surfaces=tuple(surfaces.found),
        materials=tuple(_with_textures(material) for material in contents["materials"]),
        textures=tuple(contents["textures"]),
        points=tuple(contents["points"]),
        spots=tuple(contents["spots"]),
        directional_lights=tuple(contents["directional_lights"]),
        environment=contents["environment"],
        camera=scene.camera,
    )


def _check(contents: dict[str, Any], camera: Camera) -> None:
    materials = [contents["materials"][mesh["material"]] for mesh in contents["meshes"]]
    has = {
        "cut-outs": any(
            material["opacity"] < 1 or material["opacity_texture"] != _core.NO_TEXTURE
            for material in materials
        ),
        "normal maps": any(
            material["normal_texture"] != _core.NO_TEXTURE for material in materials
        ),
        "colours of vertices": any(mesh["colors"] is not None for mesh in contents["meshes"]),
        "an orthographic camera": camera.orthographic_height > 0,
    }
    if found := [thing for thing, there in has.items() if there]:
        raise Error(f"scene: it has {', '.join(found)}: other renderers are not given those")


class _Surfaces:
    """Finds triangles that have everything in common."""

    def __init__(self) -> None:
        self.found: list[Surface] = []
        self._known: dict[Hashable, int] = {}

    def of(self, mesh: dict[str, Any]) -> np.ndarray:
        """The index of the surface of each triangle of a mesh."""
        material = mesh["material"]
        if mesh["face_radiance"] is None:
            dark = self._index(Surface(material, None, None, False))
            return np.full(len(mesh["indices"]), dark, np.int32)
        radiances, which = np.unique(mesh["face_radiance"], axis=0, return_inverse=True)
        texture = _texture(mesh["emission_texture"])
        indices = [
            self._index(
                Surface(material, triple(radiance), texture, mesh["two_sided"])
                if radiance.any()
                else Surface(material, None, None, False)
            )
            for radiance in radiances
        ]
        found: np.ndarray = np.array(indices, np.int32)[which.reshape(-1)]
        return found

    def _index(self, surface: Surface) -> int:
        if surface not in self._known:
            self._known[surface] = len(self.found)
            self.found.append(surface)
        return self._known[surface]


def _texture(texture: int) -> int | None:
    return None if texture == _core.NO_TEXTURE else texture


def _with_textures(material: dict[str, Any]) -> dict[str, Any]:
    names = ("base_color_texture", "metallic_roughness_texture")
    return material | {name: _texture(material[name]) for name in names}


def _or_zeros(values: np.ndarray | None, shape: tuple[int, int]) -> np.ndarray:
    return np.zeros(shape, np.float32) if values is None else values


def _normalized(normals: np.ndarray) -> np.ndarray:
    """In double: the squares of what floats hold."""
    exact = normals.astype(np.float64)
    lengths = np.linalg.norm(exact, axis=1, keepdims=True)
    unit: np.ndarray = np.divide(exact, lengths, out=exact, where=lengths > 0).astype(np.float32)
    return unit


def _joined(parts: list[np.ndarray], shape: tuple[int, ...], dtype: Any) -> np.ndarray:
    return np.concatenate(parts) if parts else np.zeros(shape, dtype)
