"""Cameras: those of files, those that are asked for, and those that are placed."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import lightcull
from conftest import QUAD, Outcome, square
from gltf_file import GltfFile
from lightcull.camera import View
from lightcull.views import automatic_camera, openness

Run = Callable[..., Outcome]


def cameras(folder: Path) -> Path:
    """A bright square of side 2 at z = 0, seen by cameras of 3 kinds from z = 4."""
    file = GltfFile()
    material = file.add("materials", {"emissiveFactor": [1, 1, 1]})
    file.node(mesh=file.quad(material))
    file.camera(translation=[0, 0, 4], name="near")
    file.camera(translation=[0, 0, 8], name="far")
    flat = {"type": "orthographic", "name": "flat",
            "orthographic": {"xmag": 3.0, "ymag": 2.5, "znear": 0.1, "zfar": 10.0}}  # fmt: skip
    file.node(camera=file.add("cameras", flat), translation=[0, 0, 4])
    return file.write(folder / "cameras.glb")


def covered(scene: lightcull.Scene) -> float:
    """The part of the picture that is the square."""
    image = lightcull.render(scene, spp=16, size=(64, 64), max_depth=1).image
    return float((image[..., 0]).mean())


def of_perspective(distance: float) -> float:
    """Of a square of side 2 in a square picture that is one radian high."""
    return float((1 / (distance * math.tan(0.5))) ** 2)


@pytest.mark.parametrize(
    ("which", "part"),
    [
        (None, of_perspective(4)),
        ("near", of_perspective(4)),
        ("far", of_perspective(8)),
        (1, of_perspective(8)),
        ("1", of_perspective(8)),
        ("flat", (2 / 5) ** 2),
        (2, (2 / 5) ** 2),
    ],
)
def test_cameras_of_a_file_are_chosen_by_name_or_number(
    tmp_path: Path, which: str | int | None, part: float
) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scene = lightcull.load(cameras(tmp_path), camera=which)
    assert [camera.name for camera in scene.cameras] == ["near", "far", "flat"]
    assert covered(scene) == pytest.approx(part, rel=0.02)


def test_a_camera_that_is_not_there_is_named_with_those_that_are(tmp_path: Path) -> None:
    for which in ("top", 3, "3", -1):
        with pytest.raises(lightcull.Error, match="no camera .*; there are 0 'near', 1 'far', 2 'fl"):
            lightcull.load(cameras(tmp_path), camera=which)
    with pytest.raises(lightcull.Error, match="there are none"):
        lightcull.open_scene("cornell", camera="top")


def test_what_is_said_of_a_camera_holds(tmp_path: Path) -> None:
    path = cameras(tmp_path)
    given = lightcull.load(path, camera=View(origin=(0, 0, 16), vertical_fov=1.0))
    assert given.camera.target == pytest.approx((0, 0, 0))  # the middle of the scene
    assert covered(given) == pytest.approx(of_perspective(16), rel=0.02)
    wider = lightcull.load(path, camera=View("far", vertical_fov=2 * math.atan(2 * math.tan(0.5))))
    assert covered(wider) == pytest.approx(of_perspective(16), rel=0.02)
    away = lightcull.load(path, camera=View(target=(0, 0, 5)))
    assert covered(away) == 0
    own = lightcull.load(path, camera=lightcull.Camera((0, 0, 16), (0, 0, 0), vertical_fov=1.0))
    assert covered(own) == covered(given)


def test_a_view_straight_down_needs_no_up() -> None:
    scene = lightcull.open_scene("cornell", camera=View(origin=(0, 20, 0), target=(0, 0, 0)))
    assert scene.camera.up == (0, 0, -1)


def thing(radius: float = 1.0, at: tuple[float, float, float] = (0, 0, 0)) -> lightcull.Scene:
    """An octahedron."""
    corners = np.float32([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    faces = np.uint32([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4],
                       [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])  # fmt: skip
    scene = lightcull.Scene()
    scene.add_mesh(radius * corners + np.float32(at), faces)
    return scene


@pytest.mark.parametrize("radius", [1e-3, 1.0, 1e4])
def test_a_camera_from_outside_sees_all_of_a_thing_and_little_else(radius: float) -> None:
    scene = thing(radius, (3 * radius, -radius, 2 * radius))
    assert scene.bounds is not None
    camera, said = automatic_camera(scene.bounds, scene.preview().distances)
    assert "sees everything" in said
    scene.set_camera(*camera.parameters)
    scene.set_environment((1, 1, 1))
    size = (48, 48)
    seen = lightcull.render(scene, spp=16, size=size, max_depth=1).image[..., 0] < 0.9
    assert not (seen[0].any() or seen[-1].any() or seen[:, 0].any() or seen[:, -1].any())
    rows, columns = np.nonzero(seen)
    assert max(np.ptp(rows), np.ptp(columns)) > 0.8 * size[0]
    assert abs(rows.min() + rows.max() - 47) <= 4 and abs(columns.min() + columns.max() - 47) <= 4


def walls(inwards: bool) -> lightcull.Scene:
    """A box of 8 x 3 x 4 m with another within it."""
    scene = lightcull.Scene()
    corners = np.array([[x, y, z] for x in (-4, 4) for y in (0, 3) for z in (-2, 2)], np.float32)
    sides = np.array(
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]],
        np.uint32,
    )
    indices = np.concatenate([sides[:, [0, 1, 2]], sides[:, [0, 2, 3]]])
    scene.add_mesh(corners, np.ascontiguousarray(indices[:, ::-1] if inwards else indices))
    scene.add_mesh(0.25 * corners + np.float32([2, 0, 0]), np.ascontiguousarray(indices))
    return scene


def test_a_room_is_seen_from_within_along_its_length() -> None:
    scene = walls(inwards=True)
    preview = scene.preview()
    assert scene.bounds is not None
    camera, said = automatic_camera(scene.bounds, preview.distances)
    assert "looks across the room" in said
    assert (scene.bounds[0] < camera.origin).all() and (camera.origin < scene.bounds[1]).all()
    forward = np.subtract(camera.target, camera.origin)
    ahead = preview.distances(np.float32([camera.origin]), np.float32([forward]))
    assert ahead[0] * np.linalg.norm(forward) > 4  # more than the room is wide
    assert openness(camera, preview.distances) == 0


def test_a_closed_thing_is_no_room() -> None:
    scene = walls(inwards=False)
    assert scene.bounds is not None
    camera, said = automatic_camera(scene.bounds, scene.preview().distances)
    assert "sees everything" in said
    assert openness(camera, scene.preview().distances) > 0.5


def test_a_scene_can_be_changed_after_a_preview_until_it_is_used() -> None:
    scene = thing()
    scene.preview()
    scene.add_mesh(square(3, -1, facing_up=True), QUAD)
    assert scene.triangle_count == 10
    scene.lights()
    with pytest.raises(lightcull.Error, match="committed"):
        scene.preview()


def test_orthographic_cameras_are_for_paths() -> None:
    scene = thing()
    scene.set_environment((1, 1, 1))
    scene.set_camera((0, 0, 5), (0, 0, 0), orthographic_height=4.0)
    image = lightcull.render(scene, spp=64, size=(32, 32), max_depth=1).image[..., 0]
    # The square |x| + |y| < 1 in a picture of 4 x 4 m.
    assert 1 - image.mean() == pytest.approx(2 / 16, rel=0.03)
    with pytest.raises(lightcull.Error, match="orthographic"):
        lightcull.render(scene, method="vpl_all", max_depth=3, spp=1, size=(8, 8))


def test_commands_take_cameras_and_surroundings(main_here: Run, tmp_path: Path) -> None:
    cameras(tmp_path)
    told = main_here("info", "cameras.glb")
    assert told.returncode == 0
    for line in ("camera 0", "'near'", "'far'", "5 m high"):
        assert line in told.stdout
    common = ("--size", "32x32", "--spp", "8", "-o", "a.exr", "--max-depth", "1")

    def part(*options: str) -> float:
        done = main_here("render", "cameras.glb", *common, *options)
        assert done.returncode == 0, done.stderr
        return float(lightcull.read_image(tmp_path / "a.exr")[..., 0].mean())

    assert part("--camera", "flat") == pytest.approx((2 / 5) ** 2, rel=0.03)
    far = ("--camera-from", "0,0,16", "--fov", "57.29578")
    assert part(*far) == pytest.approx(of_perspective(16), rel=0.05)
    assert part(*far, "--camera-to", "0,0,20") == 0
    white = ("--environment", "0.5", "--environment-scale", "2")
    assert part(*far, "--camera-to", "0,0,20", *white) == 1


@pytest.mark.parametrize(
    ("options", "code", "said"),
    [
        (("--camera-from", "1,2"), 2, "wanted three numbers"),
        (("--fov", "180"), 2, "wanted degrees below 180"),
        (("--camera", "top"), 1, "no camera 'top'; there are none"),
        (("--camera", "0", "--camera-from", "1,2,3"), 1, "only one of them"),
        (("--camera-from", "1,2,3", "--camera-to", "1,2,3"), 1, "camera: target is the origin"),
        (("--environment", "gone.exr"), 1, "'gone.exr' is neither a file nor a colour"),
        (("--environment", "none", "--environment-scale", "2"), 1, "not with --environment none"),
    ],
)
@pytest.mark.parametrize("command", ["render", "compare", "info", "bench"])
def test_commands_refuse_what_makes_no_sense(
    main_here: Run, command: str, options: tuple[str, ...], code: int, said: str
) -> None:
    done = main_here(command, "cornell", *options)
    assert done.returncode == code
    assert said in done.stderr and len(done.stderr.splitlines()) == 1
