"""glTF 2.0. trimesh reads geometry and images; materials, lights and cameras are read here from the
JSON, because trimesh rounds factors to 8 bits and drops extensions and all cameras but one.
"""

from __future__ import annotations

import io
import json
import struct
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np
import trimesh

from .._core import Error
from ..camera import Camera
from ..scene import Scene
from .gltf_support import (
    PBR_TEXTURES,
    Json,
    kept_primitive,
    note_unsupported,
    supported_primitives,
)
from .meshes import Surface, add_geometry, parse, uvs_of
from .textures import texels_of
from .unsupported import Notes

LightUnit: TypeAlias = Literal["candela", "watts"]
"""The unit of punctual lights: candela and lux, or W/sr and W/m^2."""
LUMENS_PER_WATT = 683.0
"""The factor by which Blender makes lumens of watts, whatever the colour."""

_GLB_MAGIC, _JSON_CHUNK = 0x46546C67, 0x4E4F534A
_BLENDER = "Khronos glTF Blender I/O"


def fill_from_gltf(path: Path, scene: Scene, notes: Notes, unit: LightUnit | None = None) -> None:
    """Fills a scene from a .glb or .gltf file. unit: that of its lights; None: watts, with a remark
    where that may be wrong.
    """
    document, chunks = _read(path)
    try:
        _fill(path, document, chunks, scene, notes, unit)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise Error(f"its JSON makes no sense: {type(error).__name__}: {error}") from error


def _fill(
    path: Path,
    document: Json,
    chunks: bytes,
    scene: Scene,
    notes: Notes,
    unit: LightUnit | None,
) -> None:
    note_unsupported(document, notes)
    stream = _write(path, _for_trimesh(document), chunks)
    parsed = parse(path, stream, notes)

    surfaces = _Surfaces(document, scene, notes)
    for transform, name in _placed_geometries(parsed):
        geometry = parsed.geometry[name]
        add_geometry(scene, name, geometry, transform, surfaces.of(geometry), notes)
    factor = 1.0 / LUMENS_PER_WATT if unit == "candela" else 1.0
    punctual = False
    for index, node in _numbered_nodes(document):
        if str(index) in parsed.graph.nodes:
            transform = parsed.graph[str(index)][0]
            punctual |= _add_light(document, node, transform, factor, scene, notes)
            _add_camera(document, node, transform, scene, notes)
    if unit is None and punctual and surfaces.emit and _is_of_blender(document):
        notes.remark(
            f"written by Blender, whose points, spots and suns are {LUMENS_PER_WATT:g} times as "
            "bright beside meshes that emit as they are in Blender, unless its lighting mode was "
            'not the default: say "candela" to divide them by that, "watts" to keep them '
            "(--gltf-lights)"
        )


def _is_of_blender(document: Json) -> bool:
    return str(document.get("asset", {}).get("generator", "")).startswith(_BLENDER)


def _read(path: Path) -> tuple[Json, bytes]:
    """The JSON, and what follows it in a .glb."""
    data = path.read_bytes()
    chunks = b""
    if path.suffix.lower() == ".glb":
        if len(data) < 20:
            raise Error("is not a binary glTF file: too short")
        magic, version, _, length, kind = struct.unpack_from("<5I", data)
        if magic != _GLB_MAGIC or version != 2 or kind != _JSON_CHUNK:
            raise Error("is not a binary glTF 2.0 file")
        data, chunks = data[20 : 20 + length], data[20 + length :]
    try:
        document = json.loads(data)
    except (RecursionError, ValueError) as error:
        raise Error(f"its JSON is broken: {error}") from error
    if not isinstance(document, dict):
        raise Error("its JSON is not an object")
    return document, chunks


def _write(path: Path, document: Json, chunks: bytes) -> io.BytesIO:
    text = json.dumps(document).encode()
    if path.suffix.lower() == ".gltf":
        return io.BytesIO(text)
    text += b" " * (-len(text) % 4)
    length = 20 + len(text) + len(chunks)
    header = struct.pack("<5I", _GLB_MAGIC, 2, length, len(text), _JSON_CHUNK)
    return io.BytesIO(header + text + chunks)


def _for_trimesh(document: Json) -> Json:
    """The document with what trimesh is to read, and indices for names, to find things again."""
    meshes = [
        {**mesh, "primitives": [kept_primitive(document, p) for p in supported_primitives(mesh)]}
        for mesh in document.get("meshes", [])
    ]
    materials = [
        {"name": str(i), **_texture_slots(material)}
        for i, material in enumerate(document.get("materials", []))
    ]
    nodes = [_kept_node(node, meshes) | {"name": str(i)} for i, node in _numbered_nodes(document)]
    return {**document, "meshes": meshes, "materials": materials, "nodes": nodes}


def _kept_node(node: Json, meshes: list[Json]) -> Json:
    left_out = {"camera", "extensions"}
    if "mesh" in node and not meshes[node["mesh"]]["primitives"]:
        left_out.add("mesh")
    return {key: value for key, value in node.items() if key not in left_out}


def _numbered_nodes(document: Json) -> list[tuple[int, Json]]:
    return list(enumerate(document.get("nodes", [])))


def _texture_slots(material: Json) -> Json:
    metallic_roughness = material.get("pbrMetallicRoughness", {})
    slots = {key: metallic_roughness.get(key) for key in PBR_TEXTURES}
    slots["emissiveTexture"] = material.get("emissiveTexture")
    return {key: {"index": slot["index"]} for key, slot in slots.items() if slot}


def _placed_geometries(parsed: trimesh.Scene) -> list[tuple[np.ndarray, str]]:
    """Transforms and names of geometries, in the order of the file's nodes and primitives: the
    order of lights must not change from one load to the next.
    """
    order = {name: i for i, name in enumerate(parsed.geometry)}
    found = []
    for node in parsed.graph.nodes_geometry:
        transform, name = parsed.graph[node]
        # Where a mesh has several primitives, trimesh adds something random to the name.
        index = int(str(node).split("_")[0])
        found.append(((index, order[name]), transform, str(name)))
    found.sort(key=lambda entry: entry[0])
    return [(transform, name) for _, transform, name in found]


class _Surfaces:
    """The materials of a document, each made when it is first needed."""

    def __init__(self, document: Json, scene: Scene, notes: Notes) -> None:
        self._materials: list[Json] = document.get("materials", [])
        self._scene = scene
        self._notes = notes
        self._made: dict[tuple[int | None, bool], Surface] = {}
        self.emit = False
        """Whether any that was made emits."""

    def of(self, geometry: Any) -> Surface:
        parsed = getattr(geometry.visual, "material", None)
        index = None
        if isinstance(parsed, trimesh.visual.material.PBRMaterial):
            index = int(parsed.name)
        key = (index, uvs_of(geometry) is not None)
        if key not in self._made:
            given = {} if index is None else self._materials[index]
            self._made[key] = self._make(given, parsed, has_uvs=key[1])
        return self._made[key]

    def _make(self, given: Json, parsed: Any, has_uvs: bool) -> Surface:
        factors = given.get("pbrMetallicRoughness", {})
        slots = _texture_slots(given)
        textures = {slot: self._texture(parsed, slot, has_uvs) for slot in slots}
        material = self._scene.add_material(
            kind="metallic_roughness",
            base_color=factors.get("baseColorFactor", [1.0] * 4)[:3],
            metallic=factors.get("metallicFactor", 1.0),
            roughness=factors.get("roughnessFactor", 1.0),
            base_color_texture=textures.get("baseColorTexture"),
            metallic_roughness_texture=textures.get("metallicRoughnessTexture"),
        )
        extension = given.get("extensions", {}).get("KHR_materials_emissive_strength", {})
        strength = float(extension.get("emissiveStrength", 1.0))
        r, g, b = (strength * float(f) for f in given.get("emissiveFactor", (0.0, 0.0, 0.0)))
        self.emit |= max(r, g, b) > 0
        return Surface(
            material,
            (r, g, b),
            textures.get("emissiveTexture"),
            bool(given.get("doubleSided", False)),
        )

    def _texture(self, parsed: Any, slot: str, has_uvs: bool) -> int | None:
        image = getattr(parsed, slot)
        name = f"{slot} of material {parsed.name}"
        if image is None:
            self._notes.left_out(f"{name}, whose image cannot be read")
            return None
        if not has_uvs:
            self._notes.left_out("textures on meshes without texture coordinates")
            return None
        return self._scene.add_texture(
            texels_of(name, image, linear_data=slot == "metallicRoughnessTexture")
        )


def _add_light(
    document: Json, node: Json, transform: np.ndarray, factor: float, scene: Scene, notes: Notes
) -> bool:
    """Adds the light of a node, its intensity times a factor. False if there is none."""
    index = node.get("extensions", {}).get("KHR_lights_punctual", {}).get("light")
    if index is None:
        return False
    light = document["extensions"]["KHR_lights_punctual"]["lights"][index]
    kind = light.get("type")
    strength = factor * float(light.get("intensity", 1.0))
    intensity = strength * np.array(light.get("color", [1.0, 1.0, 1.0]))
    position, direction = transform[:3, 3], -transform[:3, 2]
    if kind == "point":
        scene.add_point_light(position, intensity)
    elif kind == "spot":
        cone = light.get("spot", {})
        inner, outer = cone.get("innerConeAngle", 0.0), cone.get("outerConeAngle", np.pi / 4)
        scene.add_spot_light(position, direction, intensity, float(inner), float(outer))
    elif kind == "directional":
        scene.add_directional_light(direction, intensity)
    else:
        notes.left_out(f"{kind} lights")
        return False
    notes.has_light = True
    if "range" in light and kind != "directional":
        notes.left_out("ranges of lights")
    return True


def _add_camera(
    document: Json, node: Json, transform: np.ndarray, scene: Scene, notes: Notes
) -> None:
    if "camera" not in node:
        return
    camera = document["cameras"][node["camera"]]
    lens: dict[str, float] = {}
    if "perspective" in camera:
        lens["vertical_fov"] = float(camera["perspective"]["yfov"])
    else:
        lens["orthographic_height"] = 2.0 * float(camera["orthographic"]["ymag"])
    origin = transform[:3, 3]
    notes.has_camera = True
    scene.add_camera(
        Camera(
            _triple(origin),
            _triple(origin - transform[:3, 2]),
            _triple(transform[:3, 1]),
            **lens,
            name=str(node.get("name") or camera.get("name") or ""),
        )
    )


def _triple(vector: np.ndarray) -> tuple[float, float, float]:
    x, y, z = vector
    return float(x), float(y), float(z)
