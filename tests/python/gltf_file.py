"""Writes small glTF files for the tests of the loader."""

from __future__ import annotations

import base64
import io
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

_TYPES = {
    np.dtype(np.int8): 5120, np.dtype(np.uint8): 5121, np.dtype(np.int16): 5122,
    np.dtype(np.uint16): 5123, np.dtype(np.uint32): 5125, np.dtype(np.float32): 5126,
}  # fmt: skip
_SHAPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}


class GltfFile:
    """A glTF document to which meshes, materials and nodes are added."""

    def __init__(self) -> None:
        self.document: dict[str, Any] = {"asset": {"version": "2.0"}}
        self.data = b""

    def add(self, kind: str, thing: dict[str, Any]) -> int:
        """Appends to one of the document's arrays; returns the index."""
        things = self.document.setdefault(kind, [])
        things.append(thing)
        return len(things) - 1

    def accessor(
        self, values: np.ndarray, *, columns: int | None = None, normalized: bool = False
    ) -> int:
        """columns: how many of those of the array count, if not all; what follows pads a row."""
        given = 1 if values.ndim == 1 else values.shape[1]
        view = self.view(values.tobytes())
        if columns is not None:
            self.document["bufferViews"][view]["byteStride"] = values.strides[0]
        accessor = {
            "bufferView": view,
            "componentType": _TYPES[values.dtype],
            "count": len(values),
            "type": _SHAPES[columns or given],
        }
        return self.add("accessors", {**accessor, "normalized": True} if normalized else accessor)

    def view(self, data: bytes) -> int:
        offset = len(self.data)
        self.data += data + b"\0" * (-len(data) % 4)
        return self.add("bufferViews", {"buffer": 0, "byteOffset": offset, "byteLength": len(data)})

    def texture(self, pixels: np.ndarray) -> dict[str, int]:
        """From uint8 (H, W, 3) or, with alpha, (H, W, 4), as PNG."""
        stream = io.BytesIO()
        Image.fromarray(pixels).save(stream, "png")
        view = self.view(stream.getvalue())
        image = self.add("images", {"bufferView": view, "mimeType": "image/png"})
        return {"index": self.add("textures", {"source": image})}

    def quad(self, material: int | None = None, **extra: Any) -> int:
        """A mesh: a square of side 2 about the origin that faces +Z. extra: of the primitive."""
        attributes = {
            "POSITION": self.accessor(
                np.float32([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
            ),
            "TEXCOORD_0": self.accessor(np.float32([[0, 1], [1, 1], [1, 0], [0, 0]])),
        }
        attributes.update(extra.pop("attributes", {}))
        primitive = {
            "attributes": attributes,
            "indices": self.accessor(np.uint32([0, 1, 2, 0, 2, 3])),
            **extra,
        }
        if material is not None:
            primitive["material"] = material
        return self.add("meshes", {"name": "quad", "primitives": [primitive]})

    def light(self, **light: Any) -> dict[str, Any]:
        """An extension for a node that is to carry the light."""
        extension = self.document.setdefault("extensions", {}).setdefault(
            "KHR_lights_punctual", {"lights": []}
        )
        extension["lights"].append(light)
        return {"KHR_lights_punctual": {"light": len(extension["lights"]) - 1}}

    def node(self, **node: Any) -> int:
        """A node at the root of the scene."""
        index = self.add("nodes", node)
        self.document.setdefault("scenes", [{"nodes": []}])[0]["nodes"].append(index)
        return index

    def camera(self, **node: Any) -> int:
        """A camera one radian high that looks along its node's -Z."""
        index = self.add(
            "cameras", {"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}
        )
        return self.node(camera=index, **node)

    def write(self, path: Path) -> Path:
        """As .glb, or as .gltf with its data inside."""
        buffer: dict[str, Any] = {"byteLength": len(self.data)}
        document = {**self.document, "buffers": [buffer]}
        if path.suffix == ".gltf":
            data = base64.b64encode(self.data).decode()
            buffer["uri"] = f"data:application/octet-stream;base64,{data}"
            path.write_text(json.dumps(document))
            return path
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        chunks += struct.pack("<II", len(self.data), 0x004E4942) + self.data
        path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
        return path
