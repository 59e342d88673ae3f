"""What of a glTF 2.0 document is read, and what of it is not."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TypeAlias

from .._core import Error
from .unsupported import Notes

Json: TypeAlias = dict[str, Any]

READ_EXTENSIONS = {
    "EXT_mesh_gpu_instancing", "EXT_meshopt_compression", "EXT_texture_webp",
    "KHR_draco_mesh_compression", "KHR_lights_punctual", "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness", "KHR_mesh_quantization", "KHR_meshopt_compression",
    "KHR_texture_transform",
}  # fmt: skip
APPROXIMATED_EXTENSIONS = {"KHR_materials_unlit": "a diffuse surface"}
_GEOMETRY = ("accessors", "bufferViews", "buffers", "meshes")
"""Where in a document an extension may change what triangles there are."""
_NOT_OF_GEOMETRY = ("KHR_materials", "EXT_mesh_features", "EXT_structural_metadata")
"""How extensions begin that stand there and do not."""
_GLB_MAGIC, _JSON_CHUNK, _BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
_REPEAT = 10497


def read_document(path: Path) -> tuple[Json, bytes | memoryview]:
    """The JSON, and the buffer that a .glb has in it."""
    data = path.read_bytes()
    binary: bytes | memoryview = b""
    if path.suffix.lower() == ".glb" or data[:4] == b"glTF":
        data, binary = _chunks_of(data)
    try:
        document = json.loads(data)
    except (RecursionError, ValueError) as error:
        raise Error(f"its JSON is broken: {error}") from error
    if not isinstance(document, dict):
        raise Error("its JSON is not an object")
    version = str(document.get("asset", {}).get("version", "2.0"))
    if version.split(".")[0] != "2":
        raise Error(f"is glTF {version}, and only glTF 2.0 is read")
    return document, binary


def _chunks_of(data: bytes) -> tuple[bytes, memoryview]:
    if len(data) < 20:
        raise Error("is not a binary glTF file: too short")
    magic, version, total, length, kind = struct.unpack_from("<5I", data)
    if magic == _GLB_MAGIC and version == 1:
        raise Error("is glTF 1.0, and only glTF 2.0 is read")
    if magic != _GLB_MAGIC or version != 2 or kind != _JSON_CHUNK:
        raise Error("is not a binary glTF 2.0 file")
    if total > len(data):
        raise Error(f"is cut off: it has {len(data)} of {total} bytes")
    end = 20 + length
    if len(data) >= end + 8:
        size, kind = struct.unpack_from("<2I", data, end)
        if kind == _BINARY_CHUNK:
            return data[20:end], memoryview(data)[end + 8 : end + 8 + size]
    return data[20:end], memoryview(b"")


def note_unsupported(document: Json, notes: Notes) -> None:
    """Notes everything in a document that is going to be left out or shown as something else. Throws
    Error for an extension without which its geometry cannot be read.
    """
    known = READ_EXTENSIONS | set(APPROXIMATED_EXTENSIONS)
    of_geometry = {name for part in _GEOMETRY for name in _extensions(document.get(part, []))}
    required = (set(document.get("extensionsRequired", [])) & of_geometry) - known
    needed = sorted(name for name in required if not name.startswith(_NOT_OF_GEOMETRY))
    if needed:
        raise Error(f"needs {', '.join(needed)}, which is not supported")
    for extension in _extensions(document):
        if extension in APPROXIMATED_EXTENSIONS:
            notes.approximated(f"{extension} as {APPROXIMATED_EXTENSIONS[extension]}")
        elif extension not in known:
            notes.left_out(extension)
    for mesh in document.get("meshes", []):
        for primitive in mesh.get("primitives", []):
            notes.left_out("morph targets", int("targets" in primitive))
    for material in document.get("materials", []):
        notes.left_out("occlusion maps", int("occlusionTexture" in material))
    notes.left_out("animations", len(document.get("animations", [])))
    notes.left_out("skins", len(document.get("skins", [])))
    notes.left_out("scenes besides the one shown", len(document.get("scenes", [])) - 1)
    for sampler in document.get("samplers", []):
        wraps = {sampler.get(key, _REPEAT) for key in ("wrapS", "wrapT")}
        notes.left_out("textures that are not repeated", int(wraps != {_REPEAT}))


def _extensions(part: Any) -> Iterator[str]:
    """The names in every "extensions" object, wherever in a part of a document it is."""
    waiting: list[Any] = [part]
    while waiting:
        value = waiting.pop()
        if isinstance(value, list):
            waiting += reversed(value)
        elif isinstance(value, dict):
            found = value.get("extensions")
            if isinstance(found, dict):
                yield from found
            waiting += [element for key, element in reversed(value.items()) if key != "extras"]
