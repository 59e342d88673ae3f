"""Example scenes of lightcull as Mitsuba scenes, to compare the two integrators on."""

from __future__ import annotations

import importlib
from typing import Any, Literal

import lightcull
import mitsuba as mi
import numpy as np

Lights = Literal["triangles", "attribute", "texture"]
"""Emitters as a mesh for each triangle; one mesh with a radiance for each face; one mesh with a
texel for each, which Mitsuba's `path` can sample, too.
"""


class _Recorder(lightcull.Scene):
    """Keeps what is added to it."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.materials: dict[int, dict[str, Any]] = {}
        self.meshes: list[tuple[np.ndarray, np.ndarray, dict[str, Any]]] = []
        self.light_meshes: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []

    def add_material(self, kind: Any = "diffuse", **options: Any) -> int:
        number = super().add_material(kind, **options)
        self.materials[number] = {"kind": kind, **options}
        return number

    def add_mesh(self, positions: Any, indices: Any, **options: Any) -> int:
        self.meshes.append((positions, indices, options))
        return super().add_mesh(positions, indices, **options)

    def add_light_mesh(self, positions: Any, indices: Any, *, radiance: Any, **options: Any) -> int:
        each = np.broadcast_to(np.asarray(radiance, np.float32), (len(indices), 3))
        self.light_meshes.append((positions, indices, each))
        return super().add_light_mesh(positions, indices, radiance=radiance, **options)


def export(name: str, lights: Lights, size: tuple[int, int]) -> dict[str, Any]:
    """An example scene as a dictionary for `mi.load_dict`, in the variant that is set."""
    recorder = _Recorder(name)
    importlib.import_module(f"lightcull.scenes.{name}").fill(recorder)
    scene: dict[str, Any] = {"type": "scene", "sensor": _sensor(recorder.camera, size)}
    for i, (positions, indices, options) in enumerate(recorder.meshes):
        bsdf = _bsdf(recorder.materials.get(options.get("material") or -1, {}))
        scene[f"mesh{i}"] = _mesh(positions, indices, bsdf)
    corners = np.concatenate([p[i] for p, i, _ in recorder.light_meshes]).astype(np.float32)
    radiance = np.concatenate([each for _, _, each in recorder.light_meshes])
    scene.update(_light_shapes(corners, radiance, lights))
    return scene


def _sensor(camera: lightcull.Camera, size: tuple[int, int]) -> dict[str, Any]:
    to_world = mi.ScalarTransform4f().look_at(camera.origin, camera.target, camera.up)
    return {
        "type": "perspective",
        "fov": float(np.degrees(camera.vertical_fov)),
        "fov_axis": "y",
        "to_world": to_world,
        "film": {
            "type": "hdrfilm",
            "width": size[0],
            "height": size[1],
            "rfilter": {"type": "box"},
        },
        "sampler": {"type": "independent"},
    }


def _bsdf(material: dict[str, Any]) -> dict[str, Any]:
    color = [float(c) for c in material.get("base_color", (0.5, 0.5, 0.5))]
    reflectance = {"type": "rgb", "value": color}
    if material.get("kind") != "metallic_roughness":
        return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": reflectance}}
    return {
        "type": "twosided",
        "bsdf": {
            "type": "principled",
            "base_color": reflectance,
            "metallic": float(material.get("metallic", 0.0)),
            "roughness": float(material.get("roughness", 1.0)),
        },
    }


def _mesh(
    positions: np.ndarray,
    faces: np.ndarray,
    bsdf: dict[str, Any],
    radiance: dict[str, Any] | None = None,
    attribute: np.ndarray | None = None,
    uvs: np.ndarray | None = None,
) -> Any:
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(bsdf)
    if radiance is not None:
        properties["emitter"] = mi.load_dict({"type": "area", "radiance": radiance})
    mesh = mi.Mesh(
        "mesh", len(positions), len(faces), has_vertex_texcoords=uvs is not None, props=properties
    )
    if attribute is not None:
        mesh.add_attribute("face_radiance", 3, attribute.ravel())
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = np.ascontiguousarray(positions, np.float32).ravel()
    parameters["faces"] = np.ascontiguousarray(faces, np.uint32).ravel()
    if uvs is not None:
        parameters["vertex_texcoords"] = uvs.ravel()
    parameters.update()
    return mesh


_BLACK = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}


def _light_shapes(corners: np.ndarray, radiance: np.ndarray, lights: Lights) -> dict[str, Any]:
    """corners: (N, 3, 3). radiance: (N, 3)."""
    if lights == "triangles":
        one = np.array([[0, 1, 2]])
        return {
            f"light{i}": _mesh(
                corners[i], one, _BLACK, {"type": "rgb", "value": [float(c) for c in radiance[i]]}
            )
            for i in range(len(corners))
        }
    positions, faces = corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)
    if lights == "attribute":
        source = {"type": "mesh_attribute", "name": "face_radiance"}
        return {"lights": _mesh(positions, faces, _BLACK, source, attribute=radiance)}
    texture, uvs = _atlas(radiance)
    return {"lights": _mesh(positions, faces, _BLACK, texture, uvs=uvs)}


def _atlas(radiance: np.ndarray) -> tuple[dict[str, Any], np.ndarray]:
    """A texel for each triangle, and the triangle's corners inside it."""
    side = int(np.ceil(np.sqrt(len(radiance))))
    texels = np.zeros((side * side, 3), np.float32)
    texels[: len(radiance)] = radiance
    cell = np.arange(len(radiance))
    low = np.stack([cell % side, cell // side], axis=1)[:, None, :]
    inside = np.array([[0.1, 0.1], [0.9, 0.1], [0.1, 0.9]])
    uvs = ((low + inside) / side).astype(np.float32)
    picture = mi.Bitmap(np.ascontiguousarray(texels.reshape(side, side, 3)))
    texture = {"type": "bitmap", "bitmap": picture, "filter_type": "nearest", "raw": True}
    return texture, uvs
