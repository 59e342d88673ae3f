"""10,000 fairy lights on a tree in Mitsuba 3, by its own `path` and by `lightcull_path`.

    python examples/mitsuba_fairy_lights.py [--seconds 20] [--variant llvm_ad_rgb] [-o FOLDER]

Each integrator renders for as many seconds; their pictures are fairy_lights_path.png and
fairy_lights_lightcull_path.png. What it takes to change over is the name of the integrator; merging
the bulbs into a few meshes helps both, and most of all in LLVM variants.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any

import lightcull.mitsuba
import mitsuba as mi
import numpy as np

BULBS = 10_000
COLORS = {
    "red": (30.0, 3.0, 2.0),
    "amber": (28.0, 14.0, 3.0),
    "green": (3.0, 24.0, 5.0),
    "blue": (3.0, 6.0, 40.0),
    "white": (20.0, 19.0, 16.0),
}
HEIGHT, RADIUS, BULB = 4.0, 1.5, 0.012
"""Of the tree and of half a bulb, metres."""


def spiral() -> np.ndarray:
    """Places on a cone, evenly over its surface: (BULBS, 3)."""
    turn = np.arange(BULBS) * np.pi * (3 - np.sqrt(5))
    below_top = np.sqrt((np.arange(BULBS) + 0.5) / BULBS)
    out = RADIUS * below_top + 0.03
    return np.stack([out * np.cos(turn), 0.3 + HEIGHT * (1 - below_top), out * np.sin(turn)], axis=1)


def matte(*reflectance: float) -> dict[str, Any]:
    return {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(reflectance)}}


def tree(rings: int = 48, sides: int = 96) -> Any:
    """A cone whose sides are ragged like needles."""
    random = np.random.default_rng(3)
    level, turn = np.meshgrid(np.linspace(0, 1, rings), np.arange(sides), indexing="ij")
    angle = turn / sides * 2 * np.pi
    out = RADIUS * level * random.uniform(0.8, 1.0, level.shape)
    height = 0.3 + HEIGHT * (1 - level)
    positions = np.stack([out * np.cos(angle), height, out * np.sin(angle)], axis=-1)
    ring, side = np.meshgrid(np.arange(rings - 1), np.arange(sides), indexing="ij")
    a, b = ring * sides + side, ring * sides + (side + 1) % sides
    faces = np.concatenate(
        [np.stack([a, a + sides, b], -1).reshape(-1, 3),
         np.stack([b, a + sides, b + sides], -1).reshape(-1, 3)]
    )  # fmt: skip
    properties = mi.Properties()
    green = {"type": "twosided", "bsdf": matte(0.05, 0.16, 0.07)}
    properties["bsdf"] = mi.load_dict(green)
    mesh = mi.Mesh("tree", positions.size // 3, len(faces), props=properties)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = positions.astype(np.float32).ravel()
    parameters["faces"] = faces.astype(np.uint32).ravel()
    parameters.update()
    return mesh


def fairy_lights(width: int, height: int) -> dict[str, Any]:
    """The scene, with a shape and an emitter for every bulb, as one would write it down."""
    transform = mi.ScalarTransform4f
    scene: dict[str, Any] = {
        "type": "scene",
        "sensor": {
            "type": "perspective",
            "fov": 40,
            "to_world": transform().look_at([0, 2.2, 7.5], [0, 2.1, 0], [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": width, "height": height},
        },
        "snow": {
            "type": "rectangle",
            "to_world": transform().rotate([1, 0, 0], -90).scale(12),
            "bsdf": matte(0.8, 0.8, 0.85),
        },
        "wall": {
            "type": "rectangle",
            "to_world": transform().translate([0, 4, -3]).scale(12),
            "bsdf": matte(0.4, 0.35, 0.3),
        },
        "tree": tree(),
    }
    colors = list(COLORS.values())
    for i, place in enumerate(spiral()):
        scene[f"bulb{i}"] = {
            "type": "cube",
            "to_world": transform().translate([float(x) for x in place]).scale(BULB),
            "bsdf": matte(0.0, 0.0, 0.0),
            "emitter": {
                "type": "area",
                "radiance": {"type": "rgb", "value": list(colors[i % len(colors)])},
            },
        }
    return scene


def render(scene: Any, name: str, seconds: float) -> tuple[np.ndarray, int]:
    """For so many seconds of wall time: the picture, and its samples per pixel."""
    integrator = mi.load_dict({"type": name, "max_depth": 4})
    mi.render(scene, integrator=integrator, spp=1)  # compiles kernels
    total, spp, renders, pass_spp = 0.0, 0, 0, 4
    start = time.perf_counter()
    while time.perf_counter() - start < seconds:
        began = time.perf_counter()
        image = mi.render(scene, integrator=integrator, spp=pass_spp, seed=renders)
        total = total + pass_spp * np.array(image)[..., :3]
        spp, renders = spp + pass_spp, renders + 1
        if time.perf_counter() - began < 1.0:
            pass_spp *= 2
    return total / spp, spp


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--variant", default="llvm_ad_rgb")
    parser.add_argument("--size", type=int, nargs=2, default=(480, 360), metavar=("W", "H"))
    parser.add_argument("-o", "--output", type=Path, default=Path())
    options = parser.parse_args()

    mi.set_variant(options.variant)
    scene = mi.load_dict(lightcull.mitsuba.merge_emitters(fairy_lights(*options.size)))
    options.output.mkdir(parents=True, exist_ok=True)
    for name in ("path", "lightcull_path"):
        image, spp = render(scene, name, options.seconds)
        picture = options.output / f"fairy_lights_{name}.png"
        mi.util.write_bitmap(str(picture), image.astype(np.float32))
        print(f"{picture}: {spp} samples per pixel in {options.seconds:g} s")


if __name__ == "__main__":
    main()
