"""SCENE and what goes with it: the scene that is opened, and the image that it has by default."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from .._core import Error
from ..loaders import open_scene
from ..scene import Scene

if TYPE_CHECKING:  # importing it wants Mitsuba, which is optional
    from ..mitsuba import MitsubaScene

AnyScene: TypeAlias = "Scene | MitsubaScene"
ImageSize: TypeAlias = tuple[int, int]

SIZE, MAX_DEPTH = (320, 240), 2
BOUNCED_DEPTH = 3
"""The default where a method finds bounced light alone."""


def open_any(options: argparse.Namespace, default_depth: int) -> tuple[AnyScene, ImageSize, int]:
    """A scene of ours or, for an .xml file, of Mitsuba's, with the size and depth that it says."""
    is_xml = Path(options.scene).suffix.lower() == ".xml"
    if options.host is None and not is_xml:
        if options.variant is not None:
            raise Error(f"{options.scene}: --variant is for an .xml scene of Mitsuba's")
        return open_ours(options), options.size or SIZE, options.max_depth or default_depth
    if not is_xml:
        raise Error(f"{options.scene}: --host mitsuba is for an .xml scene of Mitsuba's")
    if options.virtual_lights is not None:
        raise Error(f"{options.scene}: --virtual-lights is not for a scene of Mitsuba's")
    if options.gltf_lights is not None:
        raise Error(f"{options.scene}: --gltf-lights is not for a scene of Mitsuba's")
    return _open_mitsuba(options)


def open_ours(options: argparse.Namespace) -> Scene:
    """A scene for our own renderer."""
    scene = open_scene(options.scene, gltf_lights=options.gltf_lights)
    if options.virtual_lights is not None:
        scene.add_virtual_lights(options.virtual_lights)
    return scene


def _open_mitsuba(options: argparse.Namespace) -> tuple[MitsubaScene, ImageSize, int]:
    # Here, because importing it wants Mitsuba, which is optional.
    from ..mitsuba.mitsuba_scene import DEFAULT_VARIANT, depth_of_file, load_file

    scene = load_file(options.scene, options.variant or DEFAULT_VARIANT)
    return scene, options.size or scene.size, options.max_depth or depth_of_file(options.scene)
