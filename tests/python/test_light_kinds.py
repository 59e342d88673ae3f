"""Images of spots and lamps of every size against closed forms."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

import lightcull

Array = npt.NDArray[np.float64]

# Every way to choose lights, where a word changes which formula is used.
SAMPLERS = (
    "power",
    "exhaustive",
    "light_bvh",
    "light_bvh:importance=means",
    "culled",
    "culled:group=1",
    "learned",
    "paper",
    "paper:weight=g_over_p:list=0",
    "clamped",
)


def floor_of(half_edge: float) -> tuple[Array, npt.NDArray[np.uint32]]:
    e = half_edge
    corners = np.array([[-e, 0, -e], [-e, 0, e], [e, 0, e], [e, 0, -e]], np.float32)
    return corners, np.array([[0, 1, 2], [0, 2, 3]], np.uint32)


def spot_radiance(at: Array, place: Array, direction: Array, inner: float, outer: float) -> Array:
    """What a floor of albedo 0.5 at y = 0 sends on of a spot of 100 W/sr. at: (..., 3)."""
    way = at - place
    distance = np.linalg.norm(way, axis=-1)
    # By the tangent of half the angle, which keeps the digits of narrow cones.
    half = np.linalg.norm(way / distance[..., None] - direction, axis=-1) / 2
    off, full, end = half**2, np.sin(inner / 2) ** 2, np.sin(outer / 2) ** 2
    ramp = np.clip((end - off) / max(end - full, 1e-300), 0, 1) ** 2
    falloff = np.where(off <= full, 1.0, np.where(off >= end, 0.0, ramp))
    return falloff * 100 * place[1] / distance**3 * 0.5 / np.pi


@pytest.mark.parametrize("outer", [30.0, 1.0, 0.1, 0.02, 0.005])
@pytest.mark.parametrize("part", [0.0, 0.8, 1.0])
def test_the_pool_of_light_of_a_spot(outer: float, part: float) -> None:
    height, size = 10.0, 32
    angle = np.radians(outer)
    inner, angle = float(np.float32(part * angle)), float(np.float32(angle))
    direction = np.array([0.48, -0.8, 0.36]) if outer < 30 else np.array([0.0, -1, 0])
    place = np.array([0.0, height, 0])
    middle = place + direction * (height / -direction[1])
    half_edge = height * np.tan(angle) * 1.25 / direction[1] ** 2
    scene = lightcull.Scene()
    scene.add_mesh(*floor_of(100.0))
    scene.add_spot_light(place, direction, (100.0,) * 3, inner, angle)
    # The camera looks straight down at what is lit.
    above = 20 * half_edge
    scene.set_camera(
        (middle[0], above, middle[2]),
        (middle[0], 0, middle[2]),
        up=(0, 0, -1),
        vertical_fov=float(2 * np.arctan(half_edge / above)),
    )
    image = lightcull.render(scene, "culled", spp=64, size=(size, size), seed=1).image
    fine = ((np.arange(size * 16) + 0.5) / (size * 16) * 2 - 1) * half_edge
    x, z = np.meshgrid(middle[0] + fine, middle[2] + fine)
    at = np.stack([x, np.zeros_like(x), z], -1)
    exact = spot_radiance(at, place, direction, inner, angle)
    exact = exact.reshape(size, 16, size, 16).mean((1, 3))
    pixels = image[..., 0].astype(float)
    assert pixels.sum() / exact.sum() == pytest.approx(1, abs=4e-3)
    # A pixel on a hard edge has 64 samples, each of them lit or dark.
    assert np.sqrt(np.mean((pixels - exact) ** 2)) < 0.02 * exact.max()


@pytest.mark.parametrize("sampler", SAMPLERS)
@pytest.mark.parametrize("gap", [0.0, 1e-4])
def test_every_sampler_gives_all_of_the_light_of_spots_with_a_hard_edge(
    sampler: str, gap: float
) -> None:
    outer = 0.5
    places = np.random.default_rng(0).uniform(-5, 5, (20, 3)).astype(np.float32)
    places[:, 1] = 4
    scene = lightcull.Scene()
    scene.add_mesh(*floor_of(9.0))
    for place in places:
        scene.add_spot_light(place, (0, -1, 0), (100.0,) * 3, outer - gap, outer)
    scene.set_camera((0, 20, 0), (0, 0, 0), up=(0, 0, -1), vertical_fov=2 * np.arctan(8 / 20))
    fine = (np.arange(768) + 0.5) / 768 * 16 - 8
    x, z = np.meshgrid(fine, fine)
    at = np.stack([x, np.zeros_like(x), z], -1)
    down = np.array([0.0, -1, 0])
    exact = sum(
        spot_radiance(at, place.astype(float), down, outer - gap, outer).mean() for place in places
    )
    renders = [
        lightcull.render(scene, sampler, spp=16, size=(24, 24), max_depth=2, seed=seed).image
        for seed in range(8)
    ]
    means = np.array([image[..., 0].mean(dtype=float) for image in renders])
    t = (means.mean() - exact) / (means.std(ddof=1) / np.sqrt(len(means)))
    # Student's t of 7 degrees of freedom is beyond that once in 20,000 times.
    assert abs(t) < 8.2
    assert means.mean() == pytest.approx(exact, rel=0.02)


def triangle_irradiance(at: Array, corners: Array) -> Array:
    """Irradiance by a triangle of radiance 1 on a floor that faces up (Lambert). at: (..., 3)."""
    ways = corners - at[..., None, :]
    ways /= np.linalg.norm(ways, axis=-1, keepdims=True)
    result = np.zeros(at.shape[:-1])
    for i in range(3):
        a, b = ways[..., i, :], ways[..., (i + 1) % 3, :]
        across = np.cross(a, b)
        sine = np.linalg.norm(across, axis=-1)
        result += np.arctan2(sine, (a * b).sum(-1)) * across[..., 1] / sine / 2
    return np.abs(result)


@pytest.mark.parametrize("size", [1e-18, 1e-12, 1e-11, 2e-10, 1e-6, 1, 6e7, 1e9, 1e13])
def test_a_lamp_gives_the_same_light_at_every_size(size: float) -> None:
    # An acute triangle: its circumscribed sphere is used.
    corners = np.array([[-1.0, 3, -0.6], [1, 3, -0.6], [0, 3, 1.1]])
    scene = lightcull.Scene()
    floor, indices = floor_of(4.0)
    scene.add_mesh((size * floor.astype(float)).astype(np.float32), indices)
    lamp = (size * corners).astype(np.float32)
    scene.add_light_mesh(lamp, np.array([[0, 1, 2]], np.uint32), radiance=(1.0,) * 3)
    # The camera is below the lamp.
    fov = float(2 * np.arctan(2 / 2.5))
    scene.set_camera((0, 2.5 * size, 0), (0, 0, 0), up=(0, 0, -1), vertical_fov=fov)
    images = [
        lightcull.render(scene, "culled", spp=64, size=(16, 16), seed=seed).image[..., 0]
        for seed in range(2)
    ]
    fine = (np.arange(128) + 0.5) / 128 * 4 - 2
    x, z = np.meshgrid(fine, fine)
    exact = triangle_irradiance(np.stack([x, np.zeros_like(x), z], -1), corners) * 0.5 / np.pi
    mean = np.mean([image.mean(dtype=float) for image in images])
    # The variance of a sample is 0.1 of the squared mean: this is 4 standard deviations of it.
    assert mean == pytest.approx(exact.mean(), rel=0.008)


def test_a_lamp_too_small_for_floats_is_named() -> None:
    scene = lightcull.Scene()
    corners = np.array([[0, 0, 0], [1e-20, 0, 0], [0, 0, 1e-20]], np.float32)
    with pytest.raises(lightcull.Error, match='mesh "speck": triangle 0 emits, and its area'):
        scene.add_light_mesh(
            corners, np.array([[0, 1, 2]], np.uint32), radiance=(1.0,) * 3, name="speck"
        )
    # One that has no area has no light to lose.
    flat = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0]], np.float32)
    scene.add_light_mesh(flat, np.array([[0, 1, 2]], np.uint32), radiance=(1.0,) * 3)
