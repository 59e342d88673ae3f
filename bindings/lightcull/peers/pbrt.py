"""pbrt-v4, as a sampler among others, where its program is on the path."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
import warnings
import weakref
from pathlib import Path

import numpy as np

from .. import machine
from .._core import Error
from ..images import read_image
from ..rendering.settings import RenderSettings
from ..scene import Scene
from .exported import export
from .job import check_settings, mixed
from .pbrt_file import write_pbrt

PROGRAM = "pbrt"


def check(description: str) -> None:
    """Throws Error unless it describes pbrt, and that is there."""
    if description != PROGRAM:
        raise Error(f"{description}: {PROGRAM} has no options")
    if shutil.which(PROGRAM) is None:
        raise Error(f"{PROGRAM}: there is no program {PROGRAM} on the path: build pbrt-v4")


class Pbrt:
    """A scene that pbrt renders, as `Peer` has it."""

    def __init__(self, scene: Scene, description: str, settings: RenderSettings) -> None:
        check(description)
        check_settings(description, settings)
        self.description = description
        self._threads = settings.threads or machine.core_count()
        folder = tempfile.TemporaryDirectory(prefix="lightcull-pbrt-")
        weakref.finalize(self, folder.cleanup)
        self._folder = Path(folder.name)
        exported = export(scene)
        glossy = sum(material["metallic_roughness"] for material in exported.materials)
        if glossy or exported.spots:
            warnings.warn(
                f"{description}: {glossy} glossy materials and {len(exported.spots)} spots are "
                "shown by pbrt's, which differ a little: that is in its error",
                stacklevel=2,
            )
        # Emission alone is a path of one edge with the same samples of the camera.
        self._scenes = []
        for name, max_depth in (("all", settings.max_depth), ("emission", 1)):
            (self._folder / name).mkdir()
            self._scenes.append(
                write_pbrt(self._folder / name, exported, settings.size, max_depth)
            )
        self._setup_seconds = self._run(self._scenes[0], 1, 0, "--pixelbounds", "0,1,0,1")

    def render(
        self, first: int, samples: int, seed: int
    ) -> tuple[np.ndarray, np.ndarray, float]:
        """As `Peer` has it. What pbrt takes to start and to read the scene does not count."""
        seed = mixed(seed, first)
        seconds = self._run(self._scenes[0], samples, seed)
        self._run(self._scenes[1], samples, seed)
        image, emission = (read_image(scene.with_suffix(".exr")) for scene in self._scenes)
        return image, emission, max(seconds - self._setup_seconds, 0.0) / self._threads

    def _run(self, scene: Path, samples: int, seed: int, *options: str) -> float:
        """The seconds that it took, of all processors together."""
        command = [
            PROGRAM, "--quiet", "--nthreads", str(self._threads), "--spp", str(samples),
            "--seed", str(seed), "--outfile", str(scene.with_suffix(".exr")), *options, str(scene),
        ]  # fmt: skip
        log = self._folder / "log.txt"
        with log.open("w") as output:
            process = subprocess.Popen(command, stdout=output, stderr=output)
            try:
                _, status, usage = os.wait4(process.pid, 0)
            except BaseException:
                process.kill()
                process.wait()
                raise
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            lines = [line.strip() for line in log.read_text().splitlines() if line.strip()]
            raise Error(f"{PROGRAM}: it failed: {lines[-1] if lines else 'it says nothing'}")
        return usage.ru_utime + usage.ru_stime
