"""A Mitsuba scene for our own renderer, as far as that can show it."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from .._core import Error
from ..loaders.unsupported import Notes, UnsupportedWarning
from ..scene import Scene
from .cameras import camera_of
from .geometry import Geometry, geometry_of, matrix_of
from .host import mitsuba
from .mitsuba_scene import MitsubaScene

_ROUND, _FADING = "round shapes are made of triangles", "spots fade out by another curve"
_GREY = (0.5, 0.5, 0.5)
_INSTANCE = "Instance"
_TWO_SIDED, _NORMAL_MAP = "TwoSidedBRDF", "NormalMap"
_PRINCIPLED_LEFT_OUT = ("anisotropic", "clearcoat", "flatness", "sheen", "spec_tint", "spec_trans")
"""Parameters of a principled material that ours has not, where they are above 0."""


def import_scene(scene: Any, name: str | None = None) -> Scene:
    """Makes a `lightcull.Scene` of a scene of Mitsuba's, for this project's own renderer.

    scene: what `load_file` gave, or a `mitsuba.Scene`, of an RGB variant, which must be set. name:
    for messages; None: that of the file. What film and integrator say of size, depths and
    hide_emitters holds for `lightcull.render`, too, unless it is told otherwise. Taken over are meshes, rectangles,
    instances of shapegroups, and spheres, disks and cylinders as triangles; diffuse and principled materials, those
    two-sided, and normal maps of both; area emitters with a colour, a texture or a `face_radiance`; points, spots,
    directional lights, environments; sensors. All else is named in one `UnsupportedWarning`; what
    emits by it is left out, and materials are grey.
    """
    if "rgb" not in mitsuba().variant():
        raise Error(f"import_scene: wanted an RGB variant, got {mitsuba().variant()}")
    source = scene if isinstance(scene, MitsubaScene) else MitsubaScene(scene)
    return _Import(source, source.name if name is None else name).run()


class _Import:
    """One import under way."""

    def __init__(self, source: MitsubaScene, name: str) -> None:
        self._source = source
        self._scene = Scene(name)
        self._scene.file_settings = source.file_settings
        self._notes = Notes()
        self._materials: dict[tuple[int, bool], int] = {}
        self._said: set[str] = set()
        self._groups: dict[str, list[int]] = {}

    def run(self) -> Scene:
        self._add_cameras()
        for shape in self._source.scene.shapes():
            self._add_shape(shape)
        for emitter in self._source.scene.emitters():
            self._add_emitter(emitter)
        if message := self._notes.message():
            warnings.warn(f"{self._scene.name}: {message}", UnsupportedWarning, stacklevel=3)
        return self._scene

    # ---- camera ----------------------------------------------------------------------------------

    def _add_cameras(self) -> None:
        for sensor in self._source.scene.sensors():
            camera = camera_of(sensor)
            if camera is None:
                self._notes.left_out(f"sensor {sensor.class_name()}")
                continue
            if list(sensor.film().crop_size()) != list(sensor.film().size()):
                self._notes.left_out("crop window of the film")
            values = _values(sensor)
            offsets = (_number(values.get(f"principal_point_offset_{a}", 0.0)) for a in "xy")
            if any(offsets):
                self._notes.left_out("offset of the principal point")
            self._scene.add_camera(camera)
        seen_by = camera_of(self._source.sensor) if self._source.scene.shapes() else None
        if seen_by is not None and seen_by.parameters != self._scene.camera.parameters:
            self._scene.set_camera(*seen_by.parameters)

    def _remark_once(self, text: str) -> None:
        if text not in self._said:
            self._said.add(text)
            self._notes.remark(text)

    # ---- shapes ----------------------------------------------------------------------------------

    def _add_shape(self, shape: Any) -> None:
        if shape.class_name() == _INSTANCE:
            to_world = matrix_of(_values(shape)["to_world"])
            for mesh in self._shared_meshes(_group_of(shape)):
                self._scene.add_instance(mesh, to_world)
            return
        self._add_triangles(shape, self._scene.add_mesh)

    def _shared_meshes(self, group: str) -> list[int]:
        """Those of the shapes of a shapegroup, which Mitsuba shows as parameters alone."""
        if group not in self._groups:
            parameters = mitsuba().traverse(self._source.scene).properties
            shapes = {
                id(node): node
                for name, (*_, node, _) in parameters.items()
                if name.startswith(f"{group}.") and isinstance(node, mitsuba().Shape)
            }
            add = self._scene.add_shared_mesh
            meshes = [self._add_triangles(shape, add) for shape in shapes.values()]
            self._groups[group] = [mesh for of_shape in meshes for mesh in of_shape]
        return self._groups[group]

    def _add_triangles(self, shape: Any, add: Callable[..., int]) -> list[int]:
        """Adds a shape; the meshes that it became by `add`, if it does not emit."""
        geometry = geometry_of(shape)
        if geometry is None:
            kind = f"shape {shape.class_name()}"
            self._notes.left_out(kind + (" that emits" if shape.is_emitter() else ""))
            return []
        if geometry.is_round:
            self._remark_once(_ROUND)
        if shape.interior_medium() or shape.exterior_medium():
            self._notes.left_out("medium")
        uvs = geometry.uvs
        if uvs is None and _is_textured(shape.bsdf()):
            self._notes.left_out("textures on shapes without texture coordinates")
            uvs = np.zeros((len(geometry.positions), 2), np.float32)
        what: dict[str, Any] = {"normals": geometry.normals, "uvs": uvs, "name": str(shape.id())}
        if not shape.is_emitter():
            return [
                add(
                    geometry.positions,
                    indices,
                    **what,
                    material=self._material(shape.bsdf(), mirrored=mirrored),
                )
                for mirrored, indices in self._by_hand(shape.bsdf(), geometry)
            ]
        emission = self._emission(shape, geometry)
        if emission is not None:
            what["material"] = self._material(shape.bsdf())
            self._scene.add_light_mesh(geometry.positions, geometry.indices, **what, **emission)
        return []

    def _by_hand(self, bsdf: Any, geometry: Geometry) -> Iterator[tuple[bool, np.ndarray]]:
        """Triangles of a shape, and whether its normal map is mirrored there: Mitsuba's frames are
        right-handed where ours follow texture coordinates.
        """
        if geometry.uvs is None or not any(".normalmap." in f".{key}" for key in _values(bsdf)):
            yield False, geometry.indices
            return
        a, b, c = (geometry.uvs[geometry.indices[:, k]].astype(np.float64) for k in range(3))
        first, second = b - a, c - a
        mirrored = first[:, 0] * second[:, 1] < first[:, 1] * second[:, 0]
        for hand in np.unique(mirrored):
            yield bool(hand), geometry.indices[mirrored == hand]

    def _emission(self, shape: Any, geometry: Geometry) -> dict[str, Any] | None:
        values = _values(shape)
        if shape.emitter().class_name() == "AreaLight":
            if "emitter.radiance.value" in values:
                return {"radiance": _rgb(values["emitter.radiance.value"])}
            if "face_radiance" in values:
                each = np.array(values["face_radiance"], np.float32).reshape(-1, 3)
                return {"radiance": each}
            if "emitter.radiance.data" in values and geometry.uvs is not None:
                self._check_texture(values, "emitter.radiance")
                texture = self._scene.add_texture(_texels(values["emitter.radiance.data"]))
                return {"radiance": (1.0, 1.0, 1.0), "texture": texture}
        self._notes.left_out(f"shape with emission by {shape.emitter().class_name()}")
        return None

    # ---- materials -------------------------------------------------------------------------------

    def _material(self, bsdf: Any, *, mirrored: bool = False) -> int:
        key = (id(bsdf), mirrored)
        if key not in self._materials:
            self._materials[key] = self._new_material(bsdf, mirrored=mirrored)
        return self._materials[key]

    def _new_material(self, bsdf: Any, *, mirrored: bool) -> int:
        kind, values = bsdf.class_name(), _values(bsdf)
        relief: dict[str, Any] = {}
        while kind in (_TWO_SIDED, _NORMAL_MAP):
            if kind == _NORMAL_MAP:
                relief = self._relief(values, mirrored=mirrored)
            elif any(key.startswith("brdf_1.") for key in values):
                # Both sides as the first: ours have no other.
                self._notes.left_out("other material on the back")
            inside = "nested_bsdf." if kind == _NORMAL_MAP else "brdf_0."
            values = {k.removeprefix(inside): v for k, v in values.items() if k.startswith(inside)}
            kind = _kind_of(values)
        if kind == "SmoothDiffuse":
            color = self._color(values, "reflectance")
            return self._scene.add_material("diffuse", **color, **relief)
        if kind == "Principled":
            return self._new_principled(values, relief)
        self._notes.left_out(f"material {kind or 'of two sides'}, shown as grey")
        return self._scene.add_material(base_color=_GREY)

    def _relief(self, values: dict[str, Any], *, mirrored: bool) -> dict[str, Any]:
        if "normalmap.data" not in values:
            self._notes.left_out("normal map that is no bitmap")
            return {}
        self._check_texture(values, "normalmap")
        texels = _texels(values["normalmap.data"])
        if mirrored:
            texels[..., 1] = 1.0 - texels[..., 1]
        return {"normal_texture": self._scene.add_texture(texels)}

    def _new_principled(self, values: dict[str, Any], relief: dict[str, Any]) -> int:
        for name in _PRINCIPLED_LEFT_OUT:
            if _number(values.get(f"{name}.value", 1.0)) > 0:
                self._notes.left_out(f"{name} of Principled")
        for name in ("metallic", "roughness"):
            if f"{name}.value" not in values:
                self._notes.left_out(f"texture of {name}")
        return self._scene.add_material(
            "metallic_roughness",
            metallic=_number(values.get("metallic.value", 0.0)),
            roughness=_number(values.get("roughness.value", 0.5)),
            **self._color(values, "base_color"),
            **relief,
        )

    def _check_texture(self, values: dict[str, Any], name: str) -> None:
        transform = values.get(f"{name}.to_uv")
        if transform is not None and not np.allclose(matrix_of(transform, 3), np.eye(3), atol=1e-5):
            self._notes.left_out(f"transform of the texture of {name}")

    def _color(self, values: dict[str, Any], name: str) -> dict[str, Any]:
        if f"{name}.value" in values:
            return {"base_color": _rgb(values[f"{name}.value"])}
        if f"{name}.data" in values:
            self._check_texture(values, name)
            texture = self._scene.add_texture(_texels(values[f"{name}.data"]))
            return {"base_color": (1.0, 1.0, 1.0), "base_color_texture": texture}
        self._notes.left_out(f"texture of {name}, shown as grey")
        return {"base_color": _GREY}

    # ---- emitters without a shape ----------------------------------------------------------------

    def _add_emitter(self, emitter: Any) -> None:
        kind, values = emitter.class_name(), _values(emitter)
        if kind == "PointLight" and "intensity.value" in values:
            place = np.array(values["position"], np.float64).reshape(3)
            self._scene.add_point_light(place, _rgb(values["intensity.value"]))
        elif kind == "SpotLight" and "intensity.value" in values and "texture.value" in values:
            self._add_spot(emitter, values)
        elif kind == "DirectionalEmitter" and "irradiance.value" in values:
            direction = matrix_of(values["to_world"])[:3, 2]
            self._scene.add_directional_light(direction, _rgb(values["irradiance.value"]))
        elif kind == "ConstantBackgroundEmitter" and "radiance.value" in values:
            self._scene.set_environment(_rgb(values["radiance.value"]))
        elif kind == "EnvironmentMapEmitter":
            self._add_environment(values)
        elif kind != "AreaLight":
            self._notes.left_out(f"emitter {kind}")

    def _add_spot(self, emitter: Any, values: dict[str, Any]) -> None:
        matrix = matrix_of(values["to_world"])
        inner, outer = (
            float(re.search(rf"{name} = ([\d.e+-]+)", str(emitter))[1])  # type: ignore[index]
            for name in ("beam_width", "cutoff_angle")
        )
        direction = matrix[:3, 2]
        intensity = _rgb(values["intensity.value"])
        self._remark_once(_FADING)
        self._scene.add_spot_light(matrix[:3, 3], direction, intensity, inner, outer)

    def _add_environment(self, values: dict[str, Any]) -> None:
        # Mitsuba repeats the first column at the end, and has -Z there; ours has it in the middle.
        texels = np.array(values["data"], np.float32)[:, :-1, :3]
        texels = np.ascontiguousarray(np.roll(texels, texels.shape[1] // 2, axis=1))
        turn = matrix_of(values["to_world"])[:3, :3]
        rotation = float(np.arctan2(turn[0, 2], turn[2, 2]))
        if not np.allclose(turn, _turned_about_y(rotation), atol=1e-5):
            self._notes.left_out("rotation of the environment that is not about +Y")
        self._scene.set_environment(texels, _number(values["scale"]), rotation)


def _turned_about_y(angle: float) -> np.ndarray:
    sine, cosine = np.sin(angle), np.cos(angle)
    return np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])


def _values(thing: Any) -> dict[str, Any]:
    parameters = mitsuba().traverse(thing)
    return {key: parameters[key] for key in parameters.keys()}  # noqa: SIM118


def _group_of(instance: Any) -> str:
    """The id of its shapegroup, which it only prints."""
    found = re.search(r'ShapeGroup\[\s*name = "(.*)"', str(instance))
    return found[1] if found else ""


def _is_textured(bsdf: Any) -> bool:
    return any(key.endswith(".data") for key in _values(bsdf))


def _kind_of(values: dict[str, Any]) -> str:
    """The material within another, which Mitsuba does not name."""
    if any(key.startswith("brdf_0.") for key in values):
        return _TWO_SIDED
    if any(key.startswith("normalmap.") for key in values):
        return _NORMAL_MAP
    if "base_color.value" in values or "base_color.data" in values:
        return "Principled"
    only = {key.rsplit(".", 1)[0] for key in values}
    return "SmoothDiffuse" if only <= {"reflectance", "reflectance.to_uv"} else ""


def _texels(data: Any) -> np.ndarray:
    """Mitsuba's first row is at v = 0, ours at v = 1."""
    texels = np.array(data, np.float32)
    if texels.shape[2] == 1:
        texels = np.repeat(texels, 3, axis=2)
    return np.ascontiguousarray(texels[::-1, :, :3])


def _rgb(value: Any) -> tuple[float, float, float]:
    numbers = np.array(value, np.float64).ravel()
    red, green, blue = np.broadcast_to(numbers, 3) if numbers.size == 1 else numbers
    return float(red), float(green), float(blue)


def _number(value: Any) -> float:
    return float(np.array(value, np.float64).ravel()[0])
