"""A render of ours by the clock of other renderers."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..rendering.job import LearnedView, SelectionCounts, SubjectJob
from ..rendering.statistics import Stats


class ProcessorTimeJob(SubjectJob):
    """A render in this process whose time is that of its processors, over the number of threads, as
    `Peer` has it.
    """

    def __init__(self, make: Callable[[], SubjectJob], threads: int) -> None:
        """make: sets the render up. threads: a number of them, not 0."""
        self._threads = threads
        start = time.process_time()
        self._job = make()
        self._setup_seconds = (time.process_time() - start) / threads
        self._seconds = self._setup_seconds
        self.sampler = self._job.sampler

    def render_pass(self) -> None:
        start = time.process_time()
        try:
            self._job.render_pass()
        finally:
            self._seconds += (time.process_time() - start) / self._threads

    def image(self) -> np.ndarray:
        return self._job.image()

    def lit(self) -> np.ndarray | None:
        return self._job.lit()

    def emission(self) -> np.ndarray | None:
        return self._job.emission()

    def mean_counts(self) -> SelectionCounts | None:
        return self._job.mean_counts()

    def learned_view(self) -> LearnedView | None:
        return self._job.learned_view()

    def stats(self) -> Stats:
        return replace(
            self._job.stats(), seconds=self._seconds, setup_seconds=self._setup_seconds
        )
