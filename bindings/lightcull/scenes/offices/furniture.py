"""Where the furniture of the `offices` scene is, and what it is made of."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from ...scene import Scene
from .. import geometry, scene_parts
from ..color import from_srgb
from ..geometry import Shape
from ..random_numbers import Chance
from . import fittings, pieces
from .plan import Room

DIFFUSE = {
    "wood": "#b08a62",
    "white": "#c9c8c4",
    "black": "#26272a",
    "divider": "#66727f",
    "leaf": "#4c6b35",
    "opal": "#d8d6cf",
    "lining": "#b9b2a4",
    "door": "#b4946c",
    "shade": "#6d2f2a",
    "water": "#7fa3b8",
    "red": "#93392f",
    "blue": "#33557c",
    "grey": "#8b8d8f",
    "yellow": "#c19a3f",
    "fabric black": "#33353a",
    "fabric blue": "#3b5275",
    "fabric green": "#566b4d",
}
GLOSSY = {"metal": ("#8d9094", 0.4), "glass": ("#07090d", 0.08)}
"""Colour and roughness."""


class Furniture:
    """Copies of the pieces, where they were put so far."""

    def __init__(self, chance: Chance) -> None:
        self._pieces = pieces.build(chance) | fittings.build()
        self._places: dict[str, list[np.ndarray]] = defaultdict(list)
        self._yaws: dict[str, list[float]] = defaultdict(list)

    def put(self, name: str, room: Room, place: tuple, yaw: float = 0.0) -> None:
        """place (3,), yaw: in the room's coordinates."""
        self.put_in_world(name, room.at(*place), room.yaw + yaw)

    def put_in_world(self, name: str, place: np.ndarray, yaw: float = 0.0) -> None:
        self._places[name].append(np.asarray(place, dtype=float))
        self._yaws[name].append(yaw)

    def add_to(self, scene: Scene) -> None:
        by_material: dict[str, list[Shape]] = defaultdict(list)
        for name, places in self._places.items():
            for material, shape in self._pieces[name].items():
                # Flat and smooth pieces of a material are one mesh.
                smooth = shape if shape.normals is not None else geometry.faceted(shape)
                smooth = Shape(smooth.positions, smooth.indices, smooth.normals)
                copies = geometry.scatter(smooth, np.array(places), yaws=np.array(self._yaws[name]))
                by_material[material].append(copies)
        for material, shapes in by_material.items():
            scene_parts.add(scene, material, geometry.merge(shapes), _material(scene, material))


def _material(scene: Scene, name: str) -> int:
    if name in GLOSSY:
        color, roughness = GLOSSY[name]
        return scene_parts.glossy(scene, from_srgb(color), roughness)
    return scene_parts.diffuse(scene, from_srgb(DIFFUSE[name]))
