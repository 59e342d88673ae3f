"""What surrounds a scene, and the light of one that has little."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

import lightcull
from conftest import QUAD, square
from gltf_file import GltfFile
from lightcull.loaders.completion import complete, surround
from lightcull.loaders.unsupported import Notes
from lightcull.surroundings import studio, texels_of

LAMBERT = {"metallicFactor": 0.0, "roughnessFactor": 1.0}


def model(folder: Path, emission: float | None, color: float = 0.8) -> Path:
    """A floor of side 10 with, if asked for, a square of side 0.1 that emits above it."""
    file = GltfFile()
    grey = file.add("materials", {"pbrMetallicRoughness": {"baseColorFactor": [color] * 3 + [1.0],
                                                           **LAMBERT}})  # fmt: skip
    turned = {"rotation": [-(0.5**0.5), 0, 0, 0.5**0.5]}
    file.node(mesh=file.quad(grey), scale=[5, 5, 1], **turned)
    if emission is not None:
        glow = file.add(
            "materials",
            {
                "emissiveFactor": [1, 1, 1],
                "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": emission}},
                "doubleSided": True,
            },
        )
        file.node(mesh=file.quad(glow), scale=[0.05, 0.05, 1], translation=[0, 0.5, 0])
    file.camera(translation=[0, 2, 8], rotation=[-0.0998334, 0, 0, 0.995004])
    return file.write(folder / "model.glb")


def loaded(path: Path, **options: object) -> tuple[lightcull.Scene, str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        scene = lightcull.load(path, **options)
    assert len(caught) <= 1
    return scene, "".join(str(warning.message) for warning in caught)


def picture(scene: lightcull.Scene) -> np.ndarray:
    """Luminance, (24, 32)."""
    return lightcull.render(scene, spp=64, size=(32, 24)).image.mean(axis=2)


def test_a_model_with_one_faint_emitter_is_seen(tmp_path: Path) -> None:
    path = model(tmp_path, 0.2)
    scene, said = loaded(path)
    assert "its lights show 0% of what the camera sees: a studio surrounds it" in said
    assert scene.has_environment
    assert (picture(scene)[14:] > 0.1).mean() > 0.95  # the floor
    dark, said = loaded(path, environment="none")
    assert said == "" and not dark.has_environment
    assert (picture(dark)[14:] < 0.01).all()


def test_a_file_that_lights_itself_stays_as_it_is(tmp_path: Path) -> None:
    scene, said = loaded(model(tmp_path, 4000.0))
    assert said == "" and not scene.has_environment


@pytest.mark.parametrize("color", [1.0, 0.5, 0.02])
def test_things_stand_out_from_a_studio_whatever_their_colour(tmp_path: Path, color: float) -> None:
    """By a tenth of the display's range, on average over the border of the floor."""
    scene, said = loaded(model(tmp_path, None, color))
    assert "no light: a studio surrounds it" in said
    image = lightcull.render(scene, spp=256, size=(32, 24)).image
    shown = lightcull.apply_view(image, "srgb").mean(axis=2)
    # The floor's far edge is between two rows; what is above it is the studio.
    rows = shown[:, 12:20].mean(axis=1)
    steps = abs(np.diff(rows))
    assert steps.max() > 0.1


def test_a_studio_is_lit_from_the_left_of_the_camera_wherever_that_is() -> None:
    for azimuth in (0.0, 1.0, 3.0, -2.0):
        forward = np.array([np.sin(azimuth), -0.2, -np.cos(azimuth)])
        camera = lightcull.Camera((0, 0, 0), tuple(forward))
        texels = studio(camera)[..., 0]
        row, column = np.unravel_index(texels.argmax(), texels.shape)
        height = np.pi * (row + 0.5) / texels.shape[0]
        around = 2 * np.pi * (column + 0.5) / texels.shape[1] - np.pi
        brightest = np.array([np.sin(height) * np.sin(around), np.cos(height),
                              -np.sin(height) * np.cos(around)])  # fmt: skip
        right = np.cross(forward, (0, 1, 0))
        assert brightest @ right < -0.4
        assert brightest @ forward < -0.4
        assert brightest[1] > 0.4


@pytest.mark.parametrize(
    ("given", "rgb"),
    [
        ("0.25", (0.25, 0.25, 0.25)),
        ("0.2,0.3,4", (0.2, 0.3, 4)),
        ("#ff0000", (1, 0, 0)),
        ("#bcbcbc", (0.502886, 0.502886, 0.502886)),  # IEC 61966-2-1 of 188 / 255
        ((1, 2, 3), (1, 2, 3)),
    ],
)
def test_colours_surround_a_scene(tmp_path: Path, given: object, rgb: tuple[float, ...]) -> None:
    scene, said = loaded(model(tmp_path, None), environment=given, environment_scale=2.0)
    assert said == ""
    image = lightcull.render(scene, spp=1, size=(16, 12)).image
    np.testing.assert_allclose(image[0, 0], 2 * np.array(rgb), rtol=1e-5)


def test_an_image_surrounds_a_scene_as_set_environment_does(tmp_path: Path) -> None:
    texels = np.random.default_rng(1).uniform(0, 2, (8, 16, 3)).astype(np.float32)
    lightcull.write_exr(tmp_path / "sky.exr", texels)
    for given in (tmp_path / "sky.exr", str(tmp_path / "sky.exr"), texels):
        scene, _ = loaded(model(tmp_path, None), environment=given, environment_scale=0.5)
        expected, _ = loaded(model(tmp_path, None), environment="none")
        expected.set_environment(texels, 0.5)
        assert np.array_equal(picture(scene), picture(expected))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("sky.exr", "environment: 'sky.exr' is neither a file nor a colour"),
        ("1,2", "environment: wanted one number from 0 up, or three, got '1,2'"),
        ("-1", "environment: wanted one number from 0 up, or three, got '-1'"),
        ((1, 2), "environment: wanted three numbers from 0 up"),
    ],
)
def test_what_cannot_surround_a_scene_is_refused(
    tmp_path: Path, given: object, said: str
) -> None:
    with pytest.raises(lightcull.Error, match=said):
        lightcull.load(model(tmp_path, None), environment=given)


def room(*, window: bool) -> lightcull.Scene:
    """A box of 6 x 3 x 4 m whose walls face inwards, or all of them but one."""
    corners = np.array([[x, y, z] for x in (-3, 3) for y in (0, 3) for z in (-2, 2)], np.float32)
    sides = np.array(
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]],
        np.uint32,
    )[int(window) :, ::-1]
    indices = np.concatenate([sides[:, [0, 1, 2]], sides[:, [0, 2, 3]]])
    scene = lightcull.Scene("room")
    scene.add_mesh(corners, np.ascontiguousarray(indices))
    return scene


def test_a_room_without_light_has_a_lamp_at_the_camera() -> None:
    scene, notes = room(window=False), Notes()
    complete(scene, notes)
    assert "looks across the room" in notes.message()
    assert "no light: a lamp is placed at the camera" in notes.message()
    assert not scene.has_environment
    assert (scene.bounds[0] < scene.camera.origin).all()
    assert (scene.camera.origin < scene.bounds[1]).all()
    shown = picture(scene)
    assert (shown > 0.03).all() and np.median(shown) == pytest.approx(0.3, rel=0.5)


def test_a_room_with_a_window_has_both() -> None:
    scene, notes = room(window=True), Notes()
    complete(scene, notes)
    assert "a lamp is placed at the camera and a studio surrounds it" in notes.message()
    assert scene.has_environment and scene.counts["points"] == 1


def test_an_example_can_be_surrounded_by_something_else_or_nothing() -> None:
    def sky(**options: object) -> np.ndarray:
        scene = lightcull.open_scene("cornell", **options)
        scene.set_camera((0, 2, 9), (0, 2, 20))  # away from the box
        return lightcull.render(scene, spp=1, size=(4, 3), max_depth=1).image

    assert (sky() == 0).all()
    assert np.allclose(sky(environment="0.5"), 0.5)
    scene = lightcull.Scene()
    scene.set_environment((1, 1, 1))
    surround(scene, "none", 1.0)
    assert (lightcull.render(scene, spp=1, size=(4, 3), max_depth=1).image == 0).all()


def test_only_what_is_seen_counts() -> None:
    """A floor in full light that the camera does not see does not make up for one that it sees."""
    scene, notes = lightcull.Scene(), Notes()
    scene.add_mesh(square(2, 0, facing_up=True), QUAD)
    scene.add_mesh(square(2, 0, facing_up=True) + np.float32([100, 0, 0]), QUAD)
    scene.add_point_light((100, 2, 0), (50, 50, 50))
    scene.set_camera((0, 3, 6), (0, 0, 0))
    notes.has_light = notes.has_camera = True
    complete(scene, notes)
    assert "its lights show 0%" in notes.message() and scene.has_environment


def test_names_are_not_colours() -> None:
    assert texels_of("none", lightcull.Camera()) is None
    assert texels_of("studio", lightcull.Camera()).shape == (64, 128, 3)
