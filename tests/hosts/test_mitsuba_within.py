"""`lightcull_path` within other integrators: they ask it for paths, and nobody announces passes.

z-tests as in test_mitsuba_means, false alarm 1e-4 each.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed")

import lightcull.mitsuba  # noqa: E402, F401
import mitsuba_scenes as scenes  # noqa: E402
from test_mitsuba_means import BLOCK, RENDERS, largest_z, threshold  # noqa: E402

VARIANTS = ("scalar_rgb", "llvm_ad_rgb")
ALL_VARIANTS = (*VARIANTS, "scalar_spectral", "llvm_ad_spectral")
SIDES = "albedo:albedo,normal:sh_normal"
"""What denoisers want beside the image."""


def inner(kind: str, **options: Any) -> dict[str, Any]:
    return {"type": kind, "max_depth": 3, **options}


def aov(kind: str, **options: Any) -> dict[str, Any]:
    return {"type": "aov", "aovs": SIDES, "inner": inner(kind, **options)}


def moment(kind: str, **options: Any) -> dict[str, Any]:
    return {"type": "moment", "inner": inner(kind, **options)}


def render(scene: Any, integrator: Any, spp: int = 16, seed: int = 0) -> np.ndarray:
    """All that the film has, in which colours are what sample() gave: `aov` shows another render of
    the integrator within in their place.
    """
    if isinstance(integrator, dict):
        integrator = mi.load_dict(integrator)
    mi.render(scene, integrator=integrator, spp=spp, seed=seed)
    return np.array(scene.sensors()[0].film().develop())


def render_blocks(scene: Any, integrator: Any, first_seed: int) -> np.ndarray:
    """Means of blocks of all channels, of independent renders: (renders, blocks, channels)."""
    integrator = mi.load_dict(integrator)
    renders = []
    for seed in range(first_seed, first_seed + RENDERS):
        image = render(scene, integrator, 32, seed)
        height, width, channels = image.shape
        blocks = image.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, channels)
        renders.append(blocks.mean(axis=(1, 3)).reshape(-1, channels))
    return np.stack(renders).astype(np.float64)


@pytest.mark.parametrize("variant", ALL_VARIANTS)
def test_aov_has_the_mean_of_path(variant: str) -> None:
    mi.set_variant(variant)
    scene = mi.load_dict(scenes.many_lamps())
    expected = render_blocks(scene, aov("path"), 0)
    assert expected.shape[-1] == 13, "colours, those and the alpha of the one within, albedo, normal"
    limit = threshold(expected[0].size)
    found = render_blocks(scene, aov("lightcull_path"), 1000)
    assert largest_z(expected, found) < limit
    # A twin whose light alone is brighter.
    found[..., :3] *= 1.1
    assert largest_z(expected, found) > limit, "the test could not see a bias"


@pytest.mark.parametrize("variant", VARIANTS)
def test_moment_has_the_mean_of_path_and_a_smaller_square(variant: str) -> None:
    mi.set_variant(variant)
    scene = mi.load_dict(scenes.many_lamps())
    expected = render_blocks(scene, moment("path"), 0)
    found = render_blocks(scene, moment("lightcull_path", light_sampler="culled"), 1000)
    mean, squares = slice(0, -3), slice(-3, None)
    limit = threshold(expected[0, :, mean].size)
    assert largest_z(expected[..., mean], found[..., mean]) < limit
    assert largest_z(expected[..., mean], 1.1 * found[..., mean]) > limit
    assert (found[..., squares].mean(axis=(0, 1)) < expected[..., squares].mean(axis=(0, 1))).all()


@pytest.mark.parametrize("make", [scenes.environment, scenes.suns_and_lamps, scenes.glass, scenes.panels])
@pytest.mark.parametrize("variant", VARIANTS)
def test_kinds_of_lights_and_surfaces(make: Any, variant: str) -> None:
    mi.set_variant(variant)
    scene = mi.load_dict(make())
    expected = render_blocks(scene, aov("path"), 0)
    limit = threshold(expected[0].size)
    found = render_blocks(scene, aov("lightcull_path"), 1000)
    assert largest_z(expected, found) < limit


@pytest.mark.parametrize("variant", VARIANTS)
def test_two_within_one(variant: str) -> None:
    """Each has its own lights, and shows what it does alone."""
    mi.set_variant(variant)
    scene = mi.load_dict(scenes.many_lamps())
    both = {
        "type": "aov",
        "aovs": SIDES,
        "all": inner("lightcull_path"),
        "direct": inner("lightcull_path", light_sampler="light_bvh") | {"max_depth": 2},
    }
    together = render(scene, both, spp=64)
    for depth in (2, 3):
        alone = render(scene, inner("lightcull_path") | {"max_depth": depth}, spp=64).mean()
        means = together.mean(axis=(0, 1))
        assert np.abs(means / alone - 1).min() < 0.2


@pytest.mark.parametrize("variant", VARIANTS)
def test_error_falls_with_the_root_of_the_samples(variant: str) -> None:
    """Though it was told to choose by few random ranges, which would leave an error."""
    scene = scenes.round_lamps()
    scene["sensor"] = scene["sensor"] | {
        "film": {"type": "hdrfilm", "width": 16, "height": 12, "rfilter": {"type": "box"}}
    }
    options = {"max_depth": 2, "sets": 4, "error_bound": 8.0}
    mi.set_variant("llvm_ad_rgb")
    reference = render(mi.load_dict(scene), inner("path") | {"max_depth": 2}, 65536, 77)

    mi.set_variant(variant)
    loaded = mi.load_dict(scene)

    def images(spp: int, times: int, kind: str, **more: Any) -> np.ndarray:
        integrator = mi.load_dict({"type": "aov", "aovs": SIDES, "in": inner(kind) | more})
        return np.stack([render(loaded, integrator, spp, 5 + i)[..., :3] for i in range(times)])

    def error(of: np.ndarray) -> float:
        return float(((of - reference) ** 2).mean())

    # Of path, whose error falls so: with its seeds, since a few pixels decide.
    for spp, times in {16: 16, 256: 4, 4096: 1}.items():
        expected = error(images(spp, times, "path", max_depth=2))
        found = images(spp, times, "lightcull_path", **options)
        assert 0.75 < error(found) / expected < 1.35, spp
    assert error(1.05 * found) > 1.35 * expected, "the test could not see a bias"


@pytest.mark.parametrize("variant", VARIANTS)
def test_python_may_ask_for_paths(variant: str) -> None:
    mi.set_variant(variant)
    scene = mi.load_dict(scenes.lamps(3) | scenes.stage())
    sensor = scene.sensors()[0]
    integrator = mi.load_dict(inner("lightcull_path"))
    sampler = sensor.sampler().fork()
    count = 1 if variant.startswith("scalar") else 1000
    sampler.seed(1, count)
    seen = []
    for _ in range(1000 // count):
        ray, _ = sensor.sample_ray_differential(0.0, 0.5, sampler.next_2d(), mi.Point2f(0.5))
        light, valid, channels = integrator.sample(scene, sampler, ray)
        assert channels == []
        seen.append(np.array(light))
    image = render(scene, integrator, 256)
    assert abs(np.mean(seen) / image.mean() - 1) < 0.3


def test_an_integrator_in_python_around_it() -> None:
    mi.set_variant("llvm_ad_rgb")

    class Twice(mi.SamplingIntegrator):
        """As bright again as the integrator within."""

        def __init__(self, props: Any) -> None:
            super().__init__(props)
            self.inner = props["inner"]

        def sample(self, scene: Any, sampler: Any, ray: Any, medium: Any = None, active: Any = True) -> Any:
            light, valid, _ = self.inner.sample(scene, sampler, ray, medium, active)
            return 2 * light, valid, []

    mi.register_integrator("twice", Twice)
    scene = mi.load_dict(scenes.many_lamps())
    # The numbers of a sampler have the same use in both.
    once = render(scene, inner("lightcull_path", light_sampler="light_bvh:importance=means"), 4)
    twice = render(scene, {"type": "twice", "inner": inner("lightcull_path")}, 4)
    np.testing.assert_allclose(twice.mean(), 2 * once.mean(), rtol=0.05)


@pytest.mark.parametrize("variant", VARIANTS)
def test_lights_may_change_between_renders(variant: str) -> None:
    """Also one that was dark, and one that moves."""
    mi.set_variant(variant)
    dark = scenes.lamps(2)
    dark["lamp0"]["emitter"] = scenes.area(0.0)
    scene = mi.load_dict(scenes.stage() | dark)
    integrator = mi.load_dict(aov("lightcull_path"))
    before = render(scene, integrator, 64)[..., :3].mean()
    parameters = mi.traverse(scene)
    bright = parameters["lamp1.emitter.radiance.value"]
    parameters["lamp0.emitter.radiance.value"] = bright
    parameters["lamp1.emitter.radiance.value"] = 0 * bright
    parameters.update()
    after = render(scene, integrator, 64)[..., :3].mean()
    assert 0.5 < after / before < 2
    fresh = render(scene, aov("lightcull_path"), 64)[..., :3].mean()
    assert abs(after / fresh - 1) < 0.1


class Lines(mi.Appender):
    """Keeps what is logged."""

    def __init__(self) -> None:
        super().__init__()
        self.lines: list[tuple[Any, str]] = []

    def append(self, level: Any, text: str) -> None:
        self.lines.append((level, text))


@pytest.fixture
def log() -> Any:
    lines = Lines()
    mi.logger().add_appender(lines)
    yield lines.lines
    mi.logger().remove_appender(lines)


@pytest.mark.parametrize("variant", VARIANTS)
def test_what_chooses_is_said_once(variant: str, log: Any) -> None:
    mi.set_variant(variant)
    scene = mi.load_dict(scenes.many_lamps())
    integrator = mi.load_dict(aov("lightcull_path", light_sampler="culled"))
    for _ in range(2):
        render(scene, integrator, 1)
    said = [text for level, text in log if level == mi.LogLevel.Warn and "chooses lights" in text]
    assert len(said) == 1
    assert "light_bvh:importance=means" in said[0] and "culled" in said[0]


@pytest.mark.parametrize("asked", ["light_bvh:importance=means", "learned"])
def test_what_was_asked_for_and_done_is_not_said(asked: str, log: Any) -> None:
    mi.set_variant("llvm_ad_rgb")
    lamps = 70 if asked.startswith("light_bvh") else 3
    scene = mi.load_dict(scenes.stage() | scenes.lamps(lamps))
    render(scene, aov("lightcull_path", light_sampler=asked), 1)
    assert not [text for _, text in log if "chooses lights" in text]


def test_an_error_is_seen_as_it_is(log: Any) -> None:
    mi.set_variant("llvm_ad_rgb")
    broken = scenes.rectangle([0, 3, 0], 0.5, scenes.area(float("inf"), 1, 1))
    scene = mi.load_dict(scenes.stage() | {"broken": broken})
    with pytest.raises(RuntimeError):
        render(scene, aov("lightcull_path"), 1)
    assert [text for _, text in log if '"broken"' in text and "not finite" in text]


def test_a_symbolic_loop_is_refused() -> None:
    import drjit as dr

    mi.set_variant("llvm_ad_rgb")
    scene = mi.load_dict(scenes.stage() | scenes.lamps(3))
    integrator = mi.load_dict(inner("lightcull_path"))
    ray = mi.RayDifferential3f(mi.Point3f(0, 2, 5), mi.Vector3f(0, 0, -1))
    sampler = scene.sensors()[0].sampler().fork()
    sampler.seed(1, 8)

    def body(i: Any) -> tuple[Any]:
        integrator.sample(scene, sampler, ray)
        return (i + 1,)

    with pytest.raises(RuntimeError) as error:
        dr.while_loop((dr.arange(mi.UInt32, 8),), lambda i: i < 9, body, mode="symbolic")
    message = str(error.value.__cause__ or error.value)
    assert "within a symbolic loop" in message
