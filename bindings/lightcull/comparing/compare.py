"""Comparison of samplers: one scene, the same time for each."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from pathlib import Path

from .. import machine
from .._core import Error
from ..output_files import check_writable
from ..rendering.budget import Budget
from ..rendering.progress import Progress, ProgressCallback
from ..rendering.settings import RR_DEPTH, RenderSettings
from ..rendering.subject import Subject, subject_of
from ..report import Comparison, Reference, SamplerRun, write
from ..scene import Scene
from .contender import Contender
from .reference import ReferenceOrder, reference_for

SAMPLERS = (
    "uniform", "power", "light_bvh", "exhaustive", "clamped", "culled", "learned", "paper",
)  # fmt: skip
"""Names of the samplers. Only `clamped` is biased."""
DEFAULT_SAMPLERS = ("uniform", "power", "light_bvh", "culled")
"""What the best sampler of a scene is compared with."""

_TURNS = 64
"""That each sampler gets at least."""
_LONGEST_TURN = 1.0
"""Seconds."""
_TOLERANCE = 1.03
"""Longest render time over shortest."""
_PATIENCE = 2
"""How much more of the budget may be used up to get there."""
_REFERENCE_EFFORT = 8
"""Of the reference, as a multiple of what each sampler has."""
_REFERENCE_NOISE = 0.2
"""What it may add to the error of a sampler."""


def compare(
    scene: Scene | Subject,
    samplers: Sequence[str] | None = None,
    *,
    seconds: float | None = None,
    spp: int | None = None,
    size: tuple[int, int] = (320, 240),
    max_depth: int = 2,
    seed: int = 0,
    threads: int = 0,
    rr_depth: int = RR_DEPTH,
    direct_light: str = "mis",
    reference_seconds: float | None = None,
    folder: str | os.PathLike[str] | None = None,
    command: str = "",
    progress: ProgressCallback | None = None,
) -> Comparison:
    """Renders a scene by each sampler for the same `seconds` of wall time, and measures the error.

    The time of a sampler is that of its builds, refits, pilots and passes, equal within 3 %. The
    samplers take turns, so that a noisy machine is fair to all. With spp, each renders as many
    samples per pixel instead. samplers: descriptions as in `LightSampler`; None: uniform, power,
    light_bvh, culled and learned. size: width and height, pixels. max_depth: longest path, in
    edges: 2 is direct light. rr_depth, direct_light: as in `render`. threads: 0 for all.

    The reference is rendered by `learned` (by `culled` where glossy virtual lights are among the
    lights), with seeds of its own, and kept in $XDG_CACHE_HOME/lightcull (or ~/.cache/lightcull).
    reference_seconds: its wall time; without it, 8 times what each sampler has.

    What is returned has the images, what each sampler took, and as `figures` the errors, costs and
    ratios: `lightcull.report.ComparisonFigures`, which is what report.json holds.

    folder: where a report is written: index.html, report.json, report.csv and images; None: none.
    command: what the report says made it. progress: called between passes.

    Ctrl-C ends it: samplers that have an image by then are returned and reported. A Ctrl-C before
    that, while the reference is rendered, is a KeyboardInterrupt.
    """
    if isinstance(samplers, str):
        raise TypeError(f"samplers: wanted several, got {samplers!r}")
    subject = subject_of(scene)
    if samplers is None:
        samplers = (*DEFAULT_SAMPLERS, subject.best_sampler)
    if not samplers:
        raise Error("samplers: wanted one at least")
    for description in samplers:
        subject.check_sampler(description)
    if folder is not None:
        check_writable(folder)
    settings = RenderSettings(size, max_depth, seed, threads, rr_depth, direct_light)
    comparing = _Comparing(subject, samplers, settings, Budget(spp, seconds), progress)
    reference = comparing.reference(reference_seconds)
    comparing.run(reference)
    result = comparing.result(reference, command)
    if folder is not None:
        write(result, Path(folder))
    return result


class _Comparing:
    """A comparison under way."""

    def __init__(
        self,
        scene: Subject,
        samplers: Sequence[str],
        settings: RenderSettings,
        budget: Budget,
        progress: ProgressCallback | None,
    ) -> None:
        self._scene = scene
        self._samplers = tuple(dict.fromkeys(samplers))
        self._settings = settings
        self._budget = budget
        self._progress = progress
        self._contenders: list[Contender] = []
        self._interrupted = False

    def reference(self, seconds: float | None) -> Reference:
        """The reference, from the cache or rendered."""
        budget = self._budget.times(_REFERENCE_EFFORT)
        if seconds is not None:
            budget = Budget(None, seconds)
        order = ReferenceOrder(self._scene, self._settings, budget)
        samplers_left = len(self._samplers) * (self._budget.seconds or 0.0)

        def report(fraction: float, spp: int, seconds_left: float) -> None:
            if self._progress is not None:
                left = seconds_left + samplers_left
                self._progress(Progress("reference", fraction, spp, left))

        return reference_for(order, report)

    def run(self, reference: Reference) -> None:
        """Renders in turns: always the sampler that has had the least."""
        try:
            for sampler in self._samplers:
                job = self._scene.new_job(sampler, self._settings, self._budget.spp)
                self._contenders.append(Contender(job, self._budget, reference))
            while (contender := self._next()) is not None:
                self._give_turn(contender)
        except KeyboardInterrupt:
            self._interrupted = True
        for contender in self._contenders:
            contender.finish()

    def result(self, reference: Reference, command: str) -> Comparison:
        """What was found. Throws KeyboardInterrupt if no sampler has an image yet."""
        runs = {c.job.sampler: c.result() for c in self._contenders if c.used > 0}
        if not runs:
            raise KeyboardInterrupt
        _check_noise(reference, runs)
        width, height = self._settings.size
        return Comparison(
            scene=self._scene.name,
            width=width,
            height=height,
            max_depth=self._settings.max_depth,
            threads=self._settings.threads or machine.core_count(),
            seconds=self._budget.seconds or max(run.seconds for run in runs.values()),
            machine=machine.describe() | {"lights": str(self._scene.light_count)},
            reference=reference,
            samplers=runs,
            command=command,
            interrupted=self._interrupted,
        )

    def _next(self) -> Contender | None:
        """Who is to go on; nobody when all have had the same."""
        least = min(self._contenders, key=lambda c: c.used)
        if least.used < self._budget.total:
            return least
        most = max(c.used for c in self._contenders)
        if most <= _TOLERANCE * least.used:
            return None
        if least.used > _PATIENCE * self._budget.total:
            gap = most / least.used - 1
            warnings.warn(
                f"render times differ by {gap:.0%}: one pass takes too long", stacklevel=4
            )
            return None
        return least

    def _give_turn(self, contender: Contender) -> None:
        """Lets it render for a while: one pass at least."""
        until = self._end_of_turn(contender)
        while True:
            contender.render_pass()
            self._report(contender)
            if contender.used >= until:
                return

    def _end_of_turn(self, contender: Contender) -> float:
        total = self._budget.total
        if contender.used >= total:
            return max(c.used for c in self._contenders)
        turn = total / _TURNS
        if self._budget.spp is None:
            turn = min(turn, _LONGEST_TURN)
        return min(contender.used + turn, total)

    def _report(self, contender: Contender) -> None:
        if self._progress is None:
            return
        end = max(self._budget.total, *(c.used for c in self._contenders))
        left = sum(self._budget.seconds_left(c.job.stats(), end) for c in self._contenders)
        stats = contender.job.stats()
        fraction = min(contender.used / self._budget.total, 1.0)
        self._progress(Progress(contender.job.sampler, fraction, stats.spp, left))


def _check_noise(reference: Reference, runs: dict[str, SamplerRun]) -> None:
    """Warns where the reference's own noise is a good part of what is measured."""
    name, error = min(((n, run.curve[-1][1]) for n, run in runs.items()), key=lambda run: run[1])
    noise = reference.relmse_of_itself
    if noise > _REFERENCE_NOISE * (error - noise):
        warnings.warn(
            f"the noise of the reference (relMSE {noise:.2g}) is a good part of the error measured "
            f"for {name} ({error:.2g}): give the reference more time",
            stacklevel=3,
        )
