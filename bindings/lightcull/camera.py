"""The camera of a scene."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Camera:
    """A thin lens that looks from origin to target; a pinhole where aperture_radius is 0."""

    origin: tuple[float, float, float] = (0.0, 0.0, 1.0)
    """Metres."""
    target: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Metres."""
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    """Any direction but that of the view."""
    vertical_fov: float = 0.8
    """Radians, between 0 and pi."""
    aperture_radius: float = 0.0
    """Metres."""
    focus_distance: float = 1.0
    """Metres."""
