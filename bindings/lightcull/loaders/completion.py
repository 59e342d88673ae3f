"""The camera and the light of a scene whose file has none, or which are asked for."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from .. import _core
from ..camera import Camera, View
from ..scene import Scene
from ..surroundings import AUTO, NONE, Environment, is_auto, studio, texels_of
from ..views import automatic_camera, openness
from .unsupported import Notes

CameraChoice: TypeAlias = str | int | Camera | View | None
"""One of the file by its name or its number from 0; another; what is said of one; None: the first
of the file.
"""

_WIDTH, _HEIGHT, _PASSES = 64, 48, 4
"""Of the picture by which a file's own light is judged."""
_VISIBLE = 0.01
"""Luminance below which a picture is black to the eye, at an exposure of 0."""
_LITTLE = 0.1
"""Part of what the camera sees that must be visible, for the light of a file to be enough."""
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
_IN_A_ROOM, _CLOSED = 0.25, 0.01
"""Of all directions, the part without walls: below the first little light comes in, below the
second none.
"""
_LAMP = 0.6
"""Radiance of a white wall in the light of a lamp at the camera."""


def complete(
    scene: Scene,
    notes: Notes,
    environment: Environment = AUTO,
    environment_scale: float = 1.0,
    camera: CameraChoice = None,
) -> None:
    """Gives a scene the camera and the surroundings that it is to have; notes what was made up."""
    preview: _core.Preview | None = None
    if not (notes.has_camera or is_camera(camera)):
        preview = scene.preview()
        bounds = scene.bounds
        assert bounds is not None
        placed, said = automatic_camera(bounds, preview.distances)
        scene.set_camera(*placed.parameters)
        notes.remark(said)
    choose_camera(scene, camera)
    if is_auto(environment):
        _show(scene, notes, preview or scene.preview(), environment_scale)
    else:
        surround(scene, environment, environment_scale)


def _show(scene: Scene, notes: Notes, preview: _core.Preview, environment_scale: float) -> None:
    """Sees to it that there is light on what the camera sees."""
    said = "no light"
    if notes.has_light:
        part = _visible_part(scene, preview)
        if part >= _LITTLE:
            return
        said = f"its lights show {part:.0%} of what the camera sees"
    opened = openness(scene.camera, preview.distances)
    made = []
    if opened < _IN_A_ROOM:
        made.append("a lamp is placed at the camera")
        _add_lamp(scene, preview)
    if opened > _CLOSED:
        made.append("a studio surrounds it")
        scene.set_environment(studio(scene.camera), environment_scale)
    notes.remark(f"{said}: {' and '.join(made)} (environment {NONE!r}: nothing is)")


def is_camera(camera: CameraChoice) -> bool:
    """Whether it is one that needs none of the file's."""
    return isinstance(camera, Camera) or (isinstance(camera, View) and camera.origin is not None)


def choose_camera(scene: Scene, camera: CameraChoice) -> None:
    """Sees a scene by a camera of its file, or by another."""
    if isinstance(camera, str | int):
        scene.use_camera(camera)
    elif isinstance(camera, Camera):
        scene.set_camera(*camera.parameters)
    elif camera is not None:
        if camera.which is not None:
            scene.use_camera(camera.which)
        if camera.is_changed:
            bounds = scene.bounds
            middle = np.zeros(3) if bounds is None else bounds.mean(axis=0)
            scene.set_camera(*camera.changed(scene.camera, middle).parameters)


def surround(scene: Scene, environment: Environment, scale: float) -> None:
    """Surrounds a scene by anything but AUTO."""
    texels = texels_of(environment, scene.camera)
    if texels is not None:
        scene.set_environment(texels, scale)
    elif scene.has_environment:
        scene.set_environment((0.0, 0.0, 0.0))


def _visible_part(scene: Scene, preview: _core.Preview) -> float:
    """The part of the surfaces in the picture that is not black; 1 where there are none."""
    image = preview.look(*scene.camera.parameters, _WIDTH, _HEIGHT, _PASSES)
    luminance = (image @ _LUMINANCE)[~np.isnan(image[..., 0])]
    return float((luminance >= _VISIBLE).mean()) if luminance.size else 1.0


def _add_lamp(scene: Scene, preview: _core.Preview) -> None:
    """A lamp at the camera, of a strength that suits how far away is what it sees."""
    origin = np.array(scene.camera.origin)
    forward = np.subtract(scene.camera.target, origin)
    aside = np.random.default_rng(0).normal(size=(256, 3)) * 0.3
    directions = (forward / np.linalg.norm(forward) + aside).astype(np.float32)
    found = preview.distances(np.tile(origin.astype(np.float32), (256, 1)), directions)
    lengths = abs(found) * np.linalg.norm(directions, axis=1)
    distance = float(np.median(lengths[np.isfinite(lengths)]))
    intensity = _LAMP * np.pi * distance**2
    scene.add_point_light(origin, (intensity,) * 3)
