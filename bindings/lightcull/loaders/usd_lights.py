"""UsdLux."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from pxr import Ar, UsdLux

from .._core import Error, read_image
from ..scene import Scene
from .model import Surface, Triangles, add_triangles
from .unsupported import Notes

_SEGMENTS = 32
"""Of a circle that is made of triangles."""
_Y_TO_Z = np.array(((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)))


class UsdLights:
    """Adds lights of a stage. unit: metres of its unit of length; z_is_up: as it says of itself."""

    def __init__(
        self, scene: Scene, notes: Notes, time: Any, unit: float, *, z_is_up: bool
    ) -> None:
        self._scene = scene
        self._notes = notes
        self._time = time
        self._unit = unit
        self._z_is_up = z_is_up

    def add(self, prim: Any, matrix: np.ndarray) -> None:
        """Adds a light where it stands."""
        adders = {
            "SphereLight": self._sphere,
            "DiskLight": self._disk,
            "RectLight": self._rect,
            "CylinderLight": self._cylinder,
            "DistantLight": self._distant,
            "DomeLight": self._dome,
            "DomeLight_1": self._dome,
        }
        kind = str(prim.GetTypeName())
        add = adders.get(kind)
        if add is None:
            self._notes.left_out(f"{kind} prims")
            return
        add(prim, matrix)

    def radiance(self, prim: Any, area: float) -> tuple[float, float, float]:
        """What UsdLuxLightAPI says a light emits; area: what it is divided by if it is normalised."""
        light = UsdLux.LightAPI(prim)
        color = np.array(self._get(light.GetColorAttr(), (1.0, 1.0, 1.0)), float)
        if self._get(light.GetEnableColorTemperatureAttr(), False):
            kelvin = float(self._get(light.GetColorTemperatureAttr(), 6500.0))
            color = color * np.array(UsdLux.BlackbodyTemperatureAsRgb(kelvin))
        strength = float(self._get(light.GetIntensityAttr(), 1.0))
        strength *= 2.0 ** float(self._get(light.GetExposureAttr(), 0.0))
        if self._get(light.GetNormalizeAttr(), False):
            strength /= max(area, 1e-12)
        r, g, b = (max(float(c), 0.0) * max(strength, 0.0) for c in color)
        return r, g, b

    def _get(self, attribute: Any, default: Any) -> Any:
        value = attribute.Get(self._time) if attribute else None
        return default if value is None else value

    def _stage_area(self, area: float, matrix: np.ndarray) -> float:
        """Of a shape at a scale, in units of the stage, by which UsdLux normalises."""
        scale = abs(np.linalg.det(matrix[:3, :3])) ** (1.0 / 3.0) / self._unit
        return area * scale**2

    def _sphere(self, prim: Any, matrix: np.ndarray) -> None:
        light = UsdLux.SphereLight(prim)
        radius = float(self._get(light.GetRadiusAttr(), 0.5))
        radiance = self.radiance(prim, self._stage_area(4.0 * math.pi * radius**2, matrix))
        is_point = bool(self._get(light.GetTreatAsPointAttr(), False))
        spot = self._cone(prim)
        if is_point or spot is not None or radius <= 0.0:
            # Seen from afar, a sphere of such a radiance.
            in_scene = radius * abs(np.linalg.det(matrix[:3, :3])) ** (1.0 / 3.0)
            intensity = np.array(radiance) * math.pi * in_scene**2
            self._point(matrix, intensity, spot)
            return
        self._emit(prim, _sphere(radius), radiance, matrix)

    def _point(
        self, matrix: np.ndarray, intensity: np.ndarray, cone: tuple[float, float] | None
    ) -> None:
        self._notes.has_light |= bool(intensity.any())
        if cone is None:
            self._scene.add_point_light(matrix[:3, 3], intensity)
            return
        self._notes.approximated("shaped lights as spots")
        self._scene.add_spot_light(matrix[:3, 3], -matrix[:3, 2], intensity, *cone)

    def _cone(self, prim: Any) -> tuple[float, float] | None:
        """The inner and the outer angle of UsdLuxShapingAPI, if there is a cone."""
        if not prim.HasAPI(UsdLux.ShapingAPI):
            return None
        shaping = UsdLux.ShapingAPI(prim)
        self._notes.left_out("focus of lights", int(self._get(shaping.GetShapingFocusAttr(), 0.0) != 0))
        ies = self._get(shaping.GetShapingIesFileAttr(), None)
        self._notes.left_out("IES profiles", int(ies is not None and bool(ies.path)))
        angle = float(self._get(shaping.GetShapingConeAngleAttr(), 90.0))
        if angle >= 90.0:
            return None
        softness = min(max(float(self._get(shaping.GetShapingConeSoftnessAttr(), 0.0)), 0.0), 1.0)
        outer = math.radians(max(angle, 0.0))
        return outer * (1.0 - softness), outer

    def _disk(self, prim: Any, matrix: np.ndarray) -> None:
        radius = float(self._get(UsdLux.DiskLight(prim).GetRadiusAttr(), 0.5))
        area = math.pi * radius**2
        self._flat(prim, _disk(radius), area, matrix)

    def _rect(self, prim: Any, matrix: np.ndarray) -> None:
        light = UsdLux.RectLight(prim)
        width = float(self._get(light.GetWidthAttr(), 1.0))
        height = float(self._get(light.GetHeightAttr(), 1.0))
        file = self._get(light.GetTextureFileAttr(), None)
        self._notes.left_out("textures of lights", int(file is not None and bool(file.path)))
        x, y = 0.5 * width, 0.5 * height
        corners = np.array([[-x, -y, 0], [-x, y, 0], [x, y, 0], [x, -y, 0]])  # fronts -Z
        mesh = Triangles(corners, np.array([[0, 1, 2], [0, 2, 3]]))
        self._flat(prim, mesh, width * height, matrix)

    def _flat(self, prim: Any, mesh: Triangles, area: float, matrix: np.ndarray) -> None:
        radiance = self.radiance(prim, self._stage_area(area, matrix))
        self._notes.left_out("shaping of flat lights", int(self._cone(prim) is not None))
        self._emit(prim, mesh, radiance, matrix)

    def _cylinder(self, prim: Any, matrix: np.ndarray) -> None:
        light = UsdLux.CylinderLight(prim)
        radius = float(self._get(light.GetRadiusAttr(), 0.5))
        length = float(self._get(light.GetLengthAttr(), 1.0))
        area = 2.0 * math.pi * radius * length
        radiance = self.radiance(prim, self._stage_area(area, matrix))
        self._emit(prim, _cylinder(radius, length), radiance, matrix)

    def _distant(self, prim: Any, matrix: np.ndarray) -> None:
        angle = float(self._get(UsdLux.DistantLight(prim).GetAngleAttr(), 0.53))
        # UsdLux's size of a distant light: by it radiance becomes irradiance.
        half = math.radians(min(max(angle, 0.0), 180.0)) / 2.0
        size = math.pi * math.sin(half) ** 2 if half > 0.0 else 1.0
        irradiance = np.array(self.radiance(prim, size)) * size
        self._notes.has_light |= bool(irradiance.any())
        self._scene.add_directional_light(-matrix[:3, 2], irradiance)

    def _dome(self, prim: Any, matrix: np.ndarray) -> None:
        if self._scene.has_environment:
            self._notes.left_out("dome lights after the first")
            return
        radiance = self.radiance(prim, 1.0)
        linear = matrix[:3, :3] / abs(np.linalg.det(matrix[:3, :3])) ** (1.0 / 3.0)
        if self._pole_is_z(prim):
            linear = linear @ _Y_TO_Z
        if linear[1, 1] < 0.999:
            self._notes.left_out("tilt of the dome light")
        # Latitude-longitude maps of UsdLux have +Z in the middle.
        rotation = math.pi + math.atan2(linear[0, 2], linear[2, 2])
        file = self._get(UsdLux.DomeLight(prim).GetTextureFileAttr(), None)
        texels = None
        if file is not None and file.path:
            texels = self._map(file.resolvedPath or file.path)
        self._notes.has_light |= any(radiance)
        if texels is None:
            self._scene.set_environment(radiance)
        else:
            self._scene.set_environment(texels, radiance, rotation)

    def _pole_is_z(self, prim: Any) -> bool:
        """If the dome stands on its Z before it is turned: its kind 1 may."""
        axis = prim.GetAttribute("poleAxis").Get() or "Y"
        return bool(axis == "Z" or (axis == "scene" and self._z_is_up))

    def _map(self, path: str) -> np.ndarray | None:
        try:
            return read_image(str(Ar.GetResolver().Resolve(path) or path))
        except Error:
            self._notes.left_out(f"image {path[-100:]!r} that cannot be read")
            return None

    def _emit(
        self, prim: Any, mesh: Triangles, radiance: tuple[float, float, float], matrix: np.ndarray
    ) -> None:
        if not any(radiance):
            return
        black = self._scene.add_material(base_color=(0.0, 0.0, 0.0))
        surface = Surface(black, radiance)
        add_triangles(self._scene, str(prim.GetPath()), mesh, surface, self._notes, matrix)


def _circle() -> np.ndarray:
    """Points on a polygon whose area is that of the circle of radius 1: (_SEGMENTS, 2)."""
    angle = 2.0 * math.pi / _SEGMENTS
    stretch = math.sqrt(angle / math.sin(angle))
    angles = angle * np.arange(_SEGMENTS)
    return stretch * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def _disk(radius: float) -> Triangles:
    """In the xy plane, its front to -Z."""
    rim = np.concatenate([radius * _circle(), np.zeros((_SEGMENTS, 1))], axis=1)
    i = np.arange(_SEGMENTS)
    indices = np.stack([i * 0, (i + 1) % _SEGMENTS + 1, i + 1], axis=1)
    return Triangles(np.concatenate([[[0.0, 0.0, 0.0]], rim]), indices)


def _cylinder(radius: float, length: float) -> Triangles:
    """About the x axis, without its ends, its front outwards; of the cylinder's area."""
    angle = 2.0 * math.pi / _SEGMENTS
    # The sides of a polygon whose edge is as long as the circle's.
    angles = angle * np.arange(_SEGMENTS)
    around = radius * (angle / 2.0) / math.sin(angle / 2.0)
    rim = np.stack([0 * angles, around * np.cos(angles), around * np.sin(angles)], axis=1)
    half = np.array([0.5 * length, 0.0, 0.0])
    i = np.arange(_SEGMENTS)
    j = (i + 1) % _SEGMENTS
    indices = np.concatenate([
        np.stack([i, i + _SEGMENTS, j], axis=1),
        np.stack([j, i + _SEGMENTS, j + _SEGMENTS], axis=1),
    ])  # fmt: skip
    return Triangles(np.concatenate([rim - half, rim + half]), indices[:, ::-1])


def _sphere(radius: float) -> Triangles:
    """Its front outwards; of the sphere's area."""
    rows, columns = _SEGMENTS // 2, _SEGMENTS
    polar, around = np.meshgrid(
        np.linspace(0.0, math.pi, rows + 1), 2.0 * math.pi * np.arange(columns) / columns, indexing="ij"
    )
    points = np.stack(
        [np.sin(polar) * np.cos(around), np.cos(polar), np.sin(polar) * np.sin(around)], axis=-1
    ).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    a, b = i * columns + j, i * columns + (j + 1) % columns
    c, d = a + columns, b + columns
    upper = np.stack([a, b, c], axis=-1)[1:].reshape(-1, 3)
    lower = np.stack([b, d, c], axis=-1)[:-1].reshape(-1, 3)
    indices = np.concatenate([upper, lower])
    p, q, r = (points[indices[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(q - p, r - p), axis=1).sum() / 2.0
    return Triangles(points * radius * math.sqrt(4.0 * math.pi / area), indices)
