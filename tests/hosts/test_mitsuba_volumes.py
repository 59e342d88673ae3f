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
    "box of smoke": Kind(scenes.in_a_box_of_smoke, ("scalar_rgb", "llvm_ad_spectral")),
    # volpath samples distances by one wavelength alone, and has variance without bounds here.
    "colored fog": Kind(
        scenes.colored_fog,
        (*SCALAR_AND_LLVM, "scalar_spectral"),
        twin=1.15,
        reference="volpathmis",
    ),
    "colored smoke": Kind(scenes.colored_smoke),
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


def render_blocks(
    scene: Any, kind: str, spp: int, options: dict[str, Any], seed: int, within: str | None = None
) -> np.ndarray:
    """Means of blocks, and of all, of independent renders: (renders, blocks + 1, channels)."""
    properties = {"type": kind, **options}
    if within is not None:
        properties = {"type": within, "aovs": "albedo:albedo", "inner": properties}
    integrator = mi.load_dict(properties)
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


@pytest.mark.parametrize("variant", SCALAR_AND_LLVM)
def test_lamps_just_outside_of_fog_lose_no_light(variant: str) -> None:
    """Shadow rays of `volpath` lose a tenth of it, since they hit the lamp: so it is told to find the
    lamp by the phase function alone.
    """
    mi.set_variant(variant)
    options = {"max_depth": 2}
    found_by_phase = mi.load_dict(scenes.lamp_just_outside(sample_emitters=False))
    expected = render_blocks(found_by_phase, "volpath", 512, options, 0)
    scene = mi.load_dict(scenes.lamp_just_outside())
    limit = threshold(expected[0].size)
    assert largest_z(expected, render_blocks(scene, "lightcull_volpath", 64, options, 1000)) < limit
    lossy = render_blocks(scene, "volpath", 64, options, 1000)
    assert largest_z(expected, lossy) > limit, "the test could not see what is lost"


@pytest.mark.parametrize("variant", SCALAR_AND_LLVM)
def test_within_aov(variant: str) -> None:
    mi.set_variant(variant)
    scene = mi.load_dict(scenes.in_a_box_of_fog())
    expected = render_blocks(scene, "volpath", 32, DEPTH, 0)
    found = render_blocks(scene, "lightcull_volpath", 32, DEPTH, 1000, within="aov")
    assert largest_z(expected, found) < threshold(expected[0].size)


def test_derivatives_are_refused(capfd: pytest.CaptureFixture[str]) -> None:
    import drjit as dr

    mi.set_variant("llvm_ad_rgb")
    scene = mi.load_dict(scenes.in_fog())
    parameters = mi.traverse(scene)
    key = "lamp0.emitter.radiance.value"
    dr.enable_grad(parameters[key])
    integrator = mi.load_dict({"type": "lightcull_volpath", **DEPTH})
    image = mi.render(scene, parameters, integrator=integrator, spp=1)
    with pytest.raises(RuntimeError):
        dr.backward(dr.mean(image, axis=None))
    said = [line for line in "".join(capfd.readouterr()).splitlines() if "derivatives" in line]
    assert said and "lightcull_volpath has no derivatives" in said[0] and "prbvolpath" in said[0]


def test_other_variants_are_refused_by_name() -> None:
    mi.set_variant("llvm_ad_mono")
    with pytest.raises(RuntimeError, match="lightcull_volpath renders in the variants"):
        mi.load_dict({"type": "lightcull_volpath"})


@pytest.mark.parametrize("variant", SCALAR_AND_LLVM)
def test_no_path_of_depth_0_has_light(variant: str) -> None:
    mi.set_variant(variant)
    scene = mi.load_dict(scenes.lamps_behind_fog())
    integrator = mi.load_dict({"type": "lightcull_volpath", "max_depth": 0})
    assert not np.array(mi.render(scene, integrator=integrator, spp=1)).any()
