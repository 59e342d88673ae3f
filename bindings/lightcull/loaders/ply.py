"""Stanford PLY: triangles, polygons and strips, with normals, colours and one texture.

It is read here: the libraries at hand take 16 seconds for a million triangles where faces may be of
several sizes, or do not read such files.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

import numpy as np

from .._core import Error
from ..scene import Scene
from .files import Neighbours
from .model import Surface, Triangles, add_triangles, fan_triangles, strip_triangles
from .textures import NamedImages
from .unsupported import Notes

_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
    "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": ""}
_UVS = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"))
_READ = {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", *(n for pair in _UVS for n in pair)}


@dataclass(frozen=True)
class _List:
    """The values of a list property: those of all rows, and how many each row has."""

    values: np.ndarray
    counts: np.ndarray

    @property
    def firsts(self) -> np.ndarray:
        return np.cumsum(self.counts) - self.counts


_Columns: TypeAlias = dict[str, np.ndarray | _List]


@dataclass(frozen=True)
class _Property:
    name: str
    dtype: np.dtype
    count_dtype: np.dtype | None = None
    """Of the length of a list."""


@dataclass
class _Element:
    name: str
    count: int
    properties: list[_Property] = field(default_factory=list)


@dataclass
class _Header:
    order: str
    elements: list[_Element]
    texture: str | None


def fill_from_ply(path: Path, scene: Scene, notes: Notes) -> None:
    """Fills a scene from a PLY file."""
    data = path.read_bytes()
    header, start = _read_header(data)
    reader = _AsciiRows(data[start:]) if header.order == "" else _BinaryRows(data, start)
    columns = {element.name: reader.read(element) for element in header.elements}
    mesh = _mesh_of(columns, notes)
    texture = None
    if header.texture is not None:
        if mesh.uvs is None:
            notes.left_out("textures on meshes without texture coordinates")
        else:
            images = NamedImages(scene, Neighbours(path, notes), notes)
            texture = images.color(header.texture)
    grey = 0.5 if texture is None and mesh.colors is None else 1.0
    material = scene.add_material(base_color=(grey, grey, grey), base_color_texture=texture)
    add_triangles(scene, path.stem, mesh, Surface(material), notes)


def _read_header(data: bytes) -> tuple[_Header, int]:
    """The header, and where what follows it begins."""
    end = data.find(b"end_header")
    if not data.startswith(b"ply") or end < 0:
        raise Error("cannot be read: is not a PLY file")
    newline = data.find(b"\n", end)
    after = newline + 1 if newline >= 0 else len(data)
    if data[3:4] == b"\r" and data[3:5] != b"\r\n":  # lines of old Macs
        after = end + len(b"end_header\r")
    header = _Header("?", [], None)
    for line in data[:end].decode("latin-1").splitlines():
        try:
            _read_header_line(line, header)
        except (KeyError, IndexError, ValueError) as error:
            raise Error(f"cannot be read: its header has the line {line[:60]!r}") from error
    if header.order not in _ORDERS.values():
        raise Error("cannot be read: its header names no format")
    return header, after


def _read_header_line(line: str, header: _Header) -> None:
    words = line.split()
    match words[:1]:
        case ["format"]:
            header.order = _ORDERS[words[1]]
        case ["element"]:
            header.elements.append(_Element(words[1], int(words[2])))
            if header.elements[-1].count < 0:
                raise ValueError(words[2])
        case ["property"]:
            header.elements[-1].properties.append(_property(words[1:], header.order))
        case ["comment"] if words[1:2] == ["TextureFile"]:
            header.texture = line.split(maxsplit=2)[2].strip()


def _property(words: list[str], order: str) -> _Property:
    if order not in _ORDERS.values():
        raise ValueError("there is no format yet")

    def dtype(word: str) -> np.dtype:
        return np.dtype(order + _TYPES[word])

    if words[0] == "list":
        return _Property(words[3], dtype(words[2]), dtype(words[1]))
    return _Property(words[1], dtype(words[0]))


def _too_short(element: _Element) -> Error:
    return Error(
        f"cannot be read: its header promises {element.count} rows of {element.name!r}, and there "
        "are fewer"
    )


class _BinaryRows:
    """Reads elements one after the other."""

    def __init__(self, data: bytes, start: int) -> None:
        self._data = data
        self._place = start

    def read(self, element: _Element) -> _Columns:
        """The columns of the next element."""
        if element.count == 0:
            return _empty(element)
        counts = self._counts_of_first_row(element)
        dtype = _row_dtype(element, counts)
        if dtype.itemsize == 0:
            return _empty(element)
        room = (len(self._data) - self._place) // dtype.itemsize
        # In most files all rows are like the first.
        rows = np.frombuffer(self._data, dtype, min(element.count, room), self._place)
        even = len(rows) == element.count and all(
            (rows[f"count of {name}"] == count).all() for name, count in counts.items()
        )
        if not even:
            return self._read_uneven(element)
        self._place += rows.nbytes
        return {
            p.name: _List(rows[p.name].reshape(-1), np.full(len(rows), counts[p.name]))
            if p.count_dtype is not None
            else rows[p.name]
            for p in element.properties
        }

    def _counts_of_first_row(self, element: _Element) -> dict[str, int]:
        place, counts = self._place, {}
        for p in element.properties:
            if p.count_dtype is None:
                place += p.dtype.itemsize
                continue
            counts[p.name] = self._count_at(place, p.count_dtype, element)
            place += p.count_dtype.itemsize + counts[p.name] * p.dtype.itemsize
        if place > len(self._data):
            raise _too_short(element)
        return counts

    def _count_at(self, place: int, dtype: np.dtype, element: _Element) -> int:
        raw = self._data[place : place + dtype.itemsize]
        if len(raw) < dtype.itemsize:
            raise _too_short(element)
        return max(int(np.frombuffer(raw, dtype)[0]), 0)

    def _read_uneven(self, element: _Element) -> _Columns:
        """Rows of several lengths: finds where each begins, then gathers the columns."""
        lists = [p for p in element.properties if p.count_dtype is not None]
        if not lists:
            raise _too_short(element)
        bytes_of = memoryview(self._data)
        starts: dict[str, list[int]] = {p.name: [] for p in element.properties}
        place, most = self._place, len(self._data)
        steps = [
            (starts[p.name].append, p.dtype.itemsize,
             0 if p.count_dtype is None else p.count_dtype.itemsize,
             "big" if p.count_dtype is not None and p.count_dtype.byteorder == ">" else "little")
            for p in element.properties
        ]  # fmt: skip
        for _ in range(element.count):
            for note, size, count_size, order in steps:
                note(place)
                if count_size == 0:
                    place += size
                elif count_size == 1 and place < most:
                    place += 1 + bytes_of[place] * size
                else:
                    count = int.from_bytes(bytes_of[place : place + count_size], order)
                    place += count_size + count * size
            if place > most:
                raise _too_short(element)
        self._place = place
        return {p.name: self._gather(p, np.array(starts[p.name])) for p in element.properties}

    def _gather(self, p: _Property, starts: np.ndarray) -> np.ndarray | _List:
        data = np.frombuffer(self._data, np.uint8)

        def values_at(places: np.ndarray, dtype: np.dtype) -> np.ndarray:
            rows = data[places[:, None] + np.arange(dtype.itemsize)]
            return np.ascontiguousarray(rows).view(dtype)[:, 0]

        if p.count_dtype is None:
            return values_at(starts, p.dtype)
        counts = values_at(starts, p.count_dtype).astype(np.int64)
        within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        firsts = np.repeat(starts + p.count_dtype.itemsize, counts)
        return _List(values_at(firsts + within * p.dtype.itemsize, p.dtype), counts)


class _AsciiRows:
    """The same of a text."""

    def __init__(self, data: bytes) -> None:
        try:
            self._numbers = np.array(data.split(), dtype=np.float64)
        except ValueError as error:
            raise Error(f"cannot be read: {error}") from error
        self._place = 0

    def read(self, element: _Element) -> _Columns:
        """The columns of the next element."""
        if not any(p.count_dtype is not None for p in element.properties):
            return self._read_even(element)
        numbers, place = self._numbers, self._place
        starts: dict[str, list[int]] = {p.name: [] for p in element.properties}
        for _ in range(element.count):
            for p in element.properties:
                if place >= len(numbers):
                    raise _too_short(element)
                starts[p.name].append(place)
                place += 1
                if p.count_dtype is not None:
                    count = numbers[place - 1]
                    place += int(count) if 0 <= count < len(numbers) else len(numbers)
        if place > len(numbers):
            raise _too_short(element)
        self._place = place
        return {p.name: self._gather(p, np.array(starts[p.name], int)) for p in element.properties}

    def _read_even(self, element: _Element) -> _Columns:
        columns = len(element.properties)
        rows = self._numbers[self._place : self._place + element.count * columns]
        if len(rows) < element.count * columns:
            raise _too_short(element)
        self._place += len(rows)
        table = rows.reshape(element.count, columns)
        return {p.name: table[:, i].astype(p.dtype) for i, p in enumerate(element.properties)}

    def _gather(self, p: _Property, starts: np.ndarray) -> np.ndarray | _List:
        if p.count_dtype is None:
            return self._numbers[starts].astype(p.dtype)
        counts = self._numbers[starts].astype(np.int64)
        within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        return _List(self._numbers[np.repeat(starts + 1, counts) + within].astype(p.dtype), counts)


def _row_dtype(element: _Element, counts: dict[str, int]) -> np.dtype:
    fields: list[tuple] = []
    for p in element.properties:
        if p.count_dtype is None:
            fields.append((p.name, p.dtype))
        else:
            fields += [(f"count of {p.name}", p.count_dtype), (p.name, p.dtype, (counts[p.name],))]
    try:
        return np.dtype(fields)
    except ValueError as error:
        raise Error(f"cannot be read: element {element.name!r}: {error}") from error


def _empty(element: _Element) -> _Columns:
    nothing = np.empty(0, np.int64)
    return {
        p.name: np.empty(0, p.dtype) if p.count_dtype is None else _List(nothing, nothing)
        for p in element.properties
    }


def _mesh_of(columns: dict[str, _Columns], notes: Notes) -> Triangles:
    vertices, faces = columns.get("vertex", {}), columns.get("face", {})
    notes.left_out("properties of vertices: " + ", ".join(_left_out_of(vertices)),
                   int(bool(_left_out_of(vertices))))  # fmt: skip
    positions = _table(vertices, "x", "y", "z")
    if positions is None:
        raise Error("cannot be read: its vertices have no x, y and z")
    mesh = Triangles(
        positions,
        _indices(columns),
        _table(vertices, "nx", "ny", "nz"),
        next((uvs for pair in _UVS if (uvs := _table(vertices, *pair)) is not None), None),
        _colors(vertices),
    )
    mesh.check("vertex")
    notes.left_out("colours of faces", int("red" in faces))
    notes.left_out("texture coordinates of faces", int("texcoord" in faces))
    return mesh


def _left_out_of(vertices: _Columns) -> list[str]:
    return sorted(set(vertices) - _READ - {"alpha"})


def _table(columns: _Columns, *names: str) -> np.ndarray | None:
    found = [columns.get(name) for name in names]
    if not all(isinstance(column, np.ndarray) for column in found):
        return None
    return np.stack([np.asarray(column, np.float32) for column in found], axis=1)


def _colors(vertices: _Columns) -> np.ndarray | None:
    """Linear, of sRGB as programs write it in 8 and 16 bits; floats are taken as they are."""
    colors = _table(vertices, "red", "green", "blue")
    red = vertices.get("red")
    if colors is None or not isinstance(red, np.ndarray) or red.dtype.kind == "f":
        return colors
    return _from_srgb(colors / np.float32(np.iinfo(red.dtype).max))


def _from_srgb(encoded: np.ndarray) -> np.ndarray:
    """IEC 61966-2-1."""
    encoded = np.clip(encoded, 0.0, 1.0)
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def _indices(columns: dict[str, _Columns]) -> np.ndarray:
    faces = columns.get("face", {})
    corners = faces.get("vertex_indices", faces.get("vertex_index"))
    strips = columns.get("tristrips", {}).get("vertex_indices")
    parts = [np.empty((0, 3), np.int64)]
    if isinstance(corners, _List):
        parts.append(_corners_of(corners, fan_triangles(corners.counts, corners.firsts)))
    if isinstance(strips, _List):
        parts += _strips(strips.values.astype(np.int64))
    indices = np.concatenate(parts)
    if len(indices) and indices.min() < 0:
        raise Error(f"cannot be read: a face has the vertex {indices.min()}")
    return indices


def _corners_of(corners: _List, places: np.ndarray) -> np.ndarray:
    return corners.values.astype(np.int64)[places]


def _strips(values: np.ndarray) -> list[np.ndarray]:
    """Triangles of strips, which -1 parts from each other."""
    ends = [*np.flatnonzero(values == -1), len(values)]
    begins = [0, *(end + 1 for end in ends)]
    strips = [values[begin:end] for begin, end in zip(begins, ends, strict=False)]
    triangles = [strip[strip_triangles(len(strip))] for strip in strips if len(strip) > 2]
    return [t[(t[:, 0] != t[:, 1]) & (t[:, 1] != t[:, 2]) & (t[:, 2] != t[:, 0])] for t in triangles]
