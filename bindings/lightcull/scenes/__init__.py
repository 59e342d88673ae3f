"""Example scenes, made by code: `build(name)` for a name in `NAMES`."""

from __future__ import annotations

import difflib
from collections.abc import Callable

from .._core import Error
from ..scene import Scene
from . import city, cornell, embers, lanterns, million, offices

_FILL: dict[str, Callable[..., None]] = {
    "lanterns": lanterns.fill,
    "city": city.fill,
    "embers": embers.fill,
    "cornell": cornell.fill,
    "million": million.fill,
    "offices": offices.fill,
}

NAMES = {
    "lanterns": "a courtyard with columns and 2,736 lanterns: 54,720 triangle lights",
    "city": "a street at night: windows, shops, signs and lamps, most of them out of sight",
    "embers": "250,000 embers blown over a glossy floor, powers over six decades",
    "cornell": "the Cornell box under a square lamp: 2 triangle lights",
    "million": "snowy hills planted with 51,200 glowing bulbs: 1,024,000 triangle lights",
    "offices": "144 offices at night, seen from one of them: most lamps are behind walls",
}
"""The example scenes, and what each shows."""


def build(name: str, **options: int) -> Scene:
    """Builds an example scene, the same in every call.

    options: of `lanterns`, how many `lights`; see there. Raises lightcull.Error for a name that is
    not in `NAMES`.
    """
    if name not in NAMES:
        near = difflib.get_close_matches(name, NAMES, n=1, cutoff=0.0)[0]
        raise Error(
            f"no example scene {name!r}; did you mean {near!r}? There are: {', '.join(NAMES)}"
        )
    scene = Scene(name)
    _FILL[name](scene, **options)
    return scene
