"""A render by Mitsuba that goes pass by pass."""

from __future__ import annotations

import hashlib
import time
from typing import Any

import numpy as np

from ..rendering.job import SubjectJob
from ..rendering.statistics import Stats
from .host import mitsuba

_SECONDS_PER_PASS = 0.5
"""A pass is a render call, which has a set-up: it is made of as many samples as take this long, and
more where the set-up is long."""


class MitsubaJob(SubjectJob):
    """A render that goes pass by pass, and its clock."""

    def __init__(
        self, sampler: str, scene: Any, integrator: Any, seed: int, spp: int | None
    ) -> None:
        self.sampler = sampler
        self._scene, self._integrator = scene, integrator
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
        image = mitsuba().render(self._scene, integrator=self._integrator, spp=spp, seed=seed)
        pixels = np.array(image, np.float64)[..., :3]
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
