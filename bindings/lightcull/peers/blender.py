"""Blender in a process of its own: it is large, and wants a Python of its own choice."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import weakref
from contextlib import suppress
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from .. import _core
from .._core import Error
from ..images import write_exr
from ..rendering.settings import RenderSettings
from .exported import Exported

_WORKER = Path(__file__).with_name("blender_worker.py")
_ANSWER = "lightcull-answer: "
"""As the worker has it, which can import nothing of ours."""
_PYTHON = "LIGHTCULL_BPY_PYTHON"
"""Names the Python that has bpy, which is made for one version of Python; else it is this one."""

MOST_MATERIALS = 16384
"""More surfaces than these get their radiance from an attribute, which Cycles knows less of."""


def check_blender() -> None:
    """Throws Error where there is no Blender."""
    python = os.environ.get(_PYTHON, sys.executable)
    if not _has_bpy(python):
        raise Error(
            f"cycles: {python} has no module bpy: pip install bpy, or name a Python that has it "
            f"by ${_PYTHON}"
        )


@cache
def _has_bpy(python: str) -> bool:
    find = "import importlib.util as u, sys; sys.exit(u.find_spec('bpy') is None)"
    try:
        return subprocess.run([python, "-c", find], capture_output=True).returncode == 0
    except OSError:
        return False


class Blender:
    """A scene in Blender, rendered by Cycles."""

    def __init__(
        self, scene: Exported, settings: RenderSettings, threads: int, light_tree: bool
    ) -> None:
        """threads: a number of them, not 0."""
        check_blender()
        folder = tempfile.TemporaryDirectory(prefix="lightcull-cycles-")
        weakref.finalize(self, folder.cleanup)
        self._folder = Path(folder.name)
        self._log = (self._folder / "log.txt").open("w+")
        about = {
            "size": settings.size,
            "max_depth": settings.max_depth,
            "threads": threads,
            "light_tree": light_tree,
            "most_materials": MOST_MATERIALS,
        }
        _write(self._folder, scene, about)
        self._process = subprocess.Popen(
            # -P: modules next to the worker are not for Blender, which has a "cycles", too.
            [os.environ.get(_PYTHON, sys.executable), "-P", str(_WORKER), str(self._folder)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log,
            text=True,
            start_new_session=True,  # Ctrl-C is not for it
            env={k: v for k, v in os.environ.items() if k != "PYTHONPATH"},
        )
        self._end = weakref.finalize(self, _end, self._process, self._log)
        self._read_answer()

    def render(
        self, first: int, samples: int, seed: int
    ) -> tuple[np.ndarray, np.ndarray, float]:
        """As `Peer` has it, with the seconds of all processors together."""
        path = str(self._folder / "image.exr")
        if not self._end.alive:
            raise Error("cycles: Blender was ended")
        try:
            order = {"first": first, "samples": samples, "seed": seed, "path": path}
            assert self._process.stdin is not None
            self._process.stdin.write(json.dumps(order) + "\n")
            self._process.stdin.flush()
            answer = self._read_answer()
        except BrokenPipeError:
            self._fail()
        except KeyboardInterrupt:  # no answer would be that to the next question
            self._end()
            raise
        emitters, environment = (_core.read_layer(path, layer) for layer in answer["emission"])
        return _core.read_layer(path, "Combined"), emitters + environment, answer["seconds"]

    def _read_answer(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            if line.startswith(_ANSWER):
                answer: dict[str, Any] = json.loads(line.removeprefix(_ANSWER))
                return answer
        self._fail()

    def _fail(self) -> NoReturn:
        self._process.wait()
        self._log.seek(0)
        lines = [line.strip() for line in self._log if line.strip()]
        raise Error(f"cycles: Blender failed: {lines[-1] if lines else 'it says nothing'}")


def _end(process: Any, log: Any) -> None:
    process.kill()
    process.wait()
    for stream in (process.stdin, process.stdout, log):
        with suppress(BrokenPipeError):
            stream.close()


def _write(folder: Path, scene: Exported, settings: dict[str, Any]) -> None:
    names = ("positions", "normals", "uvs", "indices", "smooth", "surface")
    np.savez(folder / "arrays.npz", **{name: getattr(scene, name) for name in names})
    for index, texture in enumerate(scene.textures):
        write_exr(folder / f"texture{index}.exr", texture)
    about = {
        "settings": settings,
        "surfaces": [asdict(surface) for surface in scene.surfaces],
        "materials": scene.materials,
        "points": scene.points,
        "spots": scene.spots,
        "directional_lights": scene.directional_lights,
        "environment": _environment(folder, scene.environment),
        "camera": asdict(scene.camera),
    }
    (folder / "scene.json").write_text(json.dumps(about))


def _environment(folder: Path, environment: dict[str, Any] | None) -> dict[str, Any] | None:
    if environment is None:
        return None
    texels, scale = environment["map"], environment["scale"]
    constant = None
    if texels.shape[:2] == (1, 1):
        constant = [float(c) for c in texels[0, 0] * np.float32(scale)]
    else:
        write_exr(folder / "environment.exr", texels)
    return {"constant": constant, "scale": scale, "rotation": environment["rotation"]}
