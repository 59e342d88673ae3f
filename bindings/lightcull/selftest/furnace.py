"""The renderer: energy that surfaces keep, and how bright a single sample can be."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cached_property

import numpy as np

from .. import scenes
from ..rendering.path_job import PathJob
from ..rendering.render import render
from ..rendering.settings import RenderSettings
from ..scene import Scene
from .case import Case, Cases, Finding

_QUAD = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
_NOISE = 6.0


def cases() -> Cases:
    yield Case("a white furnace of 64 bounces", lambda: _furnace(1.0), once=True)
    yield Case("a grey furnace of 64 bounces", lambda: _furnace(0.5), once=True)
    yield Case("a black furnace", lambda: _furnace(0.0), once=True)
    for roughness in (1e-4, 0.01, 0.1, 0.3, 0.6, 1.0):
        yield Case(f"GGX of roughness {roughness:g}", lambda r=roughness: _ggx(r), once=True)
    for scene in (
        Fireflies("lanterns", lights=2000),
        Fireflies("cornell"),
        Fireflies("city"),
        Fireflies("embers"),
        Fireflies("million"),
        Fireflies("offices"),
    ):
        yield Case(scene.name, scene.find, once=True, note=scene.note)


def _box(albedo: float) -> Scene:
    """A closed box whose walls emit and reflect, seen from inside."""
    scene = Scene("furnace")
    material = scene.add_material(base_color=(albedo,) * 3)
    for axis in range(3):
        for side in (-1, 1):
            u, v = np.roll(np.eye(3), axis, 1)[1:]
            middle = side * np.roll(np.eye(3), axis, 1)[0]
            corners = [middle + a * u + b * v for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            if side > 0:
                corners.reverse()
            scene.add_light_mesh(
                np.array(corners, np.float32), _QUAD, radiance=(1, 1, 1), material=material
            )
    scene.set_camera((0.1, 0.2, 0.9), (0, 0, -1))
    return scene


def _furnace(albedo: float) -> Iterator[Finding]:
    """Every hit brings a radiance of 1: the sum of albedo^k up to 64 bounces."""
    bounces = 64
    truth = sum(albedo**k for k in range(bounces + 1))
    for sampler in ("culled", "light_bvh"):
        job = PathJob(_box(albedo), sampler, RenderSettings((16, 16), bounces + 1, 1, 0))
        passes = np.array([_next_pass(job).mean() for _ in range(24)])
        noise = passes.std(ddof=1) / math.sqrt(len(passes))
        yield Finding(sampler, abs(passes.mean() - truth) / truth, _NOISE * noise / truth + 1e-5)


def _next_pass(job: PathJob) -> np.ndarray:
    """The samples of one pass: float64 (H, W, 3)."""
    before = job.checkpoint().sums
    job.render_pass()
    return job.checkpoint().sums - before


def _ggx(roughness: float) -> Iterator[Finding]:
    """What a white metal reflects of a white sky, by direction of view."""
    for cosine in (1e-3, 0.05, 0.3, 0.7, 1.0):
        truth = _albedo(cosine, max(roughness**2, 1e-3))
        scene = Scene("sky")
        metal = scene.add_material("metallic_roughness", (1, 1, 1), 1.0, roughness)
        floor = np.float32([[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]]) * 1000
        scene.add_mesh(floor, _QUAD, material=metal)
        scene.set_environment((1, 1, 1))
        view = (math.sqrt(1 - cosine**2), cosine, 0.0)
        scene.set_camera(view, (0, 0, 0), (0.1, 0.2, 0.97), vertical_fov=1e-4)
        images = [
            render(scene, "uniform", spp=256, size=(8, 8), seed=seed).image.mean()
            for seed in range(8)
        ]
        noise = float(np.std(images, ddof=1)) / math.sqrt(len(images))
        yield Finding(f"cosine {cosine:g}", abs(float(np.mean(images)) - truth),
                      _NOISE * noise + 1e-3)  # fmt: skip


def _albedo(cosine: float, alpha: float) -> float:
    """The directional albedo of GGX with Smith's separable masking and no Fresnel: the mean of the
    masking of the way out over visible normals (Heitz 2018), on a grid.
    """
    n = 512
    grid = (np.arange(n) + 0.5) / n
    a, b = (g.ravel() for g in np.meshgrid(grid, grid))
    sine = math.sqrt(1 - cosine**2)
    stretched = np.array([alpha * sine, 0.0, cosine])
    stretched /= np.linalg.norm(stretched)
    first = np.array([0.0, 1.0, 0.0])
    second = np.cross(stretched, first)
    r, phi = np.sqrt(a), 2 * np.pi * b
    t1 = r * np.cos(phi)
    s = 0.5 * (1 + stretched[2])
    t2 = (1 - s) * np.sqrt(1 - t1**2) + s * r * np.sin(phi)
    t3 = np.sqrt(np.maximum(0, 1 - t1**2 - t2**2))
    normal = t1[:, None] * first + t2[:, None] * second + t3[:, None] * stretched
    normal *= (alpha, alpha, 1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    out = 2 * (normal @ (sine, 0.0, cosine)) * normal[:, 2] - cosine
    up = np.maximum(out, 0)
    masking = 2 * up / (up + np.sqrt(alpha**2 + (1 - alpha**2) * up**2) + 1e-300)
    return float(np.where(out > 0, masking, 0).mean())


_FIREFLY_SAMPLERS = ("uniform", "power", "light_bvh", "light_bvh:importance=means", "culled")


_SEEDS = range(1, 19)
_EXTREMES = 1.25
"""Largest samples of equal distributions differ by as much."""


class Fireflies:
    """Of each sampler, the largest sample of a pixel over the mean of the image, in the median of
    some renders. Pixels that show a light are left out: they are as bright with any sampler.
    """

    def __init__(self, scene: str, **options: int) -> None:
        self.name = f"fireflies in {scene}"
        self._build = lambda: scenes.build(scene, **options)

    @cached_property
    def largest(self) -> dict[str, float]:
        scene, size = self._build(), (96, 72)
        seen = render(scene, "uniform", spp=16, size=size, max_depth=1).image.any(axis=2)
        found = {}
        for sampler in _FIREFLY_SAMPLERS:
            largest = []
            for seed in _SEEDS:
                settings = RenderSettings(size, 3, seed, 0, even_numbers=False)
                job = PathJob(scene, sampler, settings)
                samples = np.array([_next_pass(job)[~seen] for _ in range(16)])
                largest.append(samples.max() / samples.mean())
            found[sampler] = float(np.median(largest))
        return found

    def note(self) -> str:
        values = (f"{name} {value:.0f}" for name, value in self.largest.items())
        return f"largest sample over the mean: {', '.join(values)}"

    def find(self) -> Iterator[Finding]:
        largest = self.largest
        ratio = largest["culled"] / largest["light_bvh"]
        yield Finding("culled, over light_bvh's", ratio, _EXTREMES)
