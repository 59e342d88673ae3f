"""Scenes from files, and by name."""

from __future__ import annotations

import difflib
import os
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import get_args

import numpy as np

from .. import checks, scenes
from .._core import Error
from ..scene import Scene
from ..scene_source import SceneSource
from ..surroundings import AUTO, Environment, is_auto
from .completion import CameraChoice, choose_camera, complete, surround
from .gltf import LightUnit, fill_from_gltf
from .obj import fill_from_obj
from .ply import fill_from_ply
from .unsupported import Notes, UnsupportedWarning
from .usd import fill_from_usd

__all__ = ["UnsupportedWarning", "example_scene", "load", "open_scene"]

_LOADERS: dict[str, Callable[[Path, Scene, Notes], None]] = {
    ".glb": fill_from_gltf,
    ".gltf": fill_from_gltf,
    ".obj": fill_from_obj,
    ".ply": fill_from_ply,
    **dict.fromkeys((".usd", ".usda", ".usdc", ".usdz"), fill_from_usd),
}

_NONSENSE = (ArithmeticError, AttributeError, LookupError, RuntimeError, TypeError, ValueError)
"""What readers meet in files that follow their format, but say things that cannot be."""


def load(
    path: str | os.PathLike[str],
    *,
    gltf_lights: LightUnit | None = None,
    environment: Environment = AUTO,
    environment_scale: float = 1.0,
    camera: CameraChoice = None,
) -> Scene:
    """Loads a scene from a file: .glb, .gltf, .obj, .ply or, with usd-core, USD.

    core/docs/files.md says what becomes of what such files have. Photometric units of glTF are
    taken as radiometric ones: candela as W/sr, lux as W/m^2, candela per square metre as
    W/(m^2 sr), so that lights and surfaces that emit keep their proportion.

    gltf_lights: the unit of the lights of KHR_lights_punctual beside what surfaces emit. "candela"
    divides them by 683 lumens a watt: Blender's exporter has multiplied them, and not what
    surfaces emit, unless its lighting mode was changed. "watts" takes them as they are. None does
    so too, and warns where a file of Blender's has both.

    environment: what surrounds the scene: an image of latitude and longitude (a path, or float32
    (H, W, 3)), a colour (three numbers, "0.2,0.3,0.5" or "#336699"), "studio", or "none". "auto" is
    a studio (grey, with large lamps) where the file has no light, or where less than a tenth of
    what the camera sees is visible (0.01) by it, else nothing. environment_scale multiplies it.

    camera: one of the file by its name or its number from 0, a `Camera`, or a `View`, which is what
    is said of one; None: the file's first.
    Where there is none, one is placed that sees everything, or across the room if it is a room; if
    that has walls all around and no light, it has a lamp.

    What is not shown is named in one `UnsupportedWarning`, and so is what was made up.
    """
    path = Path(checks.path("path", path))
    fill = _LOADERS.get(path.suffix.lower())
    if fill is None:
        raise Error(f"{path}: wanted a name that ends in {', '.join(_LOADERS)}")
    if gltf_lights is not None:
        fill = _with_unit(path, gltf_lights)
    _check_file(path)
    scene, notes = Scene(path.stem), Notes()
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")  # what libraries say is for us
            fill(path, scene, notes)
    except Error as error:
        raise Error(f"{path}: {' '.join(str(error).split())[:300]}") from error
    except _NONSENSE as error:
        reason = f"{type(error).__name__}: {error}"
        raise Error(f"{path}: makes no sense: {' '.join(reason.split())[:300]}") from error
    except MemoryError as error:
        raise Error(f"{path}: does not fit into memory") from error
    if scene.triangle_count == 0:
        left_out = notes.left_out_text()
        raise Error(f"{path}: holds no triangles" + (f"; {left_out}" if left_out else ""))
    try:
        complete(scene, notes, environment, environment_scale, camera)
    except Error as error:
        raise Error(f"{path}: {' '.join(str(error).split())[:300]}") from error
    if message := notes.message():
        warnings.warn(f"{path}: {message}", UnsupportedWarning, stacklevel=2)
    return scene


def _with_unit(path: Path, unit: str) -> Callable[[Path, Scene, Notes], None]:
    if unit not in get_args(LightUnit):
        raise Error(f"gltf_lights: wanted {' or '.join(get_args(LightUnit))}, got {unit!r}")
    if _LOADERS[path.suffix.lower()] is not fill_from_gltf:
        raise Error(f"{path}: gltf_lights is for a .glb or .gltf")
    return partial(fill_from_gltf, unit=unit)


def _check_file(path: Path) -> None:
    try:
        if path.is_dir():
            raise Error(f"{path}: is a folder")
        if path.exists() and not path.is_file():
            raise Error(f"{path}: is not a file")
        with path.open("rb"):
            pass
    except FileNotFoundError as error:
        raise Error(f"{path}: no such file") from error
    except OSError as error:
        raise Error(f"{path}: cannot read: {error.strerror}") from error
    except ValueError as error:
        raise Error(f"{str(path)!r}: no name of a file") from error


def example_scene(name: str) -> Scene:
    """Makes one of the example scenes, which are named in `lightcull.scenes.NAMES`."""
    if checks.text("name", name) not in scenes.NAMES:
        raise Error(f"no example scene {name!r}{_did_you_mean(name)}; {_there_are()}")
    scene = scenes.build(name)
    scene.name = name
    return scene


def open_scene(
    name_or_path: str,
    *,
    gltf_lights: LightUnit | None = None,
    environment: Environment = AUTO,
    environment_scale: float = 1.0,
    camera: CameraChoice = None,
) -> Scene:
    """An example scene by its name, else a scene from a file, as `load` makes it."""
    scene = _open(name_or_path, gltf_lights, environment, environment_scale, camera)
    if isinstance(environment, str):
        name = name_or_path if name_or_path in scenes.NAMES else os.path.abspath(name_or_path)
        if os.path.isfile(environment):
            environment = os.path.abspath(environment)
        scene.source = SceneSource(
            scene.digest(), name, gltf_lights, environment, environment_scale, camera
        )
    return scene


def _open(
    name_or_path: str,
    gltf_lights: LightUnit | None,
    environment: Environment,
    environment_scale: float,
    camera: CameraChoice,
) -> Scene:
    if name_or_path in scenes.NAMES:
        if gltf_lights is not None:
            raise Error(f"{name_or_path}: gltf_lights is for a .glb or .gltf")
        scene = example_scene(name_or_path)
        choose_camera(scene, camera)
        if not is_auto(environment):
            surround(scene, environment, environment_scale)
        return scene
    path = Path(checks.path("scene", name_or_path))
    if os.path.exists(name_or_path) or path.suffix.lower() in _LOADERS:
        return load(
            name_or_path, gltf_lights=gltf_lights, environment=environment,
            environment_scale=environment_scale, camera=camera,
        )  # fmt: skip
    raise Error(
        f"{name_or_path!r} is neither a file nor an example scene"
        f"{_did_you_mean(name_or_path)}; {_there_are()}"
    )


def _did_you_mean(name: str) -> str:
    near = difflib.get_close_matches(name, scenes.NAMES, n=1, cutoff=0.5)
    return f": did you mean {near[0]!r}?" if near else ""


def _there_are() -> str:
    return f"there are {', '.join(scenes.NAMES)}"
