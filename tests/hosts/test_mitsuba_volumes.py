"""`lightcull_volpath` has the mean of Mitsuba's `volpath`: z-tests of blocks of pixels and of the whole
image, false alarm 1e-4 for each scene and variant (Sidak over its blocks and channels).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed")

import lightcull.mitsuba  # noqa: E402, F401
import mitsuba_scenes  # noqa: E402
import volume_scenes as scenes  # noqa: E402
from test_mitsuba_means import RENDERS, largest_z, threshold  # noqa: E402

BLOCK = 4
DEPTH = {"max_depth": 4}


@dataclass(frozen=True)
class Kind:
    """A scene and how it is rendered."""

    make: Callable[[], Any]
    variants: tuple[str, ...] = ("scalar_rgb",)
    spp: int = 64
    options: dict[str, Any] | None = None
    twin: float = 1.1
    """How much brighter a twin is that must be told apart."""
    reference: str = "volpath"


SCALAR_AND_LLVM = ("scalar_rgb", "llvm_ad_rgb")
KINDS = {
    "in fog": Kind(scenes.in_fog),
    "box of fog": Kind(scenes.in_a_box_of_fog),
    "box of smoke": Kind(scenes.in_a_box_of_smoke),
    # volpath samples distances by one wavelength alone, and has variance without bounds here.
    "colored fog": Kind(
        scenes.colored_fog,
        (*SCALAR_AND_LLVM, "scalar_spectral"),
        twin=1.15,
        reference="volpathmis",
    ),
    "colored smoke": Kind(scenes.colored_smoke, ("scalar_rgb", "llvm_ad_spectral")),
    "emitter inside": Kind(scenes.lamp_in_a_ball_of_fog, twin=1.15),
    "spot into rough glass": Kind(scenes.spot_into_rough_glass, SCALAR_AND_LLVM, 256, twin=1.5),
    "under a sky": Kind(scenes.under_a_sky, SCALAR_AND_LLVM),
    "nested": Kind(scenes.nested, SCALAR_AND_LLVM),
    "all kinds of emitters": Kind(scenes.all_kinds_of_emitters, SCALAR_AND_LLVM),
    "2,000 bulbs": Kind(scenes.many_bulbs, SCALAR_AND_LLVM, twin=1.15),
    "any depth, early roulette": Kind(scenes.in_a_box_of_fog, options={"rr_depth": 1}),
    "emitters alone": Kind(scenes.lamps_behind_fog, options={"max_depth": 1}, spp=16),
    "hidden emitters": Kind(scenes.lamps_behind_fog, options=DEPTH | {"hide_emitters": True}),
    "phase function alone": Kind(scenes.without_sampling_of_emitters, SCALAR_AND_LLVM, 256, twin=1.3),
}


def render_blocks(scene: Any, kind: str, spp: int, options: dict[str, Any], seed: int) -> np.ndarray:
    """Means of blocks, and of all, of independent renders: (renders, blocks + 1, channels)."""
    integrator = mi.load_dict({"type": kind, **options})
    renders = []
    for i in range(RENDERS):
        image = np.array(mi.render(scene, integrator=integrator, spp=spp, seed=seed + i))[..., :3]
        height, width, channels = image.shape
        blocks = image.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, channels)
        means = blocks.mean(axis=(1, 3)).reshape(-1, channels)
        renders.append(np.concatenate([means, means.mean(axis=0, keepdims=True)]))
    return np.stack(renders).astype(np.float64)


@pytest.mark.parametrize(
    ("kind", "variant"),
    [pytest.param(k, v, id=f"{name}-{v}") for name, k in KINDS.items() for v in k.variants],
)
def test_mean_is_that_of_volpath(kind: Kind, variant: str) -> None:
    mi.set_variant(variant)
    scene = mi.load_dict(kind.make())
    options = DEPTH if kind.options is None else kind.options
    expected = render_blocks(scene, kind.reference, kind.spp, options, 0)
    found = render_blocks(scene, "lightcull_volpath", kind.spp, options, 1000)
    assert expected.mean() > 0.01
    limit = threshold(expected[0].size)
    assert largest_z(expected, found) < limit
    assert largest_z(expected, kind.twin * found) > limit, "the test could not see a bias"
