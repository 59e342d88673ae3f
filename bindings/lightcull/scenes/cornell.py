"""The Cornell box: two blocks in a box of 5.5 m under one square lamp of two triangles."""

from __future__ import annotations

import numpy as np

from ..scene import Scene
from . import geometry, scene_parts
from .geometry import Shape

SIDE = 5.5
LAMP = 1.7
RADIANCE = (21.0, 17.5, 12.5)


def fill(scene: Scene) -> None:
    white = scene_parts.diffuse(scene, (0.73, 0.71, 0.68))
    red = scene_parts.diffuse(scene, (0.61, 0.06, 0.06))
    green = scene_parts.diffuse(scene, (0.12, 0.46, 0.10))
    half, s = SIDE / 2, SIDE
    shell = geometry.merge(
        (
            geometry.quad((-half, 0, half), (s, 0, 0), (0, 0, -s)),
            geometry.quad((-half, s, -half), (s, 0, 0), (0, 0, s)),
            geometry.quad((-half, 0, -half), (s, 0, 0), (0, s, 0)),
        )
    )
    scene_parts.add(scene, "floor, ceiling and back", shell, white)
    scene_parts.add(scene, "left", geometry.quad((-half, 0, half), (0, 0, -s), (0, s, 0)), red)
    scene_parts.add(scene, "right", geometry.quad((half, 0, -half), (0, 0, s), (0, s, 0)), green)
    scene_parts.add(scene, "short block", _block(1.65, 1.65, -0.29).moved(1.0, 0, 0.35), white)
    scene_parts.add(scene, "tall block", _block(1.65, 3.3, 0.30).moved(-0.95, 0, -1.1), white)
    lamp = geometry.quad((-LAMP / 2, s - 0.01, -LAMP / 2 + 0.8), (LAMP, 0, 0), (0, 0, LAMP))
    scene_parts.add_lights(scene, "lamp", lamp, np.array(RADIANCE))
    scene.set_camera(
        origin=(0.0, 2.73, 10.75), target=(0.0, 2.73, 0.0), vertical_fov=np.radians(39.0)
    )


def _block(width: float, height: float, yaw: float) -> Shape:
    half = width / 2
    return geometry.box((-half, 0, -half), (half, height, half)).turned(yaw)
