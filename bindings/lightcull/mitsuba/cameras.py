"""Mitsuba's sensors and our cameras, from one to the other."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from ..camera import Camera, triple
from ..views import Distances
from .host import mitsuba

_SIZE = (320, 240)
"""Of the film of a sensor of our own where the file has none."""


def camera_of(sensor: Any) -> Camera | None:
    """What a sensor is to us; None if it is of a kind that we have not."""
    kind, values = sensor.class_name(), mitsuba().traverse(sensor)
    if kind not in ("PerspectiveCamera", "ThinLensCamera", "OrthographicCamera"):
        return None
    # An orthographic one does not tell its own.
    transform = values["to_world"] if "to_world" in values else sensor.world_transform()
    matrix = np.array(transform.matrix, np.float64).reshape(-1)[:16].reshape(4, 4)
    width, height = sensor.film().size()
    lens = {}
    if kind == "OrthographicCamera":
        lens["orthographic_height"] = 2 * float(np.linalg.norm(matrix[:3, 0])) * height / width
    else:
        half_width = np.tan(np.radians(_number(values["x_fov"])) / 2)
        lens["vertical_fov"] = float(2 * np.arctan(half_width * height / width))
    if kind == "ThinLensCamera":
        lens["aperture_radius"] = _number(values["aperture_radius"])
        lens["focus_distance"] = _number(values["focus_distance"])
    origin, forward = matrix[:3, 3], matrix[:3, 2]
    return Camera(
        triple(origin), triple(origin + forward), triple(matrix[:3, 1]), **lens, name=sensor.id()
    )


def sensor_of(camera: Camera, like: Any) -> Any:
    """A sensor of Mitsuba's for a camera of ours, with the film of another, in the same medium; None:
    a new film.
    """
    mi = mitsuba()
    width, height = _SIZE
    film: Any = {"type": "hdrfilm", "width": width, "height": height, "pixel_format": "rgb"}
    if like is not None:
        film = like.film()
        width, height = film.size()
    transform = mi.ScalarTransform4f().look_at(
        origin=list(camera.origin), target=list(camera.target), up=list(camera.up)
    )
    sensor: dict[str, Any] = {"type": "perspective", "film": film, "near_clip": 1e-3}
    if camera.orthographic_height > 0:
        half_width = camera.orthographic_height * width / height / 2
        transform = transform @ mi.ScalarTransform4f().scale([half_width, half_width, 1])
        sensor["type"] = "orthographic"
    else:
        sensor |= {"fov": float(np.degrees(camera.vertical_fov)), "fov_axis": "y"}
    if camera.aperture_radius > 0:
        sensor |= {
            "type": "thinlens",
            "aperture_radius": camera.aperture_radius,
            "focus_distance": camera.focus_distance,
        }
    if like is not None and like.get_medium() is not None:
        sensor["medium"] = like.get_medium()
    return mi.load_dict(sensor | {"to_world": transform})


def distances_in(scene: Any) -> Distances:
    """By which an automatic camera looks about in a scene of Mitsuba's."""
    mi, dr = mitsuba(), importlib.import_module("drjit")

    def met(origin: Any, way: Any) -> Any:
        hit = scene.ray_intersect(mi.Ray3f(mi.Point3f(origin), mi.Vector3f(way)))
        return hit.t * mi.Float(dr.select(dr.dot(hit.n, mi.Vector3f(way)) > 0, -1.0, 1.0))

    def distances(origins: np.ndarray, ways: np.ndarray) -> np.ndarray:
        if mi.variant().startswith("scalar"):
            rays = zip(origins.tolist(), ways.tolist(), strict=True)
            return np.array([met(*ray) for ray in rays], np.float32)
        return np.array(met(origins.T, ways.T), np.float32)

    return distances


def _number(value: Any) -> float:
    return float(np.array(value, np.float64).ravel()[0])
