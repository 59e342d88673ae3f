"""The camera of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi
from typing import TypeAlias

import numpy as np

from ._core import Error

Triple: TypeAlias = tuple[float, float, float]


def triple(vector: Sequence[float] | np.ndarray) -> Triple:
    """Three numbers as they are kept."""
    x, y, z = vector
    return float(x), float(y), float(z)

_FOV = pi / 4


@dataclass(frozen=True)
class Camera:
    """A thin lens that looks from origin to target; a pinhole where aperture_radius is 0.
    Orthographic where orthographic_height is above 0.
    """

    origin: Triple = (0.0, 0.0, 1.0)
    """Metres."""
    target: Triple = (0.0, 0.0, 0.0)
    """Metres."""
    up: Triple = (0.0, 1.0, 0.0)
    """Any direction but that of the view."""
    vertical_fov: float = 0.8
    """Radians, between 0 and pi."""
    aperture_radius: float = 0.0
    """Metres."""
    focus_distance: float = 1.0
    """Metres."""
    orthographic_height: float = 0.0
    """Metres that the image is high: its rays are parallel. 0: perspective."""
    name: str = ""
    """In its file."""

    @property
    def parameters(self) -> tuple[Triple, Triple, Triple, float, float, float, float]:
        """As `Scene.set_camera` takes them."""
        lens = (self.vertical_fov, self.aperture_radius, self.focus_distance)
        return self.origin, self.target, self.up, *lens, self.orthographic_height


@dataclass(frozen=True)
class View:
    """What is said of a camera; None: nothing. What is not said is that of the file's camera."""

    which: str | int | None = None
    """A camera of the file, by its name or by its number from 0."""
    origin: Triple | None = None
    """Metres. A camera of its own, that looks to the middle of the scene unless told."""
    target: Triple | None = None
    """Metres."""
    up: Triple | None = None
    vertical_fov: float | None = None
    """Radians."""

    @property
    def is_changed(self) -> bool:
        """Whether it is more than one of the file's."""
        return any(v is not None for v in (self.origin, self.target, self.up, self.vertical_fov))

    def changed(self, camera: Camera, middle: np.ndarray) -> Camera:
        """A camera of the file as this has it. middle: of the scene, float (3,)."""
        if self.origin is not None:
            x, y, z = (float(number) for number in middle)
            camera = Camera(self.origin, (x, y, z), vertical_fov=_FOV)
        if self.target is not None:
            camera = replace(camera, target=self.target)
        if self.vertical_fov is not None:
            camera = replace(camera, vertical_fov=self.vertical_fov, orthographic_height=0.0)
        if self.up is not None:
            return replace(camera, up=self.up)
        forward = np.subtract(camera.target, camera.origin)
        if np.linalg.norm(np.cross(forward, camera.up)) < 1e-3 * np.linalg.norm(forward):
            camera = replace(camera, up=(0.0, 0.0, -1.0))  # it looks straight down, or up
        return replace(camera, name="")


def chosen_camera(names: Sequence[str], which: str | int) -> int:
    """The number of a camera by its name, or by its number from 0. Raises Error without one."""
    if which in names:
        return list(names).index(str(which))
    if str(which).isdecimal() and int(which) < len(names):
        return int(which)
    there = ", ".join(f"{i} {name!r}" if name else str(i) for i, name in enumerate(names))
    raise Error(f"no camera {which!r}; there are {there or 'none'}")
