"""What the tests of the package share."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

# FLIP's threads wait busily for each other: where other tests are at work, that takes far longer than
# its work. It is read when the package is loaded.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import lightcull  # noqa: E402

QUAD = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)


def square(half: float, y: float, *, facing_up: bool) -> np.ndarray:
    """Corners of a horizontal square about the y axis, float32 (4, 3)."""
    corners = np.array(
        [[-half, y, -half], [-half, y, half], [half, y, half], [half, y, -half]], np.float32
    )
    return corners if facing_up else np.ascontiguousarray(corners[::-1])


def make_room(lamps: int = 3) -> lightcull.Scene:
    """A floor under a row of square lamps, each of two triangles, seen from the side."""
    scene = lightcull.Scene("room")
    scene.add_mesh(square(4, 0, facing_up=True), QUAD, name="floor")
    for i in range(lamps):
        lamp = square(0.3, 2, facing_up=False) + np.float32([2 * i - lamps + 1, 0, 0])
        scene.add_light_mesh(lamp, QUAD, radiance=(4 + i, 4, 3), name=f"lamp {i}")
    scene.set_camera(origin=(0, 3, 6), target=(0, 0.5, 0))
    return scene


@pytest.fixture
def room() -> lightcull.Scene:
    return make_room()


@pytest.fixture(scope="session", autouse=True)
def _cache(tmp_path_factory: pytest.TempPathFactory) -> None:
    """References go where they do not outlive the tests."""
    os.environ["XDG_CACHE_HOME"] = str(tmp_path_factory.mktemp("cache"))


@pytest.fixture
def command(tmp_path: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Runs the command line in a folder of its own."""

    def run(*arguments: str, program: tuple[str, ...] = ("-m", "lightcull")):
        return subprocess.run(
            [sys.executable, *program, *arguments],
            cwd=tmp_path,
            env={**os.environ, "COLUMNS": "100"},
            capture_output=True,
            text=True,
            timeout=300,
            # Where the tests run in the background, Ctrl-C may be ignored; not in the child.
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        )

    return run


@dataclass(frozen=True)
class Outcome:
    """What a command line came to."""

    returncode: int
    stdout: str
    stderr: str


@pytest.fixture
def main_here(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., Outcome]:
    """Runs the command line in this process, which is quicker."""
    from lightcull.cli import main

    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")

    def run(*arguments: str) -> Outcome:
        capsys.readouterr()
        try:
            code = main(arguments)
        except SystemExit as exit:
            code = int(exit.code or 0)
        output = capsys.readouterr()
        return Outcome(code, output.out, output.err)

    return run
