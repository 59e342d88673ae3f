"""How the file of a scene wants to be rendered."""

from __future__ import annotations

from dataclasses import dataclass

ANY_DEPTH = 2**31 - 1
"""The max_depth of paths that only roulette ends."""


@dataclass(frozen=True)
class FileSettings:
    """What a file says of its picture and of its paths; None where it says nothing.

    `render`, `compare` and the command take it where they are told nothing else.
    """

    size: tuple[int, int] | None = None
    """Width and height, pixels."""
    max_depth: int | None = None
    """Longest path, in edges."""
    rr_depth: int | None = None
    """Edges from which Russian roulette may end a path."""
    hide_emitters: bool | None = None
    """Whether the camera sees no emitter."""
