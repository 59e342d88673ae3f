"""Where lights and points are: scale, origin, and points in places that ask for trouble."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .._core import Error
from ..sampler import LightSampler
from . import sampler_checks
from .case import Case, Cases, Finding
from .lit_points import Setting, floats, mixed_lights, mixed_setting, points_setting
from .sampler_checks import EPSILON


def cases() -> Cases:
    for exponent in range(-6, 7, 2):
        yield Case(f"scene of 1e{exponent} m", lambda k=exponent: _scaled(10.0**k))
    for exponent in range(3, 8):
        moved = _Moved(10.0**exponent)
        yield Case(f"origin 1e{exponent} scene sizes away", moved.find, note=moved.note)
    yield Case("points on lights", lambda: sampler_checks.all_of(_on_lights(0.0)))
    yield Case("points inside bounding spheres", lambda: sampler_checks.all_of(_on_lights(0.5)))
    yield Case("points one ulp off lights", lambda: sampler_checks.all_of(_one_ulp_off()))
    yield Case("points in the planes of lights", lambda: sampler_checks.all_of(_in_planes()))
    yield Case("lights below the horizon", _below_horizon)
    yield Case("points 1e-20 m from lights", lambda: sampler_checks.all_of(_far(1e-20)))
    yield Case("points 1e20 m from lights", lambda: sampler_checks.choices(_far(1e20)))
    yield Case("normals of length 0", lambda: sampler_checks.all_of(_normals(0.0)))
    yield Case("grazing normals", _grazing)
    yield Case("normals that are not normalised", _refused, once=True)


def _closed_form(lights: np.ndarray, positions: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Of point lights, intensity times cosine / distance^2, as a share: float64 (M, N)."""
    way = lights["center"].astype(np.float64) - positions.astype(np.float64)[:, None]
    distance2 = (way**2).sum(axis=2)
    height = (way * normals.astype(np.float64)[:, None]).sum(axis=2)
    power = np.maximum(height, 0) * distance2**-1.5 * lights["intensity"].astype(np.float64)
    return power / power.sum(axis=1, keepdims=True)


def _against_closed_form(setting: Setting, size: float, what: str) -> Finding:
    """Errors of the largest probabilities. Each coordinate is rounded in units of the size of the
    scene, which changes distances and heights by as much.
    """
    apart = (setting.positions[:, None] != setting.lights["center"]).any(axis=2).all(axis=1)
    setting = Setting(setting.lights, setting.positions[apart], setting.normals[apart])
    ours = sampler_checks.probs_of_all(setting.sampler("exhaustive"), setting)
    truth = _closed_form(setting.lights, setting.positions, setting.normals)
    way = setting.lights["center"].astype(np.float64) - setting.positions[:, None]
    distance = np.sqrt((way**2).sum(axis=2)) / size
    height = np.abs((way * setting.normals[:, None]).sum(axis=2)) / size
    allowed = EPSILON * (32 + len(setting.lights) + 8 / distance + 8 / np.maximum(height, 1e-12))
    allowed = allowed + (truth * allowed).sum(axis=1, keepdims=True)
    error = np.abs(ours - truth) / np.maximum(truth, 1e-12)
    error = np.where(truth > 1e-9, error, 0.0)
    place = np.unravel_index(np.argmax(error / allowed), error.shape)
    return Finding(what, float(error[place]), float(allowed[place]))


def _scaled(scale: float) -> Iterator[Finding]:
    points = points_setting()
    scaled = Setting(points.lights.copy(), floats(points.positions * scale), points.normals)
    scaled.lights["center"] = points.lights["center"] * scale
    yield _against_closed_form(scaled, scale, "exhaustive: against the closed form")
    mixed = mixed_setting()
    lights = mixed.lights.copy()
    lights["center"] *= np.float32(scale)
    lights["radius"] *= np.float32(scale)
    yield from sampler_checks.all_of(
        Setting(lights, floats(mixed.positions * scale), mixed.normals)
    )


class _Moved:
    """All of a scene moved so far, in units of its size."""

    def __init__(self, distance: float) -> None:
        self._distance = distance
        self._begins = 0.0

    def note(self) -> str:
        return f"coordinates alone change probabilities by {self._begins:.2g}"

    def find(self) -> Iterator[Finding]:
        shift = np.array([0.6, -0.5, 0.62]) * self._distance
        still = points_setting()
        moved = Setting(still.lights.copy(), floats(still.positions + shift), still.normals)
        moved.lights["center"] = still.lights["center"] + shift
        yield _against_closed_form(moved, 1.0, "exhaustive: against the closed form")
        before = _closed_form(still.lights, still.positions, still.normals)
        with np.errstate(all="ignore"):  # points may have come to lie on lights
            after = _closed_form(moved.lights, moved.positions, moved.normals)
        change = np.abs(after - before) / before.max(axis=1, keepdims=True)
        self._begins = float(np.nanmax(change))

        mixed = mixed_setting()
        lights = mixed.lights.copy()
        lights["center"] = mixed.lights["center"] + shift
        setting = Setting(lights, floats(mixed.positions + shift), mixed.normals)
        yield from sampler_checks.all_of(setting)
        yield _as_at_the_origin(setting, shift)


def _as_at_the_origin(moved: Setting, shift: np.ndarray) -> Finding:
    """The same rounded coordinates moved back, which is exact: the same answer, whatever kind of
    lights.
    """
    base = floats(shift).astype(np.float64)
    lights = moved.lights.copy()
    lights["center"] = moved.lights["center"] - base
    back = Setting(lights, floats(moved.positions - base), moved.normals)
    a, b = (sampler_checks.probs_of_all(s.sampler("exhaustive"), s) for s in (moved, back))
    error = float(np.abs(a - b).max() / b.max())
    # The middle of the scene, to which all is moved first, is rounded like any coordinate.
    return Finding("exhaustive: moved and at the origin", error, EPSILON * (512 + len(lights)))


def _on_lights(part: float) -> Setting:
    """Points at such a part of the radius from the centres of lights."""
    lights = mixed_lights(64, 7)
    random = np.random.default_rng(8)
    way = random.normal(size=(64, 3))
    way *= part * lights["radius"][:, None] / np.linalg.norm(way, axis=1, keepdims=True)
    return Setting(lights, floats(lights["center"] + way), mixed_setting().normals[:64])


def _one_ulp_off() -> Setting:
    setting = _on_lights(0.0)
    return Setting(
        setting.lights, np.nextafter(setting.positions, np.float32(np.inf)), setting.normals
    )


def _in_planes() -> Setting:
    """Flat lights in the planes x = 0 and z = 1, and points that are exactly in them."""
    lights = mixed_lights(64, 9)
    lights["cos_theta_o"], lights["cos_theta_e"] = 1, 0
    lights["center"][:32, 0], lights["axis"][:32] = 0, (1, 0, 0)
    lights["center"][32:, 2], lights["axis"][32:] = 1, (0, 0, -1)
    setting = mixed_setting()
    positions = setting.positions[:64].copy()
    positions[:32, 0] = 0
    positions[32:, 2] = 1
    return Setting(lights, positions, setting.normals[:64])


def _below_horizon() -> Iterator[Finding]:
    """Nothing is chosen of what a point cannot see, and all of it of what it can."""
    setting = points_setting()
    lights = setting.lights.copy()
    lights["center"][:, 2] = -1 - np.abs(lights["center"][:, 2])
    up = np.tile(np.float32([0, 0, 1]), (len(setting.positions), 1))
    positions = setting.positions.copy()
    positions[:, 2] = np.abs(positions[:, 2])
    dark = Setting(lights, positions, up)
    for description in ("culled", "exhaustive", *sampler_checks.TREES):
        sampler = dark.sampler(description)
        chosen = sampler.select(dark.positions, dark.normals, dark.numbers(4))
        yield Finding(f"{description}: lights chosen", float((chosen["prob"] > 0).sum()), 0)
    yield from sampler_checks.all_of(Setting(lights, positions, -up))


def _far(distance: float) -> Setting:
    setting = _on_lights(0.0)
    far = floats(setting.lights["center"] + np.float64(distance) * np.array([0.36, 0.48, 0.8]))
    return Setting(setting.lights, far, -mixed_setting().normals[:64])


def _normals(length: float) -> Setting:
    setting = mixed_setting()
    return Setting(setting.lights, setting.positions, floats(setting.normals * length))


def _grazing() -> Iterator[Finding]:
    """Normals at right angles to the way to a light, one ulp to either side."""
    setting = points_setting()
    way = setting.lights["center"][: len(setting.positions)] - setting.positions
    normals = np.cross(way.astype(np.float64), [0.3, 0.5, 0.81])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    for toward in (-np.inf, np.inf):
        grazing = np.nextafter(floats(normals), np.float32(toward))
        yield from sampler_checks.all_of(Setting(setting.lights, setting.positions, grazing))


def _refused() -> Iterator[Finding]:
    """They are, by name, and close ones are taken."""
    setting = mixed_setting()
    sampler = LightSampler(setting.lights, "culled")
    taken = 0
    for length in (1e-20, 0.9, 1.1, 1e20):
        try:
            sampler.select(setting.positions, floats(setting.normals * length), setting.numbers(5))
        except Error as error:
            taken += "normals[0]" not in str(error)
        else:
            taken += 1
    yield Finding("lengths that are taken", float(taken), 0)
    yield from sampler_checks.choices(_normals(1.0004))
