"""Scenes in which things move, frame by frame."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import QUAD, make_room, square

import lightcull

SIZE = (32, 24)


def lamps_at(shift: float) -> np.ndarray:
    """Corners of thirty lamps in a row, float32 (120, 3)."""
    lamp = square(0.05, 2, facing_up=False)
    places = [np.float32([0.2 * i - 3 + shift, 0, 0]) for i in range(30)]
    return np.concatenate([lamp + place for place in places])


def street(shift: float = 0.0, height: float = 1.5) -> tuple[lightcull.Scene, int]:
    """A floor under lamps, a point and a spot; and the id of the mesh of lamps."""
    scene = lightcull.Scene("street")
    scene.add_mesh(square(4, 0, facing_up=True), QUAD, name="floor")
    quads = np.concatenate([QUAD + np.uint32(4 * i) for i in range(30)])
    lamps = scene.add_light_mesh(lamps_at(shift), quads, radiance=(4, 4, 3), name="lamps")
    scene.add_point_light((0, height, 1), intensity=(1, 1, 2))
    scene.add_spot_light((1, height, 1), (0, -1, 0), (2, 1, 1), inner=0.3, outer=0.6)
    scene.set_camera(origin=(0, 3, 6), target=(0, 0.5, 0))
    return scene, lamps


def move(scene: lightcull.Scene, lamps: int, shift: float, height: float) -> None:
    scene.set_mesh_positions(lamps, lamps_at(shift))
    scene.set_light_positions(np.float32([[0, height, 1], [1, height, 1]]))


def test_an_animation_shows_what_each_frame_would_show_alone() -> None:
    """By a sampler that depends on nothing but the lights: to rounding; and by culled in the mean,
    within 3 %, some 5 standard deviations.
    """
    moving, lamps = street()
    frames = lightcull.Frames(moving, "exhaustive", size=SIZE, seed=3)
    culled = lightcull.Frames(moving, "culled", size=SIZE)
    for number, (shift, height) in enumerate([(0.0, 1.5), (0.1, 1.4), (0.3, 1.2)]):
        if number > 0:
            move(moving, lamps, shift, height)
        frame = frames.render(spp=4)
        assert (frame.seed, frame.stats.spp, frame.scene) == (3 + number, 4, "street")
        still, _ = street(shift, height)
        alone = lightcull.render(still, "exhaustive", spp=4, size=SIZE, seed=3 + number)
        alike = np.isclose(frame.image, alone.image, rtol=1e-4)
        assert alike.mean() > 0.998
        many = culled.render(spp=64)
        assert many.image.mean() == pytest.approx(alone.image.mean(), rel=0.03)
        assert culled.rebuilt == (number == 0)  # small moves are followed


def test_what_lights_are_is_that_of_a_scene_built_there() -> None:
    moving, lamps = street()
    before = moving.lights()
    move(moving, lamps, 0.5, 1.0)
    still, _ = street(0.5, 1.0)
    assert moving.lights().tobytes() == still.lights().tobytes() != before.tobytes()
    assert np.array_equal(moving.bounds, still.bounds)
    assert moving.digest() != street()[0].digest()


def test_what_was_moved_before_it_is_closed_is_built_there() -> None:
    moving, lamps = street()
    move(moving, lamps, 0.5, 1.0)
    assert moving.lights().tobytes() == street(0.5, 1.0)[0].lights().tobytes()


def test_arrays_of_other_dtypes_are_converted() -> None:
    scenes = [street()[0], street()[0]]
    for scene, dtype in zip(scenes, (np.float32, np.float64), strict=True):
        lamps = lamps_at(2).astype(dtype)
        scene.set_mesh_positions(1, lamps if dtype is np.float32 else np.asfortranarray(lamps))
        scene.set_light_positions(np.array([[0, 1, 1], [1, 1, 1]], dtype))
        scene.set_light_directions(np.array([[0, -2, 0]], dtype))
    assert scenes[0].lights().tobytes() == scenes[1].lights().tobytes()
    assert np.array_equal(scenes[0].bounds, scenes[1].bounds)
    assert scenes[1].bounds is not None
    assert scenes[1].bounds.dtype == np.float32
    assert scenes[0].digest() == scenes[1].digest()


def test_lights_turn() -> None:
    scene, _ = street()
    scene.add_directional_light((0, -1, 0), (1, 1, 1))
    scene.set_light_directions(np.float32([[2, 0, 0], [0, 0, 3]]))
    assert np.array_equal(scene.lights()["axis"][-2:], [[1, 0, 0], [0, 0, 1]])


def test_a_learned_sampler_goes_on_from_frame_to_frame(room: lightcull.Scene) -> None:
    frames = lightcull.Frames(room, size=SIZE)
    first = frames.render(spp=8)
    second = frames.render(spp=8)
    assert first.sampler == "learned"
    assert not np.array_equal(first.image, second.image)
    assert second.image.mean() == pytest.approx(first.image.mean(), rel=0.1)


def test_what_makes_no_sense_is_said(room: lightcull.Scene) -> None:
    with pytest.raises(lightcull.Error, match="mesh 1: positions has 3 elements for 4 corners"):
        room.set_mesh_positions(1, np.zeros((3, 3), np.float32))
    with pytest.raises(TypeError, match="positions"):
        room.set_mesh_positions(1, np.zeros((4, 2)))
    with pytest.raises(lightcull.Error, match="has 1 elements for 0 points and spots"):
        room.set_light_positions(np.zeros((1, 3), np.float32))
    with pytest.raises(TypeError, match=r"wanted a lightcull\.Scene"):
        lightcull.Frames("lanterns")
    virtual = make_room()
    virtual.add_virtual_lights(64)
    with pytest.raises(lightcull.Error, match="nothing can be moved"):
        virtual.set_mesh_positions(1, square(1, 1, facing_up=True))
