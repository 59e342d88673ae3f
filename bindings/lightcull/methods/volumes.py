"""Bounding volumes of glossy lights, and splatting: figures 9 and 10 and table 2 of [TH17]."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..scene import Scene
from .findings import Picture, Study, Table
from .measure import TIME, Bench, Measured, measure

ROUGHNESSES = (0.02, 0.05, 0.1, 0.2, 0.5)
"""GGX's alpha."""
_PICTURED = (0.02, 0.1, 0.5)
_VOLUMES = {"spheroid": "spheroid", "sphere_around": "sphere around it",
            "sphere_at_light": "sphere at the light"}  # fmt: skip
_ACCEPTED = 8.0
"""Lights per pixel, about."""
_MOST_TEXELS = 16384


def strip_scene(alpha: float | None) -> Scene:
    """A bent strip of metal on a floor, lit by a spot that lights nothing else. alpha: of the metal;
    None: the strip is diffuse."""
    scene = Scene("caustic")
    white = scene.add_material(base_color=(0.8, 0.8, 0.8))
    color = (0.95, 0.75, 0.4)
    metal = (
        scene.add_material(base_color=color)
        if alpha is None
        else scene.add_material(
            base_color=color, kind="metallic_roughness", metallic=1.0,
            roughness=float(np.sqrt(alpha)),
        )
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
    lights = _texels(bench)
    rows = []
    saved = []
    charts: list[Picture] = []
    for i, alpha in enumerate(ROUGHNESSES):
        own = replace(bench, scene=strip_scene(alpha))
        method = f"{_method(lights)}:tile=4:error_bound={_bound(own, lights):.6e}"
        found = {}
        for volume in _VOLUMES:
            bench.report("bounding volumes", i / len(ROUGHNESSES))
            found[volume] = measure(own, f"{method}:volume={volume}")
        saved.append(_removed(found))
        if alpha in _PICTURED:
            charts += _charts(alpha, found)
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
        f"at a roughness (alpha) of {ROUGHNESSES[0]:g}, {saved[2]:.0%} at {ROUGHNESSES[2]:g} and "
        f"{saved[-1]:.0%} at {ROUGHNESSES[-1]:g}.",
        note="As figures 9 and 10 of [TH17]: a strip of metal under a spot, a reflective shadow map "
        f"of {lights:,} texels, single-bounce caustics on the floor, no shadows, no interleaving, an "
        f"error bound that accepts about {_ACCEPTED:g} lights per pixel, tiles of 4 x 4 pixels (16 x "
        "16 of a picture of four times the width). Listed: lights in the list of a pixel's tile; "
        "false: the part of them in whose range the pixel is not. Time, of processors, relative to "
        "the spheroid. In the pictures the brightness is the logarithm of the lights listed, one "
        "scale for a roughness; the colour the false part, from blue (none) by green to red (all).",
        table=Table(
            ("alpha", "accepted / pixel")
            + tuple(f"listed: {name}" for name in _VOLUMES.values())
            + tuple(f"false: {name}" for name in _VOLUMES.values())
            + tuple(f"time: {name}" for name in _VOLUMES.values()),
            tuple(rows),
        ),
        figures={f"removed_at_{a:g}": s for a, s in zip(ROUGHNESSES, saved, strict=True)},
        pictures=tuple(charts),
    )


def splatting(bench: Bench) -> Study:
    """Tiles against the rectangles that the boxes around the lights' volumes cover."""
    lights = _texels(bench)
    ways = ("tile=16", "tile=4", "culling=splatting")
    rows = []
    for alpha in (None, 0.05, 0.2):
        kind = "diffuse" if alpha is None else f"alpha {alpha:g}"
        own = replace(bench, scene=strip_scene(alpha))
        for interleave in (8, 1):
            bench.report("splatting", len(rows) / 6)
            # As many lights per pixel, of so many times fewer.
            bound = _bound(own, lights) / interleave**2
            method = f"{_method(lights, interleave)}:error_bound={bound:.6e}"
            found = [measure(own, f"{method}:{way}") for way in ways]
            rows.append(
                (kind, interleave, found[0].counts.accepted)
                + tuple(m.counts.listed for m in found)
                + tuple(1e3 * m.seconds for m in found)
                + (found[2].seconds / min(m.seconds for m in found[:2]),)
            )
    ratios = [float(row[-1]) for row in rows]
    return Study(
        key="splatting",
        title="Tiles against splatting",
        finding="Splatting the box around each light's volume takes "
        f"{min(ratios):.1f} to {max(ratios):.1f} times the time of the better tiles.",
        note="As table 2 of [TH17], diffuse lights only above, glossy ones only below: the strip as "
        f"above, {lights:,} texels. Splatting: every pixel in the rectangle that the box around a "
        "light's volume covers on the screen, as far as the pixel has the light's part of the "
        f"interleaved lights. {TIME} ranges, culling and shading.",
        table=Table(
            ("lights", "interleave", "accepted / pixel", "listed: tile=16", "tile=4", "splatting",
             "ms: tile=16", "tile=4", "splatting", "splatting / better tiles, time"),
            tuple(rows),
        ),
        figures={"least_ratio": min(ratios), "greatest_ratio": max(ratios)},
    )  # fmt: skip


def _texels(bench: Bench) -> int:
    return round(min(bench.most_lights, _MOST_TEXELS) ** 0.5) ** 2


def _method(lights: int, interleave: int = 1) -> str:
    return (
        f"vpl_culled:lights={lights}:source=shadow_map:shadows=none:filter=off"
        f":interleave={interleave}"
    )


def _bound(bench: Bench, lights: int) -> float:
    """That of about _ACCEPTED lights per pixel: few are near enough to count for sure, so that
    their number goes with the bound."""
    pilot = measure(bench, f"{_method(lights)}:accepted={lights // 4}").counts
    return pilot.error_bound * max(pilot.accepted, 1e-6) / _ACCEPTED


def _charts(alpha: float, found: dict[str, Measured]) -> list[Picture]:
    listed = {name: m.lights_of_pixels[..., 0] for name, m in found.items()}
    most = max(float(np.percentile(values, 99)) for values in listed.values())
    return [
        Picture(
            f"alpha {alpha:g} {_VOLUMES[name]}",
            heat_map(m.lights_of_pixels, most),
            f"{m.counts.listed:,.1f} lights listed, {m.counts.false_discovery_rate:.1%} of them "
            "falsely",
            is_chart=True,
        )
        for name, m in found.items()
    ]


def heat_map(lights_of_pixels: np.ndarray, most: float) -> np.ndarray:
    """float32 (H, W, 3), [0, 1]: brightness by the lights listed, up to `most`; hue by the part of
    them that is not accepted, blue to red."""
    import matplotlib.colors

    listed, accepted = lights_of_pixels[..., 0], lights_of_pixels[..., 1]
    brightness = np.clip(np.log1p(listed) / np.log1p(max(most, 1.0)), 0, 1)
    true = np.divide(accepted, listed, out=np.zeros_like(listed), where=listed > 0)
    hsv = np.stack([true * 2 / 3, np.ones_like(true), brightness], axis=-1)
    return matplotlib.colors.hsv_to_rgb(hsv).astype(np.float32)


def _removed(found: dict[str, Measured]) -> float:
    """The part of the false positives of the sphere around the spheroid that the latter has not."""
    false = {name: m.counts.listed - m.counts.accepted for name, m in found.items()}
    around = false["sphere_around"]
    return 1.0 - false["spheroid"] / around if around > 0 else 0.0
