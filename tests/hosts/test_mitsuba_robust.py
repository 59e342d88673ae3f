"""What users bring: scenes without light, with broken light, with more than can be done."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed")

import lightcull.mitsuba  # noqa: E402, F401
import mitsuba_scenes as scenes  # noqa: E402

VARIANTS = ("scalar_rgb", "llvm_ad_rgb")


def render(scene: Any, spp: int = 16, seed: int = 0, **options: Any) -> np.ndarray:
    integrator = mi.load_dict({"type": "lightcull_path", "max_depth": 3, **options})
    loaded = mi.load_dict(scene) if isinstance(scene, dict) else scene
    return np.array(mi.render(loaded, integrator=integrator, spp=spp, seed=seed))


@pytest.fixture(params=VARIANTS)
def variant(request: pytest.FixtureRequest) -> str:
    mi.set_variant(request.param)
    return request.param


def test_no_lights_is_black(variant: str) -> None:
    assert (render(scenes.stage()) == 0).all()


def test_one_light(variant: str) -> None:
    image = render(scenes.stage() | scenes.lamps(1))
    assert np.isfinite(image).all() and image.mean() > 0.01


def test_a_light_without_power_changes_nothing(variant: str) -> None:
    dark = {
        "dark point": {"type": "point", "position": [0, 1, 0], "intensity": scenes.rgb(0.0)},
        "dark lamp": scenes.rectangle([1, 2, 1], 0.1, scenes.area(0.0)),
    }
    lit = render(scenes.stage() | scenes.lamps(2), spp=512)
    both = render(scenes.stage() | scenes.lamps(2) | dark, spp=512)
    assert abs(both.mean() / lit.mean() - 1) < 0.02
    assert (render(scenes.stage() | dark) == 0).all()


def test_a_degenerate_triangle_is_no_light(variant: str) -> None:
    centers = np.float32([[0, 3, 0], [1, 3, 0]])
    mesh = scenes.quads(centers, 0.4, scenes.rgb(9, 9, 9))
    parameters = mi.traverse(mesh)
    faces = np.array(parameters["faces"])
    faces[-3:] = (5, 5, 6)
    parameters["faces"] = faces
    parameters.update()
    image = render(scenes.stage() | {"lamps": mesh})
    assert np.isfinite(image).all() and image.mean() > 0.01


def broken_sky() -> dict[str, Any]:
    texels = np.full((8, 16, 3), 0.5, np.float32)
    texels[2, 3] = np.nan
    return {"type": "envmap", "bitmap": mi.Bitmap(texels)}


def broken_picture() -> dict[str, Any]:
    texels = np.full((2, 2, 3), np.nan, np.float32)
    radiance = {"type": "bitmap", "bitmap": mi.Bitmap(texels), "raw": True}
    return scenes.rectangle([0, 3, 0], 0.5, {"type": "area", "radiance": radiance})


BROKEN = {
    "color": lambda: scenes.rectangle([0, 3, 0], 0.5, scenes.area(float("inf"), 1, 1)),
    "picture": broken_picture,
    "point": lambda: {"type": "point", "intensity": scenes.rgb(float("nan"), 1, 1)},
    "lost point": lambda: {"type": "point", "position": [0, float("nan"), 0]},
    "spot": lambda: {"type": "spot", "intensity": scenes.rgb(float("nan"), 1, 1)},
    "sun": lambda: {"type": "directional", "irradiance": scenes.rgb(float("nan"), 1, 1)},
    "sky": broken_sky,
    "even sky": lambda: {"type": "constant", "radiance": scenes.rgb(float("nan"), 1, 1)},
}


@pytest.mark.parametrize("broken", BROKEN)
def test_light_that_is_no_number_names_its_shape(variant: str, broken: str) -> None:
    with pytest.raises(RuntimeError) as error:
        render(scenes.stage() | {broken: BROKEN[broken]()})
    assert f'"{broken}"' in _messages(error.value)
    assert "not finite" in _messages(error.value)


@pytest.mark.parametrize("light", ["sky", "even sky", "sun", "flat lamp"])
def test_light_that_is_dark_or_without_area_is_black(variant: str, light: str) -> None:
    if light == "flat lamp" and variant == "scalar_rgb":
        pytest.skip("Mitsuba does not load it")
    dark = {
        "sky": {"type": "envmap", "bitmap": mi.Bitmap(np.zeros((8, 16, 3), np.float32))},
        "even sky": {"type": "constant", "radiance": scenes.rgb(0.0)},
        "sun": {"type": "directional", "irradiance": scenes.rgb(0.0)},
        "flat lamp": scenes.rectangle([0, 3, 0], 0.0, scenes.area(5, 5, 5)),
    }
    assert (render(scenes.stage() | {light: dark[light]}) == 0).all()


def test_a_place_that_is_no_number_names_its_shape(variant: str) -> None:
    mesh = scenes.quads(np.float32([[0, 3, 0]]), 0.4, scenes.rgb(9, 9, 9))
    mesh.set_id("lost lamp")
    parameters = mi.traverse(mesh)
    positions = np.array(parameters["vertex_positions"])
    positions[4] = np.nan
    parameters["vertex_positions"] = positions
    parameters.update()
    with pytest.raises(RuntimeError) as error:
        render(scenes.stage() | {"lost lamp": mesh})
    assert "lost lamp" in _messages(error.value)


def _messages(error: BaseException | None) -> str:
    """Of an error and of all that led to it."""
    text = ""
    while error is not None:
        text += str(error)
        error = error.__cause__ or error.__context__
    return text


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"light_sampler": "best"}, "there are uniform, power, light_bvh"),
        ({"light_sampler": "culled:sets=5"}, "power of 4"),
        ({"light_sampler": "paper:test=none"}, "wanted vertex or light"),
        ({"error_bound": "much"}, 'wanted a number or "auto"'),
        ({"error_bound": -1.0}, "above 0"),
        ({"sets": 5}, "power of 4"),
        ({"light_sampler": "power", "sets": 16}, "no option 'sets'"),
        ({"light_sampler": "learned", "sets": 16}, "no option 'sets'"),
        ({"light_sampler": "learned:rounds=0"}, "rounds is 0"),
    ],
)
def test_wrong_parameters_are_named(options: dict[str, Any], said: str) -> None:
    mi.set_variant("scalar_rgb")
    with pytest.raises(RuntimeError, match=said):
        mi.load_dict({"type": "lightcull_path", **options})


@pytest.mark.parametrize("other", ["llvm_ad_mono", "cuda_ad_rgb", "scalar_mono_polarized"])
def test_other_variants_refuse(other: str) -> None:
    try:
        mi.set_variant(other)
    except ImportError as error:
        pytest.skip(f"Mitsuba cannot be set to it here: {error}")
    with pytest.raises(RuntimeError, match="scalar_rgb, scalar_spectral, llvm_ad_rgb.*cuda"):
        mi.load_dict({"type": "lightcull_path"})


def test_many_shapes_bring_one_warning() -> None:
    program = """
import lightcull.mitsuba, mitsuba as mi, sys
sys.path.insert(0, sys.argv[1])
import mitsuba_scenes as scenes
mi.set_variant("llvm_ad_rgb")
lamps = {f"lamp{i}": scenes.rectangle([i % 30 - 15, 3, i / 30], 0.1, scenes.area(5.0)) for i in range(501)}
scene = mi.load_dict(scenes.stage() | lamps)
for _ in range(2):
    mi.render(scene, integrator=mi.load_dict({"type": "lightcull_path", "max_depth": 1}), spp=1)
"""
    here = str(Path(__file__).parent)
    result = subprocess.run(
        [sys.executable, "-c", program, here], capture_output=True, text=True, timeout=300
    )
    assert result.returncode == 0, result.stderr
    assert (result.stdout + result.stderr).count("merge_emitters") == 1
