"""Frames of an animation, each of which is a render of its own, of a scene that is opened for it."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from math import radians
from pathlib import Path
from typing import Any

from .. import checks
from .._core import Error
from ..camera import Triple, View
from ..loaders.reopen import reopen
from ..scene_source import SceneSource
from .budget import Budget
from .passes import run_passes
from .path_job import PathJob
from .result import RenderResult
from .settings import RenderSettings
from .subject import subject_of


def numbered(pattern: str, number: int) -> str:
    """The name of a frame: signs # are its number, with zeros before it."""
    return re.sub("#+", lambda signs: f"{number:0{len(signs[0])}}", pattern)


@dataclass(frozen=True)
class FrameSeries:
    """What frames are made of."""

    first: int
    last: int
    source: SceneSource
    """Of all frames, by a name that may have # in it; its digest says nothing."""
    cameras: dict[int, View]
    """By frame, in place of that of the source; empty: that one."""
    sampler: str | None
    """None: what is best for the scene."""
    settings: RenderSettings
    budget: Budget
    """Of a frame."""

    def render(self, number: int) -> RenderResult:
        """Renders a frame: always with the same bits, if it has samples per pixel and not seconds."""
        camera = self.cameras.get(number, self.source.camera)
        scene = reopen(replace(self.source, name=self.scene_name(number), camera=camera))
        sampler = subject_of(scene).best_sampler if self.sampler is None else self.sampler
        job = PathJob(scene, sampler, self.settings)
        interrupted = run_passes(job, self.budget, None)
        settings = self.settings
        return RenderResult(
            job.image(), job.stats(), scene.name, sampler, settings.max_depth, settings.seed,
            interrupted,
        )  # fmt: skip

    def results(self) -> Iterator[tuple[int, RenderResult]]:
        """All frames, rendered here."""
        for number in range(self.first, self.last + 1):
            yield number, self.render(number)

    def scene_name(self, number: int) -> str:
        return numbered(self.source.name, number)

    def file_hash(self, number: int) -> str:
        """Of the frame's file, so that workers know theirs to be the same; empty for an example."""
        path = Path(self.scene_name(number))
        if not path.is_file():
            return ""
        return hashlib.blake2b(path.read_bytes(), digest_size=16).hexdigest()

    def to_dict(self) -> dict[str, Any]:
        """Strings, numbers, lists and dictionaries alone."""
        cameras = {str(number): asdict(view) for number, view in self.cameras.items()}
        return {**asdict(self), "source": self.source.to_dict(), "cameras": cameras}

    @classmethod
    def from_dict(cls, plain: dict[str, Any]) -> FrameSeries:
        """What `to_dict` gave."""
        parts = {
            "source": SceneSource.from_dict(plain["source"]),
            "cameras": {int(number): View(**view) for number, view in plain["cameras"].items()},
            "settings": RenderSettings(**plain["settings"]),
            "budget": Budget(**plain["budget"]),
        }
        return cls(**{**plain, **parts})


def read_camera_path(path: str) -> dict[int, View]:
    """The cameras of a JSON file: {"1": {"from": [0, 1, 5], "to": [0, 1, 0], "fov": 40}, ...}, metres and
    degrees, "up" if need be. Throws Error if it is none.
    """
    try:
        frames = json.loads(Path(checks.path("camera path", path)).read_text(encoding="utf-8"))
        return {int(number): _view_of(entry) for number, entry in frames.items()}
    except OSError as error:
        raise Error(f"{path}: cannot read: {error.strerror}") from error
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise Error(f"{path}: is no camera path: {error}") from error


def _view_of(entry: dict[str, Any]) -> View:
    unknown = set(entry) - {"from", "to", "up", "fov"}
    if unknown:
        raise ValueError(f"{min(unknown)!r} is unknown; there are from, to, up, fov")
    origin, target = _triple(entry["from"]), _triple(entry["to"])
    up = _triple(entry["up"]) if "up" in entry else None
    fov = radians(float(entry["fov"])) if "fov" in entry else None
    return View(origin=origin, target=target, up=up, vertical_fov=fov)


def _triple(numbers: Any) -> Triple:
    x, y, z = numbers
    return float(x), float(y), float(z)
