"""Rendering by virtual lights, from Python and from the command line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import lightcull
from conftest import QUAD, Outcome, make_room

SIZE = (32, 24)
FEW = ":lights=2000:filter=off"


@pytest.mark.parametrize("method", ["vpl_all:lights=300", f"vpl_culled{FEW}", "vpl_grid:lights=2000"])
def test_virtual_lights_add_what_bounces(method: str) -> None:
    def image(method: str, max_depth: int, spp: int) -> np.ndarray:
        return lightcull.render(
            lightcull.example_scene("cornell"), "uniform", method=method, max_depth=max_depth,
            spp=spp, size=SIZE,
        ).image.astype(np.float64)  # fmt: skip

    def bounced(method: str, spp: int) -> float:
        # Direct light is the same to the bit, whatever finds the rest.
        return float((image(method, 3, spp) - image("path", 2, spp)).mean())

    assert bounced("path", 600) == pytest.approx(bounced(method, 30), rel=0.06)


def test_a_seed_gives_an_image_whatever_the_threads() -> None:
    def image(**options: int) -> np.ndarray:
        return lightcull.render(
            make_room(), method="vpl_culled:lights=1000", max_depth=4, spp=2, size=SIZE, **options
        ).image

    first = image(seed=3, threads=1)
    assert np.array_equal(first, image(seed=3, threads=2))
    assert not np.array_equal(first, image(seed=4))


def test_the_method_is_in_what_is_written(
    main_here: Callable[..., Outcome], tmp_path: Path
) -> None:
    method = "vpl_culled:lights=500"
    options = ("--spp", "2", "--size", "16x12", "-o", "a.exr")
    outcome = main_here("render", "cornell", "--method", method, *options)
    assert outcome.returncode == 0, outcome.stderr
    assert f"bounces by {method}" in outcome.stdout
    assert method.encode() in (tmp_path / "a.exr").read_bytes()


@pytest.mark.parametrize(
    ("method", "says"),
    [
        ("vpl", "unknown; there are path, vpl_all, vpl_culled, vpl_clamped, vpl_grid"),
        ("vpl_culled:lights=0", "lights is not in"),
        ("vpl_culled:shadows=soft", "shadows is 'soft'; there are rays, none"),
        ("vpl_all:accepted=3", "no option 'accepted' for vpl_all"),
        ("vpl_grid:alpha=0", "alpha is not finite and above 0"),
        ("vpl_grid:alpha=inf", "alpha is not finite and above 0"),
        ("vpl_culled:error_bound=nan", "error_bound is nan, wanted finite and above 0"),
        ("vpl_clamped:accepted=-1", "expected_accepted is -1.000000, wanted finite and above 0"),
        ("vpl_culled:exposure=inf", "exposure is inf, wanted finite and above 0"),
        ("vpl_grid:interleave=4", "no option 'interleave' for vpl_grid"),
        ("path:lights=3", "unknown"),
    ],
)
def test_a_method_that_is_none_is_refused(
    main_here: Callable[..., Outcome], method: str, says: str
) -> None:
    outcome = main_here("render", "cornell", "--method", method)
    assert outcome.returncode == 2
    assert says in outcome.stderr
    with pytest.raises(lightcull.Error, match=says):
        lightcull.render(make_room(), method=method, max_depth=3, spp=1)


def test_what_cannot_be_is_refused(tmp_path: Path) -> None:
    def render(scene: lightcull.Scene, **options: object) -> None:
        lightcull.render(scene, method="vpl_culled", spp=1, size=SIZE, **options)  # type: ignore

    with pytest.raises(lightcull.Error, match="max_depth is 2: virtual lights give what bounces"):
        render(make_room())
    with pytest.raises(lightcull.Error, match="max_depth is 6, wanted 3 to 5"):
        render(make_room(), max_depth=6)
    with pytest.raises(lightcull.Error, match="checkpoint and resume: not for vpl_culled"):
        render(make_room(), max_depth=3, checkpoint=tmp_path / "c")
    mirror = make_room()
    mirror.add_material(kind="metallic_roughness", metallic=1.0, roughness=0.0)
    with pytest.raises(lightcull.Error, match="has roughness 0: a perfect mirror"):
        render(mirror, max_depth=3)
    with pytest.raises(lightcull.Error, match="only spots, directional lights and the environment"):
        lightcull.render(
            make_room(), method="vpl_culled:source=shadow_map:lights=400", max_depth=3, spp=1,
            size=SIZE,
        )  # fmt: skip


def test_a_scene_without_light_is_black() -> None:
    scene = lightcull.Scene("dark")
    with pytest.warns(UserWarning, match="the image is black"):
        result = lightcull.render(scene, method="vpl_culled", max_depth=3, spp=1, size=SIZE)
    assert not result.image.any()


def glossy_room() -> lightcull.Scene:
    """The room, with a floor of rough metal."""
    scene = make_room()
    metal = scene.add_material(
        kind="metallic_roughness", base_color=(0.8, 0.8, 0.8), metallic=0.5, roughness=0.5
    )
    floor = np.float32([[-2, 0.1, -2], [-2, 0.1, 2], [2, 0.1, 2], [2, 0.1, -2]])
    wall = np.float32([[-2, 0, -2.5], [2, 0, -2.5], [2, 3, -2.5], [-2, 3, -2.5]])
    scene.add_mesh(floor, QUAD, material=metal, name="metal")
    scene.add_mesh(wall, QUAD, name="wall")
    return scene


def test_samplers_choose_among_virtual_lights_of_a_scene() -> None:
    def mean(scene: lightcull.Scene, sampler: str, max_depth: int, spp: int) -> float:
        result = lightcull.render(scene, sampler, max_depth=max_depth, spp=spp, size=SIZE)
        return float(result.image.mean(dtype=np.float64))

    direct, bounced = (mean(glossy_room(), "power", depth, 300) for depth in (2, 3))
    means = []
    for seed in range(6):
        scene = glossy_room()
        before = len(glossy_room().lights())
        scene.add_virtual_lights(2000, seed=seed)
        lights = scene.lights()
        assert scene.counts["virtual lights"] == len(lights) - before > 1000
        assert np.count_nonzero(lights["lobe_alpha"] == np.float32(0.25)) > 100
        means.append(mean(scene, "culled", 2, 40))
    assert lightcull.render(scene, spp=1, size=SIZE).sampler == "culled"
    assert bounced > 1.05 * direct
    assert np.mean(means) - direct == pytest.approx(bounced - direct, rel=0.1)


def test_virtual_lights_of_a_scene_from_the_command_line(main_here: Callable[..., Outcome]) -> None:
    options = ("--spp", "1", "--size", "16x12", "-o", "a.exr")
    outcome = main_here("render", "cornell", "--virtual-lights", "500", *options)
    assert outcome.returncode == 0, outcome.stderr
    outcome = main_here("info", "cornell", "--virtual-lights", "500")
    assert " virtual lights" in outcome.stdout
    for refused, says in (
        (("--method", "vpl_culled"), "the scene has some among its lights already"),
        (("--max-depth", "3"), "max_depth is 3, and the scene has virtual lights"),
        (("--virtual-lights", "16777217"), "light_paths is 16777217, wanted 1 to 16777216"),
        (("--virtual-lights", "0"), "wanted a whole number from 1 up"),
    ):
        outcome = main_here("render", "cornell", "--virtual-lights", "5", *options, *refused)
        assert outcome.returncode != 0
        assert says in outcome.stderr
    outcome = main_here("render", "room.xml", "--virtual-lights", "5")
    assert "--virtual-lights is not for an .xml scene of Mitsuba's" in outcome.stderr


def test_virtual_lights_are_part_of_what_a_scene_is_known_by() -> None:
    plain, few, others = make_room(), make_room(), make_room()
    few.add_virtual_lights(10)
    others.add_virtual_lights(10, seed=1)
    assert len({plain.digest(), few.digest(), others.digest()}) == 3
    with pytest.raises(lightcull.Error, match="bounces is 4, wanted 1 to 3"):
        make_room().add_virtual_lights(10, bounces=4)
    with pytest.raises(lightcull.Error, match="nothing can be changed after commit"):
        plain.lights()
        plain.add_virtual_lights(10)


def test_more_bounces_leave_more_virtual_lights() -> None:
    def number(bounces: int) -> int:
        scene = glossy_room()
        scene.add_virtual_lights(2000, bounces=bounces)
        return int(scene.counts["virtual lights"])

    assert number(1) * 1.05 < number(2)
