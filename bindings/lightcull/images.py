"""Image files, in and out."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from . import _core, checks
from ._core import Error

FORMATS = (".exr", ".png")
"""What images are written as."""


def read_image(path: str | os.PathLike[str], linear_data: bool = False) -> np.ndarray:
    """Reads an image of any usual format: float32 (H, W, 3), linear RGB, row 0 at the top.

    8- and 16-bit images are taken as sRGB, unless linear_data says that they hold numbers.
    """
    return _core.read_image(checks.path("path", path), bool(linear_data))


def write_exr(
    path: str | os.PathLike[str],
    image: np.ndarray,
    *,
    half: bool = False,
    metadata: dict[str, str] | None = None,
) -> None:
    """Writes linear RGB, float32 (H, W, 3), as OpenEXR with 32 or, if `half`, 16 bits."""
    about = checks.texts("metadata", metadata or {})
    _core.write_exr(checks.path("path", path), image, bool(half), about)


def write_png(
    path: str | os.PathLike[str], image: np.ndarray, *, metadata: dict[str, str] | None = None
) -> None:
    """Writes what `apply_view` gave, float32 (H, W, 3), as an 8-bit PNG."""
    _core.write_png(checks.path("path", path), image, checks.texts("metadata", metadata or {}))


def view_names() -> list[str]:
    """The views there are, the default first: those of the configuration that $OCIO names, or
    "aces" and "srgb".
    """
    return _core.view_names()


def apply_view(image: np.ndarray, view: str | None = None, exposure: float = 0.0) -> np.ndarray:
    """What a display shows of linear RGB, float32 (H, W, 3): the same shape, values in [0, 1].

    view: one of `view_names()`; None: the first. exposure: stops.
    """
    name = view_names()[0] if view is None else checks.text("view", view)
    return _core.apply_view(image, name, checks.number("exposure", exposure))


def save_image(
    path: str | os.PathLike[str],
    image: np.ndarray,
    metadata: dict[str, str],
    view: str | None = None,
    exposure: float = 0.0,
) -> None:
    """Writes linear RGB as .exr, or through a view as .png, by the name of the file."""
    if check_format(path) == ".exr":
        if view is not None or exposure != 0.0:
            name = os.fspath(path)
            raise Error(f"{name}: a view and exposure are for a .png; an .exr stays linear")
        write_exr(path, image, metadata=metadata)
    else:
        write_png(path, apply_view(image, view, exposure), metadata=metadata)


def check_format(path: str | os.PathLike[str]) -> str:
    """The ending of a file name, of those in FORMATS."""
    name = checks.path("path", path)
    ending = Path(name).suffix.lower()
    if ending not in FORMATS:
        raise Error(f"{name}: the name must end in {' or '.join(FORMATS)}")
    return ending
