"""A Mitsuba scene, rendered by Mitsuba: what `lightcull render` and `compare` take."""

from __future__ import annotations

import hashlib
import importlib
import os
import re
import warnings
from typing import Any

import numpy as np

from .._core import Error
from ..camera import Camera, View, chosen_camera
from ..file_settings import FileSettings
from ..loaders.completion import CameraChoice
from ..loaders.unsupported import UnsupportedWarning
from ..rendering.settings import RenderSettings
from ..surroundings import Environment, is_auto, texels_of
from ..views import automatic_camera
from .cameras import camera_of, distances_in, sensor_of
from .file_integrator import DIRECT_DEPTH, PATH, FileIntegrator
from .host import build_digest, mitsuba
from .mitsuba_job import MitsubaJob, check_film


IN_MEDIA = "light_bvh:importance=means"
"""The sampler of `lightcull_volpath`, which has no other."""


class MitsubaScene:
    """A scene of Mitsuba's, which `lightcull.render` and `lightcull.compare` take, too.

    Its samplers are those of `lightcull_path`, with their options ("culled:sets=16"), and "path",
    which is Mitsuba's own integrator: `path`, or `volpath` where the file says that. Where it says
    that, and there are media, there is `IN_MEDIA` in place of the former, by `lightcull_volpath`.

    scene: a `mi.Scene` of the variant that is set. digest: tells it from other scenes; None: it is
    not known, and no reference is ever found in the cache. integrator: what holds of the one of the
    file, as `load_file` finds it; None: what that of the scene tells.
    """

    def __init__(
        self,
        scene: Any,
        name: str = "scene",
        digest: str | None = None,
        *,
        integrator: FileIntegrator | None = None,
    ) -> None:
        self.name = name
        self.scene = scene
        self.integrator = _integrator_of(scene) if integrator is None else integrator
        self._has_media = any(
            shape.interior_medium() or shape.exterior_medium() for shape in scene.shapes()
        ) or any(sensor.get_medium() for sensor in scene.sensors())
        self._sensor = next(iter(scene.sensors()), None)
        self._variant = mitsuba().variant()
        self._digest = digest or os.urandom(16).hex()

    @property
    def light_count(self) -> int:
        """Emitters, as Mitsuba counts them: a mesh is one."""
        return len(self.scene.emitters())

    @property
    def sensor(self) -> Any:
        """What it is seen by: the first of the file unless another was chosen. Where there is none
        one is placed, of which an UnsupportedWarning tells. Raises Error if there is no shape.
        """
        if self._sensor is None:
            bounds = self.bounds
            if bounds is None:
                raise Error(f"{self.name}: holds no shapes")
            placed, said = automatic_camera(bounds, distances_in(self.scene))
            self._sensor = sensor_of(placed, None)
            warnings.warn(f"{self.name}: {said}", UnsupportedWarning, stacklevel=2)
        return self._sensor

    def use_camera(self, camera: CameraChoice) -> None:
        """Sees the scene by one of the file's sensors, by its id or its number from 0, or by
        another camera, whose picture is as large as that of the file's.
        """
        sensors = self.scene.sensors()
        if isinstance(camera, Camera):
            self._sensor = sensor_of(camera, self._sensor)
            return
        view = camera if isinstance(camera, View) else View(which=camera)
        if view.which is not None:
            self._sensor = sensors[chosen_camera([each.id() for each in sensors], view.which)]
        if not view.is_changed:
            return
        before = Camera() if view.origin is not None else camera_of(self.sensor)
        if before is None:
            raise Error(f"{self.name}: its {self.sensor.class_name()} can only be left as it is")
        bounds = self.bounds
        middle = np.zeros(3) if bounds is None else bounds.mean(axis=0)
        self._sensor = sensor_of(view.changed(before, middle), self._sensor)

    def surround(self, environment: Environment, scale: float = 1.0) -> None:
        """Surrounds the scene by something else than its file does; "auto": by that."""
        if is_auto(environment):
            return
        camera = None if self._sensor is None else camera_of(self._sensor)
        texels = texels_of(environment, camera or Camera())
        kept = [e for e in self.scene.emitters() if not (e.is_environment() or _is_of_shape(e))]
        things = [*self.scene.shapes(), *kept, *self.scene.sensors(), self.scene.integrator()]
        scene = {"type": "scene"} | {f"_{i}": x for i, x in enumerate(things) if x is not None}
        if texels is not None:
            scene["environment"] = _environment(texels, scale)
        try:
            self.scene = mitsuba().load_dict(scene)
        except RuntimeError as error:
            raise Error(f"environment: {str(error).splitlines()[0].rsplit('] ', 1)[-1]}") from error
        told = hashlib.blake2b(repr((texels is None, scale)).encode(), digest_size=16)
        told.update(b"" if texels is None else texels.tobytes())
        self._digest += told.hexdigest()

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the picture, pixels: of the film's crop window."""
        width, height = self.sensor.film().crop_size()
        return int(width), int(height)

    @property
    def bounds(self) -> np.ndarray | None:
        """Smallest and largest corner of all shapes, float32 (2, 3), metres; None without any."""
        corners = [_corners(shape) for shape in self.scene.shapes()]
        if not corners:
            return None
        points = np.concatenate(corners)
        return np.stack([points.min(axis=0), points.max(axis=0)])

    @property
    def file_settings(self) -> FileSettings:
        """What film and integrator say."""
        size = None if self._sensor is None else self.size
        return FileSettings(
            size, self.integrator.max_depth, self.integrator.rr_depth, self.integrator.hide_emitters
        )

    @property
    def variant(self) -> str:
        """Of Mitsuba, that it was made by."""
        return str(self._variant)

    def digest(self) -> str:
        seen_by = hashlib.blake2b(str(self.sensor).encode(), digest_size=16).hexdigest()
        return f"{self._digest}-{seen_by}-{self._variant}-{build_digest()}"

    def check_sampler(self, description: str) -> None:
        self._new_integrator(description)

    def new_job(self, sampler: str, settings: RenderSettings, spp: int | None = None) -> MitsubaJob:
        check_film(self.name, self.sensor.film())
        self._set_size(settings.size)
        if settings.threads:
            # Dr.Jit comes with Mitsuba, which is optional.
            importlib.import_module("drjit").set_thread_count(settings.threads)
        if settings.direct_light != "mis":
            raise Error("direct_light: not for Mitsuba, whose paths sample lights and the BSDF")
        integrator = self._new_integrator(
            sampler,
            max_depth=settings.max_depth,
            rr_depth=settings.rr_depth,
            hide_emitters=settings.hide_emitters,
        )
        return MitsubaJob(sampler, self.scene, self.sensor, integrator, settings.seed, spp)

    @property
    def best_sampler(self) -> str:
        """`learned`; `IN_MEDIA` where there are media."""
        return IN_MEDIA if self.wants_media else "learned"

    @property
    def wants_media(self) -> bool:
        """Whether there are media, and the integrator of the scene renders them."""
        return self._has_media and self.integrator.kind != PATH

    def _check_attributes(self) -> None:
        """Raises Error for emitters whose radiance is an attribute of their mesh. Mitsuba asks for
        it at a point without a shape: it crashes in scalar variants, and loses light in others.
        """
        for shape in self.scene.shapes():
            if shape.is_emitter() and _ATTRIBUTE in str(shape.emitter()):
                raise Error(
                    f"sampler {PATH!r}: Mitsuba's own integrators sample no radiance that is an "
                    f"attribute of a mesh, as that of {shape.id()!r} is: take the scene as it was "
                    "before merge_emitters"
                )

    def _of_lightcull(self, description: str) -> dict[str, Any]:
        if not self.wants_media:
            # A job is one render to its user, though it is many to Mitsuba.
            return {"type": "lightcull_path", "light_sampler": description, "keep_learned": True}
        if description != IN_MEDIA:
            raise Error(
                f"sampler {description!r}: not for the media of {self.name}: {IN_MEDIA} renders "
                f"them by lightcull_volpath, and path by Mitsuba's {self.integrator.kind}"
            )
        return {"type": "lightcull_volpath"}

    def _set_size(self, size: tuple[int, int]) -> None:
        """A crop window is scaled with its film: the picture shows what it showed before."""
        if self.size == size:
            return
        parameters = mitsuba().traverse(self.sensor)
        old = {key: list(parameters[f"film.{key}"]) for key in ("size", "crop_offset")}
        factors = [new / was for new, was in zip(size, self.size, strict=True)]
        scaled = {
            key: [round(factor * x) for factor, x in zip(factors, value, strict=True)]
            for key, value in old.items()
        }
        parameters["film.crop_size"] = list(size)
        parameters["film.crop_offset"] = scaled["crop_offset"]
        parameters["film.size"] = [
            max(whole, offset + part)
            for whole, offset, part in zip(scaled["size"], scaled["crop_offset"], size, strict=True)
        ]
        parameters.update()
        if self.size != size:
            raise Error(f"{self.name}: its film cannot be made {size[0]}x{size[1]}")

    def _new_integrator(self, description: str, **wanted: int) -> Any:
        properties: dict[str, Any] = {"type": self.integrator.kind}
        if description == PATH:
            self._check_attributes()
        else:
            properties = self._of_lightcull(description)
        try:
            return mitsuba().load_dict(properties | self.integrator.properties | wanted)
        except RuntimeError as error:
            reason = str(error).splitlines()[0].rsplit("] ", 1)[-1]
            raise Error(f"sampler {description!r}: {reason}") from error


_ATTRIBUTE = "MeshAttribute["


def _is_of_shape(emitter: Any) -> bool:
    """Whether it comes with a shape."""
    return emitter.get_shape() is not None


def _environment(texels: np.ndarray, scale: float) -> dict[str, Any]:
    """A map of ours as Mitsuba has it: -Z is in its first column, ours has it in the middle."""
    if texels.shape[:2] == (1, 1):
        color = [float(scale * value) for value in texels[0, 0]]
        return {"type": "constant", "radiance": {"type": "rgb", "value": color}}
    turned = np.ascontiguousarray(np.roll(texels, texels.shape[1] // 2, axis=1), np.float32)
    return {"type": "envmap", "bitmap": mitsuba().Bitmap(turned), "scale": scale}


def _corners(shape: Any) -> np.ndarray:
    """Of its bounds: float32 (2, 3). The box that a merged mesh tells is that of its first part."""
    parameters = mitsuba().traverse(shape)
    if "vertex_positions" in parameters:
        points = np.array(parameters["vertex_positions"], np.float32).reshape(-1, 3)
        return np.stack([points.min(axis=0), points.max(axis=0)])
    box = shape.bbox()
    return np.array([box.min, box.max], np.float32).reshape(2, 3)


_KINDS = {
    "VolumetricPathIntegrator": "volpath",
    "VolpathMisIntegratorImpl": "volpathmis",
    "LightcullVolpath": "volpath",
}


def _integrator_of(scene: Any) -> FileIntegrator:
    """What an integrator tells of itself, which is its kind and its depths."""
    integrator = scene.integrator()
    said = dict(re.findall(r"(max_depth|rr_depth) = (\d+)", str(integrator)))
    known = FileIntegrator()
    # Mitsuba has -1 as an unsigned number.
    depth = min(int(said.get("max_depth", known.max_depth)), known.max_depth)
    if "DirectIntegrator[" in str(integrator):
        depth = DIRECT_DEPTH
    kind = PATH if integrator is None else _KINDS.get(integrator.class_name(), PATH)
    hidden = bool(getattr(integrator, "hide_emitters", False))
    return FileIntegrator(kind, depth, int(said.get("rr_depth", known.rr_depth)), hidden)
