"""Arrays in: what is wanted and what came."""

from __future__ import annotations

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
            {"positions": FLOOR.astype(np.float64)},
            r"positions: wanted a C-contiguous float32 array of shape \(N, 3\), "
            r"got float64 \(4, 3\)",
        ),
        ({"positions": FLOOR[:, :2].copy()}, r"of shape \(N, 3\), got float32 \(4, 2\)"),
        ({"positions": FLOOR.ravel()}, r"got float32 \(12,\)"),
        ({"positions": FLOOR.astype(">f4")}, r"positions: wanted a C-contiguous float32"),
        (
            {"positions": np.asfortranarray(FLOOR)},
            r"got float32 \(4, 3\) that is not C-contiguous",
        ),
        ({"positions": FLOOR.tolist()}, r"positions: .*, got list"),
        ({"positions": None}, r"positions: .*, got NoneType"),
        ({"positions": b"123456789012"}, r"positions: .*, got bytes"),
        ({"indices": QUAD.astype(np.int32)}, r"uint32 array of shape \(N, 3\), got int32 \(2, 3\)"),
        ({"indices": QUAD.astype(np.int64)}, r"indices: wanted .*uint32.*, got int64"),
        ({"normals": FLOOR[:3]}, r"normals: wanted .*\(4, 3\), got float32 \(3, 3\)"),
        ({"uvs": FLOOR}, r"uvs: wanted .*\(4, 2\), got float32 \(4, 3\)"),
    ],
)
def test_mesh_wants_arrays_as_documented(changes: dict[str, object], message: str) -> None:
    with pytest.raises(TypeError, match=message):
        add(**changes)


def test_a_view_of_whole_rows_is_contiguous_enough() -> None:
    twice = np.concatenate([FLOOR, FLOOR])
    add(positions=twice[4:])
    with pytest.raises(TypeError, match="not C-contiguous"):
        add(positions=twice[::2])


def not_aligned(array: np.ndarray) -> np.ndarray:
    data = np.frombuffer(b"-" + array.tobytes(), np.uint8)[1:]
    return data.view(array.dtype).reshape(array.shape)


def test_numbers_stand_where_the_processor_wants_them() -> None:
    for name, array in (("positions", FLOOR), ("indices", QUAD)):
        with pytest.raises(TypeError, match=f"{name}: wanted .* that is not aligned"):
            add(**{name: not_aligned(array)})
    lights = lightcull.point_lights(FLOOR, np.ones(4, np.float32))
    with pytest.raises(TypeError, match="lights: wanted .* that is not aligned"):
        lightcull.LightSampler(np.frombuffer(b"-" + lights.tobytes(), lights.dtype, offset=1))
    lightcull.LightSampler(lights[1:])


def test_an_array_that_cannot_be_written_is_read() -> None:
    positions = FLOOR.copy()
    positions.flags.writeable = False
    add(positions=positions)


def test_radiance_of_each_triangle() -> None:
    scene = lightcull.Scene()
    with pytest.raises(TypeError, match=r"radiance: wanted .*\(2, 3\), got float32 \(3, 3\)"):
        scene.add_light_mesh(FLOOR, QUAD, radiance=np.ones((3, 3), np.float32))
    with pytest.raises(TypeError, match="radiance: wanted three numbers, got 3.0"):
        scene.add_light_mesh(FLOOR, QUAD, radiance=3.0)
    scene.add_light_mesh(FLOOR, QUAD, radiance=np.float32([[1, 1, 1], [3, 3, 3]]))
    np.testing.assert_allclose(scene.lights()["intensity"], [2, 6], rtol=1e-5)


def test_textures_and_images() -> None:
    scene = lightcull.Scene()
    with pytest.raises(TypeError, match=r"texture: wanted .*\(N, M, 3\), got float32 \(4, 4\)"):
        scene.add_texture(np.zeros((4, 4), np.float32))
    with pytest.raises(TypeError, match=r"image: wanted .*float32.*, got uint8 \(4, 4, 3\)"):
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
