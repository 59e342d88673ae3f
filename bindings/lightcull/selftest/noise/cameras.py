"""What a camera sees otherwise than sharply and at once: through a lens, and in a mirror."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from .lamps import scattered
from .panels import down
from .situation import Situation
from .stage import Stage


def situations() -> Iterator[Situation]:
    yield Situation("through a lens", "cameras", partial(_lens, False))
    yield Situation("panels through a lens", "cameras", partial(_lens, True))
    yield Situation("in a mirror", "cameras", _Mirror)


def _lens(of_panels: bool) -> Stage:
    """Out of focus: a place of the image is a disk of 0.65 m on the floor."""
    stage = Stage(lens=0.25, margin=1)
    if of_panels:
        for x in np.linspace(-3, 3, 4):
            for z in np.linspace(-3, 3, 4):
                down(stage, (x, 3, z), 0.2, 0.2, 5)
    else:
        stage.points(scattered(0, 100, (-4, 2.6, -4), (4, 4, 4)), 1)
    return stage


class _Mirror(Stage):
    """A floor in a mirror at 45 degrees, in whose shadow a part of it lies. All lamps are above it.

    What the camera sees is what one above the middle of the floor would.
    """

    def __init__(self) -> None:
        half, height, before = 1.5, 2.5, 0.2
        super().__init__(half=half, height=height, margin=2, max_depth=3)
        self.points(scattered(0, 100, (-0.5, 3.2, -4), (4, 4, 4)), 1)
        white = self.scene.add_material(
            "metallic_roughness", (1.0, 1.0, 1.0), metallic=1.0, roughness=0.0
        )
        self.plate((-0.1, 2.4, -0.35), (0.45, -0.45, 0), (0, 0, 0.7), material=white)
        fov = float(2 * np.arctan(half / height))
        middle = height - before
        self.scene.set_camera((-before, middle, 0), (0, middle, 0), vertical_fov=fov)
