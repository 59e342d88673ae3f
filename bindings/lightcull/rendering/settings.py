"""How an image is rendered, but for how long."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from .. import checks, memory
from .._core import Error
from ..field_docs import with_field_docs
from ..file_settings import FileSettings

DIRECT_LIGHT = ("mis", "lights", "bsdf")
SIZE, MAX_DEPTH, RR_DEPTH = (320, 240), 2, 5
"""Where neither anybody nor a file says."""


@with_field_docs
@dataclass(frozen=True)
class RenderSettings:
    """What `render` and `compare` have in common, as they document it."""

    size: tuple[int, int]
    """Width and height, pixels."""
    max_depth: int
    """Longest path, in edges: 2 is direct light."""
    seed: int
    """Of the random numbers: others make an independent image."""
    threads: int
    """The most that are used; 0: as many as there are."""
    rr_depth: int = RR_DEPTH
    """Edges from which Russian roulette may end a path."""
    direct_light: str = "mis"
    """One of DIRECT_LIGHT: lights and the BSDF are sampled (mis), or one of them alone."""
    emission_apart: bool = False
    """Whether what the camera sees of emitters directly is kept in a film of its own."""
    even_numbers: bool = True
    """Whether the random numbers of a pixel cover their ranges evenly from pass to pass, which leaves
    less error; else passes are independent, for statistics of one."""
    hide_emitters: bool = False
    """Whether the camera sees neither triangles that emit nor the environment."""

    def __post_init__(self) -> None:
        if self.direct_light not in DIRECT_LIGHT:
            raise Error(
                f"direct_light: wanted one of {', '.join(DIRECT_LIGHT)}, got {self.direct_light!r}"
            )
        checked = {
            "rr_depth": checks.whole_number("rr_depth", self.rr_depth, 1),
            "size": checks.size(self.size),
            "max_depth": checks.whole_number("max_depth", self.max_depth, 1),
            "seed": checks.whole_number("seed", self.seed, most=checks.MOST_64_BITS),
            "threads": checks.whole_number("threads", self.threads),
            "hide_emitters": bool(self.hide_emitters),
        }
        for name, value in checked.items():  # numbers of any kind become Python's
            object.__setattr__(self, name, value)
        memory.check_image(self.size)


class Wanted(NamedTuple):
    """What a file may say of how it is rendered, too; the fields are as in `RenderSettings`."""

    size: tuple[int, int]
    max_depth: int
    rr_depth: int
    hide_emitters: bool


def settings_of(
    scene: Any,
    size: tuple[int, int] | None,
    max_depth: int | None,
    rr_depth: int | None,
    hide_emitters: bool | None,
    default_depth: int = MAX_DEPTH,
) -> Wanted:
    """What is wanted: as told, else as the file of the scene says, else the defaults."""
    written = getattr(scene, "file_settings", FileSettings())
    hidden = written.hide_emitters if hide_emitters is None else hide_emitters
    return Wanted(
        next(value for value in (size, written.size, SIZE) if value is not None),
        next(value for value in (max_depth, written.max_depth, default_depth) if value is not None),
        next(value for value in (rr_depth, written.rr_depth, RR_DEPTH) if value is not None),
        bool(hidden),
    )
