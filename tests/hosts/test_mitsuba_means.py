"""`lightcull_path` has the mean of Mitsuba's `path`: z-tests of blocks of pixels and of the whole
image, false alarm 1e-4 for each scene and sampler (Sidak over its blocks and channels).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from statistics import NormalDist
from typing import Any

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed")

import lightcull.mitsuba  # noqa: E402, F401
import mitsuba_scenes as scenes  # noqa: E402

FALSE_ALARM = 1e-4
BLOCK = 8
RENDERS = 16


@dataclass(frozen=True)
class Kind:
    """A scene and how it is rendered."""

    name: str
    make: Callable[[], Any]
    spp: int = 64
    options: dict[str, Any] = field(default_factory=lambda: {"max_depth": 4})
    reference: Callable[[], Any] | None = None
    """What `path` renders instead; none: the same."""
    variants: tuple[str, ...] = ("scalar_rgb", "llvm_ad_rgb")
    twin: float = 1.1
    """How much brighter a twin is that must be told apart."""
    samplers: tuple[str, ...] = ("culled",)


def glossy(name: str, **bsdf: Any) -> Kind:
    return Kind(name, lambda: scenes.glossy({"type": name, **bsdf}), variants=SCALAR)


SCALAR = ("scalar_rgb",)
"""Where LLVM variants would test Mitsuba's own parts again."""
BOTH_SAMPLERS = ("culled", "learned")
IN_KERNEL = "light_bvh:importance=means"
"""In LLVM variants chosen by within the kernel, as by culled and learned among up to 64."""
BOTH_WAYS = ("culled", "light_bvh")
"""In LLVM variants within the kernel where there are up to 64 lights, and between kernels."""
BOTH_SPECTRAL = ("scalar_spectral", "llvm_ad_spectral")
KINDS = [
    Kind("cornell box", scenes.cornell),
    Kind("3,000 lamps", scenes.many_lamps, samplers=(*BOTH_SAMPLERS, IN_KERNEL)),
    Kind("textured lamps", scenes.textured_lamps),
    # path itself loses the light that it samples on a mesh with an attribute: it asks for the
    # radiance at a point without a shape.
    Kind("mesh attribute", scenes.attribute_lamps, reference=scenes.separate_lamps, samplers=BOTH_WAYS),
    Kind("turned lamps", scenes.turned_lamps),
    Kind("round lamps", scenes.round_lamps, samplers=(*BOTH_SAMPLERS, IN_KERNEL)),
    Kind("environment", scenes.environment, samplers=BOTH_WAYS),
    Kind("glossy floor under 3,000 lamps", scenes.many_lamps_on_metal, samplers=("culled", IN_KERNEL)),
    Kind("only an environment", scenes.sky_only),
    Kind("points and spots", scenes.points_and_spots, samplers=BOTH_WAYS),
    Kind("directional", scenes.directional),
    Kind("suns and lamps", scenes.suns_and_lamps, samplers=(*BOTH_SAMPLERS, "light_bvh")),
    Kind("spectral suns", scenes.directional, variants=BOTH_SPECTRAL),
    glossy("roughconductor", alpha=0.3),
    Kind("panels", scenes.panels, samplers=BOTH_WAYS),
    glossy("roughplastic", alpha=0.1),
    glossy("principled", metallic=0.3, roughness=0.3, clearcoat=0.5),
    Kind("cut lamps", scenes.cut_lamps, samplers=(*BOTH_SAMPLERS, "light_bvh")),
    Kind("cut lamps over metal", scenes.cut_lamps_over_metal, samplers=("culled", "light_bvh")),
    Kind("spectral cut lamps", scenes.cut_lamps, variants=BOTH_SPECTRAL, samplers=("light_bvh",)),
    Kind("as published", scenes.round_lamps, samplers=("paper", "paper:list=0"), twin=1.2),
    Kind("glass", scenes.glass, options={"max_depth": 6}, variants=SCALAR),
    Kind("rough glass", scenes.rough_glass, options={"max_depth": 6}),
    Kind("mask and null", scenes.see_through, options={"max_depth": 6}, twin=1.2, samplers=BOTH_WAYS),
    Kind("normal map and blend", scenes.bumpy, variants=SCALAR),
    Kind(
        "hidden emitters",
        scenes.lamps_in_view,
        options={"max_depth": 3, "hide_emitters": True},
        samplers=BOTH_WAYS,
    ),
    Kind("shown emitters", scenes.lamps_in_view, options={"max_depth": 1}, spp=16),
    Kind("depth 2", scenes.round_lamps, options={"max_depth": 2}, variants=SCALAR),
    Kind("depth 5, early roulette", scenes.environment, options={"max_depth": 5, "rr_depth": 2}, samplers=BOTH_WAYS),
    Kind("any depth", scenes.environment, options={}, spp=32),
    Kind("film options", scenes.film_options, samplers=BOTH_WAYS),
    Kind("spectral", scenes.environment, variants=BOTH_SPECTRAL, samplers=BOTH_WAYS),
    Kind("spectral points", scenes.points_and_spots, variants=BOTH_SPECTRAL),
]


def render_blocks(scene: Any, integrator: Any, spp: int, first_seed: int) -> np.ndarray:
    """Means of blocks, and of all, of independent renders: (renders, blocks + 1, channels)."""
    renders = []
    for seed in range(first_seed, first_seed + RENDERS):
        image = np.array(mi.render(scene, integrator=integrator, spp=spp, seed=seed))[..., :3]
        height, width, channels = image.shape
        blocks = image.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, channels)
        means = blocks.mean(axis=(1, 3)).reshape(-1, channels)
        renders.append(np.concatenate([means, means.mean(axis=0, keepdims=True)]))
    return np.stack(renders).astype(np.float64)


def largest_z(a: np.ndarray, b: np.ndarray) -> float:
    """Of the differences of means of two samples of renders."""
    variance = (a.var(axis=0, ddof=1) + b.var(axis=0, ddof=1)) / RENDERS
    # What both have exactly, such as a background, is equal up to rounding.
    rounding = 1e-5 * np.abs(a.mean(axis=0)) + 1e-9
    t = (a.mean(axis=0) - b.mean(axis=0)) / np.sqrt(variance + rounding**2)
    freedom = 2 * RENDERS - 2
    # Student's t to normal (Abramowitz & Stegun 26.7.8).
    z = t * (1 - 1 / (4 * freedom)) / np.sqrt(1 + t**2 / (2 * freedom))
    return float(np.abs(z).max())


def threshold(tests: int) -> float:
    each = 1 - (1 - FALSE_ALARM) ** (1 / tests)
    return NormalDist().inv_cdf(1 - each / 2)


@pytest.mark.parametrize(
    ("kind", "variant"),
    [pytest.param(k, v, id=f"{k.name}-{v}") for k in KINDS for v in k.variants],
)
def test_mean_is_that_of_path(kind: Kind, variant: str) -> None:
    mi.set_variant(variant)
    scene = mi.load_dict(kind.make())
    path = mi.load_dict({"type": "path", **kind.options})
    reference = scene if kind.reference is None else mi.load_dict(kind.reference())
    expected = render_blocks(reference, path, kind.spp, 0)
    limit = threshold(expected[0].size)
    assert expected.mean() > 0.01
    for sampler in kind.samplers:
        properties = {"type": "lightcull_path", "light_sampler": sampler, **kind.options}
        found = render_blocks(scene, mi.load_dict(properties), kind.spp, 1000)
        assert largest_z(expected, found) < limit, sampler
        assert largest_z(expected, kind.twin * found) > limit, "the test could not see a bias"
