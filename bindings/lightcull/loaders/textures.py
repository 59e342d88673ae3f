"""Images, as textures."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from .._core import Error, read_image
from ..scene import Scene
from .files import Neighbours
from .unsupported import Notes

Source: TypeAlias = Callable[[], bytes | None]
"""Gives an image file's bytes; None, with a note, if it cannot."""


class Textures:
    """Makes each texture of a file once. Images keep their 8 or 16 bits."""

    def __init__(self, scene: Scene, notes: Notes) -> None:
        self._scene = scene
        self._notes = notes
        self._decoded: dict[str, tuple[np.ndarray, np.ndarray | None] | None] = {}
        self._made: dict[tuple[str, str], int | None] = {}

    def color(self, name: str, source: Source, *, linear_data: bool = False) -> int | None:
        """The texture of an image's colours: sRGB, or numbers. None, with a note, if the image cannot
        be read. name: that of the image.
        """
        key = (name, "numbers" if linear_data else "colours")
        if key not in self._made:
            image = self._decode(name, source)
            self._made[key] = image and self._scene.add_texture(image[0], linear_data=linear_data)
        return self._made[key]

    def alpha(self, name: str, source: Source) -> int | None:
        """The texture of an image's alpha; None where it has none, or cannot be read."""
        key = (name, "alpha")
        if key not in self._made:
            image = self._decode(name, source)
            alpha = image[1] if image else None
            made = None if alpha is None else self._scene.add_texture(alpha, linear_data=True)
            self._made[key] = made
        return self._made[key]

    def _decode(self, name: str, source: Source) -> tuple[np.ndarray, np.ndarray | None] | None:
        if name not in self._decoded:
            data = source()
            try:
                self._decoded[name] = None if data is None else decode(data)
            except Exception:  # PIL lets through what its decoders meet
                self._notes.left_out(f"image {name!r} that cannot be read")
                self._decoded[name] = None
        return self._decoded[name]


def decode(data: bytes) -> tuple[np.ndarray, np.ndarray | None]:
    """Colours, uint8 or uint16 (H, W, 3) or (H, W), and alpha, (H, W), unless it is all opaque."""
    from PIL import Image

    with Image.open(io.BytesIO(data)) as image:
        image.load()
        if image.mode.startswith("I"):
            return np.clip(np.asarray(image), 0, 65535).astype(np.uint16), None
        if image.mode in ("L", "1"):
            return np.array(image.convert("L")), None
        if not image.has_transparency_data:
            return np.array(image.convert("RGB")), None
        texels = np.array(image.convert("RGBA"))
    alpha = np.ascontiguousarray(texels[..., 3])
    return np.ascontiguousarray(texels[..., :3]), None if alpha.min() == 255 else alpha


class NamedImages:
    """Textures of image files that a file names."""

    def __init__(self, scene: Scene, neighbours: Neighbours, notes: Notes) -> None:
        self._textures = Textures(scene, notes)
        self._neighbours = neighbours
        self._scene = scene
        self._notes = notes

    def color(self, name: str, *, linear_data: bool = False) -> int | None:
        """The texture of an image's colours; None, with a note, if there is none."""
        if name.lower().endswith((".exr", ".hdr")):
            return self._floats(name)
        return self._textures.color(name, self._source(name), linear_data=linear_data)

    def alpha(self, name: str) -> int | None:
        """The texture of an image's alpha; None where it has none."""
        return self._textures.alpha(name, self._source(name))

    def _source(self, name: str) -> Source:
        return lambda: self._neighbours.read(name)

    def _floats(self, name: str) -> int | None:
        path = self._neighbours.find(name)
        if path is None:
            return None
        try:
            return self._scene.add_texture(read_image(str(path)))
        except Error:
            self._notes.left_out(f"image {name!r} that cannot be read")
            return None
