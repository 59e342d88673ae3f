"""The lights of the `offices` scene: globes, downlights, desk lamps, screens, signs and LEDs."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from ...scene import Scene
from .. import geometry, scene_parts
from ..color import blackbody, with_luminance
from ..geometry import Shape
from ..random_numbers import Chance
from .fittings import GLOBE_RADIUS

LAMP_SIGMA = 0.4
"""Deviation of the logarithm of a lamp's power from that of the others in its room."""


class Lamps:
    """Lamps, where they were put so far."""

    def __init__(self, chance: Chance) -> None:
        self._chance = chance
        globe = geometry.icosahedron()
        self._shapes = {
            "globes": globe.scaled(*(3 * (GLOBE_RADIUS,))),
            "downlights": _disc(0.076, 10),
            "pendants": _flat(geometry.icosphere(1)).scaled(0.13, 0.13, 0.13),
            "bulbs": globe.scaled(0.035, 0.035, 0.035),
            "screens": geometry.quad((-0.275, 0.155, 0.002), (0.55, 0, 0), (0, 0.33, 0)),
            "projections": geometry.quad((-0.8, 1.0, 0.03), (1.6, 0, 0), (0, 0.9, 0)),
            "signs": geometry.box((-0.17, -0.08, -0.02), (0.17, 0.08, 0.02)),
            "LEDs": geometry.quad((-0.007, -0.007, 0.0), (0.014, 0, 0), (0, 0.014, 0)),
        }
        self._places: dict[str, list[np.ndarray]] = defaultdict(list)
        self._yaws: dict[str, list[float]] = defaultdict(list)
        self._radiance: dict[str, list[np.ndarray]] = defaultdict(list)

    def put(
        self, name: str, place: np.ndarray, color: np.ndarray, luminance: float, yaw: float = 0.0
    ) -> None:
        """place (3,), yaw: in the world; luminance: median, W/(m^2 sr)."""
        self._places[name].append(place)
        self._yaws[name].append(yaw)
        own = luminance * float(self._chance.log_normal(LAMP_SIGMA))
        self._radiance[name].append(with_luminance(color, own))

    def add_to(self, scene: Scene) -> None:
        for name, places in self._places.items():
            shape = self._shapes[name]
            copies = geometry.scatter(shape, np.array(places), yaws=np.array(self._yaws[name]))
            radiance = np.repeat(np.array(self._radiance[name]), len(shape.indices), axis=0)
            picture = _screen(self._chance) if name in ("screens", "projections") else None
            scene_parts.add_lights(scene, name, copies, radiance, texture=picture)


def white(kelvin: float) -> np.ndarray:
    """(3,) of luminance 1."""
    return blackbody(np.array(kelvin))


def _disc(radius: float, sides: int) -> Shape:
    """Faces down, a little below y = 0."""
    angles = 2 * np.pi * np.arange(sides) / sides
    ring = np.column_stack((radius * np.cos(angles), np.zeros(sides), radius * np.sin(angles)))
    positions = np.concatenate((np.zeros((1, 3)), ring)) - (0.0, 0.006, 0.0)
    here = np.arange(sides)
    fan = np.column_stack((np.zeros(sides), 1 + here, 1 + (here + 1) % sides))
    return Shape(positions, fan.astype(np.uint32))


def _flat(shape: Shape) -> Shape:
    return Shape(shape.positions, shape.indices)


def _screen(chance: Chance) -> np.ndarray:
    """(H, W, 3): windows with lines of text. Few pixels: a light's mean is taken over them."""
    rows, columns = 24, 40
    picture = np.full((rows, columns, 3), (0.18, 0.28, 0.42))
    for left, right, top, bottom in ((2, 24, 2, 20), (22, 38, 7, 23)):
        picture[top:bottom, left:right] = 0.92
        picture[top, left:right] = (0.3, 0.42, 0.6)
        for row in range(top + 2, bottom - 1, 2):
            end = left + 2 + int(chance.uniform(4, right - left - 3))
            picture[row, left + 1 : end] = chance.pick(np.array((0.35, 0.5, 0.62)))
    return picture
