"""Derivatives by `lightcull_path`, in LLVM variants: by emission, materials and textures.

z-tests against Mitsuba's `prb` as in test_mitsuba_means, false alarm 1e-4 each; and, with the same
random numbers, what is exact.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed")

import drjit as dr  # noqa: E402
import lightcull.mitsuba  # noqa: E402, F401
import mitsuba_scenes as scenes  # noqa: E402
from test_mitsuba_means import RENDERS, largest_z, threshold  # noqa: E402

VARIANTS = ("llvm_ad_rgb", "llvm_ad_spectral")
MEANS = "light_bvh:importance=means"


@pytest.fixture(autouse=True)
def _llvm() -> None:
    mi.set_variant("llvm_ad_rgb")


def texels(seed: int) -> Any:
    values = np.random.default_rng(seed).uniform(0.2, 0.8, (3, 4, 3)).astype(np.float32)
    # Spectral variants want colours.
    raw = not mi.is_spectral
    return {"type": "bitmap", "bitmap": mi.Bitmap(values), "raw": raw, "filter_type": "nearest"}


def furnished() -> scenes.SceneDict:
    """A textured floor, a wall, a glossy ball, and lights of all kinds, one of them textured."""
    scene = scenes.stage(object_bsdf={"type": "roughconductor", "alpha": 0.4})
    scene["floor"]["bsdf"] = {"type": "diffuse", "reflectance": texels(1)}
    screen = scenes.rectangle([-1.5, 2.5, 0], 0.6, {"type": "area", "radiance": texels(2)})
    return scene | scenes.lamps(2) | {
        "screen": screen,
        "mesh": scenes.quads(np.float32([[1.2, 3, 0], [2, 2.5, 1]]), 0.3, scenes.rgb(6, 5, 4)),
        "point": {"type": "point", "position": [-2, 2, 1], "intensity": scenes.rgb(3, 4, 5)},
        "sun": {"type": "directional", "direction": [0.4, -1, -0.5], "irradiance": scenes.rgb(0.5)},
        "sky": {"type": "constant", "radiance": scenes.rgb(0.3)},
    }


EMISSION = (
    "lamp0.emitter.radiance.value",
    "lamp1.emitter.radiance.value",
    "screen.emitter.radiance.data",
    "mesh.emitter.radiance.value",
    "point.intensity.value",
    "sun.irradiance.value",
    "sky.radiance.value",
)
MATERIALS = ("floor.bsdf.reflectance.data", "wall.bsdf.reflectance.value", "ball.bsdf.alpha.value")
SPECTRAL = (
    "wall.bsdf.reflectance.value", "ball.bsdf.alpha.value", "floor.bsdf.reflectance.data",
)


def load(scene: scenes.SceneDict) -> Any:
    """With the ids that parameters are called by."""
    if "mesh" in scene:
        scene["mesh"].set_id("mesh")
    return mi.load_dict(scene)


def weights(scene: Any) -> np.ndarray:
    """What a loss weighs pixels with, (height, width, 3)."""
    height, width = scene.sensors()[0].film().size()[::-1]
    return np.random.default_rng(3).uniform(0, 1, (int(height), int(width), 3)).astype(np.float32)


def gradients(scene: Any, integrator: Any, keys: Sequence[str], seed: int, spp: int = 16) -> np.ndarray:
    """Of the sum of weights * image by all the numbers of the parameters, in a row."""
    parameters = mi.traverse(scene)
    for key in keys:
        dr.enable_grad(parameters[key])
    parameters.update()  # textures keep values of their own
    integrator.render_backward(
        scene, parameters, mi.TensorXf(weights(scene)), scene.sensors()[0], seed, spp
    )
    found = [np.array(dr.grad(parameters[key])).ravel() for key in keys]
    for key in keys:
        dr.disable_grad(parameters[key])
    parameters.update()
    return np.concatenate(found).astype(np.float64)


def integrator_of(kind: str, **options: Any) -> Any:
    return mi.load_dict({"type": kind, "max_depth": 4, **options})


@pytest.mark.parametrize("variant", VARIANTS)
def test_gradients_have_the_mean_of_prb(variant: str) -> None:
    mi.set_variant(variant)
    keys = (*EMISSION, *MATERIALS) if variant == "llvm_ad_rgb" else SPECTRAL
    scene = load(furnished())
    prb, ours = integrator_of("prb"), integrator_of("lightcull_path", light_sampler="culled")
    expected = np.stack([gradients(scene, prb, keys, seed) for seed in range(RENDERS)])
    found = np.stack([gradients(scene, ours, keys, 1000 + seed) for seed in range(RENDERS)])
    limit = threshold(expected[0].size)
    assert (np.abs(expected.mean(axis=0)) > 0).all()
    assert largest_z(expected, found) < limit
    assert largest_z(expected, 1.1 * found) > limit, "the test could not see a bias"


def test_forward_derivatives_have_the_mean_of_prb() -> None:
    scene = load(furnished())
    key = "floor.bsdf.reflectance.data"

    def image(integrator: Any, seed: int) -> np.ndarray:
        parameters = mi.traverse(scene)
        before = mi.TensorXf(parameters[key])
        change = mi.Float(0.0)
        dr.enable_grad(change)
        parameters[key] = before + change
        parameters.update()
        dr.set_grad(change, 1.0)
        dr.forward(change, dr.ADFlag.ClearEdges)
        derived = integrator.render_forward(scene, parameters, scene.sensors()[0], seed, 16)
        result = np.array(derived).reshape(3, 8, 4, 8, 3).mean(axis=(1, 3))
        parameters[key] = before
        parameters.update()
        return result.reshape(-1).astype(np.float64)

    prb, ours = integrator_of("prb"), integrator_of("lightcull_path")
    expected = np.stack([image(prb, seed) for seed in range(RENDERS)])
    found = np.stack([image(ours, 1000 + seed) for seed in range(RENDERS)])
    limit = threshold(expected[0].size)
    assert largest_z(expected, found) < limit
    assert largest_z(expected, 1.1 * found) > limit, "the test could not see a bias"


def test_light_is_linear_in_emission() -> None:
    """With the same paths: the sum of emission * gradient is the light, up to rounding."""
    scene = load(furnished())
    integrator = integrator_of("lightcull_path", light_sampler=MEANS)
    image = np.array(mi.render(scene, integrator=integrator, spp=32, seed=9))
    parameters = mi.traverse(scene)
    emission = np.concatenate([np.array(parameters[key]).ravel() for key in EMISSION])
    found = gradients(scene, integrator, EMISSION, 9, spp=32)
    np.testing.assert_allclose((emission * found).sum(), (weights(scene) * image).sum(), rtol=1e-3)


@pytest.mark.parametrize("passes", [1, 2])
def test_gradients_by_materials_are_differences(passes: int) -> None:
    """Paths, with the same numbers, do not depend on how much matte surfaces reflect. More than 64
    samples take several passes.
    """
    spp = 64 * passes
    scene = load(scenes.stage(bsdf=scenes.diffuse(0.5, 0.4, 0.6)) | scenes.lamps(3))
    integrator = integrator_of("lightcull_path", rr_depth=100)
    key = "floor.bsdf.reflectance.value"
    found = gradients(scene, integrator, [key], 4, spp)
    parameters = mi.traverse(scene)
    value = np.array(parameters[key]).ravel()

    def loss(channel: int, change: float) -> float:
        changed = value.copy()
        changed[channel] += change
        parameters[key] = mi.Color3f(*map(float, changed))
        parameters.update()
        image = np.array(mi.render(scene, integrator=integrator, spp=spp, seed=4))
        return float((weights(scene) * image).sum())

    step = 0.05
    expected = [(loss(i, step) - loss(i, -step)) / (2 * step) for i in range(3)]
    # The light is a polynomial of the third degree: differences are off by step^2 times a sixth of
    # the third derivative.
    np.testing.assert_allclose(found, expected, rtol=0.01)


def thousand_lamps() -> scenes.SceneDict:
    """1,000 triangles that emit, in one mesh: as many shapes would take minutes to compile."""
    places = np.random.default_rng(5).uniform((-4, 1.0, -2.5), (4, 3.2, 4), (500, 3))
    scene = scenes.stage()
    scene["floor"]["bsdf"] = {"type": "diffuse", "reflectance": texels(1)}
    return scene | {"mesh": scenes.quads(places.astype(np.float32), 0.02, scenes.rgb(60, 50, 40))}


def test_a_thousand_emitters_take_less_variance() -> None:
    """At as many samples, in the mean over parameters of the variance by the squared mean."""
    scene = load(thousand_lamps())
    keys = (
        "floor.bsdf.reflectance.data",
        "wall.bsdf.reflectance.value",
        "mesh.emitter.radiance.value",
    )
    prb, ours = integrator_of("prb", max_depth=3), integrator_of("lightcull_path", max_depth=3)
    expected = np.stack([gradients(scene, prb, keys, seed, 4) for seed in range(RENDERS)])
    found = np.stack([gradients(scene, ours, keys, 1000 + seed, 4) for seed in range(RENDERS)])
    assert largest_z(expected, found) < threshold(expected[0].size)
    mean = np.abs(0.5 * (expected + found)).mean(axis=0)

    def variance(of: np.ndarray) -> float:
        return float((of.var(axis=0, ddof=1) / mean**2).mean())

    assert variance(found) < 0.5 * variance(expected), variance(found) / variance(expected)


def test_they_come_through_mitsuba_render() -> None:
    scene = load(furnished())
    parameters = mi.traverse(scene)
    key = "wall.bsdf.reflectance.value"
    dr.enable_grad(parameters[key])
    image = mi.render(scene, parameters, integrator=integrator_of("lightcull_path"), spp=8)
    dr.backward(dr.mean(image, axis=None))
    assert (np.array(dr.grad(parameters[key])) > 0).all()


def messages(error: BaseException | None) -> str:
    """Of an error and of all that led to it."""
    text = ""
    while error is not None:
        text += str(error)
        error = error.__cause__ or error.__context__
    return text


def test_within_aov_they_are_the_same() -> None:
    scene = load(furnished())
    inner = {"type": "lightcull_path", "max_depth": 4}
    aov = mi.load_dict({"type": "aov", "aovs": "d:depth", "inner": inner})
    key = "wall.bsdf.reflectance.value"
    alone = gradients(scene, mi.load_dict(inner), [key], 5)
    parameters = mi.traverse(scene)
    dr.enable_grad(parameters[key])
    of_depth = np.zeros((*weights(scene).shape[:2], 1), np.float32)
    gradient = mi.TensorXf(np.concatenate([weights(scene), of_depth], axis=2))
    aov.render_backward(scene, parameters, gradient, scene.sensors()[0], 5, 16)
    np.testing.assert_allclose(np.array(dr.grad(parameters[key])).ravel(), alone, rtol=1e-3)


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("mesh.vertex_positions", "no derivatives by the form or place of shapes"),
        ("sensor.to_world", "none by what was asked for"),
    ],
)
def test_what_there_is_not_is_refused(key: str, said: str) -> None:
    scene = load(furnished())
    parameters = mi.traverse(scene)
    if key == "sensor.to_world":
        moved = mi.Float(0.0)
        dr.enable_grad(moved)
        parameters[key] = mi.Transform4f().translate(mi.Vector3f(moved, 0, 0)) @ parameters[key]
        parameters.update()
    else:
        dr.enable_grad(parameters[key])
    integrator = integrator_of("lightcull_path")
    with pytest.raises(RuntimeError) as error:
        image = mi.render(scene, parameters, integrator=integrator, spp=1)
        dr.backward(dr.mean(image, axis=None))
    assert said in messages(error.value)
