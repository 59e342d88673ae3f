"""A street at night in a town of 36 blocks: lit windows, shops, neon signs, street lamps, cars.

Nearly all of the lights are in other streets than the camera.
"""

from __future__ import annotations

import numpy as np

from ..scene import Scene
from . import geometry, interiors, scene_parts
from .color import blackbody, from_srgb, with_luminance
from .geometry import Shape
from .houses import BLOCK, KERB, LOT, Town, add_town, build_block, build_house
from .plants import leafy_balls
from .random_numbers import Chance

BLOCKS = 6
"""Along either side of the town."""
STREET = 18.0
PITCH = BLOCK + STREET
ROAD = 11.0
"""Width of the carriageway; what is left of the street is pavement."""
VISTA = -82.0
"""z of the front of the tower that closes the camera's street."""
LAMPS_PER_BLOCK = 5
"""On each side of a street."""


def fill(scene: Scene) -> None:
    chance = Chance(1928)
    town = Town(interiors.rooms(chance), interiors.shops(chance))
    centres = (np.arange(BLOCKS) + 0.5 - BLOCKS / 2) * PITCH
    for z in centres:
        for x in centres:
            build_block(town, chance, x, z)
    build_house(town, chance, np.array((-LOT / 2, VISTA - LOT)), 17, ["south"])
    add_town(scene, town)
    _add_ground(scene, centres)
    _add_lamps(scene, chance, centres)
    _add_cars(scene, chance)
    _add_trees(scene, chance)
    scene.set_camera(
        origin=(-2.6, 2.6, 97.0), target=(1.2, 8.2, 40.0), vertical_fov=np.radians(58.0)
    )


def _add_ground(scene: Scene, centres: np.ndarray) -> None:
    reach = BLOCKS * PITCH / 2 + STREET
    asphalt = scene_parts.diffuse(scene, from_srgb("#5c5d61"))
    road = geometry.quad((-reach, 0, reach), (2 * reach, 0, 0), (0, 0, -2 * reach))
    scene_parts.add(scene, "road", road, asphalt)

    half = BLOCK / 2 + (STREET - ROAD) / 2
    pavements = [
        geometry.box((x - half, -0.1, z - half), (x + half, KERB, z + half))
        for x in centres
        for z in centres
    ]
    paving = scene_parts.diffuse(scene, from_srgb("#8d8a85"))
    scene_parts.add(scene, "pavements", geometry.merge(pavements), paving)

    paint = scene_parts.diffuse(scene, from_srgb("#d8d6cc"))
    scene_parts.add(scene, "markings", _markings(), paint)


def _markings() -> Shape:
    """Dashes along the camera's street, and zebra crossings at its corners."""
    corner_z = (np.arange(BLOCKS + 1) - BLOCKS / 2) * PITCH
    marks = []
    for z in np.arange(VISTA + 1, BLOCKS * PITCH / 2, 6.0):
        if np.abs(corner_z - (z + 1.5)).min() > STREET / 2 + 3.5:
            marks.append(_mark(0.0, z + 1.5, 0.08, 1.5))
    for z in corner_z:
        for side in (-1, 1):
            for x in np.arange(-ROAD / 2 + 0.6, ROAD / 2, 1.1):
                marks.append(_mark(x, z + side * (STREET / 2 + 1.2), 0.28, 1.5))
    return geometry.merge(marks)


def _mark(x: float, z: float, half_width: float, half_length: float) -> Shape:
    return geometry.quad(
        (x - half_width, 0.012, z + half_length), (2 * half_width, 0, 0), (0, 0, -2 * half_length)
    )


def _add_lamps(scene: Scene, chance: Chance, centres: np.ndarray) -> None:
    """Globes on posts along both sides of every street between the blocks."""
    along = (np.arange(LAMPS_PER_BLOCK) + 0.5) * BLOCK / LAMPS_PER_BLOCK - BLOCK / 2
    streets = (np.arange(BLOCKS - 1) + 1 - BLOCKS / 2) * PITCH
    offset = ROAD / 2 + 0.5
    places = []
    for street in streets:
        for block in centres:
            for step in along:
                for side in (-offset, offset):
                    places.append((street + side, KERB, block + step))
                    places.append((block + step, KERB, street + side))
    places = np.array(places)
    in_tower = (np.abs(places[:, 0]) < LOT / 2) & (
        np.abs(places[:, 2] - VISTA + LOT / 2) < LOT / 2 + 1
    )
    places = places[~in_tower]

    radius, top = 0.27, 4.0
    post = [(0.2, 0.0), (0.2, 0.25), (0.1, 0.4), (0.07, 0.9), (0.05, top - 0.2), (0.12, top - 0.1),
            (0.12, top - 0.02), (0.0, top)]  # fmt: skip
    iron = scene_parts.diffuse(scene, np.full(3, 0.05))
    scene_parts.add(scene, "lamp posts", geometry.scatter(geometry.lathe(post, 10), places), iron)
    globes = geometry.scatter(
        geometry.icosahedron(), places + (0.0, top + radius, 0.0), radius,
        chance.uniform(0, 2 * np.pi, len(places)),
    )  # fmt: skip
    color = blackbody(np.where(chance.uniform(shape=len(places)) < 0.8, 2600.0, 3900.0))
    radiance = with_luminance(color, 120.0 * chance.log_normal(0.4, len(places)))
    scene_parts.add_lights(scene, "lamps", globes, np.repeat(radiance, 20, axis=0))


def _add_cars(scene: Scene, chance: Chance) -> None:
    """Cars parked along the camera's street, and some that drive there with their lights on."""
    parked_z = np.arange(VISTA + 10, 210.0, 7.5)
    corner_z = (np.arange(BLOCKS + 1) - BLOCKS / 2) * PITCH
    clear = np.abs(parked_z[:, None] - corner_z).min(axis=1) > STREET / 2 + 6
    cars = []
    for side in (-1.0, 1.0):
        z = parked_z[clear & (chance.uniform(shape=len(parked_z)) < 0.7)]
        cars += [(side * (ROAD / 2 - 1.15), 0.0, at + chance.uniform(-0.8, 0.8)) for at in z]
    # None where the camera would look through it.
    parked = np.array([car for car in cars if car[0] > 0 or not 84.0 < car[2] < 102.0])
    driving = np.array([(1.75, 0.0, 79.0), (1.75, 0.0, 24.0), (1.8, 0.0, -41.0),
                        (-1.7, 0.0, 58.0), (-1.75, 0.0, -15.0), (-1.7, 0.0, -60.0)])  # fmt: skip
    places = np.concatenate((parked, driving))
    # Those on the right go away from the camera, towards -Z; they are built facing +Z.
    yaws = np.where(places[:, 0] > 0, np.pi, 0.0)

    paints = ("#23272e", "#7c1d1f", "#c9ccd1", "#27415f", "#4e5a4a")
    sides = [(-0.86, -2.15), (-0.86, 2.2), (0.86, 2.2), (0.86, -2.15)]
    body = geometry.merge(
        (geometry.prism(sides, 0.32, 0.62), geometry.prism(sides, 0.62, 0.92, 0.95))
    )
    roof = [(-0.78, -1.8), (-0.78, 0.75), (0.78, 0.75), (0.78, -1.8)]
    cabin = geometry.prism(roof, 0.92, 1.42, 0.76)
    wheel = geometry.lathe([(0.0, -0.11), (0.31, -0.11), (0.31, 0.11), (0.0, 0.11)], 16)
    wheel = Shape(wheel.positions[:, [1, 2, 0]], wheel.indices, wheel.normals[:, [1, 2, 0]])
    wheels = geometry.scatter(wheel, [(x, 0.31, z) for x in (-0.78, 0.78) for z in (-1.35, 1.4)])
    which = chance.pick(np.arange(len(paints)), len(places))
    for i, code in enumerate(paints):
        own = which == i
        shape = geometry.scatter(body, places[own], yaws=yaws[own])
        scene_parts.add(
            scene, f"cars {code}", shape, scene_parts.glossy(scene, from_srgb(code), 0.3)
        )
    glass = scene_parts.glossy(scene, np.full(3, 0.015), roughness=0.1)
    scene_parts.add(scene, "car windows", geometry.scatter(cabin, places, yaws=yaws), glass)
    rubber = scene_parts.diffuse(scene, np.full(3, 0.03))
    scene_parts.add(scene, "wheels", geometry.scatter(wheels, places, yaws=yaws), rubber)

    turns = yaws[len(parked) :]
    for name, z, facing, color, luminance in (
        ("headlamps", 2.22, 1.0, blackbody(np.array(4300.0)), 60.0),
        ("tail lamps", -2.17, -1.0, from_srgb("#ff1a10"), 9.0),
    ):
        lamp = geometry.merge(
            [geometry.quad((x - 0.17 * facing, 0.5, z), (0.34 * facing, 0, 0), (0, 0.14, 0))
             for x in (-0.62, 0.62)]
        )  # fmt: skip
        lamps = geometry.scatter(lamp, driving, yaws=turns)
        scene_parts.add_lights(scene, name, lamps, with_luminance(color, luminance))


def _add_trees(scene: Scene, chance: Chance) -> None:
    z = np.concatenate([(np.arange(3) + 0.5) * 14.0 - 21.0 + block for block in (-36, 36, 108)])
    places = np.array([(side * (ROAD / 2 + 0.9), KERB, at + 3.4) for at in z for side in (-1, 1)])
    trunk = geometry.lathe([(0.14, 0.0), (0.09, 3.4)], 8)
    bark = scene_parts.diffuse(scene, from_srgb("#4b3d33"))
    scene_parts.add(scene, "trunks", geometry.scatter(trunk, places), bark)
    crowns = places + (0.0, 4.3, 0.0)
    leaf = scene_parts.diffuse(scene, from_srgb("#56733c"))
    scene_parts.add(scene, "leaves", leafy_balls(chance, crowns, (0.7, 1.6), 700, 0.13), leaf)
