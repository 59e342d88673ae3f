"""glTF 2.0. It is read here from the JSON: pygltflib gives that JSON as objects and leaves accessors
and extensions to its user; trimesh and Assimp leave out instancing, cameras and most extensions.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np

from ..camera import Camera, triple
from ..scene import Scene
from .files import Neighbours
from .gltf_data import GltfData
from .gltf_document import Json, note_unsupported, read_document
from .gltf_materials import Materials
from .gltf_meshes import read_primitive
from .gltf_nodes import instances_of, placed_nodes
from .model import PlacedMeshes, Surface, Triangles
from .unsupported import Notes

LightUnit: TypeAlias = Literal["candela", "watts"]
"""The unit of punctual lights: candela and lux, or W/sr and W/m^2."""
LUMENS_PER_WATT = 683.0
"""The factor by which Blender makes lumens of watts, whatever the colour."""

_BLENDER = "Khronos glTF Blender I/O"


def fill_from_gltf(path: Path, scene: Scene, notes: Notes, unit: LightUnit | None = None) -> None:
    """Fills a scene from a .glb or .gltf file. unit: that of its lights; None: watts, with a remark
    where that may be wrong.
    """
    document, binary = read_document(path)
    note_unsupported(document, notes)
    data = GltfData(document, binary, Neighbours(path, notes))
    _fill(document, data, scene, notes, unit)


def _fill(
    document: Json, data: GltfData, scene: Scene, notes: Notes, unit: LightUnit | None
) -> None:
    nodes = placed_nodes(document)
    places = [
        (node["mesh"], transform @ instance)
        for _, node, transform in nodes
        if "mesh" in node
        for instance in instances_of(node, data)
    ]
    placed = PlacedMeshes(scene, notes, Counter(index for index, _ in places))
    meshes = _Meshes(document, data, Materials(document, data, scene, notes), notes, placed)
    for index, transform in places:
        meshes.add(index, transform)
    factor = 1.0 / LUMENS_PER_WATT if unit == "candela" else 1.0
    punctual = False
    for _, node, transform in nodes:
        punctual |= _add_light(document, node, transform, factor, scene, notes)
        _add_camera(document, node, transform, scene, notes)
    if unit is None and punctual and meshes.materials.emit and _is_of_blender(document):
        notes.remark(
            f"written by Blender, whose points, spots and suns are {LUMENS_PER_WATT:g} times as "
            "bright beside meshes that emit as they are in Blender, unless its lighting mode was "
            'not the default: say "candela" to divide them by that, "watts" to keep them '
            "(--gltf-lights)"
        )


def _is_of_blender(document: Json) -> bool:
    return str(document.get("asset", {}).get("generator", "")).startswith(_BLENDER)


class _Meshes:
    """The meshes of a document, each read once."""

    def __init__(
        self,
        document: Json,
        data: GltfData,
        materials: Materials,
        notes: Notes,
        placed: PlacedMeshes,
    ) -> None:
        self._meshes: list[Json] = document.get("meshes", [])
        self._data = data
        self._notes = notes
        self._read: dict[int, list[tuple[Triangles, Surface]]] = {}
        self._placed = placed
        self.materials = materials

    def add(self, index: int, transform: np.ndarray) -> None:
        """Adds a mesh to the scene where a node has it."""
        mesh = self._meshes[index]
        name = str(mesh.get("name", index))
        if index not in self._read:
            self._read[index] = list(self._primitives(name, mesh))
        for number, (triangles, surface) in enumerate(self._read[index]):
            self._placed.add(index, number, name, triangles, surface, transform)

    def _primitives(self, name: str, mesh: Json) -> Iterator[tuple[Triangles, Surface]]:
        for given in mesh["primitives"]:
            primitive = read_primitive(self._data, name, given, self._notes)
            if primitive is not None:
                surface = self.materials.dress(given.get("material"), primitive)
                yield primitive.triangles, surface


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
            triple(origin),
            triple(origin - transform[:3, 2]),
            triple(transform[:3, 1]),
            **lens,
            name=str(node.get("name") or camera.get("name") or ""),
        )
    )
