"""A sampler under test."""

from __future__ import annotations

import math

import numpy as np

from ..rendering.budget import Budget
from ..rendering.job import LearnedView, SubjectJob
from ..report import Learned, Measure, Moment, SamplerRun
from .slicer import Slicer

_MOMENT_RATIO = 1.3
"""Between the samples at which the error is taken and the next."""


class Contender:
    """A sampler under test with one seed: its render, and the error so far."""

    def __init__(
        self, name: str, job: SubjectJob, budget: Budget, measure: Measure, slices: int = 0
    ) -> None:
        """name: of the sampler, as it is shown. slices: in how many its samples are kept, too."""
        self.name = name
        self.job = job
        self._budget = budget
        self._measure = measure
        self._curve: list[Moment] = []
        self._next_spp = 0
        self._slices = Slicer(budget.total, slices)

    @property
    def used(self) -> float:
        """How much of the budget; 0 before the first pass."""
        stats = self.job.stats()
        return self._budget.used(stats) if stats.spp > 0 else 0.0

    def render_pass(self) -> None:
        """Renders a pass, and takes the error if it is time to.

        That is so after numbers of samples, not of seconds: runs with other seeds have the same.
        """
        self.job.render_pass()
        if self.job.stats().spp >= self._next_spp:
            self._take_error()
        self._slices.after_pass(self.job, self.used)

    def finish(self) -> None:
        """Takes the error at the end."""
        if self._curve and self.job.stats().spp > self._curve[-1].spp:
            self._take_error()
        self._slices.finish(self.job)

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
            accepted_per_point=math.nan if counts is None else counts.accepted,
            nodes_per_point=math.nan if counts is None else counts.nodes_visited,
            lights_tested_per_point=math.nan if counts is None else counts.lights_tested,
            lit=self.job.lit(),
            emission=self.job.emission(),
            own_seconds=stats.own_seconds,
            curve=list(self._curve),
            learned=_learned(self.job.learned_view()),
            slices=self._slices.found,
        )

    def _take_error(self) -> None:
        stats = self.job.stats()
        self._curve.append(Moment(stats.spp, stats.seconds, self._measure.relmse(_lit(self.job))))
        self._next_spp = max(math.ceil(_MOMENT_RATIO * stats.spp), stats.spp + 1)


def _lit(job: SubjectJob) -> np.ndarray:
    lit = job.lit()
    return job.image() if lit is None else lit


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
