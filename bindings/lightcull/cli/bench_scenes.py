"""The scenes that `lightcull bench` measures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeAlias

from .. import scenes
from ..loaders import open_scene
from ..scene import Scene
from ..scenes.lanterns import LIGHTS
from .view_option import Look

SERIES = "series"
SERIES_LIGHTS = (1_000, 10_000, LIGHTS, 250_000, 1_000_000)

SceneMaker: TypeAlias = Callable[[], Scene]


def scene_makers(names: Sequence[str], look: Look) -> list[SceneMaker]:
    """What makes the scenes of these names (none: all examples and the series), each once. Files are
    read at once, so that errors come at once. look: of files and examples.
    """
    makers: dict[tuple[str, int], SceneMaker] = {}
    for name in names or [*scenes.NAMES, SERIES]:
        if name == SERIES:
            for lights in SERIES_LIGHTS:
                make = partial(scenes.build, "lanterns", lights=lights)
                makers[("lanterns", lights)] = make
        elif name in scenes.NAMES:
            lights = LIGHTS if name == "lanterns" else 0
            makers[(name, lights)] = partial(open_scene, name, **look)
        else:
            makers[(name, 0)] = partial(_same, open_scene(name, **look))
    return list(makers.values())


def _same(scene: Scene) -> Scene:
    return scene
