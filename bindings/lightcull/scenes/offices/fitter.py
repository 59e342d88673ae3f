"""Fits out rooms of the `offices` scene: single things and lamps, and workplaces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..color import from_srgb
from ..random_numbers import Chance
from .furniture import Furniture
from .lamps import Lamps, white
from .pieces import FABRICS
from .plan import DEPTH, HEIGHT, WIDTH, Room

GLOBE, DOWNLIGHT, PENDANT, BULB, SCREEN, LED = 190.0, 320.0, 85.0, 280.0, 4.0, 40.0
"""Median luminance of lamps, W/(m^2 sr)."""


@dataclass(frozen=True)
class Fitter:
    """Fits out one room."""

    room: Room
    furniture: Furniture
    lamps: Lamps
    chance: Chance

    def put(self, name: str, x: float, z: float, yaw: float = 0.0, y: float = 0.0) -> None:
        self.furniture.put(name, self.room, (x, y, z), yaw)

    def any_of(self, name: str, count: int) -> str:
        return f"{name} {int(self.chance.uniform(0, count))}"

    def light(
        self, name: str, place: tuple, color: np.ndarray, luminance: float, yaw: float = 0.0
    ) -> None:
        self.lamps.put(name, self.room.at(*place), color, luminance, self.room.yaw + yaw)

    def ceiling_lamp(self, fixture: str, name: str, x: float, z: float, luminance: float) -> None:
        """A lamp and what holds it, or that alone where it is switched off."""
        drop = {"stem": 0.19, "rod": 0.86, "ring": 0.0}[fixture]
        self.put(fixture, x, z, y=HEIGHT)
        share = {"lit": 1.0, "half": 0.35, "desk": 0.0, "dark": 0.0}[self.room.lighting]
        if self.chance.uniform() < share:
            color = white(self.room.kelvin)
            self.light(name, (x, HEIGHT - drop, z), color, self.room.level * luminance)
        elif fixture == "stem":
            self.put("unlit globe", x, z, y=HEIGHT - drop)

    def ceiling_grid(self, fixture: str, columns: int, rows: int) -> None:
        name, luminance = {"stem": ("globes", GLOBE), "ring": ("downlights", DOWNLIGHT)}[fixture]
        for x in (np.arange(columns) + 0.5) * WIDTH / columns - WIDTH / 2:
            for z in (np.arange(rows) + 0.5) * DEPTH / rows:
                self.ceiling_lamp(fixture, name, x, z, luminance)

    def workplace(self, x: float, z: float, yaw: float) -> None:
        """A desk at which one sits on the side of +z, turned by yaw."""
        cos, sin = np.cos(yaw), np.sin(yaw)

        def beside(dx: float, dz: float) -> tuple[float, float]:
            return x + cos * dx + sin * dz, z - sin * dx + cos * dz

        top = 0.74
        self.put("desk", x, z, yaw)
        turn = yaw + self.chance.uniform(-0.8, 0.8)
        chair = beside(self.chance.uniform(-0.2, 0.1), self.chance.uniform(0.55, 0.7))
        self.put(self.any_of("chair", len(FABRICS)), *chair, np.pi + turn)
        tilt = yaw + self.chance.uniform(-0.25, 0.25)
        screen = beside(-0.1, -0.12)
        self.put("monitor", *screen, tilt, top)
        self.put("keyboard", *beside(-0.1, 0.18), yaw, top)
        if self.chance.uniform() < 0.7:
            self.put("papers", *beside(0.45, 0.1), yaw, top)
        if self.room.lighting != "dark" and self.chance.uniform() < 0.65:
            sx, sz = screen
            self.light("screens", (sx, top, sz), from_srgb("#dfe8ff"), SCREEN, tilt)
        else:
            self.standby(screen[0], top + 0.147, screen[1], tilt, "#ff7a20")
        if self.chance.uniform() < 0.6:
            self.desk_lamp(*beside(-0.62, -0.2), yaw + self.chance.uniform(0.2, 0.9), top)

    def desk_lamp(self, x: float, z: float, yaw: float, y: float) -> None:
        self.put("desk lamp", x, z, yaw, y)
        on = {"lit": 0.5, "half": 0.9, "desk": 1.0, "dark": 0.0}[self.room.lighting]
        if self.chance.uniform() < on:
            place = (x + 0.22 * np.sin(yaw), y + 0.37, z + 0.22 * np.cos(yaw))
            self.light("bulbs", place, white(2700.0), BULB)

    def standby(self, x: float, y: float, z: float, yaw: float, code: str) -> None:
        """An LED on the front of what is at (x, z)."""
        place = (x + 0.004 * np.sin(yaw), y, z + 0.004 * np.cos(yaw))
        self.light("LEDs", place, from_srgb(code), LED, yaw)
