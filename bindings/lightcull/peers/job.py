"""A render by another renderer."""

from __future__ import annotations

import hashlib
from typing import Any, Protocol

import numpy as np

from .._core import Error
from ..rendering.job import SubjectJob
from ..rendering.settings import RenderSettings
from ..rendering.statistics import Stats

_SECONDS_PER_PASS = 0.25
"""A pass is a render call, which has a set-up: it is made of as many samples as take this long."""


class Peer(Protocol):
    """Another renderer, with a scene and settings: jobs that differ in their seed share it."""

    description: str

    def render(
        self, first: int, samples: int, seed: int
    ) -> tuple[np.ndarray, np.ndarray, float]:
        """Renders samples number `first` and so on of what a seed, below 2^31, gives.

        Returns their mean and the part of it that the camera sees of emitters directly, float32
        (H, W, 3), and the seconds that it took: of the processors, over the number of threads, so
        that it does not matter what else the machine does.
        """


def check_settings(description: str, settings: RenderSettings) -> None:
    """Throws Error for settings that no other renderer has."""
    if settings.direct_light != "mis":
        raise Error(f"{description}: direct_light is {settings.direct_light!r}: it has its own")
    if settings.hide_emitters:
        raise Error(f"{description}: hide_emitters: not for other renderers")


def mixed(*numbers: int) -> int:
    """A number below 2^31 that is another one for other numbers."""
    digest = hashlib.blake2b(repr(numbers).encode(), digest_size=4).digest()
    return int.from_bytes(digest) >> 1


class PeerJob(SubjectJob):
    """A render by another renderer that goes pass by pass."""

    def __init__(self, peer: Peer, seed: int, spp: int | None) -> None:
        self.sampler = peer.description
        self._peer = peer
        self._seed = mixed(seed)
        self._asked_for = spp or 2**30
        self._sum: Any = 0.0
        self._emission: Any = 0.0
        self._spp = 0
        self._pass_spp = 1
        self._seconds = 0.0

    def render_pass(self) -> None:
        spp = max(min(self._pass_spp, self._asked_for - self._spp), 1)
        image, emission, seconds = self._peer.render(self._spp, spp, self._seed)
        self._sum = self._sum + spp * image.astype(np.float64)
        self._emission = self._emission + spp * emission.astype(np.float64)
        self._spp += spp
        self._seconds += seconds
        if seconds < 0.5 * _SECONDS_PER_PASS:
            self._pass_spp *= 2

    def image(self) -> np.ndarray:
        return self._mean(self._sum)

    def emission(self) -> np.ndarray:
        return self._mean(self._emission)

    def lit(self) -> np.ndarray:
        return self._mean(self._sum - self._emission)

    def stats(self) -> Stats:
        return Stats(self._spp, self._seconds)

    def _mean(self, total: Any) -> np.ndarray:
        mean: np.ndarray = (total / self._spp).astype(np.float32)
        return mean
