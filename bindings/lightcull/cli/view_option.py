"""What a scene is seen by and what surrounds it, as the command line says."""

from __future__ import annotations

import argparse
from math import radians
from typing import TypedDict

from .._core import Error
from ..camera import View
from ..surroundings import AUTO, NONE


class Look(TypedDict):
    """As `open_scene` takes them."""

    environment: str
    environment_scale: float
    camera: View | None


def look_of(options: argparse.Namespace) -> Look:
    """What the options say. Raises Error for those that make no sense together."""
    if options.camera is not None and options.camera_from is not None:
        raise Error("--camera and --camera-from: only one of them")
    if options.environment_scale is not None and options.environment == NONE:
        raise Error(f"--environment-scale: not with --environment {NONE}")
    fov = None if options.fov is None else radians(options.fov)
    view = View(options.camera, options.camera_from, options.camera_to, options.camera_up, fov)
    return Look(
        environment=AUTO if options.environment is None else options.environment,
        environment_scale=options.environment_scale or 1.0,
        camera=None if view == View() else view,
    )
