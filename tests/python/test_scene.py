"""lightcull.Scene."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import lightcull
from conftest import QUAD, make_room, square


def test_lights_are_in_the_order_in_which_they_were_added() -> None:
    scene = make_room(lamps=1)
    scene.add_point_light((1, 2, 3), (5, 5, 5))
    scene.add_spot_light((0, 4, 0), (0, -2, 0), (7, 7, 7), inner=0.2, outer=0.5)
    lights = scene.lights()
    assert lights.dtype == lightcull.LIGHT
    assert len(lights) == 4
    np.testing.assert_allclose(lights["axis"][:2], [[0, -1, 0]] * 2, atol=1e-6)
    np.testing.assert_allclose(lights["center"][2], [1, 2, 3])
    np.testing.assert_allclose(lights["intensity"][2:], [5, 7], rtol=1e-5)
    np.testing.assert_allclose(lights["axis"][3], [0, -1, 0], atol=1e-6)
    assert scene.counts["points"] == scene.counts["spots"] == 1


def test_a_directional_light_is_a_light_and_part_of_the_digest() -> None:
    digests = set()
    down = (0, -2, 0)
    for direction, irradiance in ((down, (7, 7, 7)), ((0, -1, 1), (7, 7, 7)), (down, (7, 7, 8))):
        scene = make_room(lamps=1)
        scene.add_directional_light(direction, irradiance)
        digests.add(scene.digest())
    assert len(digests) == 3
    lights = scene.lights()
    assert list(lights["directional"]) == [False, False, True]
    np.testing.assert_allclose(lights["axis"][2], [0, -1, 0], atol=1e-6)
    assert lights["intensity"][2] == pytest.approx(7 * (0.2126 + 0.7152) + 8 * 0.0722, rel=1e-4)
    assert scene.counts["directional lights"] == 1
    with pytest.raises(lightcull.Error, match="directional light 0: direction is 0"):
        make_room(lamps=1).add_directional_light((0, 0, 0), (1, 1, 1))


def test_a_triangle_that_is_long_beside_its_distance_to_the_floor_is_several_lights() -> None:
    scene = lightcull.Scene()
    floor = np.array([[-20, 0, -20], [-20, 0, 20], [20, 0, 20], [20, 0, -20]], np.float32)
    scene.add_mesh(floor, QUAD)
    strip = np.array([[-15, 3, 0], [15, 3, 0], [15, 3, 0.1], [-15, 3, 0.1]], np.float32)
    scene.add_light_mesh(strip, QUAD, radiance=(2, 2, 2))
    scene.add_point_light((0, 5, 0), (1, 1, 1))
    lights = scene.lights()
    assert 20 < len(lights) < 200
    assert scene.closed().emitter_count() == 3
    np.testing.assert_allclose(lights["center"][2], [0, 5, 0])
    parts = np.delete(lights, 2)
    np.testing.assert_allclose(parts["intensity"].sum(), 2 * 30 * 0.1, rtol=1e-5)
    assert np.median(parts["radius"]) < 2


def test_a_scene_is_closed_by_its_first_use(room: lightcull.Scene) -> None:
    room.lights()
    with pytest.raises(lightcull.Error, match="nothing can be changed"):
        room.add_point_light((0, 1, 0), (1, 1, 1))
    room.lights()


def test_digest_knows_scenes_apart() -> None:
    digests = {make_room(lamps).digest() for lamps in (1, 2, 3)}
    assert len(digests) == 3
    moved = make_room(1)
    moved.set_camera((0, 3, 6), (0, 0, 0))
    assert moved.digest() not in digests
    assert make_room(2).digest() in digests
    texels = np.zeros((2, 2, 3), np.float32)
    textured = [lightcull.Scene(), lightcull.Scene()]
    for scene, value in zip(textured, (0.25, 0.5), strict=True):
        scene.add_texture(texels + np.float32(value))
    assert textured[0].digest() != textured[1].digest()


def test_bounds_and_camera(room: lightcull.Scene) -> None:
    np.testing.assert_allclose(room.bounds, [[-4, 0, -4], [4, 2, 4]])
    assert room.camera.origin == (0, 3, 6)
    assert room.camera == lightcull.Camera((0, 3, 6), (0, 0.5, 0))
    assert lightcull.Scene().bounds is None


def test_environment_is_a_colour_a_map_or_a_path(tmp_path: Path) -> None:
    sky = np.zeros((4, 8, 3), np.float32)
    sky[:2] = (0.25, 0.5, 1)
    lightcull.write_exr(tmp_path / "sky.exr", sky)
    images = []
    for environment in (sky, str(tmp_path / "sky.exr"), tmp_path / "sky.exr"):
        scene = lightcull.Scene()
        scene.set_environment(environment, scale=2.0)
        scene.set_camera((0, 0, 0), (0, 1, 0), up=(0, 0, 1), vertical_fov=0.2)
        images.append(lightcull.render(scene, spp=1, size=(4, 3)).image)
        assert scene.has_environment
    np.testing.assert_allclose(images[0], np.broadcast_to([0.5, 1, 2], (3, 4, 3)), rtol=1e-5)
    assert all(np.array_equal(image, images[0]) for image in images)
    with pytest.raises(TypeError, match="environment: wanted a path, a map or three numbers"):
        lightcull.Scene().set_environment((1, 2))


def test_a_light_mesh_is_textured(tmp_path: Path) -> None:
    texels = np.zeros((1, 2, 3), np.float32)
    texels[0, 1] = 1
    uvs = np.float32([[0, 0], [0, 1], [1, 1], [1, 0]])
    scene = lightcull.Scene()
    texture = scene.add_texture(texels)
    scene.add_light_mesh(
        square(1, 0, facing_up=True), QUAD, radiance=(4, 4, 4), texture=texture, uvs=uvs
    )
    scene.set_camera((0, 2, 0), (0, 0, 0), up=(0, 0, -1), vertical_fov=0.9)
    image = lightcull.render(scene, spp=4, size=(16, 16), max_depth=1).image
    assert image[8, 4].max() < 0.5 < 3.5 < image[8, 11].min()


def test_a_light_knows_the_mean_of_a_large_texture() -> None:
    """Four texels in the middle give all the light: half to each triangle, on their edge."""
    scene = lightcull.Scene()
    texels = np.zeros((2048, 4096, 3), np.float32)
    texels[1023:1025, 2047:2049] = 1e6
    scene.add_light_mesh(
        np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32),
        QUAD,
        radiance=(1, 1, 1),
        texture=scene.add_texture(texels),
        uvs=np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32),
    )
    area, mean = 0.5, 4e6 / (2048 * 4096)
    np.testing.assert_allclose(scene.lights()["intensity"], area * mean, rtol=1e-5)


def test_material_kinds() -> None:
    with pytest.raises(lightcull.Error, match="kind 'glass' is neither"):
        lightcull.Scene().add_material(kind="glass")
    with pytest.raises(lightcull.Error, match="roughness"):
        lightcull.Scene().add_material(kind="metallic_roughness", roughness=2.0)


def test_a_missing_image_is_named() -> None:
    with pytest.raises(lightcull.Error, match="nowhere.png"):
        lightcull.Scene().add_texture("nowhere.png")


def test_example_scenes_go_by_name() -> None:
    scene = lightcull.example_scene("cornell")
    assert scene.name == "cornell"
    assert len(scene.lights()) == 2
    with pytest.raises(lightcull.Error, match="no example scene 'lantern': did you mean 'lanterns'"):
        lightcull.example_scene("lantern")
