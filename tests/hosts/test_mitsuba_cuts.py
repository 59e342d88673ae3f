"""Long and textured emitters are several lights to `lightcull_path`: how much noise is left.

Variances are of one sample, relative to the square of its mean, from 6 renders of 64 samples at
some 1,500 pixels: known to 3 %.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed")

import lightcull.mitsuba  # noqa: E402, F401
import mitsuba_scenes as scenes  # noqa: E402

VARIANTS = ("scalar_rgb", "llvm_ad_rgb")
IN_KERNEL = "light_bvh:importance=means"
"""In LLVM variants; as is learned where there are few lights."""
SEEDS, SPP = 6, 32
TEXELS, BRIGHT = 64, (21, 40)
NEGLIGIBLE = 0.006
"""A blended texel, which is no even light, has this much of its own left: after 64 samples, 1 %."""
PANEL = 2.0  # half of its edge, metres


def floor(**emitters: Any) -> Any:
    """A floor, seen so that it fills the picture."""
    look = scenes.transform().look_at([0, 8, 0.01], [0, 0, 0], [0, 0, -1])
    sensor = scenes.stage()["sensor"] | {"to_world": look}
    ground = scenes.rectangle([0, 0, 0], 20, None, down=False)
    return mi.load_dict({"type": "scene", "sensor": sensor, "floor": ground, **emitters})


def variance(scene: Any, sampler: str) -> float:
    options = {"type": "path"} if sampler == "path" else {"type": "lightcull_path", "light_sampler": sampler}
    integrator = mi.load_dict({"max_depth": 2, "hide_emitters": True, **options})
    images = [
        np.array(mi.render(scene, integrator=integrator, spp=SPP, seed=seed)).mean(axis=2)
        for seed in range(SEEDS)
    ]
    mean = np.mean(images, axis=0)
    assert mean.min() > 0.05 * mean.mean()
    return float(SPP * (np.var(images, axis=0, ddof=1) / mean**2).mean())


def panel(filter_type: str, as_rectangle: bool) -> Any:
    texels = np.zeros((TEXELS, TEXELS, 3), np.float32)
    texels[BRIGHT[1], BRIGHT[0]] = 1000.0
    texture = {"type": "bitmap", "bitmap": mi.Bitmap(texels), "filter_type": filter_type, "raw": True}
    if as_rectangle:
        return scenes.rectangle([0, 3, 0], PANEL, {"type": "area", "radiance": texture})
    return scenes.quads(np.float32([[0, 3, 0]]), PANEL, texture, uvs=True)


def texel_as_triangles() -> Any:
    """The texel alone."""
    half = PANEL / TEXELS
    x, z = (2 * half * (place + 0.5) - PANEL for place in BRIGHT)
    return scenes.quads(np.float32([[x, 3, z]]), half, scenes.rgb(1000.0))


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("filter_type", ["nearest", "bilinear"])
def test_a_texel_is_as_good_as_triangles(variant: str, filter_type: str) -> None:
    mi.set_variant(variant)
    for sampler in ("learned", "light_bvh"):
        alone = variance(floor(texel=texel_as_triangles()), sampler)
        for as_rectangle in (False, True):
            found = variance(floor(panel=panel(filter_type, as_rectangle)), sampler)
            assert found < max(2.2 * alone, NEGLIGIBLE), (sampler, as_rectangle)


@pytest.mark.parametrize("variant", VARIANTS)
def test_a_strip_among_dim_lamps(variant: str) -> None:
    """30 m in two triangles, 3 m above the floor."""
    mi.set_variant(variant)
    random = np.random.default_rng(0)
    centers = random.uniform((-10, 2.5, -4), (10, 4, 4), (400, 3)).astype(np.float32)
    dim = scenes.quads(centers, 0.02, scenes.rgb(0.3))
    to_world = scenes.transform().translate([0, 3, 0]).rotate([1, 0, 0], 90).scale([15, 0.05, 1])
    tube = scenes.rectangle([0, 0, 0], 1, scenes.area(5.0)) | {"to_world": to_world}
    mesh = scenes.strip(15.0, 0.05, scenes.area(5.0), height=3.0)
    for strip in (mesh, tube):
        scene = floor(dim=dim, strip=strip)
        for sampler in ("learned", IN_KERNEL):
            assert variance(scene, sampler) < 0.15, sampler
