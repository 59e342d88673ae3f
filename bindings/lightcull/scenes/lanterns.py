"""A palace of four courtyards at night, hung with 2,736 lanterns; the camera is in one of them.

Each lantern is an icosahedron of 20 lights; its power is log-normal. The same palace can be lit by
more and dimmer lanterns, or by fewer and brighter ones.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import filling, geometry, palace
from .chance import Chance
from .color import from_srgb, with_luminance
from .palace import (
    BAY,
    COLUMN_RADIUS,
    COURTS,
    DEPTH,
    HALF_LENGTH,
    HALF_WIDTH,
    STOREYS,
    places_around_courts,
)

if TYPE_CHECKING:
    from lightcull import Scene

STRINGS, PER_STRING = 2, 12
"""In each court."""
LANTERNS = 2736
LIGHTS = 20 * LANTERNS
POWER_MEDIAN, POWER_SIGMA = 1.6, 1.5
"""Of a lantern's power, in watts, and deviation of its logarithm."""
TOTAL_POWER = 14_256.5
"""What `LANTERNS` of them happen to have together, in watts: any other number gets the same."""
PAPERS = ("#ffa640", "#ff9438", "#ffbf5c", "#ff7a3a", "#ff5a36", "#ffd48a")
ODD_PAPERS = ("#ff4f86", "#58d0c0", "#9d7bff")


def fill(scene: Scene, lights: int = LIGHTS) -> None:
    """lights: a multiple of 20. Places for `LANTERNS` of them are filled in part where they are
    fewer, and are taken closer together where they are more, for lanterns that are smaller in
    proportion. The power of all together stays.
    """
    import lightcull

    if lights < 20 or lights % 20 != 0:
        raise lightcull.Error(f"lanterns: lights must be a multiple of 20, got {lights}")
    chance = Chance(2736)
    palace.add_architecture(scene, chance)
    palace.add_fountains(scene)
    crowns = palace.add_trees(scene, chance)
    _add_lanterns(scene, chance, crowns, lights // 20)
    scene.set_camera(
        origin=(8.0, 1.7, 8.6), target=(10.0, 2.95, -6.0), vertical_fov=np.radians(58.0)
    )


def _add_lanterns(scene: Scene, chance: Chance, crowns: np.ndarray, count: int) -> None:
    crowding = -(-count // LANTERNS)
    places = crowding * LANTERNS
    radii = chance.uniform(0.06, 0.11, places) / crowding
    over_court, strings = _strings(chance, crowding)
    in_bays = _in_bays(chance, crowding)
    hung = np.concatenate((over_court, in_bays))
    drop = np.zeros_like(hung)
    drop[:, 1] = np.concatenate(
        (chance.uniform(0.2, 0.5, len(over_court)), chance.uniform(0.2, 1.3, len(in_bays)))
    )
    centres = [hung - drop, _on_columns(chance, crowding)]
    centres += [_on_arches(crowding), _on_balustrade(crowding), _in_trees(chance, crowns, crowding)]
    standing = places - sum(map(len, centres))
    centres.append(_on_the_ground(chance, radii[-standing:], crowding))
    turns = chance.uniform(0, 2 * np.pi, places)

    taken = _taken(chance, places, count)
    lanterns = geometry.scatter(
        geometry.icosahedron(), np.concatenate(centres)[taken], radii[taken], turns[taken]
    )
    radiance = _radiance(chance, radii[taken])
    filling.add_lights(scene, "lanterns", lanterns, np.repeat(radiance, 20, axis=0))
    cord = filling.diffuse(scene, np.full(3, 0.03))
    filling.add(scene, "strings", geometry.tubes(strings, 0.006), cord)
    hangers = np.stack((hung, hung - drop), axis=1)[taken[taken < len(hung)]]
    filling.add(scene, "hangers", geometry.tubes(hangers, 0.003), cord)


def _taken(chance: Chance, places: int, count: int) -> np.ndarray:
    """Which of the places have a lantern: (count,) ascending."""
    if count == places:
        return np.arange(places)
    return np.sort(np.argsort(chance.uniform(shape=places), kind="stable")[:count])


def _radiance(chance: Chance, radii: np.ndarray) -> np.ndarray:
    """(N, 3) for N lanterns: log-normal power, spread over the lantern's surface."""
    count = len(radii)
    tint = chance.pick(np.array([from_srgb(code) for code in PAPERS]), count)
    odd = chance.uniform(shape=count) < 0.06
    tint[odd] = chance.pick(np.array([from_srgb(code) for code in ODD_PAPERS]), odd.sum())
    power = POWER_MEDIAN * chance.log_normal(POWER_SIGMA, count)
    if count != LANTERNS:
        power *= TOTAL_POWER / power.sum()
    # A sphere's M = pi L over its area; the icosahedron has four fifths of it.
    return with_luminance(tint, power / (np.pi * 4 * np.pi * radii**2))


def _strings(chance: Chance, crowding: int) -> tuple[np.ndarray, np.ndarray]:
    """Points that lanterns hang from (K, 3), and the strings across the courts (S, P, 3)."""
    count = STRINGS * len(COURTS)
    middle_z = np.linspace(-0.5, 0.5, STRINGS) * HALF_LENGTH
    x = np.repeat(COURTS[:, 0], STRINGS)
    z = (COURTS[:, 2:] + middle_z).ravel()
    slant = np.where(np.arange(count) % 2, 1.0, -1.0) * chance.uniform(0.5, 3.0, count)
    ends_z = np.stack((z - slant, z + slant))
    ends_y = chance.uniform(5.4, 6.8, (2, count))
    sag = chance.uniform(1.0, 2.0, count)

    def along(s: np.ndarray) -> np.ndarray:
        across = x[:, None] + HALF_WIDTH * (2 * s - 1)
        y = ends_y[0][:, None] * (1 - s) + ends_y[1][:, None] * s
        y = y - 4 * sag[:, None] * s * (1 - s)
        return np.stack((across, y, ends_z[0][:, None] * (1 - s) + ends_z[1][:, None] * s), axis=-1)

    each = PER_STRING * crowding
    places = along((np.arange(each) + 0.5) / each)
    return places.reshape(-1, 3), along(np.linspace(0, 1, 25))


def _around(chance: Chance, middle: np.ndarray, each: int, near: float, far: float) -> np.ndarray:
    """`each` points about each of (K, 3), at a level distance between near and far metres."""
    count = len(middle) * each
    angle = chance.uniform(0, 2 * np.pi, count)
    away = np.sqrt(chance.uniform(near**2, far**2, count))
    offset = np.column_stack((away * np.cos(angle), np.zeros(count), away * np.sin(angle)))
    return np.repeat(middle, each, axis=0) + offset


def _in_bays(chance: Chance, crowding: int) -> np.ndarray:
    """Points on the ceilings of the arcades."""
    middles = [places_around_courts(0.0, ceiling, -DEPTH / 2) for _, ceiling in STOREYS]
    return _around(chance, np.concatenate(middles), crowding, 0.0, 1.0)


def _on_columns(chance: Chance, crowding: int) -> np.ndarray:
    """Garlands wound around the columns of the ground floor."""
    feet = places_around_courts(-BAY / 2, 0.0, 0.0)
    each = 6 * crowding
    turn = np.tile(np.arange(each) / each, len(feet))
    angle = 2 * np.pi * 2.0 * turn + np.repeat(chance.uniform(0, 2 * np.pi, len(feet)), each)
    height = 0.55 + 2.0 * turn
    offset = 0.34 * np.column_stack((np.cos(angle), np.zeros_like(angle), np.sin(angle)))
    offset[:, 1] = height
    return np.repeat(feet, each, axis=0) + offset


def _on_arches(crowding: int) -> np.ndarray:
    """Lanterns along the edges of the arches, on the side of the court."""
    each = 4 * crowding
    angle = np.pi * (np.arange(each) + 0.5) / each
    reach = BAY / 2 - COLUMN_RADIUS + 0.16
    rows = []
    for spring in (STOREYS[0][0] + 2.9, STOREYS[1][0] + 2.1):
        for x, y in zip(reach * np.cos(angle), spring + 0.9 * reach * np.sin(angle)):
            rows.append(places_around_courts(x, y, 0.36))
    return np.concatenate(rows)


def _on_balustrade(crowding: int) -> np.ndarray:
    """Lanterns along the rail of the gallery, in swags on the side of the court."""
    x = np.linspace(-0.8, 0.8, 2 * crowding)
    heights = STOREYS[1][0] + 0.5 + 0.2 * (x / 1.2) ** 2
    return np.concatenate([places_around_courts(a, b, 0.26) for a, b in zip(x, heights)])


def _in_trees(chance: Chance, crowns: np.ndarray, crowding: int) -> np.ndarray:
    each = 4 * crowding
    out = chance.directions(each * len(crowns))
    return np.repeat(crowns, each, axis=0) + out * chance.uniform(0.75, 0.95, len(out))[:, None]


def _on_the_ground(chance: Chance, radii: np.ndarray, crowding: int) -> np.ndarray:
    """Lanterns that stand at the feet of the columns, about the fountains and along a path."""
    feet = places_around_courts(-BAY / 2, 0.0, 0.35)
    at_columns = _around(chance, feet, crowding, 0.25, 0.75)
    each = (len(radii) - len(at_columns)) // len(COURTS)
    ring = each // 3
    angle = 2 * np.pi * np.arange(ring) / ring
    about_fountain = 2.8 * np.column_stack((np.cos(angle), np.zeros(ring), np.sin(angle)))
    step = np.arange(each - ring)
    side = np.where(step % 2, 1.2, -1.2)
    away = 3.6 + (HALF_WIDTH - 4.2) * (step // 4) / (len(step) // 4)
    along_path = np.column_stack((np.where(step % 4 < 2, away, -away), np.zeros(len(step)), side))
    in_courts = [court + np.concatenate((about_fountain, along_path)) for court in COURTS]
    places = np.concatenate((at_columns, *in_courts))
    return places + np.column_stack((np.zeros(len(radii)), radii, np.zeros(len(radii))))
