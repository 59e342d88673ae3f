"""How light that bounces is found: by paths, or by one of the kinds of virtual lights."""

from __future__ import annotations

from .. import _core, checks

PATH = "path"
"""The method that is the path tracer."""
METHODS = (PATH, "vpl_all", "vpl_culled", "vpl_clamped", "vpl_grid")
"""Names of the methods. `vpl_clamped` is biased."""


def check_method(description: str) -> str:
    """Returns the description of a method. Raises Error if it is none."""
    if checks.text("method", description) != PATH:
        _core.check_virtual_light_method(description)
    return description
