"""The example scenes, as what they add to a scene: counts, orientation, powers, determinism."""

from __future__ import annotations

import hashlib
import importlib
from dataclasses import dataclass
from functools import cache

import lightcull
import numpy as np
import pytest
from lightcull import scenes
from lightcull.scenes import geometry
from lightcull.scenes.color import LUMINANCE, blackbody, from_srgb, with_luminance
from lightcull.scenes.random_numbers import Chance

LIGHTS = {
    "lanterns": 54_720,
    "city": 55_138,
    "embers": 250_000,
    "cornell": 2,
    "million": 1_024_000,
    "offices": 37_614,
}


@dataclass
class Mesh:
    name: str
    positions: np.ndarray
    indices: np.ndarray
    normals: np.ndarray | None
    uvs: np.ndarray | None
    material: int | None
    radiance: np.ndarray | None = None
    two_sided: bool = False

    def corners(self) -> np.ndarray:
        return self.positions[self.indices].astype(np.float64)

    def face_vectors(self) -> np.ndarray:
        """(M, 3), along the normal, as long as twice the area."""
        a, b, c = np.moveaxis(self.corners(), 1, 0)
        return np.cross(b - a, c - a)

    def powers(self) -> np.ndarray:
        """(M,) radiant power, weighted by luminance, of triangles that emit."""
        area = 0.5 * np.linalg.norm(self.face_vectors(), axis=1)
        radiance = np.broadcast_to(self.radiance, (len(area), 3)).astype(np.float64)
        return np.pi * area * (radiance @ LUMINANCE) * (2 if self.two_sided else 1)


class Recorder:
    """Takes what lightcull.Scene takes, and keeps it."""

    def __init__(self) -> None:
        self.meshes: list[Mesh] = []
        self.textures: list[np.ndarray] = []
        self.materials: list[dict] = []
        self.environment: np.ndarray | None = None
        self.camera: dict | None = None

    def add_texture(self, texels: np.ndarray) -> int:
        self.textures.append(texels)
        return len(self.textures) - 1

    def add_material(self, **material: object) -> int:
        self.materials.append(material)
        return len(self.materials) - 1

    def add_mesh(self, positions, indices, *, normals, uvs, material, name):
        self.meshes.append(Mesh(name, positions, indices, normals, uvs, material))

    def add_light_mesh(self, positions, indices, *, radiance, two_sided, texture, uvs, name):
        radiance = np.asarray(radiance, dtype=np.float32)
        self.meshes.append(Mesh(name, positions, indices, None, uvs, None, radiance, two_sided))

    def set_environment(self, texels: np.ndarray) -> None:
        self.environment = texels

    def set_camera(self, **camera: object) -> None:
        self.camera = camera

    @property
    def lights(self) -> list[Mesh]:
        return [mesh for mesh in self.meshes if mesh.radiance is not None]

    def digest(self) -> str:
        digest = hashlib.sha256()
        for mesh in self.meshes:
            for array in (mesh.positions, mesh.indices, mesh.normals, mesh.uvs, mesh.radiance):
                digest.update(b"none" if array is None else array.tobytes())
        for texture in self.textures:
            digest.update(texture.tobytes())
        digest.update(repr((self.materials, self.camera)).encode())
        return digest.hexdigest()


def record(name: str) -> Recorder:
    recorder = Recorder()
    importlib.import_module(f"lightcull.scenes.{name}").fill(recorder)
    return recorder


recorded = cache(record)
every_scene = pytest.mark.parametrize("name", list(scenes.NAMES))


def test_names_are_those_of_the_modules() -> None:
    assert set(LIGHTS) == set(scenes.NAMES)


@every_scene
def test_number_of_lights(name: str) -> None:
    assert sum(len(mesh.indices) for mesh in recorded(name).lights) == LIGHTS[name]


@every_scene
def test_arrays_are_what_a_scene_takes(name: str) -> None:
    for mesh in recorded(name).meshes:
        assert mesh.positions.dtype == np.float32 and mesh.positions.flags.c_contiguous
        assert mesh.indices.dtype == np.uint32 and mesh.indices.flags.c_contiguous
        assert mesh.indices.max() < len(mesh.positions), mesh.name
        for per_corner in (mesh.normals, mesh.uvs):
            assert per_corner is None or len(per_corner) == len(mesh.positions), mesh.name


@every_scene
def test_everything_is_finite(name: str) -> None:
    scene = recorded(name)
    for mesh in scene.meshes:
        for array in (mesh.positions, mesh.normals, mesh.uvs, mesh.radiance):
            assert array is None or np.isfinite(array).all(), mesh.name
    for texture in scene.textures:
        assert np.isfinite(texture).all() and texture.min() >= 0 and texture.max() <= 1
    assert scene.environment is None or np.isfinite(scene.environment).all()


@every_scene
def test_no_triangle_is_degenerate(name: str) -> None:
    for mesh in recorded(name).meshes:
        corners = mesh.corners()
        longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        height = np.linalg.norm(mesh.face_vectors(), axis=1) / longest
        # A thousand times what float32 can tell apart at that distance from the origin.
        resolution = np.abs(corners).max(axis=(1, 2)) * 2.0**-23
        assert (height > 1e3 * resolution).all() or height.min() > 1e-3, mesh.name


@every_scene
def test_shading_normals_are_on_the_side_of_the_face(name: str) -> None:
    for mesh in recorded(name).meshes:
        if mesh.normals is not None:
            assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-5), mesh.name
            faces = geometry.unit(mesh.face_vectors())
            cosine = np.einsum("mk,mck->mc", faces, mesh.normals[mesh.indices])
            assert cosine.min() > 0, mesh.name


@every_scene
def test_every_light_emits(name: str) -> None:
    for mesh in recorded(name).lights:
        assert (mesh.powers() > 0).all(), mesh.name
        assert mesh.radiance.min() >= 0, mesh.name


@every_scene
def test_the_camera_looks_at_something(name: str) -> None:
    camera = recorded(name).camera
    assert camera is not None and 0 < camera["vertical_fov"] < np.pi
    assert np.linalg.norm(np.subtract(camera["target"], camera["origin"])) > 1


@every_scene
def test_two_builds_are_equal(name: str) -> None:
    assert record(name).digest() == recorded(name).digest()


def test_no_two_scenes_are_equal() -> None:
    assert recorded("lanterns").digest() != recorded("cornell").digest()


def assert_closed_bodies_face_out(mesh: Mesh, faces_of_each: int) -> None:
    """Every `faces_of_each` triangles in turn are a convex body: its lights must face away from its
    middle."""
    corners = mesh.corners().reshape(-1, faces_of_each, 3, 3)
    middle = corners.mean(axis=(1, 2))[:, None]
    outward = corners.mean(axis=2) - middle
    cosine = np.einsum("bfk,bfk->bf", outward, mesh.face_vectors().reshape(outward.shape))
    assert (cosine > 0).all(), mesh.name


def light_mesh(scene: str, name: str) -> Mesh:
    return next(mesh for mesh in recorded(scene).lights if mesh.name == name)


def test_lanterns_and_bulbs_face_out() -> None:
    assert_closed_bodies_face_out(light_mesh("lanterns", "lanterns"), 20)
    assert_closed_bodies_face_out(light_mesh("million", "bulbs"), 20)
    assert_closed_bodies_face_out(light_mesh("city", "signs"), 12)
    assert_closed_bodies_face_out(light_mesh("city", "lamps"), 20)


def test_the_lamp_shines_down() -> None:
    assert (light_mesh("cornell", "lamp").face_vectors()[:, 1] < 0).all()


def test_lit_windows_shine_into_the_streets() -> None:
    from lightcull.scenes import city

    for name in ("lit windows", "shop windows"):
        windows = light_mesh("city", name)
        outward = geometry.unit(windows.face_vectors())
        half_metre_out = windows.corners().mean(axis=1) + 0.5 * outward
        # Blocks repeat; a point is in a street where its place in the pattern is outside a block.
        place = np.mod(half_metre_out[:, [0, 2]], city.PITCH)
        in_street = np.abs(place - city.PITCH / 2).max(axis=1) > city.BLOCK / 2
        assert in_street.all(), name


def test_lantern_powers_are_log_normal() -> None:
    from lightcull.scenes import lanterns

    log_power = np.log(light_mesh("lanterns", "lanterns").powers().reshape(-1, 20).sum(axis=1))
    # The standard error of a deviation is sigma / sqrt(2 n): five of them.
    error = lanterns.POWER_SIGMA / np.sqrt(2 * lanterns.LANTERNS)
    assert abs(np.std(log_power) - lanterns.POWER_SIGMA) < 5 * error
    standardised = (log_power - log_power.mean()) / log_power.std()
    assert abs(np.mean(standardised**3)) < 5 * np.sqrt(6 / lanterns.LANTERNS)


def test_ember_powers_span_six_decades_evenly() -> None:
    decades = np.log10(light_mesh("embers", "embers").powers())
    assert decades.max() - decades.min() == pytest.approx(6.0, abs=1e-3)
    counts, _ = np.histogram(decades, bins=6)
    assert np.abs(counts / len(decades) - 1 / 6).max() < 0.01


def test_embers_lie_above_the_floor() -> None:
    assert light_mesh("embers", "embers").positions[:, 1].min() > 0


def test_city_has_lights_of_every_kind() -> None:
    lights = {mesh.name: len(mesh.indices) for mesh in recorded("city").lights}
    assert lights["lit windows"] > 30_000
    assert lights["lamps"] == 20 * 596
    assert set(lights) == {
        "lit windows", "shop windows", "lamps", "signs", "headlamps", "tail lamps"
    }  # fmt: skip


def test_an_unknown_name_names_the_nearest() -> None:
    with pytest.raises(lightcull.Error, match="'lantern'.*did you mean 'lanterns'"):
        scenes.build("lantern")


def test_build_gives_a_scene() -> None:
    assert isinstance(scenes.build("cornell"), lightcull.Scene)


def volume(shape: geometry.Shape) -> float:
    """Of a closed shape, positive if its triangles face out (Gauss)."""
    a, b, c = np.moveaxis(shape.positions[shape.indices], 1, 0)
    return float(np.einsum("ik,ik->", a, np.cross(b, c)) / 6)


def test_closed_shapes_face_out() -> None:
    assert volume(geometry.box((-1, -2, -3), (1, 2, 3))) == pytest.approx(48)
    assert volume(geometry.icosphere(4)) == pytest.approx(4 / 3 * np.pi, rel=0.01)
    cylinder = geometry.lathe([(0, 0), (1, 0), (1, 2), (0, 2)], 256)
    assert volume(cylinder) == pytest.approx(2 * np.pi, rel=0.001)
    copies = geometry.scatter(
        geometry.icosahedron(), np.eye(3) * 5, np.array([1.0, 2.0, 3.0]), np.array([0.0, 1.0, 2.0])
    )
    assert volume(copies) == pytest.approx(36 * volume(geometry.icosahedron()))


def test_icosahedron_has_equal_triangles() -> None:
    shape = geometry.icosahedron()
    assert len(shape.indices) == 20
    a, b, c = np.moveaxis(shape.positions[shape.indices], 1, 0)
    areas = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    # Edge a = 1 / sin(2 pi / 5) for corners at distance 1; a triangle has sqrt(3) / 4 a^2.
    assert np.allclose(areas, np.sqrt(3) / 4 / np.sin(2 * np.pi / 5) ** 2)


def test_colors() -> None:
    assert np.allclose(from_srgb("#ffffff"), 1)
    assert from_srgb("#808080")[0] == pytest.approx(0.2158605, abs=1e-6)
    assert with_luminance(np.array([1.0, 2.0, 3.0]), 5.0) @ LUMINANCE == pytest.approx(5.0)
    red, green, blue = blackbody(np.array(6504.0))
    assert red == pytest.approx(1, abs=0.06) and blue == pytest.approx(1, abs=0.06)
    cooler = blackbody(np.array([1000.0, 2000.0, 4000.0]))
    assert (np.diff(cooler[:, 0] / cooler[:, 1]) < 0).all()
    assert (np.diff(cooler[:, 2]) >= 0).all()


def test_random_numbers_keep_their_stream() -> None:
    """The first numbers of the generator, so that scenes stay what they are."""
    assert Chance(7).uniform(shape=2) == pytest.approx([0.6250954666, 0.8972138009], abs=1e-9)
    assert abs(np.std(Chance(1).normal(100_000)) - 1) < 5 / np.sqrt(200_000)
