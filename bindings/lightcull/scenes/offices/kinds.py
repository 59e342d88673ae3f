"""How the rooms of the `offices` scene are furnished and lit, by what they are for."""

from __future__ import annotations

import numpy as np

from ..color import from_srgb
from ..random_numbers import Chance
from .fitter import DOWNLIGHT, LED, PENDANT, SCREEN, Fitter
from .furniture import Furniture
from .lamps import Lamps
from .pieces import FABRICS, SHELVES
from .plan import BANDS, DEPTH, LINING, WALL, WIDTH, Room


def furnish(room: Room, furniture: Furniture, lamps: Lamps, chance: Chance) -> None:
    fitter = Fitter(room, furniture, lamps, chance)
    _hang_door(fitter)
    if room.band in (0, BANDS - 1) and room.kind in ("office", "shared", "lounge"):
        fitter.put("window", 0.0, DEPTH, np.pi)
    {
        "office": _office,
        "shared": _shared,
        "meeting": _meeting,
        "lounge": _lounge,
        "archive": _archive,
        "servers": _servers,
    }[room.kind](fitter)


def _hang_door(fitter: Fitter) -> None:
    door = fitter.room.door
    width = "double" if door.double else "single"
    fitter.put(f"lining {width}", door.centre, 0.0)
    left, right = door.edges
    hinge = -0.012
    if door.double or door.angles[1] == 0:
        fitter.put(f"leaf {width}", left + LINING, hinge, -door.angles[0])
    if door.double or door.angles[1] > 0:
        fitter.put(f"leaf {width}", right - LINING, hinge, np.pi + door.angles[1])
    # The reader of cards, on the corridor's side.
    x = right + 0.2 if door.centre < 0 else left - 0.2
    fitter.put("reader", x, -WALL, np.pi)
    code = "#ff2a20" if door.closed else "#30ff50"
    fitter.light("LEDs", (x, 1.17, -WALL - 0.022), from_srgb(code), LED, np.pi)


def _office(fitter: Fitter) -> None:
    half, chance = WIDTH / 2, fitter.chance
    side = -1 if fitter.room.door.centre > 0 else 1
    fitter.ceiling_grid("stem", 3, 5)
    fitter.workplace(side * (half - 1.0), 2.6 + chance.uniform(-0.2, 0.3), side * -0.5 * np.pi)
    fitter.put(fitter.any_of("shelf", SHELVES), -side * (half - 0.18), 2.6, side * 0.5 * np.pi)
    fitter.put(fitter.any_of("shelf", SHELVES), -side * (half - 0.18), 3.54, side * 0.5 * np.pi)
    fitter.put("cabinet", side * 0.5, DEPTH - 0.22, np.pi)
    fitter.put("plant", -side * (half - 0.45), DEPTH - 0.45, chance.uniform(0, 6))
    fitter.put("bin", side * (half - 0.3), 1.2)
    fitter.put(fitter.any_of("picture", 2), side * half, 2.6, side * -0.5 * np.pi)


def _shared(fitter: Fitter) -> None:
    half = WIDTH / 2
    fitter.ceiling_grid("stem", 4, 6)
    for z in (1.9, 3.6):
        for side in (-1, 1):
            fitter.workplace(side * 0.95, z, 0.0)
        fitter.put("divider", -0.82, z - 0.43)
        fitter.put("divider", 0.82, z - 0.43)
    fitter.put("whiteboard", -half, 3.0, 0.5 * np.pi)
    fitter.put(fitter.any_of("shelf", SHELVES), half - 0.5, DEPTH - 0.18, np.pi)
    fitter.put("cabinet", -half + 0.5, DEPTH - 0.22, np.pi)


def _meeting(fitter: Fitter) -> None:
    half, chance = WIDTH / 2, fitter.chance
    for z in np.linspace(1.6, 3.8, 5):
        fitter.ceiling_lamp("rod", "pendants", 0.0, z, PENDANT)
    for x in (-half + 0.45, half - 0.45):
        for z in np.linspace(0.7, DEPTH - 0.7, 6):
            fitter.ceiling_lamp("ring", "downlights", x, z, 0.4 * DOWNLIGHT)
    fitter.put("table", 0.0, 2.7, 0.5 * np.pi)
    for side in (-1, 1):
        for z in (1.9, 2.7, 3.5):
            turn = side * -0.5 * np.pi + chance.uniform(-0.3, 0.3)
            x = side * (0.78 + chance.uniform(0.0, 0.2))
            fitter.put(fitter.any_of("seat", len(FABRICS)), x, z, turn)
    fitter.put("whiteboard", 0.0, DEPTH, np.pi)
    if fitter.room.lighting in ("lit", "half") and chance.uniform() < 0.5:
        fitter.light("projections", (0.0, 0.0, DEPTH), from_srgb("#dfe8ff"), SCREEN, np.pi)
    fitter.put("plant", half - 0.4, DEPTH - 0.4, chance.uniform(0, 6))
    fitter.put("papers", 0.1, 2.4, 1.5, 0.74)


def _lounge(fitter: Fitter) -> None:
    half, chance = WIDTH / 2, fitter.chance
    fitter.ceiling_grid("ring", 3, 3)
    for x, z in ((-0.6, 2.2), (0.5, 2.9), (-0.3, 3.6)):
        fitter.ceiling_lamp("rod", "pendants", x, z, PENDANT)
    fitter.put(fitter.any_of("sofa", len(FABRICS)), -half + 0.5, 2.9, 0.5 * np.pi)
    fitter.put(fitter.any_of("sofa", len(FABRICS)), 0.4, DEPTH - 0.5, np.pi)
    fitter.put("low table", 0.2, 3.0, 0.5 * np.pi)
    fitter.put("cooler", half - 0.25, 2.0, -0.5 * np.pi)
    for z in (2.7, 3.6):
        fitter.put("cabinet", half - 0.22, z, -0.5 * np.pi)
    fitter.put("plant", -half + 0.4, DEPTH - 0.45, chance.uniform(0, 6))
    fitter.put(fitter.any_of("picture", 2), -half, 2.9, 0.5 * np.pi)
    fitter.standby(half - 0.42, 0.9, 2.0, -0.5 * np.pi, "#3070ff")


def _archive(fitter: Fitter) -> None:
    fitter.ceiling_grid("ring", 2, 4)
    for z in (1.6, 2.7, 3.8):
        for x in (-1.3, -0.36, 0.58):
            fitter.put(fitter.any_of("shelf", SHELVES), x, z - 0.17, np.pi)
            fitter.put(fitter.any_of("shelf", SHELVES), x, z + 0.17)
    fitter.standby(WIDTH / 2 - 0.01, 2.2, 2.5, -0.5 * np.pi, "#30ff50")


def _servers(fitter: Fitter) -> None:
    """Two rows of racks that face each other."""
    fitter.ceiling_grid("ring", 2, 3)
    codes = np.array([from_srgb(code) for code in ("#30ff50", "#30ff50", "#3090ff", "#ffab20")])
    for side in (-1, 1):
        for z in np.arange(1.5, 4.6, 0.62):
            x = side * (WIDTH / 2 - 0.5)
            fitter.put("rack", x, z, side * -0.5 * np.pi)
            for y in np.arange(0.15, 1.85, 0.13):
                offsets = fitter.chance.uniform(-0.24, 0.24, 2)
                for dz in offsets:
                    place = (x - side * 0.462, y, z + dz)
                    color = codes[int(fitter.chance.uniform(0, len(codes)))]
                    fitter.light("LEDs", place, color, LED, side * -0.5 * np.pi)
