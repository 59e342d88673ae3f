"""Arrays in: what is wanted and what came."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import lightcull
from conftest import QUAD, square

FLOOR = square(1, 0, facing_up=True)


def add(**changes: object) -> None:
    arguments = {"positions": FLOOR, "indices": QUAD, **changes}
    lightcull.Scene().add_mesh(**arguments)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"positions": FLOOR[:, :2].copy()},
            r"positions: wanted an array of shape \(N, 3\) for float32, got float32 \(4, 2\)",
        ),
        ({"positions": FLOOR.ravel()}, r"got float32 \(12,\)"),
        ({"positions": FLOOR.astype(np.complex64)}, r"positions: .*, got complex64 \(4, 3\)"),
        ({"positions": FLOOR.astype(object)}, r"positions: .*, got object \(4, 3\)"),
        ({"positions": FLOOR > 0}, r"positions: .*, got bool \(4, 3\)"),
        ({"positions": FLOOR.tolist()}, r"positions: .*, got list"),
        ({"positions": None}, r"positions: .*, got NoneType"),
        ({"positions": b"123456789012"}, r"positions: .*, got bytes"),
        ({"indices": QUAD.ravel()}, r"indices: wanted .* \(N, 3\) for uint32, got uint32 \(6,\)"),
        ({"normals": FLOOR[:3]}, r"normals: wanted .*\(4, 3\) .*, got float32 \(3, 3\)"),
        ({"uvs": FLOOR}, r"uvs: wanted .*\(4, 2\) .*, got float32 \(4, 3\)"),
    ],
)
def test_mesh_wants_arrays_as_documented(changes: dict[str, object], message: str) -> None:
    with pytest.raises(TypeError, match=message):
        add(**changes)


def bounds_of(positions: np.ndarray, indices: np.ndarray = QUAD) -> np.ndarray:
    scene = lightcull.Scene()
    scene.add_mesh(positions, indices)
    assert scene.bounds is not None
    return scene.bounds


def in_every_layout(array: np.ndarray) -> list[np.ndarray]:
    """The same numbers, otherwise in memory."""
    padded = np.full((2 * len(array), array.shape[1] + 1), 7, array.dtype)
    padded[::2, :-1] = array
    unaligned = np.frombuffer(b"-" + array.tobytes(), np.uint8)[1:].view(array.dtype)
    return [
        np.asfortranarray(array),
        padded[::2, :-1],
        np.ascontiguousarray(array[::-1])[::-1],
        np.ascontiguousarray(array.T).T,
        unaligned.reshape(array.shape),
        array.astype(array.dtype.newbyteorder()),
    ]


def test_arrays_of_any_real_dtype_and_layout_are_taken() -> None:
    scene = lightcull.Scene()
    scene.add_mesh(FLOOR, QUAD)
    digest = scene.digest()
    for dtype in (np.float16, np.float32, np.float64, np.longdouble, np.int8, np.int64):
        for positions in (FLOOR.astype(dtype), *in_every_layout(FLOOR.astype(dtype))):
            np.testing.assert_array_equal(bounds_of(positions), [[-1, 0, -1], [1, 0, 1]])
    add(indices=QUAD.astype(np.float64))
    for dtype in (np.uint8, np.int16, np.int32, np.uint32, np.int64, np.uint64):
        for indices in (QUAD.astype(dtype), *in_every_layout(QUAD.astype(dtype))):
            again = lightcull.Scene()
            again.add_mesh(FLOOR.astype(np.float64), indices)
            assert again.digest() == digest


def test_lights_and_points_too() -> None:
    places = np.array([[0, 1, 0], [3, 1, 0.0], [0, 1, 5]])
    lights = lightcull.point_lights(places[::-1], np.array([1, 2, 3]))
    np.testing.assert_array_equal(lights["center"], places[::-1].astype(np.float32))
    np.testing.assert_array_equal(lights["intensity"], [1, 2, 3])
    sampler = lightcull.LightSampler(np.repeat(lights, 2)[::2], "power")
    up = np.broadcast_to(np.array([0, 1.0, 0]), (3, 3))
    chosen = sampler.select(np.zeros((3, 3)), up, np.array([0.1, 0.4, 0.9]))
    assert set(chosen["light"]) <= {0, 1, 2}
    unaligned = np.frombuffer(b"-" + lights.tobytes(), lights.dtype, offset=1)
    lightcull.LightSampler(unaligned, "power")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"indices": QUAD.astype(np.int64) - 1}, r"indices\[0\]\[0\] is -1, which uint32 does not hold"),
        ({"indices": QUAD.astype(np.int64) + 2**32}, r"indices\[0\]\[0\] is 4294967296, which uint32 does not hold"),
        ({"indices": QUAD + 0.5}, r"indices\[0\]\[0\] is 0.5, which uint32 does not hold"),
        ({"indices": np.full((2, 3), np.nan)}, r"indices\[0\]\[0\] is nan, which uint32 does not hold"),
        ({"positions": FLOOR.astype(float) * 1e40}, r"positions\[0\]\[0\] is -1e\+40, which float32 does not hold"),
        ({"positions": np.full((4, 3), np.inf)}, "positions"),
    ],
)
def test_numbers_that_do_not_fit_are_named(changes: dict[str, object], message: str) -> None:
    with warnings.catch_warnings(), pytest.raises(lightcull.Error, match=message):
        warnings.simplefilter("error")
        add(**changes)


def test_an_array_that_cannot_be_written_is_read() -> None:
    positions = FLOOR.copy()
    positions.flags.writeable = False
    add(positions=positions)


def test_radiance_of_each_triangle() -> None:
    scene = lightcull.Scene()
    with pytest.raises(TypeError, match=r"radiance: wanted .*\(2, 3\) .*, got float32 \(3, 3\)"):
        scene.add_light_mesh(FLOOR, QUAD, radiance=np.ones((3, 3), np.float32))
    with pytest.raises(TypeError, match="radiance: wanted three numbers, got 3.0"):
        scene.add_light_mesh(FLOOR, QUAD, radiance=3.0)
    scene.add_light_mesh(FLOOR, QUAD, radiance=np.float32([[1, 1, 1], [3, 3, 3]]))
    np.testing.assert_allclose(scene.lights()["intensity"], [2, 6], rtol=1e-5)


def test_textures_and_images() -> None:
    scene = lightcull.Scene()
    with pytest.raises(TypeError, match=r"texture: wanted .*\(N, M, 3\) .*, got float32 \(4, 4\)"):
        scene.add_texture(np.zeros((4, 4), np.float32))
    # Whole numbers are no linear RGB.
    with pytest.raises(TypeError, match=r"texture: wanted .*float32, got int64 \(4, 4, 3\)"):
        scene.add_texture(np.zeros((4, 4, 3), np.int64))
    with pytest.raises(TypeError, match=r"image: wanted .*float32, got uint8 \(4, 4, 3\)"):
        lightcull.apply_view(np.zeros((4, 4, 3), np.uint8))


def test_values_that_make_no_sense_are_an_error_of_lightcull() -> None:
    with pytest.raises(lightcull.Error, match="indices"):
        add(indices=QUAD + np.uint32(9))
    with pytest.raises(lightcull.Error, match="positions"):
        add(positions=FLOOR * np.float32(np.nan))
    assert issubclass(lightcull.Error, RuntimeError)


def test_three_numbers_may_come_as_anything() -> None:
    for vector in ((1, 2, 3), [1.0, 2, 3], np.arange(3), np.ones(3, np.float32)):
        lightcull.Scene().add_point_light(vector, vector)
    for vector in ((1, 2), "abc", None, ("a", "b", "c")):
        with pytest.raises(TypeError, match="position: wanted three numbers"):
            lightcull.Scene().add_point_light(vector, (1, 1, 1))
