"""lightcull.render."""

from __future__ import annotations

import os
import signal
import threading
from pathlib import Path

import numpy as np
import pytest

import lightcull
from conftest import QUAD, make_room, square

SIZE = (48, 32)


@pytest.fixture
def ctrl_c():
    """Ctrl-C as a shell in the foreground has it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield lambda: os.kill(os.getpid(), signal.SIGINT)
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("sampler", ["learned", "culled", "uniform"])
def test_same_seed_same_bits_whatever_the_threads(sampler: str) -> None:
    def image(**options: int) -> np.ndarray:
        return lightcull.render(
            make_room(), sampler, spp=3, size=(130, 70), max_depth=3, **options
        ).image

    first = image(seed=5, threads=1)
    assert first.dtype == np.float32
    assert first.shape == (70, 130, 3)
    assert first.flags.c_contiguous
    assert np.array_equal(first, image(seed=5, threads=2))
    assert not np.array_equal(first, image(seed=6, threads=1))


def test_learned_is_the_default(room: lightcull.Scene) -> None:
    by_default = lightcull.render(room, spp=6, size=SIZE)
    assert by_default.sampler == "learned"
    assert np.array_equal(by_default.image, lightcull.render(room, "learned", spp=6, size=SIZE).image)


def test_a_point_light_over_a_floor() -> None:
    """Radiance of a diffuse floor right below: albedo / pi * intensity / distance^2."""
    scene = lightcull.Scene()
    white = scene.add_material(base_color=(0.8, 0.4, 0.2))
    scene.add_mesh(square(5, 0, facing_up=True), QUAD, material=white)
    scene.add_point_light((0, 2, 0), (10, 10, 10))
    scene.set_camera((0, 1, 0), (0, 0, 0), up=(0, 0, 1), vertical_fov=0.02)
    image = lightcull.render(scene, spp=1, size=(2, 2)).image
    expected = np.array([0.8, 0.4, 0.2]) / np.pi * 10 / 4
    np.testing.assert_allclose(image, np.broadcast_to(expected, image.shape), rtol=1e-3)


@pytest.mark.filterwarnings("ignore:scene. the image is black")
@pytest.mark.parametrize("distance", [3.0, 100.0, 5000.0])
@pytest.mark.parametrize("kind", ["area", "point"])
def test_a_plate_right_before_a_lamp_hides_it(kind: str, distance: float) -> None:
    """Radiance of a floor below: albedo / pi * intensity / distance^2, or nothing."""

    def radiance(plate: float | None) -> float:
        scene = lightcull.Scene()
        scene.add_mesh(square(distance, 0, facing_up=True), QUAD)
        half = 1e-3 * distance
        if kind == "area":
            lamp = square(half, distance, facing_up=False)
            scene.add_light_mesh(lamp, QUAD, radiance=(1 / (4 * half**2),) * 3)
        else:
            scene.add_point_light((0, distance, 0), (1, 1, 1))
        if plate is not None:
            scene.add_mesh(square(2 * half, plate, facing_up=False), QUAD)
        scene.set_camera((0, distance / 2, 0), (0, 0, 0), up=(0, 0, 1), vertical_fov=0.002)
        return float(lightcull.render(scene, spp=4, size=(16, 16)).image.mean(dtype=np.float64))

    white = radiance(None)
    albedo = 0.5
    assert white == pytest.approx(albedo / np.pi / distance**2, rel=1e-3)
    gap = 2.0**-20 * distance
    assert radiance(distance - gap) == 0
    assert radiance(distance + gap) == white
    assert radiance(distance) == white


def test_stats_and_progress(room: lightcull.Scene) -> None:
    steps: list[lightcull.Progress] = []
    result = lightcull.render(room, spp=4, size=SIZE, progress=steps.append)
    assert [step.spp for step in steps] == [1, 2, 3, 4]
    assert [step.fraction for step in steps] == [0.25, 0.5, 0.75, 1.0]
    assert steps[0].seconds_left > 0 == steps[-1].seconds_left
    assert {step.stage for step in steps} == {"learned"}
    stats = result.stats
    assert stats.spp == 4
    assert not result.interrupted
    assert stats.seconds >= stats.setup_seconds > 0
    assert 0 < stats.selections <= stats.spp * SIZE[0] * SIZE[1]
    assert stats.rays >= stats.spp * SIZE[0] * SIZE[1]


def test_seconds_are_enough_for_a_sample_and_are_used_up(room: lightcull.Scene) -> None:
    assert lightcull.render(room, seconds=1e-9, size=SIZE).stats.spp == 1
    assert lightcull.render(room, seconds=0.2, size=SIZE).stats.seconds >= 0.2


def test_ctrl_c_between_passes_keeps_what_there_is(room: lightcull.Scene, ctrl_c) -> None:
    def stop(step: lightcull.Progress) -> None:
        if step.spp == 3:
            ctrl_c()

    result = lightcull.render(room, spp=10_000_000, size=SIZE, seed=3, progress=stop)
    assert result.interrupted
    assert 3 <= result.stats.spp < 10_000_000
    again = lightcull.render(make_room(), spp=result.stats.spp, size=SIZE, seed=3)
    assert np.array_equal(result.image, again.image)


def test_ctrl_c_twice_within_a_pass_raises_at_once(ctrl_c) -> None:
    scene = make_room(lamps=8_000)
    for seconds in (0.5, 0.7):
        threading.Timer(seconds, ctrl_c).start()
    with pytest.raises(KeyboardInterrupt):
        # Some 50 billion lights to weigh.
        lightcull.render(scene, "exhaustive", spp=1, size=(2048, 1536))


def test_what_the_callback_raises_ends_the_render(room: lightcull.Scene) -> None:
    def fail(step: lightcull.Progress) -> None:
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        lightcull.render(room, spp=10, size=SIZE, progress=fail)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "give either seconds=... or spp=..."),
        ({"spp": 1, "seconds": 1.0}, "give either seconds=... or spp=..."),
        ({"spp": 0}, "spp: wanted at least 1, got 0"),
        ({"seconds": -1.0}, "seconds: wanted more than 0, got -1.0"),
        ({"seconds": float("nan")}, "seconds: wanted more than 0, got nan"),
        ({"spp": 1, "size": (0, 5)}, "width: wanted a whole number from 1 up, got 0"),
        ({"spp": 1, "max_depth": 0}, "max_depth: wanted a whole number from 1 up, got 0"),
        ({"spp": 1, "seed": -1}, "seed: wanted a whole number from 0 up, got -1"),
        ({"spp": 1, "sampler": "cull"}, "cull"),
    ],
)
def test_options_that_make_no_sense(
    room: lightcull.Scene, options: dict[str, object], message: str
) -> None:
    with pytest.raises(lightcull.Error, match=message):
        lightcull.render(room, **options)


def test_an_image_holds_what_made_it(room: lightcull.Scene, tmp_path: Path) -> None:
    result = lightcull.render(room, "uniform", spp=2, size=SIZE, seed=9)
    result.save(tmp_path / "room.exr")
    np.testing.assert_array_equal(lightcull.read_image(tmp_path / "room.exr"), result.image)
    written = (tmp_path / "room.exr").read_bytes()[:4096]
    for name, value in result.metadata().items():
        assert name.encode() in written
        assert value.encode() in written
    assert {"scene", "sampler", "seed", "samples", "seconds"} <= set(result.metadata())
    with pytest.raises(lightcull.Error, match=r"must end in \.exr or \.png"):
        result.save(tmp_path / "room.jpg")
    with pytest.raises(lightcull.Error, match="nowhere"):
        result.save(tmp_path / "nowhere" / "room.exr")


def test_a_png_goes_through_a_view(room: lightcull.Scene, tmp_path: Path) -> None:
    result = lightcull.render(room, spp=1, size=SIZE)
    for view in lightcull.view_names():
        result.save(tmp_path / "a.png", view=view)
        shown = lightcull.apply_view(result.image, view)
        read = lightcull.read_image(tmp_path / "a.png", linear_data=True)
        np.testing.assert_allclose(read, shown, atol=0.51 / 255)
    brighter = lightcull.apply_view(result.image, exposure=1.0)
    assert brighter.mean() > lightcull.apply_view(result.image).mean()
    with pytest.raises(lightcull.Error, match="sepia"):
        lightcull.apply_view(result.image, "sepia")


def test_half_floats_are_half_as_precise(room: lightcull.Scene, tmp_path: Path) -> None:
    image = lightcull.render(room, spp=1, size=SIZE).image
    lightcull.write_exr(tmp_path / "half.exr", image, half=True)
    read = lightcull.read_image(tmp_path / "half.exr")
    assert np.array_equal(read, image.astype(np.float16).astype(np.float32))
    assert not np.array_equal(read, image)


def test_how_paths_end_and_direct_light_is_sampled_can_be_said(room: lightcull.Scene) -> None:
    def render(**settings: object) -> np.ndarray:
        return lightcull.render(room, spp=2, size=(24, 16), max_depth=6, **settings).image

    default = render()
    np.testing.assert_array_equal(render(rr_depth=5, direct_light="mis"), default)
    assert not np.array_equal(render(rr_depth=1), default)
    assert not np.array_equal(render(direct_light="lights"), default)
    with pytest.raises(lightcull.Error, match="direct_light: wanted one of mis, lights, bsdf"):
        render(direct_light="both")
    with pytest.raises(lightcull.Error, match="rr_depth"):
        render(rr_depth=0)
    with pytest.raises(lightcull.Error, match="are for paths"):
        render(rr_depth=2, method="vpl_culled")


def test_hidden_emitters_are_seen_by_nobody_but_light(tmp_path: Path) -> None:
    def stage() -> lightcull.Scene:
        scene = lightcull.Scene()
        scene.add_mesh(square(1, 0, facing_up=True), QUAD)
        scene.add_light_mesh(square(0.4, 2, facing_up=False), QUAD, radiance=(4, 4, 4))
        scene.set_environment((0.25, 0.25, 0.25))
        scene.set_camera((0, 30, 0), (0, 0, 0), up=(0, 0, 1), vertical_fov=0.1)
        return scene

    shown, hidden = (
        lightcull.render(stage(), "uniform", spp=64, size=(18, 18), hide_emitters=hide).image[..., 0]
        for hide in (None, True)
    )
    assert shown[0, 0] == 0.25 and hidden[0, 0] == 0
    # The lamp is seen from its dark back, before a floor that it lights.
    assert shown[9, 9] == 0 and hidden[9, 9] > 0.15
    beside = np.s_[7:11, 4:6]
    np.testing.assert_array_equal(shown[beside], hidden[beside])
    bounced = lightcull.render(
        stage(), spp=8, size=(18, 18), max_depth=3, method="vpl_culled", hide_emitters=True
    ).image[..., 0]
    assert bounced[0, 0] == 0 and bounced[9, 9] > 0.15
    lightcull.render(stage(), spp=1, size=(8, 8), checkpoint=tmp_path / "a", hide_emitters=True)
    with pytest.raises(lightcull.Error, match="is of hide_emitters True, not False"):
        lightcull.render(stage(), spp=2, size=(8, 8), resume=tmp_path / "a")
