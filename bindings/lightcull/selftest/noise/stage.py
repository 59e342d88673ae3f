"""A floor that a camera sees from above, with lights over it: the scene, and its closed form."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import closed_forms as forms
from .situation import Picture

QUAD = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
_ALBEDO = 0.5
_MOST_PAIRS = 4_000_000
"""Pairs of a place and a light that a reference sums up, about."""
_VIEWS = (6, 8)
"""Places of a lens, along its radius and round it."""


class Stage(Picture):
    """A square floor from -half to half in x and z at y = 0, which fills the image of a camera
    `height` above its middle. Lights are added to the scene and, on their own, to the reference.

    lens: radius of the camera's lens, which looks sharply at what is 1 m before it. margin: by how
    much the floor is larger than what the camera sees of it. material: of the floor, as for
    `Scene.add_material`; none: diffuse, grey of 0.5.
    """

    def __init__(
        self, half: float = 4.0, height: float = 2.3, lens: float = 0.0, margin: float = 0.0,
        max_depth: int = 2, **material: Any,
    ) -> None:  # fmt: skip
        super().__init__(max_depth)
        self._half, self._height, self._lens = half, height, lens
        self._material = material
        shiny = self.scene.add_material("metallic_roughness", **material) if material else None
        edge = half + margin
        corners = np.float32([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]]) * np.float32(edge)
        self.scene.add_mesh(corners, QUAD, material=shiny)
        fov = float(2 * np.arctan(half / height))
        lens_of = {"aperture_radius": lens, "focus_distance": 1.0} if lens else {}
        self.scene.set_camera((0, height, 0), (0, 0, 0), up=(0, 0, -1), vertical_fov=fov, **lens_of)
        self._points: list[tuple[np.ndarray, np.ndarray]] = []
        self._spots: list[tuple[np.ndarray, ...]] = []
        self._suns = 0.0
        self._triangles: list[tuple[np.ndarray, np.ndarray]] = []
        self._plates: list[np.ndarray] = []
        self._unseen = 0.0

    # ---- what there is ---------------------------------------------------------------------------

    def points(self, places: Any, intensity: Any) -> None:
        """places: (N, 3); intensity: W/sr."""
        places = np.float32(places)
        of_each = np.broadcast_to(np.float32(intensity), len(places))
        for place, value in zip(places.tolist(), of_each.tolist(), strict=True):
            self.scene.add_point_light(tuple(place), (value,) * 3)
        self._points.append((places.astype(float), of_each.astype(float)))

    def spots(self, places: np.ndarray, directions: np.ndarray, inner: float, outer: float) -> None:
        """Of intensity 10; places, directions: (N, 3); inner, outer: radians."""
        places, directions = np.float32(places), np.float32(directions)
        for place, way in zip(places.tolist(), directions.tolist(), strict=True):
            self.scene.add_spot_light(tuple(place), tuple(way), (10.0,) * 3, inner, outer)
        ways = directions / np.linalg.norm(directions.astype(float), axis=1, keepdims=True)
        angles = (np.full(len(places), angle) for angle in (inner, outer))
        self._spots.append((places.astype(float), ways, *angles))

    def suns(self, ways: np.ndarray, irradiance: Any) -> None:
        """Directional lights. ways: (N, 3), to them; irradiance: of what faces them."""
        of_each = np.broadcast_to(np.float32(irradiance), len(ways))
        for way, value in zip(np.float32(ways).tolist(), of_each.tolist(), strict=True):
            self.scene.add_directional_light((-way[0], -way[1], -way[2]), (value,) * 3)
        cosines = ways[:, 1] / np.linalg.norm(ways, axis=1)
        self._suns += float(of_each.astype(float) @ np.maximum(cosines, 0.0))

    def triangles(
        self, corners: np.ndarray, radiance: float | np.ndarray, whole: np.ndarray | None = None,
        two_sided: bool = False,
    ) -> None:  # fmt: skip
        """corners: (N, 3, 3); radiance: of all, or (N,). whole: the same area, cut otherwise."""
        corners = np.float32(corners)
        of_each = np.broadcast_to(np.float32(radiance), len(corners))
        index = np.arange(3 * len(corners), dtype=np.uint32).reshape(-1, 3)
        rgb = np.repeat(of_each[:, None], 3, axis=1)
        self.scene.add_light_mesh(
            corners.reshape(-1, 3), index, radiance=np.ascontiguousarray(rgb), two_sided=two_sided
        )
        known = corners if whole is None else np.float32(whole)
        values = of_each if whole is None else np.broadcast_to(of_each[:1], len(known))
        self._triangles.append((known.astype(float), values.astype(float)))

    def panel(
        self, middle: Any, u: Any, v: Any, radiance: float, cut: int = 1, two_sided: bool = False,
        parts: int = 1, hides: bool = False,
    ) -> None:  # fmt: skip
        """A parallelogram middle +- u +- v that emits along u x v, in 2 cut^2 triangles.

        parts: 2 parts^2 triangles are so small that they are hidden, or mirrored, as a whole or not
        at all. hides: that it stands before other lights.
        """
        known = cut_up(middle, u, v, parts)
        self.triangles(cut_up(middle, u, v, cut), radiance, known, two_sided)
        if hides:
            u, v = np.float64(u), np.float64(v)
            self._plates.append(np.array([np.float64(middle) - u - v, 2 * u, 2 * v]))

    def textured(self, middle: Any, u: Any, v: Any, radiance: float, texels: np.ndarray) -> None:
        """A panel of two triangles with an image (n, n) on it, interpolated between texels."""
        size = len(texels)
        corners = np.float32([_place(middle, u, v, a, b) for a, b in _CORNERS])
        uvs = np.float32([[(a + 1) / 2, (b + 1) / 2] for a, b in _CORNERS])
        image = np.ascontiguousarray(np.repeat(np.float32(texels)[..., None], 3, axis=2))
        self.scene.add_light_mesh(
            corners, QUAD, radiance=(radiance,) * 3, texture=self.scene.add_texture(image), uvs=uvs
        )
        halves, size = _interpolated(np.float64(texels)), 2 * size
        for row, column in zip(*np.nonzero(halves), strict=True):
            a, b = (2 * column + 1) / size - 1, 1 - (2 * row + 1) / size  # row 0 is the top
            at = _place(middle, u, v, a, b)
            part = cut_up(at, np.float64(u) / size, np.float64(v) / size, 1)
            self._triangles.append((part, np.full(2, radiance * halves[row, column])))

    def plate(self, corner: Any, u: Any, v: Any, material: int | None = None) -> None:
        """A parallelogram from a corner along u and v, that lets nothing through."""
        plate = np.float64([corner, u, v])
        at = plate[0]
        corners = np.float32([at, at + plate[1], at + plate[1] + plate[2], at + plate[2]])
        self.scene.add_mesh(corners, QUAD, material=material)
        self._plates.append(plate)

    def unseen(self, half: float) -> None:
        """The square from -half to half is hidden from the camera by a panel's back."""
        self._unseen = half

    # ---- what is right ---------------------------------------------------------------------------

    def mean(self) -> float:
        """The mean of the image."""
        if self._material or self._plates:
            return self._sum_of_small_parts()
        total = self._suns
        total += sum(self._of_points(*lights) for lights in self._points)
        total += sum(self._of_spots(*lights) for lights in self._spots)
        if self._triangles:
            lights = [np.concatenate(parts) for parts in zip(*self._triangles, strict=True)]
            total += self._of_triangles(*lights, self._half)
            if self._unseen:
                share = (self._unseen / self._half) ** 2
                total -= share * self._of_triangles(*lights, self._unseen)
        return _ALBEDO / np.pi * float(total)

    def _views(self) -> np.ndarray:
        """The middles (V, 2) of the floor as places of the lens see it."""
        if not self._lens:
            return np.zeros((1, 2))
        # A ray through the lens at p meets the floor p (1 - height / focus) beside the middle one.
        radii, angles = ((np.arange(count) + 0.5) / count for count in _VIEWS)
        turn = 2 * np.pi * angles
        disk = np.sqrt(radii)[:, None, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        return (1 - self._height) * self._lens * disk.reshape(-1, 2)

    def _of_points(self, places: np.ndarray, intensity: np.ndarray) -> float:
        """The mean irradiance: each point's flux is its intensity times the solid angle."""
        half, views = np.full(2, self._half), self._views()
        flux = [(intensity * forms.solid_angle(places, v - half, v + half)).sum() for v in views]
        return float(np.mean(flux)) / (2 * self._half) ** 2

    def _of_spots(
        self, places: np.ndarray, ways: np.ndarray, inner: np.ndarray, outer: np.ndarray
    ) -> float:
        """All of the flux of spots whose cones end on the floor; of the others, sums over it."""
        whole = self._on_floor(places, ways, outer)
        total = float((10 * forms.spot_flux(inner, outer))[whole].sum()) / (2 * self._half) ** 2
        if whole.all():
            return total
        places, ways, inner, outer = places[~whole], ways[~whole], inner[~whole], outer[~whole]
        floor, weights = forms.gauss_places(self._half, _count(len(places), 32, 160))
        blocks = max(1, len(floor) * len(places) // 500_000)
        for part, share in zip(
            np.array_split(floor, blocks), np.array_split(weights, blocks), strict=True
        ):
            way = part[:, None] - places[None]
            distance = np.linalg.norm(way, axis=2)
            cosine = np.einsum("plj,lj->pl", way, ways) / distance
            falloff = forms.spot_falloff(cosine, inner, outer)
            total += float(share @ (10 * falloff * -way[..., 1] / distance**3).sum(axis=1))
        return total

    def _on_floor(self, places: np.ndarray, ways: np.ndarray, outer: np.ndarray) -> np.ndarray:
        """Whether the edge of each spot's cone lies on the floor."""
        aside = np.cross(ways, [1.0, 0.3, 0.1])
        aside /= np.linalg.norm(aside, axis=1, keepdims=True)
        other = np.cross(ways, aside)
        turn = np.linspace(0, 2 * np.pi, 64)[:, None, None]
        edge = np.cos(outer)[:, None] * ways + np.sin(outer)[:, None] * (
            np.cos(turn) * aside + np.sin(turn) * other
        )
        below = edge[..., 1] < -1e-3
        reach = places[:, 1] / np.where(below, -edge[..., 1], 1.0)
        end = np.abs(places + reach[..., None] * edge)
        return (below & (end[..., 0] < self._half) & (end[..., 2] < self._half)).all(axis=0)

    def _of_triangles(self, corners: np.ndarray, radiance: np.ndarray, half: float) -> float:
        """By Lambert's formula and Gauss' rule, of error exp(-2 count height / half)."""
        count = int(np.clip(6 * half / corners[..., 1].min(), 12, 100))
        floor, weights = forms.gauss_places(half, count)
        blocks = max(1, len(floor) * len(corners) // 200_000)
        total = 0.0
        for view in self._views():
            for part, share in zip(
                np.array_split(floor + [view[0], 0, view[1]], blocks),
                np.array_split(weights, blocks), strict=True,
            ):  # fmt: skip
                total += float(share @ (forms.triangle_irradiance(part, corners) @ radiance))
        return total / len(self._views())

    def _sum_of_small_parts(self) -> float:
        """For a floor that shines, and for lights behind plates: triangles as points."""
        lights, ways, intensity = self._small_parts()
        floor, weights = forms.gauss_places(self._half, _count(len(lights), 24, 192))
        eye = np.array([0, self._height, 0])
        total = 0.0
        blocks = max(1, len(floor) * len(lights) // 300_000)
        for part, share in zip(
            np.array_split(floor, blocks), np.array_split(weights, blocks), strict=True
        ):
            way = lights[None] - part[:, None]
            distance2 = (way * way).sum(axis=2)
            cosine = -np.einsum("plj,lj->pl", way, ways) / np.sqrt(distance2)
            # Points emit in all directions alike, and have no way.
            emitted = np.where((ways != 0).any(axis=1), np.maximum(cosine, 0.0), 1.0)
            value = intensity * emitted / distance2 * self._reflected(part, eye, lights)
            for plate in self._plates:
                value[forms.hidden(part, lights, plate)] = 0.0
            total += float(share @ value.sum(axis=1))
        return total

    def _reflected(self, floor: np.ndarray, eye: np.ndarray, lights: np.ndarray) -> np.ndarray:
        if not self._material:
            way = lights[None] - floor[:, None]
            return _ALBEDO / np.pi * np.maximum(way[..., 1], 0) / np.linalg.norm(way, axis=2)
        base, metallic = self._material["base_color"][0], self._material["metallic"]
        f0 = 0.04 * (1 - metallic) + base * metallic
        alpha = self._material["roughness"] ** 2
        # The renderer's base is darkened by the Fresnel term of the half vector, as here.
        return forms.metal_radiance(floor, eye, lights, f0, base * (1 - metallic), alpha)

    def _small_parts(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Places (L, 3), directions (of points 0) and intensities."""
        places = [p for p, _ in self._points]
        ways = [np.zeros_like(p) for p, _ in self._points]
        intensities = [i for _, i in self._points]
        for corners, radiance in self._triangles:
            # Radon's rule of seven places would do no better for panels so small and so far.
            for weights in (np.full((3, 3), 1 / 6) + np.eye(3) / 2):
                cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
                length = np.linalg.norm(cross, axis=1)
                places.append(np.einsum("i,tij->tj", weights, corners))
                ways.append(cross / length[:, None])
                intensities.append(radiance * length / 6)
        return np.concatenate(places), np.concatenate(ways), np.concatenate(intensities)


_CORNERS = ((-1, -1), (1, -1), (1, 1), (-1, 1))


def _place(middle: Any, u: Any, v: Any, a: float, b: float) -> np.ndarray:
    return np.float64(middle) + a * np.float64(u) + b * np.float64(v)


def cut_up(middle: Any, u: Any, v: Any, cut: int) -> np.ndarray:
    """The triangles (2 cut^2, 3, 3) of a parallelogram that face along u x v."""
    line = np.linspace(-1, 1, cut + 1)
    found = []
    for i in range(cut):
        for j in range(cut):
            a, b, c, d = (
                _place(middle, u, v, line[i + k], line[j + n])
                for k, n in ((0, 0), (1, 0), (1, 1), (0, 1))
            )
            found += [[a, b, c], [a, c, d]]
    return np.array(found)


def _interpolated(texels: np.ndarray) -> np.ndarray:
    """The means (2n, 2n) of the four quarters of each texel of an image (n, n) that repeats."""
    for axis in (0, 1):
        lower, upper = (0.75 * texels + 0.25 * np.roll(texels, step, axis) for step in (1, -1))
        texels = np.stack([lower, upper], axis=axis + 1).reshape(
            [2 * n if i == axis else n for i, n in enumerate(texels.shape)]
        )
    return texels


def _count(lights: int, least: int, most: int) -> int:
    """The places along an edge of the floor: an even number, so that none lies in a wall at 0."""
    return int(np.clip(np.sqrt(_MOST_PAIRS / lights), least, most)) // 2 * 2
