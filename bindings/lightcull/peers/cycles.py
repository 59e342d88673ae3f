"""Cycles, the path tracer of Blender, as a sampler among others."""

from __future__ import annotations

import warnings

import numpy as np

from .. import machine
from .._core import Error
from ..rendering.settings import RenderSettings
from ..scene import Scene
from .blender import Blender, check_blender
from .exported import export
from .job import check_settings


def check(description: str) -> bool:
    """Whether the light tree is on. Throws Error unless it describes Cycles, and that is there."""
    _, *options = description.split(":")
    known = {"light_tree=on": True, "light_tree=off": False}
    for option in options:
        if option not in known:
            raise Error(f"{description}: unknown option {option!r}; there are {', '.join(known)}")
    check_blender()
    return all(known[option] for option in options)


class Cycles:
    """A scene that Cycles renders with some settings: jobs that differ in their seed share it."""

    def __init__(self, scene: Scene, description: str, settings: RenderSettings) -> None:
        light_tree = check(description)
        check_settings(description, settings)
        if settings.max_depth < 2:
            raise Error(f"{description}: max_depth is {settings.max_depth}, wanted 2 at least")
        self.description = description
        self.threads = settings.threads or machine.core_count()
        exported = export(scene)
        glossy = sum(material["metallic_roughness"] for material in exported.materials)
        if glossy:
            warnings.warn(
                f"{description}: {glossy} glossy materials are shown by Blender's, which differ a "
                "little: that is in its error",
                stacklevel=2,
            )
        self._blender = Blender(exported, settings, self.threads, light_tree)

    def render(
        self, first: int, samples: int, seed: int
    ) -> tuple[np.ndarray, np.ndarray, float]:
        """As `Peer` has it. What Blender takes to start and to take over the scene, its trees
        included, does not count.
        """
        image, emission, seconds = self._blender.render(first, samples, seed)
        return image, emission, seconds / self.threads
