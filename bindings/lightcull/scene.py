"""Scenes: geometry, materials, emitters and a camera."""

from __future__ import annotations

import os
import threading
from collections.abc import Sequence
from numbers import Real
from typing import Any, Literal, TypeAlias

import numpy as np

from . import _core, checks
from ._core import Error
from .camera import Camera, chosen_camera, triple
from .file_settings import FileSettings
from .scene_digest import SceneDigest
from .scene_record import SceneRecord, new_record, recorded
from .scene_source import SceneSource

Vector: TypeAlias = Sequence[float] | np.ndarray
"""Three numbers: metres, a direction, or linear RGB."""
TextureSource: TypeAlias = str | os.PathLike[str] | np.ndarray
"""Path of an image, or an array of texels with row 0 at the top."""
_NO_EMISSION = ((0.0, 0.0, 0.0), None, _core.NO_TEXTURE, False)


class Scene:
    """Geometry, materials, emitters and a camera, in metres, radians and linear RGB.

    Fill it, then render it. The first use (`render`, `lights`, a `LightSampler`) closes it: nothing
    can be added from then on, but what there is can be moved, while nothing renders it. Arrays are
    kept as float32, and indices as uint32; those of any other real dtype, in any order in memory,
    are converted. Another shape is a TypeError, and values that do not fit or make no sense are a
    `lightcull.Error`.

    >>> scene = Scene()
    >>> floor = np.array([[-5, 0, -5], [-5, 0, 5], [5, 0, 5], [5, 0, -5]], np.float32)
    >>> quad = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    >>> scene.add_mesh(floor, quad, name="floor")
    >>> scene.add_point_light((0, 3, 0), intensity=(10, 10, 10))
    >>> scene.set_camera(origin=(0, 2, 8), target=(0, 0, 0))
    """

    def __init__(self, name: str = "scene", *, recorded: bool = False) -> None:
        """name: for images and reports. recorded: copies are kept of what is added, so that the scene
        can be sent to a cluster; one from a file or by name need not be.
        """
        self.name = checks.text("name", name)
        """What images and reports call it."""
        self.file_settings = FileSettings()
        """How its file wants to be rendered."""
        self._core = _core.Scene()
        self._camera = Camera()
        self._cameras: list[Camera] = []
        self._digest = SceneDigest()
        self._record: SceneRecord | None = new_record(recorded)
        self.source: SceneSource | None = None
        """Where it can be had from again, unless something was added since."""
        self._closed = False
        self._moved = False
        self._lock = threading.Lock()
        self._default_materials: dict[float, int] = {}
        self._mesh_bounds: dict[int, np.ndarray] = {}
        """Those of meshes by their ids, of instances by -1, -2 and so on."""
        self._shared_bounds: dict[int, np.ndarray] = {}
        self._counts = {"meshes": 0, "materials": 0, "textures": 0, "points": 0, "spots": 0}
        self._counts["instances"] = 0
        self._counts["directional lights"] = self._counts["virtual lights"] = 0

    def add_texture(self, texels: TextureSource, *, linear_data: bool = False) -> int:
        """Adds an image and returns its id, for materials and emission. It repeats.

        texels: a path, or floats (H, W, 3), linear RGB; or uint8 or uint16 (H, W, 3) or (H, W),
        which stay what they are in memory. Row 0 is the top, v = 1. linear_data: 8 and 16 bits hold
        numbers (roughness, opacity), parts of 255 or 65535, not sRGB colours.
        """
        if not isinstance(texels, np.ndarray):
            texels = _core.read_stored_image(checks.path("texture", texels))
        return self._add_texels(texels, linear_data)

    @recorded
    def _add_texels(self, texels: np.ndarray, linear_data: bool) -> int:
        texture = self._core.add_texture(texels, bool(linear_data))
        of_texels = (str(texels.dtype), texels.shape, np.ascontiguousarray(texels).data)
        self._digest.add("texture", *of_texels, bool(linear_data))
        self._counts["textures"] += 1
        return texture

    @recorded
    def add_material(
        self,
        kind: Literal["diffuse", "metallic_roughness"] = "diffuse",
        base_color: Vector = (0.5, 0.5, 0.5),
        metallic: float = 0.0,
        roughness: float = 1.0,
        base_color_texture: int | None = None,
        metallic_roughness_texture: int | None = None,
        opacity: float = 1.0,
        opacity_texture: int | None = None,
        opacity_threshold: float = 0.0,
        normal_texture: int | None = None,
        normal_scale: float = 1.0,
    ) -> int:
        """Adds a material, which reflects on both sides, and returns its id.

        kind: "diffuse", or "metallic_roughness", which is that of glTF 2.0: GGX, F0 0.04.
        base_color: linear RGB in [0, 1]; metallic, roughness (perceptual: alpha is its square):
        [0, 1]. Textures multiply them; of metallic_roughness_texture green is the roughness and
        blue the metalness. opacity in [0, 1], times the red of its texture: the probability with
        which a ray meets the surface, and what it emits; else it goes on. With an opacity_threshold
        above 0 the ray meets it where the opacity is at least that, and only there. normal_texture, a
        texture of linear_data, has the normals that light is reflected by, as glTF has them: 2 * texel - 1,
        x towards where u grows, y where v does, both times normal_scale.
        """
        if kind not in ("diffuse", "metallic_roughness"):
            raise Error(f"material: kind {kind!r} is neither 'diffuse' nor 'metallic_roughness'")
        parameters = (
            kind == "metallic_roughness",
            base_color,
            checks.number("metallic", metallic),
            checks.number("roughness", roughness),
            _texture_id("base_color_texture", base_color_texture),
            _texture_id("metallic_roughness_texture", metallic_roughness_texture),
            checks.number("opacity", opacity),
            _texture_id("opacity_texture", opacity_texture),
            checks.number("opacity_threshold", opacity_threshold),
            _texture_id("normal_texture", normal_texture),
            checks.number("normal_scale", normal_scale),
        )
        material = self._core.add_material(*parameters)
        self._digest.add("material", *parameters)
        self._counts["materials"] += 1
        return material

    def add_mesh(
        self,
        positions: np.ndarray,
        indices: np.ndarray,
        *,
        normals: np.ndarray | None = None,
        uvs: np.ndarray | None = None,
        colors: np.ndarray | None = None,
        material: int | None = None,
        name: str = "",
    ) -> int:
        """Adds triangles that reflect and returns the id of the mesh.

        positions: (N, 3), metres. indices: (M, 3). normals: (N, 3), for shading; none: flat. uvs:
        (N, 2), v upwards. colors: (N, 3), linear RGB in [0, 1], which multiplies the base colour.
        material: an id of `add_material`; none: diffuse, grey of 0.5. name: for messages.
        """
        if material is None:
            material = self._default_material(0.5)
        return self._add_mesh(name, positions, indices, normals, uvs, colors, material, _NO_EMISSION)

    def add_light_mesh(
        self,
        positions: np.ndarray,
        indices: np.ndarray,
        *,
        radiance: Vector,
        two_sided: bool = False,
        texture: int | None = None,
        normals: np.ndarray | None = None,
        uvs: np.ndarray | None = None,
        colors: np.ndarray | None = None,
        material: int | None = None,
        name: str = "",
    ) -> int:
        """Adds triangles that emit, each of them a light or, if need be, several, and returns the
        id of the mesh.

        radiance: linear RGB, W/(m^2 sr); for all, or (M, 3), one for each triangle.
        two_sided: emits from the back too; the front is where corners run anticlockwise.
        texture: an id of `add_texture` that multiplies the radiance. material: how it reflects;
        none: not at all. The rest as in `add_mesh`.
        """
        if material is None:
            material = self._default_material(0.0)
        per_face = isinstance(radiance, np.ndarray) and radiance.ndim != 1
        emission = (
            (1.0, 1.0, 1.0) if per_face else radiance,
            radiance if per_face else None,
            _texture_id("texture", texture),
            bool(two_sided),
        )
        return self._add_mesh(name, positions, indices, normals, uvs, colors, material, emission)

    def add_shared_mesh(
        self,
        positions: np.ndarray,
        indices: np.ndarray,
        *,
        normals: np.ndarray | None = None,
        uvs: np.ndarray | None = None,
        colors: np.ndarray | None = None,
        material: int | None = None,
        name: str = "",
    ) -> int:
        """Adds triangles that are nowhere yet and returns the id of their mesh, for `add_instance`: they
        take their memory once, however often they are placed. They do not emit. The rest as in
        `add_mesh`.
        """
        if material is None:
            material = self._default_material(0.5)
        return self._add_mesh(
            name, positions, indices, normals, uvs, colors, material, _NO_EMISSION, shared=True
        )

    @recorded
    def add_instance(self, mesh: int, transform: np.ndarray) -> None:
        """Places a mesh of `add_shared_mesh` once more.

        transform: (3, 4) or (4, 4), metres, applied to columns; its linear part is not flat.
        """
        checks.whole_number("mesh", mesh)
        matrix = np.asarray(transform, np.float64)
        if matrix.shape not in ((3, 4), (4, 4)):
            raise TypeError(f"transform: wanted (3, 4) or (4, 4), got {matrix.shape}")
        with np.errstate(over="ignore"):  # what is infinite then is refused
            numbers = matrix[:3].astype(np.float32).ravel().tolist()
        self._core.add_instance(mesh, numbers)
        self._digest.add("instance", mesh, numbers)
        self._counts["instances"] += 1
        if mesh in self._shared_bounds:
            box = self._shared_bounds[mesh]
            corners = np.array(np.meshgrid(*box.T)).reshape(3, -1)
            placed = (matrix[:3, :3] @ corners).T + matrix[:3, 3]
            self._include(-self._counts["instances"], placed)

    @recorded
    def add_point_light(self, position: Vector, intensity: Vector) -> None:
        """Adds a point that emits in all directions. intensity: linear RGB, W/sr."""
        self._core.add_point_light(position, intensity)
        self._digest.add("point", position, intensity)
        self._counts["points"] += 1

    @recorded
    def add_spot_light(
        self, position: Vector, direction: Vector, intensity: Vector, inner: float, outer: float
    ) -> None:
        """Adds a point that emits `intensity` (linear RGB, W/sr) up to `inner` from `direction`,
        and from there smoothly less until nothing at `outer`; radians, 0 <= inner <= outer.
        """
        angles = checks.number("inner", inner), checks.number("outer", outer)
        parameters = (position, direction, intensity, *angles)
        self._core.add_spot_light(*parameters)
        self._digest.add("spot", *parameters)
        self._counts["spots"] += 1

    @recorded
    def add_directional_light(self, direction: Vector, irradiance: Vector) -> None:
        """Adds a sun: parallel light from infinity that goes into `direction`.

        irradiance: linear RGB, W/m^2, on a surface that faces it.
        """
        self._core.add_directional_light(direction, irradiance)
        self._digest.add("directional", direction, irradiance)
        self._counts["directional lights"] += 1

    @recorded
    def add_virtual_lights(self, light_paths: int, bounces: int = 1, seed: int = 0) -> None:
        """Adds virtual lights to what samplers choose from: lights where paths from the emitters
        and the environment meet surfaces. Last of all: light paths know what was added before.

        A render with a max_depth of 2 then has what bounces, up to `bounces` times (1 to 3), with
        the error that so few places of it have: near them their light is bounded, and the same ones
        light every sample. light_paths: 1 to 2^24; each gives a light or, on glossy surfaces, two
        for each bounce. Not with a method other than "path", nor with perfect mirrors.
        """
        parameters = (
            checks.whole_number("light_paths", light_paths),
            checks.whole_number("bounces", bounces),
            checks.whole_number("seed", seed, most=checks.MOST_64_BITS),
        )
        with self._lock:
            before = self._core.light_count()
            _core.add_virtual_lights(self._core, *parameters)
            self._counts["virtual lights"] += self._core.light_count() - before
        self._digest.add("virtual lights", *parameters)

    def set_environment(
        self,
        map_or_rgb: TextureSource | Vector,
        scale: float | Vector = 1.0,
        rotation: float = 0.0,
    ) -> None:
        """Surrounds the scene by light from infinity, W/(m^2 sr).

        map_or_rgb: linear RGB, or a latitude-longitude map with +Y up and -Z in the middle: a path,
        or floats (H, W, 3). scale: one number or three, which multiply it. rotation: radians
        about +Y.
        """
        rgb_scale = (scale,) * 3 if isinstance(scale, Real) else scale
        self._set_environment(_environment_texels(map_or_rgb), rgb_scale, rotation)

    @recorded
    def _set_environment(self, texels: np.ndarray, rgb_scale: Any, rotation: float) -> None:
        self._core.set_environment(texels, rgb_scale, checks.number("rotation", rotation))
        self._digest.add("environment", texels, rgb_scale, rotation)

    @recorded
    def set_camera(
        self,
        origin: Vector,
        target: Vector,
        up: Vector = (0.0, 1.0, 0.0),
        vertical_fov: float = 0.8,
        aperture_radius: float = 0.0,
        focus_distance: float = 1.0,
        orthographic_height: float = 0.0,
    ) -> None:
        """Places the camera: a thin lens at `origin` that looks to `target` (metres).

        vertical_fov: radians. aperture_radius, focus_distance: metres; a radius of 0 is a pinhole.
        orthographic_height: metres that the image is high, seen by parallel rays from the plane of
        the origin; 0: perspective.
        """
        lens = (
            checks.number("vertical_fov", vertical_fov),
            checks.number("aperture_radius", aperture_radius),
            checks.number("focus_distance", focus_distance),
            checks.number("orthographic_height", orthographic_height),
        )
        parameters = (origin, target, up, *lens)
        self._core.set_camera(*parameters)
        self._digest.add("camera", *parameters)
        self._camera = Camera(triple(origin), triple(target), triple(up), *lens)

    @recorded
    def set_mesh_positions(
        self, mesh: int, positions: np.ndarray, normals: np.ndarray | None = None
    ) -> None:
        """Moves the corners of a mesh, of lamps or anything else; see `Frames`.

        mesh: an id of `add_mesh` or `add_light_mesh`. positions: (N, 3), metres, as many as it was
        added with. normals: likewise, of a mesh that has them; None: they stay.
        """
        checks.whole_number("mesh", mesh, most=_core.NO_TEXTURE - 1)
        with self._lock:
            self._core.set_mesh_positions(mesh, positions, normals)
            self._moved = True
        self._digest.add("mesh positions", mesh, positions, normals)
        self._include(mesh, positions)

    @recorded
    def set_light_positions(self, positions: np.ndarray) -> None:
        """Moves the points and spots: (N, 3), metres, one for each in the order in which they were
        added.
        """
        with self._lock:
            self._core.set_light_positions(positions)
            self._moved = True
        self._digest.add("light positions", positions)

    @recorded
    def set_light_directions(self, directions: np.ndarray) -> None:
        """Turns the spots and directional lights: (N, 3), any length but 0, one for each in the
        order in which they were added.
        """
        with self._lock:
            self._core.set_light_directions(directions)
            self._moved = True
        self._digest.add("light directions", directions)

    def add_camera(self, camera: Camera) -> None:
        """Adds a camera to those of the scene's file. The first one is in use."""
        self._cameras.append(camera)
        if len(self._cameras) == 1:
            self.use_camera(0)

    def use_camera(self, which: str | int) -> None:
        """Sees the scene by one of `cameras`: by its name, or by its number from 0."""
        camera = self._cameras[chosen_camera([c.name for c in self._cameras], which)]
        self.set_camera(*camera.parameters)
        self._camera = camera

    @property
    def cameras(self) -> tuple[Camera, ...]:
        """Those of the scene's file."""
        return tuple(self._cameras)

    @property
    def camera(self) -> Camera:
        """The camera that is in use."""
        return self._camera

    def preview(self) -> _core.Preview:
        """A look at the scene as it is so far, which stays open."""
        return _core.Preview(self._core)

    @property
    def bounds(self) -> np.ndarray | None:
        """Smallest and largest corner of all meshes, float32 (2, 3), metres; None without any."""
        if not self._mesh_bounds:
            return None
        corners = np.stack(list(self._mesh_bounds.values()))
        return np.stack([corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)])

    @property
    def triangle_count(self) -> int:
        """Number of triangles, those that emit included."""
        return self._core.triangle_count()

    @property
    def has_environment(self) -> bool:
        """Whether light comes from infinity."""
        return self._core.has_environment()

    @property
    def counts(self) -> dict[str, int]:
        """How many meshes, instances, materials, textures, points, spots, directional and virtual lights
        were added.
        """
        return dict(self._counts)

    def lights(self) -> np.ndarray:
        """The lights that samplers choose from: (N,) of dtype `lightcull.LIGHT`, in the order in
        which they were added, and after these the further parts of triangles that are cut: those
        that are long beside their distance to what they light, or whose texture is uneven. The
        environment is not among them. Closes the scene.
        """
        return self.closed().lights()

    @property
    def record(self) -> SceneRecord | None:
        """All that was done to it; None unless that was wanted."""
        return self._record

    def digest(self) -> str:
        """A hash of all that was added, to know the scene by."""
        return self._digest.hexdigest()

    def closed(self) -> _core.Scene:
        """The compiled scene, ready to be rendered as it is now; nothing can be added any more."""
        with self._lock:
            if not self._closed or self._moved:
                self._make_ready()
        return self._core

    @recorded
    def _make_ready(self) -> None:
        if self._closed:
            self._core.refit()
        else:
            self._core.commit()
        self._closed = True
        self._moved = False

    def __repr__(self) -> str:
        return f"<lightcull.Scene {self.name!r}: {self.triangle_count} triangles>"

    @recorded
    def _add_mesh(
        self,
        name: str,
        positions: np.ndarray,
        indices: np.ndarray,
        normals: np.ndarray | None,
        uvs: np.ndarray | None,
        colors: np.ndarray | None,
        material: int,
        emission: tuple[Any, Any, int, bool],
        *,
        shared: bool = False,
    ) -> int:
        checks.text("name", name)
        checks.whole_number("material", material)
        parameters = (name, positions, indices, normals, uvs, colors, material, *emission, shared)
        mesh = self._core.add_mesh(*parameters)
        self._digest.add("mesh", *parameters)
        self._counts["meshes"] += 1
        if shared:
            if len(positions) > 0:
                self._shared_bounds[mesh] = _box_of(positions)
        else:
            self._include(mesh, positions)
        return mesh

    def _include(self, mesh: int, positions: np.ndarray) -> None:
        if len(positions) > 0:
            self._mesh_bounds[mesh] = _box_of(positions)

    def _default_material(self, grey: float) -> int:
        if grey not in self._default_materials:
            self._default_materials[grey] = self.add_material(base_color=(grey, grey, grey))
        return self._default_materials[grey]


def _box_of(positions: np.ndarray) -> np.ndarray:
    return np.stack([positions.min(axis=0), positions.max(axis=0)]).astype(np.float32)


def _texture_id(name: str, texture: int | None) -> int:
    if texture is None:
        return _core.NO_TEXTURE
    return checks.whole_number(name, texture, most=_core.NO_TEXTURE - 1)


def _environment_texels(map_or_rgb: TextureSource | Vector) -> np.ndarray:
    if isinstance(map_or_rgb, str | os.PathLike):
        return _core.read_image(checks.path("environment", map_or_rgb), False)
    if isinstance(map_or_rgb, np.ndarray) and map_or_rgb.ndim != 1:
        return map_or_rgb
    if np.shape(map_or_rgb) != (3,):
        raise TypeError(f"environment: wanted a path, a map or three numbers, got {map_or_rgb!r}")
    with np.errstate(over="ignore"):  # what is infinite then is refused
        return np.array(map_or_rgb, dtype=np.float32).reshape(1, 1, 3)
