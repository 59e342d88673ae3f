"""The samples of a render in parts, for those who want to look at more than their mean."""

from __future__ import annotations

import numpy as np

from ..rendering.job import SubjectJob
from ..report import Slice


class Slicer:
    """Keeps the samples of a render in slices of equal shares of its budget.

    A slice ends with the pass that uses its share up; a pass that uses up several ends one.
    """

    def __init__(self, budget: float, count: int) -> None:
        """count: 0 for none."""
        self._share = budget / count if count else np.inf
        self._end = self._share
        self._sum: np.ndarray | float = 0.0
        self._spp = 0
        self.found: list[Slice] = []

    def after_pass(self, job: SubjectJob, used: float) -> None:
        """Ends the slice if it is time to. used: of the budget."""
        if used >= self._end * (1 - 1e-9):
            self._take(job)
            while self._end <= used:
                self._end += self._share

    def finish(self, job: SubjectJob) -> None:
        """Takes what there is since the last slice."""
        if np.isfinite(self._share) and job.stats().spp > self._spp:
            self._take(job)

    def _take(self, job: SubjectJob) -> None:
        stats = job.stats()
        total = job.image().astype(np.float64) * stats.spp
        count = stats.spp - self._spp
        mean = np.asarray((total - self._sum) / count, np.float32)
        self.found.append(Slice(mean, count, stats.seconds))
        self._sum, self._spp = total, stats.spp
