"""Lamps and things in the corridors and the passage of the `offices` scene."""

from __future__ import annotations

import numpy as np

from ..color import from_srgb
from ..random_numbers import Chance
from . import plan
from .furniture import Furniture
from .lamps import Lamps, white
from .plan import CORRIDOR, HALF_LENGTH, HEIGHT

GLOBE, SIGN = 210.0, 7.0
"""Median luminance, W/(m^2 sr)."""
SPACING = 1.25
"""Of the lamps, metres."""
BROKEN = 0.12
"""Share of the lamps that are out."""


def furnish(furniture: Furniture, lamps: Lamps, chance: Chance) -> None:
    for corridor in range(plan.CORRIDORS):
        z = plan.corridor_z(corridor)
        kelvin, level = chance.uniform(2900.0, 4300.0), chance.log_normal(0.4)
        for x in np.arange(-HALF_LENGTH + 0.7, HALF_LENGTH, SPACING):
            _lamp(furniture, lamps, chance, (x, HEIGHT, z), kelvin, level)
        for x in (-HALF_LENGTH + 1.5, -2.2, 2.2, HALF_LENGTH - 1.5):
            _sign(furniture, lamps, (x, HEIGHT, z), 0.5 * np.pi)
        _things(furniture, chance, z)
    for corridor in range(plan.CORRIDORS - 1):
        (_, _, low), (_, _, high) = plan.passage_bounds(corridor)
        kelvin, level = chance.uniform(2900.0, 4300.0), chance.log_normal(0.4)
        for z in np.arange(low + 0.8, high, SPACING):
            _lamp(furniture, lamps, chance, (0.0, HEIGHT, z), kelvin, level)


def _lamp(
    furniture: Furniture, lamps: Lamps, chance: Chance, top: tuple, kelvin: float, level: float
) -> None:
    """top: where it hangs from."""
    place = np.array(top)
    furniture.put_in_world("stem", place)
    globe = place - (0.0, 0.19, 0.0)
    if chance.uniform() < BROKEN:
        furniture.put_in_world("unlit globe", globe)
    else:
        lamps.put("globes", globe, white(kelvin), level * GLOBE)


def _sign(furniture: Furniture, lamps: Lamps, place: tuple, yaw: float) -> None:
    """A sign to the exit, hung across the corridor."""
    furniture.put_in_world("stem", np.array(place), yaw)
    lamps.put("signs", np.array(place) - (0.0, 0.23, 0.0), from_srgb("#20e070"), SIGN, yaw)


def _things(furniture: Furniture, chance: Chance, z: float) -> None:
    """Between the doors, at the walls between two rooms."""
    for column in range(plan.COLUMNS - 1):
        for side in (-1, 1):
            x = plan.column_x(column) + plan.COLUMN_PITCH / 2
            if column == plan.COLUMNS // 2 - 1:
                continue
            name, out = (
                ("copier", 0.34), ("plant", 0.4), ("cabinet", 0.22), ("cooler", 0.18),
                ("extinguisher", 0.08), ("picture 0", 0.0), ("picture 1", 0.0),
            )[int(chance.uniform(0, 7))]  # fmt: skip
            yaw = 0.0 if side < 0 else np.pi
            place = np.array((x, 0.0, z + side * (CORRIDOR / 2 - out)))
            furniture.put_in_world(name, place, yaw)
