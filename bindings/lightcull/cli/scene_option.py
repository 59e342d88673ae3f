"""SCENE and what goes with it: the scene that is opened."""

from __future__ import annotations

import argparse
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from .._core import Error
from ..loaders import open_scene
from ..scene import Scene
from ..scene_source import SceneSource
from ..scenes import NAMES
from .progress_bars import reading
from .view_option import look_of

if TYPE_CHECKING:  # importing it wants Mitsuba, which is optional
    from ..mitsuba import MitsubaScene

AnyScene: TypeAlias = "Scene | MitsubaScene"

BOUNCED_DEPTH = 3
"""The default where a method finds bounced light alone."""


def open_any(options: argparse.Namespace) -> AnyScene:
    """A scene of ours or, for an .xml file, of Mitsuba's."""
    is_xml = Path(options.scene).suffix.lower() == ".xml"
    if not is_xml and options.host is not None:
        raise Error(f"{options.scene}: --host mitsuba is for an .xml scene of Mitsuba's")
    _refuse(options, _OURS if is_xml else _MITSUBA, is_xml)
    with reading(options.scene):
        return _open_mitsuba(options) if is_xml else open_ours(options)


def open_ours(options: argparse.Namespace) -> Scene:
    """A scene for our own renderer."""
    scene = open_scene(options.scene, gltf_lights=options.gltf_lights, **look_of(options))
    if options.virtual_lights is not None:
        scene.add_virtual_lights(options.virtual_lights)
        if scene.source is not None:
            scene.source = replace(
                scene.source, digest=scene.digest(), virtual_lights=options.virtual_lights
            )
    return scene


def named_source(options: argparse.Namespace) -> SceneSource:
    """What is said of a scene for our own renderer that is not opened yet, of no digest."""
    name = options.scene if options.scene in NAMES else os.path.abspath(options.scene)
    look = look_of(options)
    return SceneSource(
        "", name, options.gltf_lights, camera=look["camera"], environment=look["environment"],
        environment_scale=look["environment_scale"], virtual_lights=options.virtual_lights,
    )  # fmt: skip


_OURS = ("virtual_lights", "gltf_lights")
_MITSUBA = ("variant", "define")


def _refuse(options: argparse.Namespace, names: tuple[str, ...], is_xml: bool) -> None:
    """Raises Error for options of the other kind of scene."""
    for name in names:
        if getattr(options, name) is not None:
            option = f"--{name.replace('_', '-')}"
            what = "not for" if is_xml else "for"
            raise Error(f"{options.scene}: {option} is {what} an .xml scene of Mitsuba's")


def _open_mitsuba(options: argparse.Namespace) -> MitsubaScene:
    # Here, because importing it wants Mitsuba, which is optional.
    from ..mitsuba.scene_file import DEFAULT_VARIANT, load_file

    parameters = dict(options.define or ())
    scene = load_file(options.scene, options.variant or DEFAULT_VARIANT, parameters)
    look = look_of(options)
    scene.use_camera(look["camera"])
    scene.surround(look["environment"], look["environment_scale"])
    return scene
