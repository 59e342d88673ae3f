"""Scenes that are opened again, from where they were."""

from __future__ import annotations

import warnings
from typing import cast

from ..scene import Scene
from ..scene_source import SceneSource
from . import open_scene
from .gltf import LightUnit


def reopen(source: SceneSource) -> Scene:
    """The scene of a source, as it is there now."""
    with warnings.catch_warnings():  # whoever opened it first has seen them
        warnings.simplefilter("ignore")
        scene = open_scene(
            source.name, gltf_lights=cast(LightUnit | None, source.gltf_lights),
            environment=source.environment, environment_scale=source.environment_scale,
            camera=source.camera,
        )  # fmt: skip
        if source.virtual_lights is not None:
            scene.add_virtual_lights(source.virtual_lights)
    return scene
