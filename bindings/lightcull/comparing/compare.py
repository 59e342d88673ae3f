"""Comparison of samplers: one scene, the same time for each."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from .. import checks, machine
from .._core import Error
from ..output_files import check_writable
from ..peers.subject import SubjectWithPeers, is_peer
from ..rendering.budget import Budget
from ..rendering.chunk import CLUSTER_CHUNK
from ..rendering.cluster_access import ClusterChoice, check_cluster, connected
from ..rendering.job import SubjectJob
from ..rendering.own_sampler import SamplerChoice, check_choice
from ..rendering.progress import Progress, ProgressCallback
from ..rendering.settings import RenderSettings, settings_of
from ..rendering.subject import OwnSubject, Subject, subject_of
from ..report import Comparison, Measure, Metric, Reference, SamplerRun, write
from ..report.errors import metrics_by_name
from ..report.metrics import relmse
from ..report.write import check_names
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
"""Of the reference, as a multiple of what each run has."""
_REFERENCE_NOISE = 0.2
"""What it may add to the error of a sampler."""


def compare(
    scene: Scene | Subject,
    samplers: Sequence[str] | Mapping[str, SamplerChoice] | None = None,
    *,
    seconds: float | None = None,
    spp: int | None = None,
    repeats: int = 1,
    size: tuple[int, int] | None = None,
    max_depth: int | None = None,
    seed: int = 0,
    threads: int = 0,
    rr_depth: int | None = None,
    direct_light: str = "mis",
    hide_emitters: bool | None = None,
    reference_seconds: float | None = None,
    mask: np.ndarray | None = None,
    metrics: Sequence[str | Metric] = (),
    slices: int = 0,
    cluster: ClusterChoice | None = None,
    chunk: int | None = None,
    folder: str | os.PathLike[str] | None = None,
    command: str = "",
    progress: ProgressCallback | None = None,
) -> Comparison:
    """Renders a scene by each sampler for the same `seconds` of wall time, and measures the error.

    The time of a sampler is that of its builds, refits, pilots and passes, equal within 3 %. The
    samplers take turns, so that a noisy machine is fair to all. With spp, each renders as many
    samples per pixel instead. samplers: descriptions as in `LightSampler`; None: uniform, power,
    light_bvh, culled and learned; or by the names under which they are shown descriptions, and
    samplers of one's own: what makes an `OwnSampler` of the scene, as a class does, or a
    `SamplerLibrary`. "cycles", "cycles:light_tree=off" and "pbrt" are other renderers (see below).
    scene: a `Subject` for a whole renderer of one's own. size, max_depth, rr_depth, direct_light,
    hide_emitters: as in `render`. threads: 0 for all.

    repeats: runs of each sampler, with the seeds seed, seed + 1 and so on, each for `seconds`; all
    runs of all samplers take turns side by side, and are in memory at once. From two on there are
    95 % intervals for every figure and ratio, and variance and bias are told apart. One run says
    nothing of how sure its figures are: five are better.

    What is measured is the light that falls on surfaces: emission that the camera sees directly is
    the same whatever samples lights, is kept apart, and its error is shown beside, as the floor
    that all share. mask: bool (height, width), True for the pixels that errors are means over.

    metrics: errors that are taken besides, by name (relmse, mape, smape, flip: as published, with
    the noise of the reference in them) or as functions of an image and the reference, float32
    (height, width, 3), that give an error map or a number. slices: parts into which the samples of
    each run are kept besides, as raw images, each of an equal share of its time; 0: none.

    Other renderers show the same scene, as far as it maps, against the same reference: "cycles" is
    Cycles, in a process of its own, where Blender's module bpy can be imported, or a Python that
    $LIGHTCULL_BPY_PYTHON names can; "pbrt" is pbrt-v4 where its program is on the path. Time is then
    for all that of processors, over the number of threads, and what it takes those to start and to
    take over the scene is not counted.

    The reference is rendered by `learned` (by `culled` where glossy virtual lights are among the
    lights), with seeds of its own, and kept in $XDG_CACHE_HOME/lightcull (or ~/.cache/lightcull).
    reference_seconds: its wall time; without it, 8 times what each run has. Its own noise, known
    from its two halves, is taken off the errors.

    cluster: shares the passes of the reference out, as `render` has it, in chunks of so many; by
    "learned:rounds=32" in place of `learned`. The samplers are measured on this machine, one beside
    the other: times of different machines say nothing of each other.

    What is returned has the images, what each run took, and as `figures` the errors, costs and
    ratios: `lightcull.report.ComparisonFigures`, which is what report.json holds.

    folder: where a report is written: index.html, report.json, report.csv and images; None: none.
    command: what the report says made it. progress: called between passes.

    Ctrl-C ends it: runs that have an image by then are returned and reported. A Ctrl-C before
    that, while the reference is rendered, is a KeyboardInterrupt.
    """
    if isinstance(samplers, str):
        raise TypeError(f"samplers: wanted several, got {samplers!r}")
    subject = _subject(scene, samplers)
    if samplers is None:
        samplers = (*DEFAULT_SAMPLERS, subject.best_sampler)
    if not samplers:
        raise Error("samplers: wanted one at least")
    choices = _choices(subject, samplers)
    check_names(tuple(choices))
    if folder is not None:
        check_writable(folder)
    size, max_depth, rr_depth, hide_emitters = settings_of(
        scene, size, max_depth, rr_depth, hide_emitters
    )
    settings = RenderSettings(
        size, max_depth, seed, threads, rr_depth, direct_light,
        emission_apart=True, hide_emitters=hide_emitters,
    )  # fmt: skip
    checks.whole_number("repeats", repeats, 1)
    checks.whole_number("slices", slices)
    _check_mask(mask, settings)
    shared = _shared(subject, cluster, chunk)
    plan = _Plan(
        subject, choices, settings, Budget(spp, seconds), repeats, mask,
        metrics_by_name(metrics, settings.size), slices,
    )  # fmt: skip
    comparing = _Comparing(plan, progress)
    comparing.render_reference(reference_seconds, shared)
    comparing.run()
    result = comparing.result(command)
    if folder is not None:
        write(result, Path(folder))
    return result


def _subject(
    scene: Scene | Subject, samplers: Sequence[str] | Mapping[str, SamplerChoice] | None
) -> Subject:
    chosen = samplers.values() if isinstance(samplers, Mapping) else samplers or ()
    peers = any(isinstance(sampler, str) and is_peer(sampler) for sampler in chosen)
    return SubjectWithPeers(scene) if peers and isinstance(scene, Scene) else subject_of(scene)


def _choices(
    subject: Subject, samplers: Sequence[str] | Mapping[str, SamplerChoice]
) -> dict[str, SamplerChoice]:
    """The samplers by name, which have been found to work."""
    if not isinstance(samplers, Mapping):
        for description in samplers:
            subject.check_sampler(description)
        return {description: description for description in samplers}
    for name, choice in samplers.items():
        checks.text("sampler", name)
        check_choice(name, choice)
        if isinstance(choice, str):
            subject.check_sampler(choice)
        elif isinstance(subject, OwnSubject):
            subject.try_own(name, choice)
        else:
            raise Error(f"sampler {name!r}: samplers of one's own are for scenes of ours")
    return dict(samplers)


@dataclass(frozen=True)
class _Shared:
    """Who shares a reference, and how."""

    scene: Scene
    cluster: ClusterChoice
    chunk: int


def _shared(subject: Subject, cluster: ClusterChoice | None, chunk: int | None) -> _Shared | None:
    if cluster is None:
        if chunk is not None:
            raise Error("chunk: only with a cluster, which renders the reference")
        return None
    check_cluster(cluster)
    if not isinstance(subject, OwnSubject):
        raise Error("cluster: not for a scene of another renderer")
    size = CLUSTER_CHUNK if chunk is None else checks.whole_number("chunk", chunk, 1)
    return _Shared(subject.scene, cluster, size)


def _check_mask(mask: np.ndarray | None, settings: RenderSettings) -> None:
    if mask is None:
        return
    width, height = settings.size
    if not isinstance(mask, np.ndarray) or (mask.dtype, mask.shape) != (bool, (height, width)):
        got = f"{mask.dtype} {mask.shape}" if isinstance(mask, np.ndarray) else type(mask).__name__
        raise TypeError(f"mask: wanted a bool array of shape {(height, width)}, got {got}")
    if not mask.any():
        raise Error("mask: has no pixel that counts")


@dataclass(frozen=True)
class _Plan:
    """What is to be compared."""

    scene: Subject
    samplers: dict[str, SamplerChoice]
    settings: RenderSettings
    budget: Budget
    """Of a run."""
    repeats: int
    mask: np.ndarray | None
    metrics: dict[str, Metric]
    slices: int

    def new_job(self, name: str, repeat: int) -> SubjectJob:
        seed = (self.settings.seed + repeat) % (checks.MOST_64_BITS + 1)
        settings, choice = replace(self.settings, seed=seed), self.samplers[name]
        if isinstance(choice, str):
            return self.scene.new_job(choice, settings, self.budget.spp)
        assert isinstance(self.scene, OwnSubject)  # as _choices() has seen
        return self.scene.new_own_job(name, choice, settings)


class _Comparing:
    """A comparison under way."""

    def __init__(self, plan: _Plan, progress: ProgressCallback | None) -> None:
        self._plan = plan
        self._budget = plan.budget
        self._progress = progress
        self._reference: Reference
        self._contenders: list[Contender] = []
        self._interrupted = False

    def render_reference(self, seconds: float | None, shared: _Shared | None) -> None:
        """The reference, from the cache or rendered, here or by those who share it."""
        plan = self._plan
        budget = self._budget.times(_REFERENCE_EFFORT)
        if seconds is not None:
            budget = Budget(None, seconds)
        runs_left = len(plan.samplers) * plan.repeats * (self._budget.seconds or 0.0)

        def report(fraction: float, spp: int, seconds_left: float) -> None:
            if self._progress is not None:
                left = seconds_left + runs_left
                self._progress(Progress("reference", fraction, spp, left))

        if shared is None:
            order = ReferenceOrder(plan.scene, plan.settings, budget)
            self._reference = reference_for(order, report)
            return
        with connected(shared.cluster) as client, ExitStack() as jobs:
            # Here, because importing it wants Dask, which is optional.
            from ..rendering.cluster.cluster_subject import ClusterSubject

            subject = ClusterSubject(client, shared.scene, shared.chunk, jobs)
            order = ReferenceOrder(subject, plan.settings, budget, shared.chunk)
            self._reference = reference_for(order, report)

    def run(self) -> None:
        """Renders in turns: always the run that has had the least."""
        plan = self._plan
        measure = Measure(self._reference, plan.mask)
        try:
            for repeat in range(plan.repeats):
                for name in plan.samplers:
                    job = plan.new_job(name, repeat)
                    self._contenders.append(
                        Contender(name, job, self._budget, measure, plan.slices)
                    )
            while (contender := self._next()) is not None:
                self._give_turn(contender)
        except KeyboardInterrupt:
            self._interrupted = True
        for contender in self._contenders:
            contender.finish()

    def result(self, command: str) -> Comparison:
        """What was found. Throws KeyboardInterrupt if no run has an image yet."""
        runs: dict[str, list[SamplerRun]] = {}
        for contender in self._contenders:
            if contender.used > 0:
                runs.setdefault(contender.name, []).append(contender.result())
        if not runs:
            raise KeyboardInterrupt
        plan, settings = self._plan, self._plan.settings
        width, height = settings.size
        comparison = Comparison(
            scene=plan.scene.name,
            width=width,
            height=height,
            max_depth=settings.max_depth,
            threads=settings.threads or machine.core_count(),
            seconds=self._budget.seconds or max(r.seconds for of in runs.values() for r in of),
            machine=machine.describe() | {"lights": str(plan.scene.light_count)},
            reference=self._reference,
            samplers={name: tuple(of_sampler) for name, of_sampler in runs.items()},
            command=command,
            interrupted=self._interrupted,
            mask=plan.mask,
            metrics=plan.metrics,
        )
        _check_noise(comparison)
        return comparison

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
        runs = [c for c in self._contenders if c.name == contender.name]
        done = sum(min(c.used / self._budget.total, 1.0) for c in runs) / len(runs)
        self._progress(Progress(contender.name, done, contender.job.stats().spp, left))


def _check_noise(comparison: Comparison) -> None:
    """Warns where the reference's own noise is a good part of what is measured."""
    reference = comparison.reference.lit_image
    errors = {
        name: relmse(runs[0].lit_image, reference)
        for name, runs in comparison.samplers.items()
    }
    name = min(errors, key=lambda name: errors[name])
    noise = comparison.reference.relmse_of_itself
    if noise > _REFERENCE_NOISE * (errors[name] - noise):
        warnings.warn(
            f"the noise of the reference (relMSE {noise:.2g}) is a good part of the error measured "
            f"for {name} ({errors[name]:.2g}): it is taken off, but give the reference more time",
            stacklevel=4,
        )
