"""The numbers of a glTF document: buffers, views of them, accessors, compressed or not."""

from __future__ import annotations

import base64
import binascii
from typing import Any
from urllib.parse import unquote, unquote_to_bytes

import DracoPy
import meshopt
import numpy as np

from .._core import Error
from .files import Neighbours
from .gltf_document import Json

_DTYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_MOST_BYTES = 1 << 30
"""Of an accessor that no buffer stands behind, or a compressed one does: files of a few bytes can
name any number.
"""


class GltfData:
    """Reads buffers when they are first needed."""

    def __init__(self, document: Json, binary: bytes | memoryview, neighbours: Neighbours) -> None:
        self._document = document
        self._binary = binary
        self._neighbours = neighbours
        self._buffers: dict[int, memoryview] = {}
        self._views: dict[int, memoryview] = {}
        self._draco: dict[int, Any] = {}

    def accessor(self, index: int) -> np.ndarray:
        """Its elements: (N,) or (N, columns). Integers that are normalised are floats."""
        accessor = self._document["accessors"][index]
        dtype = np.dtype(_DTYPES[accessor["componentType"]])
        columns, count = _COLUMNS[accessor["type"]], _natural(accessor["count"])
        if "bufferView" in accessor:
            offset = _natural(accessor.get("byteOffset", 0))
            values = self._elements(accessor["bufferView"], offset, dtype, columns, count)
        else:
            _check_size(count * columns * dtype.itemsize)
            values = np.zeros((count, columns), dtype)
        if "sparse" in accessor:
            values = self._with_sparse(values, accessor["sparse"], columns)
        if columns == 1:
            values = values[:, 0]
        return normalized(values) if accessor.get("normalized") else values

    def describe(self, index: int) -> Json:
        """What the document says of an accessor."""
        found: Json = self._document["accessors"][index]
        return found

    def indices(self, index: int) -> np.ndarray:
        """An accessor's whole numbers, (N,)."""
        values = self.accessor(index)
        if values.ndim != 1 or values.dtype.kind != "u":
            raise Error(f"accessor {index}: is not made of indices")
        return values

    def view(self, index: int) -> memoryview:
        """The bytes of a view, decompressed."""
        if index not in self._views:
            view = self._document["bufferViews"][index]
            self._views[index] = self._decompressed(view, _meshopt_of(view))
        return self._views[index]

    def draco(self, extension: Json) -> Any:
        """The mesh of a KHR_draco_mesh_compression."""
        index = extension["bufferView"]
        if index not in self._draco:
            try:
                self._draco[index] = DracoPy.decode(bytes(self.view(index)))
            except Exception as error:  # it has several of its own
                raise Error(f"bufferView {index}: cannot be decoded by Draco: {error}") from error
        return self._draco[index]

    def _elements(
        self, index: int, offset: int, dtype: np.dtype, columns: int, count: int
    ) -> np.ndarray:
        data, size = self.view(index), dtype.itemsize * columns
        view = self._document["bufferViews"][index]
        compressed = _meshopt_of(view)
        stride = (compressed or view).get("byteStride") or size
        if stride < size:
            raise Error(f"bufferView {index}: elements of {size} bytes, {stride} bytes apart")
        if count and offset + (count - 1) * stride + size > len(data):
            raise Error(f"bufferView {index}: has {len(data)} bytes, too few for {count} elements")
        if count == 0:
            return np.empty((0, columns), dtype)
        return np.ndarray((count, columns), dtype, data, offset, (stride, dtype.itemsize))

    def _with_sparse(self, values: np.ndarray, sparse: Json, columns: int) -> np.ndarray:
        count = _natural(sparse["count"])
        places, given = sparse["indices"], sparse["values"]
        rows = self._elements(
            places["bufferView"], _natural(places.get("byteOffset", 0)),
            np.dtype(_DTYPES[places["componentType"]]), 1, count,
        )[:, 0]  # fmt: skip
        if count and rows.max() >= len(values):
            raise Error(f"a sparse accessor has element {rows.max()} of {len(values)}")
        values = values.copy()
        values[rows] = self._elements(
            given["bufferView"], _natural(given.get("byteOffset", 0)), values.dtype, columns, count
        )
        return values

    def _decompressed(self, view: Json, compressed: Json | None) -> memoryview:
        if compressed is None:
            return self._slice(view)
        count, stride = _natural(compressed["count"]), _natural(compressed["byteStride"])
        _check_size(count * stride)
        try:
            plain = meshopt.decode_gltf_buffer(
                bytes(self._slice(compressed)), count, stride, compressed["mode"],
                compressed.get("filter", "NONE"),
            )  # fmt: skip
        except Exception as error:
            raise Error(f"a bufferView cannot be decoded by meshoptimizer: {error}") from error
        return memoryview(np.ascontiguousarray(plain).reshape(-1).view(np.uint8)).cast("B")

    def _slice(self, view: Json) -> memoryview:
        buffer = self._buffer(view["buffer"])
        offset, length = _natural(view.get("byteOffset", 0)), _natural(view["byteLength"])
        if offset + length > len(buffer):
            raise Error(
                f"buffer {view['buffer']}: has {len(buffer)} bytes, too few for a bufferView that "
                f"ends at {offset + length}"
            )
        return buffer[offset : offset + length]

    def _buffer(self, index: int) -> memoryview:
        if index not in self._buffers:
            uri = self._document["buffers"][index].get("uri")
            if uri is None:
                data: bytes | memoryview | None = self._binary
            else:
                data = self.file(uri)
            if data is None:
                raise Error(f"buffer {index}: its file {uri[:100]!r} is missing")
            self._buffers[index] = memoryview(data)
        return self._buffers[index]

    def file(self, uri: str) -> bytes | None:
        """What a URI stands for: data in it, or a file; None, with a note, if there is none."""
        if uri.startswith("data:"):
            head, _, data = uri.partition(",")
            try:
                if head.endswith(";base64"):
                    return base64.b64decode(unquote(data))
                return unquote_to_bytes(data)
            except binascii.Error as error:
                raise Error(f"a data URI is not base64: {error}") from error
        return self._neighbours.read(unquote(uri))


def normalized(values: np.ndarray) -> np.ndarray:
    """Integers as the floats in [0, 1] or [-1, 1] that glTF 2.0, section 3.6.2.2, makes of them."""
    if values.dtype.kind == "f":
        return values
    floats = values.astype(np.float32) / np.float32(np.iinfo(values.dtype).max)
    return np.maximum(floats, -1.0) if values.dtype.kind == "i" else floats


def _meshopt_of(view: Json) -> Json | None:
    extensions = view.get("extensions", {})
    found: Json | None = extensions.get("EXT_meshopt_compression") or extensions.get(
        "KHR_meshopt_compression"
    )
    return found


def _natural(value: Any) -> int:
    if not isinstance(value, int) or value < 0:
        raise ValueError(f"{value!r} is no size or place")
    return value


def _check_size(size: int) -> None:
    if size > _MOST_BYTES:
        raise Error(f"an accessor or a compressed bufferView promises {size} bytes")
