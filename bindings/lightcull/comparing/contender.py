"""A sampler under test."""

from __future__ import annotations

from ..rendering.budget import Budget
from ..rendering.job import CountingJob, LearnedView
from ..report import Learned, Reference, SamplerRun
from ..report.metrics import relmse

_MOMENT_RATIO = 1.3
"""Between one moment at which the error is taken and the next."""


class Contender:
    """A sampler under test: its render, and the error so far."""

    def __init__(self, job: CountingJob, budget: Budget, reference: Reference) -> None:
        self.job = job
        self._budget = budget
        self._reference = reference
        self._curve: list[tuple[float, float]] = []
        self._next_moment = 0.0

    @property
    def used(self) -> float:
        """How much of the budget; 0 before the first pass."""
        stats = self.job.stats()
        return self._budget.used(stats) if stats.spp > 0 else 0.0

    def render_pass(self) -> None:
        """Renders a pass, and takes the error if it is time to."""
        self.job.render_pass()
        if self.job.stats().seconds >= self._next_moment:
            self._take_error()

    def finish(self) -> None:
        """Takes the error at the end."""
        if self._curve and self.job.stats().seconds > self._curve[-1][0]:
            self._take_error()

    def result(self) -> SamplerRun:
        stats, counts = self.job.stats(), self.job.mean_counts()
        return SamplerRun(
            image=self.job.image(),
            spp=stats.spp,
            seconds=stats.seconds,
            setup_seconds=stats.setup_seconds,
            selection_seconds=stats.selection_seconds,
            sampler_seconds=stats.sampler_seconds,
            selections=stats.selections,
            rays=stats.rays,
            accepted_per_point=counts.accepted,
            nodes_per_point=counts.nodes_visited,
            lights_tested_per_point=counts.lights_tested,
            curve=list(self._curve),
            learned=_learned(self.job.learned_view()),
        )

    def _take_error(self) -> None:
        seconds = self.job.stats().seconds
        self._curve.append((seconds, relmse(self.job.image(), self._reference.image)))
        self._next_moment = seconds * _MOMENT_RATIO


def _learned(view: LearnedView | None) -> Learned | None:
    if view is None:
        return None
    return Learned(
        cells=view.cells(),
        visibility=view.visibility(),
        normals=view.normals(),
        light=view.light,
        light_position=view.light_position,
        cell_count=view.cell_count,
        memory_size=view.memory_size,
    )
