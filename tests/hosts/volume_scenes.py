"""Small Mitsuba scenes with media, each different in kind, as dictionaries for `mi.load_dict`.

Lamps keep a distance from surfaces that let light straight through: shadow rays of Mitsuba's own
`volpath` that have passed one may hit the lamp that they are aimed at, which is darker then.
"""

from __future__ import annotations

from typing import Any

import mitsuba as mi
import numpy as np
from mitsuba_scenes import SceneDict, area, diffuse, rectangle, rgb, sensor, transform

SIZE = (16, 12)
NULL = {"type": "null"}


def fog(sigma_t: Any = 0.3, albedo: Any = 0.9, **options: Any) -> SceneDict:
    """The same everywhere; sigma_t in 1/m."""
    numbers = {
        name: rgb(*value) if isinstance(value, tuple) else value
        for name, value in {"sigma_t": sigma_t, "albedo": albedo}.items()
    }
    return {"type": "homogeneous", **numbers, **options}


def forward(g: float) -> SceneDict:
    return {"type": "hg", "g": g}


def grid(channels: int = 1) -> Any:
    """Blobs of density between 0 and 1, (8, 8, 8, channels)."""
    random = np.random.default_rng(4)
    values = random.uniform(size=(8, 8, 8, channels)) * (random.uniform(size=(8, 8, 8, 1)) < 0.4)
    return mi.VolumeGrid(values.astype(np.float32))


def smoke(low: Any, high: Any, scale: float, channels: int = 1, **options: Any) -> SceneDict:
    """Blobs in the box from `low` to `high`, up to `scale` dense, 1/m."""
    size = np.subtract(high, low)
    to_world = transform().translate([float(x) for x in low]).scale([float(x) for x in size])
    density = {"type": "gridvolume", "grid": grid(channels), "to_world": to_world, "raw": True}
    return {"type": "heterogeneous", "sigma_t": density, "albedo": 0.8, "scale": scale, **options}


def box(low: Any, high: Any, medium: SceneDict, bsdf: SceneDict = NULL) -> SceneDict:
    """A box with a medium in it."""
    middle, half = 0.5 * np.add(low, high), 0.5 * np.subtract(high, low)
    to_world = transform().translate([float(x) for x in middle]).scale([float(x) for x in half])
    return {"type": "cube", "to_world": to_world, "bsdf": bsdf, "interior": medium}


def ball(center: Any, radius: float, medium: SceneDict | None, bsdf: SceneDict = NULL) -> SceneDict:
    shape = {"type": "sphere", "center": center, "radius": radius, "bsdf": bsdf}
    return shape if medium is None else shape | {"interior": medium}


def room(medium: SceneDict | None = None) -> SceneDict:
    """A floor and a wall, without light, seen by a camera in `medium`."""
    camera = sensor({"width": SIZE[0], "height": SIZE[1]})
    wall = {"type": "rectangle", "to_world": transform().translate([0, 2, -3]).scale(5)}
    return {
        "type": "scene",
        "sensor": camera if medium is None else camera | {"medium": medium},
        "floor": rectangle([0, 0, 0], 5, None, down=False) | {"bsdf": diffuse(0.6, 0.5, 0.4)},
        "wall": wall | {"bsdf": diffuse(0.3, 0.5, 0.6)},
    }


def lamps(count: int = 3) -> SceneDict:
    """Squares in a row under the ceiling, of several colours."""
    return {
        f"lamp{i}": rectangle([x, 3.2, 0.5], 0.35, area(12 + 4 * i, 10, 8))
        for i, x in enumerate(np.linspace(-2, 2, count))
    }


AROUND = ([-6, -1, -4], [6, 6, 9])
"""Corners of a box that holds all of `room()` and its camera."""


def in_fog() -> SceneDict:
    """Camera and lamps in fog without end."""
    return room(fog()) | lamps()


def in_a_box_of_fog() -> SceneDict:
    """Fog in a box, in which lamps are; the camera is outside."""
    return room() | lamps() | {"fog": box([-4, -0.5, -2.5], [4, 5, 3], fog(0.4))}


def in_a_box_of_smoke() -> SceneDict:
    """As that, of varying density."""
    low, high = [-4, -0.5, -2.5], [4, 5, 3]
    return room() | lamps() | {"smoke": box(low, high, smoke(low, high, 1.5))}


def colored_fog() -> SceneDict:
    """Extinction of another size in each channel, and light that is scattered forwards."""
    medium = fog((0.1, 0.4, 1.0), (0.95, 0.8, 0.6), phase=forward(0.7))
    return room() | lamps() | {"fog": box([-4, -0.5, -2.5], [4, 5, 3], medium)}


def colored_smoke() -> SceneDict:
    """As that, of varying density."""
    low, high = [-4, -0.5, -2.5], [4, 5, 3]
    medium = smoke(low, high, 1.5, 3, phase=forward(-0.5))
    return room() | lamps() | {"smoke": box(low, high, medium)}


def lamp_in_a_ball_of_fog() -> SceneDict:
    lamp = ball([0, 1.2, 0], 0.3, None, diffuse(0.5)) | {"emitter": area(8, 6, 4)}
    return room() | {"fog": ball([0, 1.2, 0], 1.2, fog(1.5, 0.8)), "lamp": lamp}


def spot_into_rough_glass() -> SceneDict:
    """The spot reaches what is in the ball through its surface alone."""
    spot = {
        "type": "spot",
        "to_world": transform().look_at([2, 4, 3], [0, 1, 0], [0, 0, 1]),
        "intensity": rgb(150.0),
        "cutoff_angle": 30,
    }
    glass = {"type": "roughdielectric", "alpha": 0.4, "int_ior": 1.2}
    return room() | lamps(1) | {"ball": ball([0, 1.2, 0], 1.1, fog(0.8, 0.9), glass), "spot": spot}


def under_a_sky() -> SceneDict:
    """A boundary of no effect between fog and a sky."""
    sky = np.full((16, 32, 3), (0.2, 0.3, 0.5), np.float32)
    sky[3:5, 10:14] = (9.0, 8.0, 6.0)
    return room() | {
        "fog": ball([0, 1.2, 0], 1.2, fog(1.0)),
        "sky": {"type": "envmap", "bitmap": mi.Bitmap(sky)},
    }


def nested() -> SceneDict:
    """Smoke and a ball of dense fog in a box of thin fog, which they push away; one of glass."""
    thin, low, high = fog(0.1), [-2.2, 0.2, -1], [-0.4, 2, 1]
    dense = ball([1.2, 1.0, 0.5], 0.8, fog(2.0, (0.9, 0.5, 0.3))) | {"exterior": thin}
    glass = {"type": "dielectric", "int_ior": 1.3}
    clear = ball([0.1, 0.6, 1.8], 0.4, None, glass) | {"exterior": thin}
    cloud = box(low, high, smoke(low, high, 4.0)) | {"exterior": thin}
    return room() | lamps() | {
        "fog": box([-4, -0.5, -2.5], [4, 5, 3], thin),
        "dense": dense,
        "clear": clear,
        "cloud": cloud,
    }


def all_kinds_of_emitters() -> SceneDict:
    """Lamps, a point, a direction, and a sky, with glossy surfaces in fog. The point is not in the
    fog, where the variance of its light has no bound.
    """
    metal = {"type": "roughconductor", "alpha": 0.2}
    return room() | lamps(2) | {
        "metal": ball([0.8, 0.9, 0.5], 0.9, None, metal),
        "fog": box([-4, -0.5, -2.5], [4, 5, 3], fog(0.2)),
        "point": {"type": "point", "position": [-5, 3, 1], "intensity": rgb(20, 18, 15)},
        "sun": {"type": "directional", "direction": [0.4, -1, -0.5], "irradiance": rgb(1, 1, 0.8)},
        "sky": {"type": "constant", "radiance": rgb(0.3)},
    }


def many_bulbs(count: int = 2000, sigma_t: float = 0.15) -> SceneDict:
    """So many octahedra, one mesh, in fog."""
    places = np.random.default_rng(5).uniform((-3, 0.4, -2.5), (3, 3.5, 3), (count, 3))
    return room(fog(sigma_t)) | {"bulbs": octahedra(places, 0.02, rgb(40, 34, 26))}


def octahedra(centers: np.ndarray, radius: float, radiance: SceneDict) -> Any:
    """One mesh that emits: (N, 3) centres."""
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
    positions = (centers[:, None, :] + radius * axes).reshape(-1, 3).astype(np.float32)
    indices = (6 * np.arange(len(centers))[:, None, None] + np.array(faces)).reshape(-1, 3)
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(diffuse(0.2))
    properties["emitter"] = mi.load_dict({"type": "area", "radiance": radiance})
    mesh = mi.Mesh("bulbs", len(positions), len(indices), props=properties)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = positions.ravel()
    parameters["faces"] = indices.astype(np.uint32).ravel()
    parameters.update()
    return mesh


def lamps_behind_fog() -> SceneDict:
    """Lamps in view, behind a ball of fog and beside it."""
    shown = {
        f"shown{i}": rectangle([x, 0, 0], 0.3, area(4, 4, 4))
        | {"to_world": transform().translate([x, 1.2, -1]).scale(0.5)}
        for i, x in enumerate((-0.2, 1.8))
    }
    return room() | shown | {"fog": ball([0, 1.2, 1.2], 0.8, fog(0.8))}


def without_sampling_of_emitters() -> SceneDict:
    """Fog that is lit by what the phase function finds."""
    return room() | lamps(1) | {
        "sky": {"type": "constant", "radiance": rgb(0.5)},
        "fog": box([-4, -0.5, -2.5], [4, 5, 3], fog(0.4, sample_emitters=False)),
    }


def lamp_just_outside(**options: Any) -> SceneDict:
    """Fog that is lit by a lamp a few centimetres from its boundary."""
    seen = room()
    fog_box = box([-1.2, 0.2, -1], [1.2, 2, 1], fog(0.8, **options))
    lamp = rectangle([0, 2.02, 0], 0.5, area(9, 8, 7))
    return {name: seen[name] for name in ("type", "sensor")} | {"fog": fog_box, "lamp": lamp}


def street(size: tuple[int, int] = SIZE) -> SceneDict:
    """10,000 bulbs of 4 cm on both sides of 200 m of road, in fog of a mean free path of 20 m."""
    random = np.random.default_rng(5)
    side = np.where(random.uniform(size=10_000) < 0.5, -4, 4)
    places = np.stack(
        [
            side + random.normal(0, 0.3, 10_000),
            random.uniform(2, 4, 10_000),
            random.uniform(-200, 5, 10_000),
        ],
        axis=1,
    )
    scene = room(fog(0.05))
    scene["sensor"]["film"] |= {"width": size[0], "height": size[1]}
    scene["floor"]["to_world"] = transform().translate([0, 0, -100]).rotate([1, 0, 0], -90).scale([8, 120, 1])
    del scene["wall"]
    return scene | {"bulbs": octahedra(places, 0.02, rgb(40, 34, 26))}
