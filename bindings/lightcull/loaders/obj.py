"""Wavefront OBJ: tinyobjloader reads the geometry, and materials are read here."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import numpy as np

from .._core import read_obj
from ..scene import Scene
from .files import Neighbours
from .model import Surface, Triangles, add_triangles
from .mtl import Map, MtlMaterial, read_mtl
from .textures import NamedImages
from .unsupported import Notes

_SILENT = {"v", "vt", "vn", "f", "g", "o", "s", "usemtl", "mtllib", "vp"}
"""Statements that are read, or change nothing here (groups and smoothing)."""
_OTHER_STATEMENT = re.compile(rb"^[ \t]*([a-zA-Z]\w*)(?=[ \t\r\n]|$)", re.MULTILINE)
_LIBRARY = re.compile(rb"^[ \t]*mtllib[ \t]+([^\r\n]*)", re.MULTILINE)
_USE = re.compile(rb"^([ \t]*usemtl)(?:[ \t]+([^\r\n]*)|[ \t]*)\r?$", re.MULTILINE)
_SILENT_NUMBERS = {"ka", "kd", "ke", "ns", "ni", "illum", "d", "tr", "ks", "tf", "sharpness", "km"}
"""Numbers that are read or looked at, or change nothing without specular reflection."""
_MAPS = ("map_ke", "map_kd", "map_d", "norm")
"""The first of them that a material has says what texture coordinates all take."""
_SILENT_MAPS = {"map_ka", "map_ns", "map_aat"}


def fill_from_obj(path: Path, scene: Scene, notes: Notes) -> None:
    """Fills a scene from a Wavefront OBJ file and its materials."""
    text = re.sub(rb"\\\r?\n", b" ", path.read_bytes())
    neighbours = Neighbours(path, notes)
    _note_statements(text, notes)
    materials = _read_materials(text, neighbours, notes)
    numbered, names = _number_materials(text)
    surfaces = _Surfaces(materials, scene, neighbours, notes)
    for mesh in read_obj(numbered, len(names)):
        number = mesh.pop("material")
        triangles = Triangles(**mesh)
        surface = surfaces.of(names[number] if number >= 0 else None, triangles)
        add_triangles(scene, path.stem, triangles, surface, notes)


def _note_statements(text: bytes, notes: Notes) -> None:
    found = Counter(m.group(1).decode() for m in _OTHER_STATEMENT.finditer(_without_geometry(text)))
    for statement in sorted(set(found) - _SILENT):
        notes.left_out(f"OBJ statement {statement[:20]!r}", found[statement])


def _without_geometry(text: bytes) -> bytes:
    """The lines that are not vertices and faces, which are most of a file."""
    lines = text.splitlines()
    return b"\n".join(line for line in lines if line[:2] not in (b"v ", b"vt", b"vn", b"f "))


def _read_materials(
    text: bytes, neighbours: Neighbours, notes: Notes
) -> dict[str, MtlMaterial]:
    """Those of all libraries; the first of a name counts."""
    materials: dict[str, MtlMaterial] = {}
    for match in _LIBRARY.finditer(text):
        line = match.group(1).decode("utf-8", errors="replace").strip()
        # A name with blanks, or several names.
        names = [line] if line.lower().count(".mtl") <= 1 else line.split()
        for name in names:
            data = neighbours.read(name)
            if data is not None:
                found = read_mtl(data.decode("utf-8", errors="replace"))
                materials = found | materials
    return materials


def _number_materials(text: bytes) -> tuple[bytes, list[str]]:
    """The text with numbers for the names of materials, which may have blanks; and the names."""
    numbers: dict[bytes, int] = {}

    def number(match: re.Match[bytes]) -> bytes:
        name = (match.group(2) or b"").strip()
        return match.group(1) + b" %d" % numbers.setdefault(name, len(numbers))

    numbered = _USE.sub(number, text)
    return numbered, [name.decode("utf-8", errors="replace") for name in numbers]


class _Surfaces:
    """Materials by their names, each made when it is first needed."""

    def __init__(
        self,
        materials: dict[str, MtlMaterial],
        scene: Scene,
        neighbours: Neighbours,
        notes: Notes,
    ) -> None:
        self._materials = materials
        self._scene = scene
        self._notes = notes
        self._images = NamedImages(scene, neighbours, notes)
        self._made: dict[tuple[str | None, bool, bool], tuple[Surface, Map | None]] = {}

    def of(self, name: str | None, mesh: Triangles) -> Surface:
        """The surface of a mesh, whose texture coordinates are those of its maps from then on."""
        key = (name, mesh.uvs is not None, mesh.colors is not None)
        if key not in self._made:
            self._made[key] = self._make(*key)
        surface, first = self._made[key]
        if mesh.uvs is not None and first is not None:
            mesh.uvs = mesh.uvs * np.float32(first.scale) + np.float32(first.offset)
        return surface

    def _make(self, name: str | None, has_uvs: bool, has_colors: bool) -> tuple[Surface, Map | None]:
        material = self._materials.get(name or "")
        if material is None:
            if name:
                self._notes.left_out(f"material {name[:60]!r}, which no MTL file has")
            grey = 1.0 if has_colors else 0.5
            return Surface(self._scene.add_material(base_color=(grey, grey, grey))), None
        _note_mtl(material, self._notes)
        maps = {key: material.maps[key] for key in _MAPS if key in material.maps}
        if maps and not has_uvs:
            self._notes.left_out("textures on meshes without texture coordinates", len(maps))
            maps = {}
        first = next(iter(maps.values()), None)
        for key, other in list(maps.items()):
            assert first is not None
            if (other.scale, other.offset) != (first.scale, first.offset):
                self._notes.left_out("textures with other coordinates than the material's first")
                del maps[key]
        return self._make_from(material, maps, has_colors), first

    def _make_from(
        self, material: MtlMaterial, maps: dict[str, Map], has_colors: bool
    ) -> Surface:
        texture = self._images.color(maps["map_kd"].name) if "map_kd" in maps else None
        emission = self._images.color(maps["map_ke"].name) if "map_ke" in maps else None
        mask = None
        if "map_d" in maps:
            name = maps["map_d"].name
            mask = self._images.alpha(name)
            if mask is None:
                mask = self._images.color(name, linear_data=True)
        relief = self._images.color(maps["norm"].name, linear_data=True) if "norm" in maps else None
        grey = 0.5 if texture is None and not has_colors else 1.0
        r, g, b = (min(max(c, 0.0), 1.0) for c in material.color("kd", grey))
        opacity = material.number("d", 1.0 - material.number("tr", 0.0))
        return Surface(
            self._scene.add_material(
                base_color=(r, g, b),
                base_color_texture=texture,
                opacity=min(max(opacity, 0.0), 1.0),
                opacity_texture=mask,
                normal_texture=relief,
            ),
            material.color("ke", 0.0 if emission is None else 1.0),
            emission,
        )


def _note_mtl(material: MtlMaterial, notes: Notes) -> None:
    for statement in sorted(set(material.numbers) - _SILENT_NUMBERS):
        notes.left_out(f"{statement[:20]} of materials")
    for statement in sorted(set(material.maps) - set(_MAPS) - _SILENT_MAPS):
        notes.left_out(f"{statement[:20]} of materials")
    for statement in material.others:
        notes.left_out(f"MTL statement {statement[:20]!r}")
    notes.left_out("ks of materials", int(any(material.color("ks", 0.0))))
