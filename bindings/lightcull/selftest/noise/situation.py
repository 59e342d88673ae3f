"""What the battery measures: a situation, and what samplers make of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ...rendering.path_job import PathJob
from ...rendering.settings import RenderSettings
from ...scene import Scene


@dataclass(frozen=True)
class Estimate:
    """What a sampler made of many places in a number of passes, of one sample each."""

    places: np.ndarray
    """Means over the passes: float64 (P,)."""
    passes: np.ndarray
    """Means over the places: float64 (N,)."""


class Subject(Protocol):
    """Something whose mean is known, and that a sampler's estimates may be had of."""

    def mean(self) -> float:
        """The right mean."""

    def estimate(self, sampler: str, seed: int, passes: int, even: bool) -> Estimate:
        """One sample in each pass at each of some thousand places. even: by numbers that cover
        their ranges evenly from pass to pass; else those of the passes are independent.
        """


@dataclass(frozen=True)
class Situation:
    """A few lights that are hard, or easy, to choose from."""

    name: str
    kind: str
    make: Callable[[], Subject]


class Picture:
    """The direct light in the image of a scene."""

    _EDGE = 48  # pixels

    def __init__(self, max_depth: int = 2) -> None:
        self.scene = Scene()
        self._max_depth = max_depth

    def estimate(self, sampler: str, seed: int, passes: int, even: bool) -> Estimate:
        """The places are pixels."""
        settings = RenderSettings(
            (self._EDGE, self._EDGE), self._max_depth, seed, threads=1, even_numbers=even
        )
        job = PathJob(self.scene, sampler, settings)
        sums = []
        for number in range(1, passes + 1):
            job.render_pass()
            image = job.image()[..., 1].astype(float).ravel()
            sums.append(number * image.mean())
        return Estimate(image, np.diff(sums, prepend=0.0))
