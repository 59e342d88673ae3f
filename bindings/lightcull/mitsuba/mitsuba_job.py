"""A render by Mitsuba that goes pass by pass."""

from __future__ import annotations

import hashlib
import time
from typing import Any

import numpy as np

from .._core import Error
from ..rendering.job import SubjectJob
from ..rendering.statistics import Stats
from .host import mitsuba

_SECONDS_PER_PASS = 0.5
"""A pass is a render call, which has a set-up: it is made of as many samples as take this long, and
more where the set-up is long."""

_RGB_OF_XYZ = np.array(
    [
        [3.240479, -1.537150, -0.498535],
        [-0.969256, 1.875991, 0.041556],
        [0.055648, -0.204043, 1.057311],
    ]
)
"""ITU-R Rec. BT.709, as in Mitsuba."""
_FILM = "HDRFilm"


class MitsubaJob(SubjectJob):
    """A render that goes pass by pass, and its clock."""

    def __init__(
        self, sampler: str, scene: Any, sensor: Any, integrator: Any, seed: int, spp: int | None
    ) -> None:
        self.sampler = sampler
        self._scene, self._sensor, self._integrator = scene, sensor, integrator
        # Far from the seeds of another job with the seed next to it.
        self._seed = int.from_bytes(hashlib.blake2b(str(seed).encode(), digest_size=3).digest())
        self._asked_for = spp or 2**32
        self._sum: Any = 0.0
        self._spp = self._passes = 0
        self._pass_spp = 1
        self._seconds = 0.0

    def render_pass(self) -> None:
        spp = max(min(self._pass_spp, self._asked_for - self._spp), 1)
        start = time.perf_counter()
        seed = (self._seed << 8) + self._passes
        image = mitsuba().render(
            self._scene, sensor=self._sensor, integrator=self._integrator, spp=spp, seed=seed
        )
        pixels = _linear_rgb(np.array(image, np.float64), self._sensor.film())
        seconds = time.perf_counter() - start
        self._sum = self._sum + spp * pixels
        self._spp += spp
        self._passes += 1
        self._seconds += seconds
        if seconds < 0.5 * _SECONDS_PER_PASS:
            self._pass_spp *= 2

    def image(self) -> np.ndarray:
        mean: np.ndarray = (self._sum / self._spp).astype(np.float32)
        return mean

    def stats(self) -> Stats:
        """Of which Mitsuba tells only samples and seconds."""
        return Stats(self._spp, self._seconds)


def check_film(scene: str, film: Any) -> None:
    """Raises Error for a film of which no picture in colours or grey comes."""
    if film.class_name() != _FILM:
        raise Error(f"{scene}: its film is a {film.class_name()}, and wanted is a {_FILM}")


def _linear_rgb(channels: np.ndarray, film: Any) -> np.ndarray:
    """What a film holds, as linear RGB: (H, W, 3). Grey where that is all."""
    pixel_format = str(film.bitmap().pixel_format()).rsplit(".", 1)[-1]
    if pixel_format in ("Y", "YA"):
        return np.repeat(channels[..., :1], 3, axis=2)
    if pixel_format in ("XYZ", "XYZA"):
        return channels[..., :3] @ _RGB_OF_XYZ.T
    return channels[..., :3]
