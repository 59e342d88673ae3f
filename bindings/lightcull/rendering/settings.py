"""How an image is rendered, but for how long."""

from __future__ import annotations

from dataclasses import dataclass

from .. import checks, memory


@dataclass(frozen=True)
class RenderSettings:
    """What `render` and `compare` have in common, as they document it."""

    size: tuple[int, int]
    max_depth: int
    seed: int
    threads: int

    def __post_init__(self) -> None:
        checked = {
            "size": checks.size(self.size),
            "max_depth": checks.whole_number("max_depth", self.max_depth, 1),
            "seed": checks.whole_number("seed", self.seed, most=checks.MOST_64_BITS),
            "threads": checks.whole_number("threads", self.threads),
        }
        for name, value in checked.items():  # numbers of any kind become Python's
            object.__setattr__(self, name, value)
        memory.check_image(self.size)
