"""What of glTF 2.0 is not supported."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from .._core import Error
from .unsupported import Notes

Json = dict[str, Any]

SUPPORTED_EXTENSIONS = {
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
}
PBR_TEXTURES = ("baseColorTexture", "metallicRoughnessTexture")
_TRIANGLES, _TRIANGLE_STRIP = 4, 5
_REPEAT = 10497
_FLOAT = 5126


def supported_primitives(mesh: Json) -> list[Json]:
    """Those that are made of triangles."""
    modes = (_TRIANGLES, _TRIANGLE_STRIP)
    return [p for p in mesh["primitives"] if p.get("mode", _TRIANGLES) in modes]


def kept_primitive(document: Json, primitive: Json) -> Json:
    """A primitive with those of its attributes that are supported."""
    attributes = {
        name: accessor
        for name, accessor in primitive["attributes"].items()
        if name in ("POSITION", "NORMAL")
        or name == "TEXCOORD_0" and _is_float(document, accessor)
    }
    kept = {key: primitive[key] for key in primitive if key in ("indices", "material", "mode")}
    return {**kept, "attributes": attributes}


def _is_float(document: Json, accessor: int) -> bool:
    return bool(document["accessors"][accessor]["componentType"] == _FLOAT)


def note_unsupported(document: Json, notes: Notes) -> None:
    """Notes everything in a document that is going to be left out. Throws Error for an extension
    without which the document says that it cannot be read.
    """
    required = set(document.get("extensionsRequired", [])) - SUPPORTED_EXTENSIONS
    if required:
        raise Error(f"needs {', '.join(sorted(required))}, which is not supported")
    for extension in _extensions(document):
        if extension not in SUPPORTED_EXTENSIONS:
            notes.left_out(extension)
    for mesh in document.get("meshes", []):
        primitives = mesh.get("primitives", [])
        others = len(primitives) - len(supported_primitives(mesh))
        notes.left_out("primitives that are not triangles", others)
        for primitive in primitives:
            _note_attributes(document, primitive, notes)
    for material in document.get("materials", []):
        _note_material(material, notes)
    notes.left_out("animations", len(document.get("animations", [])))
    notes.left_out("skins", len(document.get("skins", [])))
    notes.left_out("scenes besides the one shown", len(document.get("scenes", [])) - 1)
    notes.left_out("sparse accessors", sum("sparse" in a for a in document.get("accessors", [])))
    for sampler in document.get("samplers", []):
        wraps = {sampler.get(key, _REPEAT) for key in ("wrapS", "wrapT")}
        notes.left_out("textures that are not repeated", int(wraps != {_REPEAT}))


def _extensions(value: Any) -> Iterator[str]:
    """The names in every "extensions" object, wherever in the document it is."""
    if isinstance(value, list):
        for element in value:
            yield from _extensions(element)
    elif isinstance(value, dict):
        for key, element in value.items():
            if key == "extensions" and isinstance(element, dict):
                yield from element
            if key != "extras":
                yield from _extensions(element)


def _note_attributes(document: Json, primitive: Json, notes: Notes) -> None:
    attributes = primitive["attributes"]
    notes.left_out("vertex colours", int("COLOR_0" in attributes))
    notes.left_out("morph targets", int("targets" in primitive))
    if "TEXCOORD_0" in attributes and not _is_float(document, attributes["TEXCOORD_0"]):
        notes.left_out("texture coordinates that are not float")
    if "NORMAL" in attributes and "POSITION" in attributes:
        normals, positions = (
            document["accessors"][attributes[name]] for name in ("NORMAL", "POSITION")
        )
        fit = normals["type"] == "VEC3" and normals["count"] == positions["count"]
        notes.left_out("normals that are not one for each position", int(not fit))


def _note_material(material: Json, notes: Notes) -> None:
    notes.left_out("normal maps", int("normalTexture" in material))
    notes.left_out("occlusion maps", int("occlusionTexture" in material))
    notes.left_out("transparency", int(material.get("alphaMode", "OPAQUE") != "OPAQUE"))
    textures = [
        material.get("emissiveTexture"),
        *(material.get("pbrMetallicRoughness", {}).get(slot) for slot in PBR_TEXTURES),
    ]
    others = sum(texture is not None and texture.get("texCoord", 0) != 0 for texture in textures)
    notes.left_out("texture coordinates besides the first", others)

