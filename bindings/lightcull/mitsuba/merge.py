"""Thousands of small emitters as a few meshes."""

from __future__ import annotations

import json
import warnings
from collections import Counter
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from ..loaders.unsupported import UnsupportedWarning
from .host import mitsuba

SceneDict: TypeAlias = dict[str, Any]

_MESH_TYPES = ("cube", "obj", "ply", "rectangle", "serialized")
_CONSTANT_RADIANCES = ("blackbody", "d65", "irregular", "regular", "rgb", "spectrum", "uniform")
_PARTS = ("emitter", "bsdf", "id")
"""Of a shape, that are not its geometry."""
_MOST_MESHES = 16
"""With more radiances than that, they become an attribute of one mesh, where one can hold them."""


def merge_emitters(scene: SceneDict) -> SceneDict:
    """A scene with its mesh emitters merged, which is the same light exactly.

    scene: as for `mi.load_dict`, of which a variant must be set. Shapes of type rectangle, cube,
    obj, ply and serialized with an `area` emitter of constant radiance are merged where they have
    equal materials: into a mesh for each radiance, or, where there are more than 16 and all are RGB
    in an RGB variant, into one with a `face_radiance` (which Mitsuba's own `path` does not sample
    rightly). Spectra have no such attribute that holds them exactly: scenes with many of them stay
        fast in spectral LLVM variants if bulbs share some hundred radiances at most. All else stays as
    it is; of emitters among that an UnsupportedWarning says how many, and why: spheres, discs and
    tubes would not be the same light as meshes, textures need coordinates that merging leaves out.
    Shapes in the result are in world space.
    """
    merged: SceneDict = {}
    left: Counter[str] = Counter()
    groups: dict[tuple[str, bool], list[_Part]] = {}
    for name, value in scene.items():
        reason = _why_not(value)
        if reason is not None:
            merged[name] = value
            left[reason] += 1
            continue
        part = _part_of(value)
        groups.setdefault((part.bsdf_key, part.normals is not None), []).append(part)
    for number, parts in enumerate(groups.values()):
        for name, mesh in _meshes_of(parts, f"merged_emitters_{number}").items():
            merged[name] = mesh
    del left[_NO_EMITTER]
    if left:
        said = ", ".join(f"{count:,} ({reason})" for reason, count in left.most_common())
        text = f"merge_emitters leaves emitters as they are: {said}"
        warnings.warn(text, UnsupportedWarning, stacklevel=2)
    return merged


@dataclass(frozen=True)
class _Part:
    """A shape to be merged, in world space."""

    positions: np.ndarray
    """float32 (N, 3)."""
    faces: np.ndarray
    """uint32 (M, 3)."""
    normals: np.ndarray | None
    """float32 (N, 3); None: those of the faces."""
    radiance: Any
    bsdf: Any

    @property
    def bsdf_key(self) -> str:
        return _key(self.bsdf)


def _key(value: Any) -> str:
    """Equal for equal parts of a scene; an object is equal to itself only."""
    return json.dumps(value, sort_keys=True, default=lambda v: f"{type(v).__name__} {id(v)}")


_NO_EMITTER = "no emitter"


def _why_not(shape: Any) -> str | None:
    """What keeps a part of a scene from being merged; None: nothing."""
    if not isinstance(shape, dict):
        return _NO_EMITTER
    emitters = [key for key, value in shape.items() if _type_of(value) == "area"]
    if shape.get("type") == "shapegroup" or not emitters:
        return _NO_EMITTER
    if shape["type"] not in _MESH_TYPES:
        return f"{shape['type']}: no mesh"
    children = [key for key, value in shape.items() if isinstance(value, dict)]
    if emitters != ["emitter"] or set(children) - {"emitter", "bsdf"}:
        return "with media or other parts"
    emitter = shape["emitter"]
    radiance = emitter.get("radiance")
    if not (isinstance(radiance, int | float) or _type_of(radiance) in _CONSTANT_RADIANCES):
        return "no constant radiance"
    if set(emitter) - {"type", "id", "radiance"}:
        return "with a sampling weight or a medium"
    if _has_texture(shape.get("bsdf")):
        return "with a textured material"
    return None


def _type_of(value: Any) -> str | None:
    return value.get("type") if isinstance(value, dict) else None


def _has_texture(bsdf: Any) -> bool:
    """Whether a material needs the coordinates that merging leaves out."""
    if not isinstance(bsdf, dict):
        return bsdf is not None
    kinds = ("bitmap", "checkerboard", "mesh_attribute", "volume")
    return bsdf.get("type") in kinds or any(
        _has_texture(value) for value in bsdf.values() if isinstance(value, dict)
    )


def _part_of(shape: SceneDict) -> _Part:
    geometry = {key: value for key, value in shape.items() if key not in _PARTS}
    if shape["type"] == "rectangle":
        positions, faces = _rectangle(geometry)
        normals = None
    else:
        positions, faces, normals = _loaded(geometry)
    return _Part(positions, faces, normals, shape["emitter"]["radiance"], shape.get("bsdf"))


def _rectangle(shape: SceneDict) -> tuple[np.ndarray, np.ndarray]:
    to_world = shape.get("to_world")
    matrix = np.eye(4) if to_world is None else np.array(to_world.matrix, np.float64)
    corners = np.array([[-1, -1, 0, 1], [1, -1, 0, 1], [1, 1, 0, 1], [-1, 1, 0, 1]])
    positions = corners @ matrix.T
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    # Its normal is transformed as one, and so does not turn round in a mirror.
    mirrored = np.linalg.det(matrix[:3, :3]) < 0
    if mirrored != bool(shape.get("flip_normals", False)):
        faces = faces[:, ::-1]
    return (positions[:, :3] / positions[:, 3:]).astype(np.float32), faces


def _loaded(shape: SceneDict) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    mi = mitsuba()
    mesh = mi.load_dict(shape)
    parameters = mi.traverse(mesh)
    positions = np.array(parameters["vertex_positions"], np.float32).reshape(-1, 3)
    faces = np.array(parameters["faces"], np.uint32).reshape(-1, 3)
    if mesh.has_flipped_normals():
        faces = faces[:, ::-1]
    if not mesh.has_vertex_normals():
        return positions, faces, None
    normals = np.array(parameters["vertex_normals"], np.float32).reshape(-1, 3)
    if mesh.has_flipped_normals():
        normals = -normals
    return positions, faces, None if _are_flat(positions, faces, normals) else normals


def _are_flat(positions: np.ndarray, faces: np.ndarray, normals: np.ndarray) -> bool:
    """Whether the normals of vertices are those of the faces that they belong to."""
    a, b, c = (positions[faces[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    cross /= np.maximum(np.linalg.norm(cross, axis=1, keepdims=True), 1e-30)
    cosines = np.einsum("fi,fki->fk", cross, normals[faces])
    return bool((cosines > 1 - 1e-5).all())


def _meshes_of(parts: list[_Part], name: str) -> SceneDict:
    by_radiance: dict[str, list[_Part]] = {}
    for part in parts:
        by_radiance.setdefault(_key(part.radiance), []).append(part)
    colors = [rgb for part in parts if (rgb := _rgb(part.radiance)) is not None]
    if len(by_radiance) <= _MOST_MESHES or len(colors) < len(parts):
        return {
            f"{name}_{i}": _mesh(same, f"{name}_{i}", same[0].radiance)
            for i, same in enumerate(by_radiance.values())
        }
    each = np.repeat(np.array(colors, np.float32), [len(part.faces) for part in parts], axis=0)
    attribute = {"type": "mesh_attribute", "name": "face_radiance"}
    return {name: _mesh(parts, name, attribute, each)}


def _rgb(radiance: Any) -> list[float] | None:
    """As an attribute holds it exactly; None if none does."""
    if "spectral" in mitsuba().variant():
        return None
    value = radiance["value"] if _type_of(radiance) == "rgb" else radiance
    if isinstance(value, dict):
        return None
    numbers = [value] * 3 if isinstance(value, int | float) else list(value)
    return [float(number) for number in numbers]


def _mesh(
    parts: list[_Part], name: str, radiance: Any, attribute: np.ndarray | None = None
) -> Any:
    mi = mitsuba()
    properties = mi.Properties()
    if isinstance(parts[0].bsdf, dict):
        properties["bsdf"] = mi.load_dict(parts[0].bsdf)
    properties["emitter"] = mi.load_dict({"type": "area", "radiance": radiance})
    firsts = np.cumsum([0] + [len(part.positions) for part in parts[:-1]])
    faces = [part.faces + np.uint32(first) for part, first in zip(parts, firsts, strict=True)]
    has_normals = parts[0].normals is not None
    mesh = mi.Mesh(
        name,
        sum(len(part.positions) for part in parts),
        sum(len(part.faces) for part in parts),
        has_vertex_normals=has_normals,
        props=properties,
    )
    if attribute is not None:
        mesh.add_attribute("face_radiance", 3, attribute.ravel())
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = np.concatenate([p.positions for p in parts]).ravel()
    parameters["faces"] = np.concatenate(faces).ravel()
    if has_normals:
        parameters["vertex_normals"] = np.concatenate([p.normals for p in parts]).ravel()
    parameters.update()
    return mesh
