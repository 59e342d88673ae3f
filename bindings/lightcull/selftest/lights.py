"""Which lights there are: powers, shapes, and how many."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from .. import _core
from . import sampler_checks
from .case import Case, Cases, Finding
from .lit_points import Setting, directions, floats, mixed_lights, mixed_setting
from .sampler_checks import EPSILON

_MANY = 2**20 + 1


def cases() -> Cases:
    yield Case("powers over twelve decades", lambda: sampler_checks.all_of(_twelve_decades()))
    yield Case("one light with 0.999999 of the power", _OneAndAMillion().find)
    yield Case("all lights in one point", lambda: sampler_checks.all_of(_in_one_point()))
    yield Case("all lights in a line", lambda: sampler_checks.all_of(_in_a_line()))
    yield Case("two lights in one place, back to back", _back_to_back)
    yield Case("triangles of zero area", _zero_area)
    yield Case("needles of aspect 1e7", lambda: sampler_checks.all_of(_needles()))
    yield Case("areas and intensities of triangles", _intensities, once=True)
    for radiance in (0.0, 1e-44, 1e30):
        yield Case(f"radiance {radiance:g}", lambda r=radiance: _radiance(r))
    for count in (0, 1, 2, 7, 8, 9):
        yield Case(f"{count} lights", lambda n=count: sampler_checks.all_of(_so_many(n)))
    yield Case("2^20 + 1 lights", _VeryMany().find)
    for count in (0, 1, 7, 8, 9, 17):
        yield Case(f"{count} points in a batch", lambda n=count: sampler_checks.choices(_points(n)))


def _twelve_decades() -> Setting:
    setting = mixed_setting()
    lights = setting.lights.copy()
    lights["intensity"] = 10 ** np.random.default_rng(21).uniform(-6, 6, len(lights))
    return Setting(lights, setting.positions, setting.normals)


class _OneAndAMillion:
    """The closed form of p of the bright one, in the middle of a shell of the others."""

    @cached_property
    def setting(self) -> Setting:
        centers = directions(1_000_001, 22)
        centers[0] = 0
        intensity = np.full(len(centers), 1e-12, np.float32)
        intensity[0] = 0.999999
        positions = np.float32([[0.5, 0, 0]])
        return Setting(_core.point_lights(centers, intensity), positions, 0 * positions)

    def find(self) -> Iterator[Finding]:
        setting = self.setting
        way = setting.lights["center"].astype(np.float64) - setting.positions
        power = setting.lights["intensity"].astype(np.float64) / (way**2).sum(axis=1)
        truth = power / power.sum()
        point = (setting.positions, setting.normals)
        for description in ("exhaustive", *sampler_checks.TREES, "culled"):
            sampler = setting.sampler(description)
            chosen = sampler.select(*point, np.float32([0.5]))
            prob = sampler.prob(*point, chosen, np.zeros(1, np.uint32))
            # The others together are 7e-7 of the whole: a sum of a million may lose them all.
            yield Finding(f"{description}: of the bright one", abs(float(prob[0]) - truth[0]), 2e-6)
        many = [np.repeat(a, 1000, 0) for a in point]
        sampler = setting.sampler("power")
        chosen = sampler.select(*many, setting.numbers(1).repeat(1000))
        dim = sampler.prob(*many, chosen, np.arange(1, 1001, dtype=np.uint32)) / 1e-12
        yield Finding("power: of a dim one", float(np.abs(dim - 1).max()), 1e-5)


def _in_one_point() -> Setting:
    setting = mixed_setting()
    lights = setting.lights.copy()
    lights["center"] = (0.3, -0.2, 0.1)
    lights["radius"] = 0
    return Setting(lights, setting.positions, setting.normals)


def _in_a_line() -> Setting:
    setting = mixed_setting()
    lights = setting.lights.copy()
    lights["center"][:, 1:] = 0
    lights["radius"] = 0
    return Setting(lights, setting.positions, setting.normals)


def _back_to_back() -> Iterator[Finding]:
    """A point sees the one that faces it; with normals of length 0, so do all."""
    corners = floats(
        np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 0], [0, 1, 0], [1, 0, 0]]])
    )
    lights = _core.triangle_lights(corners, np.ones(2, np.float32))
    positions = mixed_setting().positions + np.float32([0, 0, 0.01])
    setting = Setting(lights, positions, np.zeros_like(positions))
    # light_bvh bounds angles from above, by those that a bounding sphere fills.
    for description in ("exhaustive", "culled"):
        sampler = setting.sampler(description)
        chosen = sampler.select(positions, setting.normals, setting.numbers(6))
        seen = np.where(positions[:, 2] > 0, 0, 1)
        away = np.abs(positions[:, 2]) > 0.1
        wrong = (chosen["prob"] > 0) & (chosen["light"] != seen) & away
        # The axis is kept in 16 bits, so that a little is left of what faces away.
        probs = sampler.prob(positions, setting.normals, chosen, (1 - seen).astype(np.uint32))
        yield Finding(f"{description}: of the one that faces away",
                      float(probs[away & np.isfinite(probs)].max(initial=0)), 1e-2)  # fmt: skip
        yield Finding(f"{description}: chosen though it faces away", float(wrong.sum()), 1)
    yield from sampler_checks.all_of(setting)


def _triangles(corners: np.ndarray, radiance: float = 1.0) -> Setting:
    setting = mixed_setting()
    values = np.full(len(corners), radiance, np.float32)
    lights = np.empty(len(setting.lights) + len(corners), _core.LIGHT)
    lights[: len(setting.lights)] = setting.lights
    lights[len(setting.lights) :] = _core.triangle_lights(floats(corners), values)
    return Setting(lights, setting.positions, setting.normals)


def _zero_area() -> Iterator[Finding]:
    """They are never chosen."""
    random = np.random.default_rng(23)
    corners = random.uniform(-1, 1, (64, 3, 3))
    corners[:32, 2] = corners[:32, 1]
    corners[32:, 1:] = corners[32:, :1]
    setting = _triangles(corners)
    first = len(mixed_setting().lights)
    yield Finding("intensity", float(setting.lights["intensity"][first:].max()), 0)
    for description in sampler_checks.UNBIASED:
        if description == "uniform":
            continue
        chosen = setting.sampler(description).select(
            setting.positions, setting.normals, setting.numbers(7)
        )
        wrong = (chosen["prob"] > 0) & (chosen["light"] >= first)
        yield Finding(f"{description}: chosen", float(wrong.sum()), 0)
    yield from sampler_checks.all_of(setting)


def _needle_corners() -> np.ndarray:
    random = np.random.default_rng(24)
    start, way = random.uniform(-1, 1, (64, 3)), directions(64, 25).astype(np.float64)
    aside = np.cross(way, directions(64, 26))
    return np.stack([start, start + way, start + 0.5 * way + 1e-7 * aside], axis=1)


def _needles() -> Setting:
    return _triangles(_needle_corners(), 1e9)


def _intensities() -> Iterator[Finding]:
    """Radiance times area, by Kahan's formula in double; edges are differences of coordinates."""
    random = np.random.default_rng(27)
    for scale in (1e-6, 1.0, 1e6):
        corners = floats(random.uniform(-1, 1, (1000, 3, 3)) * scale)
        exact = corners.astype(np.float64)
        ab, ac = exact[:, 1] - exact[:, 0], exact[:, 2] - exact[:, 0]
        area = 0.5 * np.linalg.norm(np.cross(ab, ac), axis=1)
        ours = _core.triangle_lights(corners, np.full(1000, 3, np.float32))["intensity"]
        longest = np.linalg.norm(ab, axis=1) * np.linalg.norm(ac, axis=1)
        error = np.abs(ours / 3.0 - area)
        allowed = EPSILON * (4 * area + 8 * longest)
        place = int(np.argmax(error / allowed))
        yield Finding(f"scale {scale:g}", float(error[place] / area[place]),
                      float(allowed[place] / area[place]))  # fmt: skip


def _radiance(radiance: float) -> Iterator[Finding]:
    """Beside others, and alone, where all of it is relative to the brightest."""
    corners = np.random.default_rng(28).uniform(-1, 1, (50, 3, 3))
    yield from sampler_checks.choices(_triangles(corners, radiance))
    mixed = mixed_setting()
    alone = _core.triangle_lights(floats(corners), np.full(50, radiance, np.float32))
    setting = Setting(alone, mixed.positions, mixed.normals)
    if radiance == 0:
        chosen = setting.sampler("culled").select(
            mixed.positions, mixed.normals, setting.numbers(8)
        )
        yield Finding("culled: chosen", float((chosen["prob"] > 0).sum()), 0)
    yield from sampler_checks.all_of(setting)


def _so_many(count: int) -> Setting:
    mixed = mixed_setting()
    return Setting(mixed_lights(200, 14)[:count], mixed.positions, mixed.normals)


def _points(count: int) -> Setting:
    mixed = mixed_setting()
    return Setting(mixed.lights, mixed.positions[:count], mixed.normals[:count])


class _VeryMany:
    """At a few points."""

    @cached_property
    def setting(self) -> Setting:
        random = np.random.default_rng(29)
        centers = floats(random.uniform(-1, 1, (_MANY, 3)))
        lights = _core.point_lights(centers, floats(10 ** random.uniform(-1, 1, _MANY)))
        mixed = mixed_setting()
        return Setting(lights, mixed.positions[:4], mixed.normals[:4])

    @cached_property
    def totals(self) -> list[Finding]:
        """prob() is the same with all instruction sets."""
        return list(sampler_checks.totals(self.setting, ("light_bvh",)))

    def find(self) -> Iterator[Finding]:
        yield from self.totals
        yield from sampler_checks.choices(self.setting, ("culled:sets=4", "light_bvh"))
