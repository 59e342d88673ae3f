"""How long a render goes on."""

from __future__ import annotations

from dataclasses import dataclass

from .. import checks
from .._core import Error
from .statistics import Stats


@dataclass(frozen=True)
class Budget:
    """When a render is done: after `spp` samples per pixel, or else after `seconds`."""

    spp: int | None
    seconds: float | None

    def __post_init__(self) -> None:
        if (self.spp is None) == (self.seconds is None):
            raise Error("give either seconds=... or spp=...")
        if (
            self.spp is not None
            and checks.whole_number("spp", self.spp, 0, checks.MOST_64_BITS) < 1
        ):
            raise Error(f"spp: wanted at least 1, got {self.spp}")
        if self.seconds is not None and not checks.number("seconds", self.seconds) > 0:
            raise Error(f"seconds: wanted more than 0, got {self.seconds}")

    @property
    def total(self) -> float:
        """In samples per pixel or in seconds, as `used` is."""
        return float(self.spp or self.seconds or 0.0)

    def times(self, factor: float) -> Budget:
        """So many times as much."""
        if self.spp is not None:
            return Budget(max(round(factor * self.spp), 1), None)
        return Budget(None, factor * self.total)

    def used(self, stats: Stats) -> float:
        """How much of the total a render has had."""
        return float(stats.spp) if self.spp is not None else stats.seconds

    def is_used(self, stats: Stats) -> bool:
        """Whether a render is done. It has one sample at least."""
        return stats.spp > 0 and self.used(stats) >= self.total

    def fraction(self, stats: Stats) -> float:
        """How much of it is used, [0, 1]."""
        return min(self.used(stats) / self.total, 1.0)

    def seconds_left(self, stats: Stats, until: float | None = None) -> float:
        """Estimated wall time until the total, or `until`, is used."""
        left = max((until or self.total) - self.used(stats), 0.0)
        if self.spp is None:
            return left
        return left * stats.seconds / max(stats.spp, 1)

    def seconds_needed(self, stats: Stats) -> float:
        """Estimated wall time of it all, for another render like this."""
        if self.seconds is not None:
            return self.seconds
        return self.total * stats.seconds / max(stats.spp, 1)
