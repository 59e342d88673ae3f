"""Bounding volumes of glossy lights: figures 9 and 10 of [TH17], and the lower half of table 2."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..scene import Scene
from .measure import Bench, Measured, measure
from .model import Study, Table

ROUGHNESSES = (0.02, 0.05, 0.1, 0.2, 0.5)
"""GGX's alpha."""
_VOLUMES = {"spheroid": "spheroid", "sphere_around": "sphere around it",
            "sphere_at_light": "sphere at the light"}  # fmt: skip


_ACCEPTED = 8.0
"""Lights per pixel, about."""


def glossy_scene(alpha: float) -> Scene:
    """A bent strip of metal on a floor, lit by a spot that lights nothing else."""
    scene = Scene("caustic")
    white = scene.add_material(base_color=(0.8, 0.8, 0.8))
    metal = scene.add_material(
        base_color=(0.95, 0.75, 0.4), kind="metallic_roughness", metallic=1.0,
        roughness=float(np.sqrt(alpha)),
    )  # fmt: skip
    quad = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    floor = np.array([[-3, 0, -3], [-3, 0, 3], [3, 0, 3], [3, 0, -3]], np.float32)
    scene.add_mesh(floor, quad, material=white, name="floor")
    angles = np.linspace(0.15 * np.pi, 0.85 * np.pi, 33)
    ring = np.stack([np.cos(angles), np.zeros_like(angles), -np.sin(angles)], axis=1)
    strip = np.concatenate([ring, ring + [0, 0.6, 0]]).astype(np.float32)
    count = len(angles)
    faces = [
        face
        for i in range(count - 1)
        for face in ((i, i + 1, count + i + 1), (i, count + i + 1, count + i))
    ]
    scene.add_mesh(strip, np.array(faces, np.uint32), material=metal, name="strip")
    scene.add_spot_light((0, 1.5, 2.0), (0, -1.2, -2.9), (60, 60, 60), 0.1, 0.16)
    scene.set_camera(origin=(0, 3.2, 3.2), target=(0, 0.1, 0), vertical_fov=0.8)
    return scene


def spheroids(bench: Bench) -> Study:
    """False discovery rate, lights per pixel and time with each volume, by roughness."""
    edge = round(min(bench.most_lights, 16384) ** 0.5)
    lights = edge * edge
    method = (
        f"vpl_culled:lights={lights}:source=shadow_map:shadows=none:filter=off:interleave=1"
    )
    rows = []
    saved = []
    for i, alpha in enumerate(ROUGHNESSES):
        own = replace(bench, scene=glossy_scene(alpha))
        pilot = measure(own, f"{method}:accepted={lights // 4}").counts
        # Few lights are near enough to count for sure, so that their number goes with the bound.
        bound = pilot.error_bound * max(pilot.accepted, 1e-6) / _ACCEPTED
        found = {}
        for volume in _VOLUMES:
            bench.report("bounding volumes", i / len(ROUGHNESSES))
            found[volume] = measure(own, f"{method}:error_bound={bound:.6e}:volume={volume}")
        saved.append(_removed(found))
        tight = found["spheroid"]
        rows.append(
            (alpha, tight.counts.accepted)
            + tuple(m.counts.listed for m in found.values())
            + tuple(m.counts.false_discovery_rate for m in found.values())
            + tuple(m.seconds / tight.seconds for m in found.values())
        )
    return Study(
        key="volumes",
        title="Bounding volumes of glossy lights",
        finding=f"The spheroid removes {saved[0]:.0%} of the false positives of the sphere around it "
        f"at a roughness (alpha) of {ROUGHNESSES[0]:g}, and {saved[-1]:.0%} at {ROUGHNESSES[-1]:g}.",
        note="As figures 9 and 10 of [TH17]: a strip of metal under a spot, a reflective shadow map "
        f"of {edge} x {edge} texels, single-bounce caustics on the floor, no shadows, no interleaving, an error bound that accepts "
        f"about {_ACCEPTED:g} lights per pixel. Listed: "
        "lights in the list of a pixel's tile; accepted: those in whose range it is. Time relative to "
        "the spheroid.",
        table=Table(
            ("alpha", "accepted / pixel")
            + tuple(f"listed: {name}" for name in _VOLUMES.values())
            + tuple(f"false: {name}" for name in _VOLUMES.values())
            + tuple(f"time: {name}" for name in _VOLUMES.values()),
            tuple(rows),
        ),
        figures={f"removed_at_{a:g}": s for a, s in zip(ROUGHNESSES, saved, strict=True)},
    )


def _removed(found: dict[str, Measured]) -> float:
    """The part of the false positives of the sphere around the spheroid that the latter has not."""
    false = {name: m.counts.listed - m.counts.accepted for name, m in found.items()}
    around = false["sphere_around"]
    return 1.0 - false["spheroid"] / around if around > 0 else 0.0
