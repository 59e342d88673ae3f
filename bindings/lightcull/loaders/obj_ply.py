"""OBJ and PLY: triangles, and little else."""

from __future__ import annotations

import io
from collections import Counter
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import trimesh

from .._core import Error
from ..scene import Scene
from .meshes import Surface, add_geometry, parse, uvs_of
from .textures import texels_of
from .unsupported import Notes

_OBJ_STATEMENTS = {"v", "vt", "vn", "f", "g", "o", "s", "usemtl", "mtllib"}
"""What is read, or changes nothing here (groups and smoothing)."""
_MTL_STATEMENTS = {"kd", "map_kd", "ke", "map_ke", "ka", "ns", "ni", "illum", "d", "tr", "ks"}
"""What is read or looked at, or changes nothing without specular reflection."""
_WORDS_OF_PLACE = 5
"""Of `v x y z w` at most; colours follow `v x y z`."""
_COLORS = "colours of vertices or faces"


def fill_from_obj(path: Path, scene: Scene, notes: Notes) -> None:
    """Fills a scene from a Wavefront OBJ file and its materials."""
    _note_obj_statements(path, notes)
    # Names in other encodings are of no matter: trimesh would want another library to guess them.
    text = path.read_text(encoding="utf-8", errors="replace")
    parsed = parse(path, io.BytesIO(text.encode()), notes)
    surfaces: dict[tuple[str, bool], Surface] = {}
    for name, geometry in parsed.geometry.items():
        key = (_material_name(geometry), uvs_of(geometry) is not None)
        if key not in surfaces:
            surfaces[key] = _obj_surface(path, scene, geometry, notes)
        add_geometry(scene, name, geometry, np.eye(4), surfaces[key], notes)


def fill_from_ply(path: Path, scene: Scene, notes: Notes) -> None:
    """Fills a scene from a Stanford PLY file."""
    with path.open("rb") as stream:
        _check_header(stream, notes)
        stream.seek(0)
        parsed = parse(path, stream, notes)
    for name, geometry in parsed.geometry.items():
        image = getattr(_material(geometry), "image", None)
        texture = scene.add_texture(texels_of("its texture", image)) if image is not None else None
        grey = 0.5 if texture is None else 1.0
        material = scene.add_material(
            base_color=(grey, grey, grey),
            base_color_texture=texture if uvs_of(geometry) is not None else None,
        )
        add_geometry(scene, name, geometry, np.eye(4), Surface(material), notes)


def _check_header(stream: BinaryIO, notes: Notes) -> None:
    """Throws Error if a text file has less than its header promises, which trimesh does not mind."""
    is_text, promised, has_colors = False, 0, False
    for line in stream:
        words = line.split()
        if words[:1] == [b"end_header"]:
            break
        has_colors |= words[:1] == [b"property"] and words[-1] == b"red"
        is_text |= words[:2] == [b"format", b"ascii"]
        if words[:1] == [b"element"] and words[-1].isdigit():
            promised += int(words[-1])
    notes.left_out(_COLORS, int(has_colors))
    rows = sum(bool(line.strip()) for line in stream) if is_text else promised
    if rows < promised:
        raise Error(f"cannot be read: its header promises {promised} rows, and there are {rows}")


def _material(geometry: Any) -> Any:
    return getattr(geometry.visual, "material", None) if hasattr(geometry, "visual") else None


def _material_name(geometry: Any) -> str:
    return str(getattr(_material(geometry), "name", ""))


def _note_obj_statements(path: Path, notes: Notes) -> None:
    found: Counter[str] = Counter()
    has_colors = False
    with path.open(encoding="utf-8", errors="replace") as lines:
        for line in lines:
            if not line[:1].isalpha():
                continue
            words = line.partition("#")[0].split()
            found[words[0]] += 1
            has_colors |= words[0] == "v" and len(words) > _WORDS_OF_PLACE
    for statement in sorted(set(found) - _OBJ_STATEMENTS):
        notes.left_out(f"OBJ statement {statement!r}", found[statement])
    notes.left_out("mtllib after the first", found["mtllib"] - 1)
    notes.left_out(_COLORS, int(has_colors))


def _obj_surface(path: Path, scene: Scene, geometry: Any, notes: Notes) -> Surface:
    material = _material(geometry)
    if not isinstance(material, trimesh.visual.material.SimpleMaterial):
        return Surface(scene.add_material())
    statements = material.kwargs
    _note_mtl_statements(material.name, statements, notes)

    has_uvs = uvs_of(geometry) is not None
    color, texture = _rgb(statements, "kd", 0.5), None
    if material.image is not None and has_uvs:
        texture = scene.add_texture(texels_of(_image_name(material.image), material.image))
        color = _rgb(statements, "kd", 1.0)
    emission_texture = None
    if "map_ke" in statements and has_uvs:
        emission_texture = scene.add_texture(path.parent / " ".join(statements["map_ke"]))
    return Surface(
        scene.add_material(base_color=color, base_color_texture=texture),
        _rgb(statements, "ke", 0.0 if emission_texture is None else 1.0),
        emission_texture,
    )


def _image_name(image: Any) -> str:
    """As the file has it, where this trimesh keeps it."""
    return str(image.info.get("file_path", "map_Kd"))


def _note_mtl_statements(name: str, statements: dict[str, Any], notes: Notes) -> None:
    for statement in sorted(set(statements) - _MTL_STATEMENTS):
        notes.left_out(f"{statement} of materials")
    if any(_rgb(statements, "ks", 0.0)):
        notes.left_out("ks of materials")
    opacity = float(np.ravel(statements.get("d", 1.0))[-1])
    transparency = float(np.ravel(statements.get("tr", 0.0))[-1])
    if opacity < 1 or transparency > 0:
        notes.left_out("transparency of materials")


def _rgb(statements: dict[str, Any], key: str, grey: float) -> tuple[float, float, float]:
    values = [float(value) for value in np.ravel(statements.get(key, grey))]
    r, g, b = values if len(values) == 3 else [values[0]] * 3
    return r, g, b
