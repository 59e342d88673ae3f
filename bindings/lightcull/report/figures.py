"""The figures of a comparison, worked out once for JSON, CSV, the page and the command alike.

None stands for a figure that there is not: a baseline that is not in the run, a division by 0, what a
host does not tell.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from ..field_docs import with_field_docs
from . import intervals
from .errors import Measure, Metric
from .intervals import Interval
from .runs import Learned, Reference, SamplerRun

_BASELINES = ("uniform", "light_bvh")
"""The samplers whose efficiency divides that of the others."""


@with_field_docs
@dataclass(frozen=True)
class LearnedFigures:
    """What a sampler has learned came to, and the light whose visibility is shown."""

    cells: int
    """Cells that there are, seen or not."""
    bytes: int
    """Memory that they take."""
    light: int
    """Index of the light."""
    light_position: tuple[float, float, float] | None
    """Metres; None for a directional light."""


@with_field_docs
@dataclass(frozen=True)
class CurvePoint:
    """A point of an error curve: means over the repeats at a number of samples per pixel."""

    spp: float
    """Samples per pixel by then."""
    seconds: float
    """Render time by then, set-up included."""
    relmse: float | None
    """As `SamplerFigures.relmse`."""
    low: float | None = None
    """The lower end of its 95 % interval; None of a single run."""
    high: float | None = None
    """The upper end."""


@with_field_docs
@dataclass(frozen=True)
class MetricFigures:
    """An error by a metric that was asked for."""

    value: float | None
    """Mean over the repeats."""
    low: float | None = None
    """The lower end of its 95 % interval; None of a single run."""
    high: float | None = None
    """The upper end."""


@with_field_docs
@dataclass(frozen=True)
class SamplerFigures:
    """What one sampler came to: means over its repeats, which differ in their seeds.

    Errors are of the light that falls on surfaces, unless said: emission that the camera sees
    directly, which is the same whatever samples lights, is left out where the renderer keeps it
    apart. They are against the reference, with its own noise taken off (`metrics.squared_error`),
    unless said. Times are wall time.
    """

    repeats: int
    """Runs that these are the figures of."""
    spp: float
    """Samples per pixel."""
    seconds: float
    """Render time, `setup_seconds` included."""
    setup_seconds: float
    """Time before the first sample: builds, pilots."""
    ns_per_selection: float | None
    """Time of a thread for one choice of a light, nanoseconds."""
    selection_share: float | None
    """The share of the passes' time that went to refits and to choosing lights, [0, 1]."""
    own_seconds: float | None
    """The part of `seconds` inside the calls of a sampler of one's own; None of all others."""
    rays_per_second: float | None
    """Camera, shadow and scattered rays for each second of the passes."""
    accepted_per_point: float | None
    """Lights weighed with a weight above 0, mean over shading points."""
    nodes_per_point: float | None
    """Tree nodes visited, mean over shading points."""
    lights_tested_per_point: float | None
    """Lights whose range or importance was computed, mean over shading points."""
    rmse: float | None
    """Square root of the mean squared error."""
    relmse: float | None
    """Mean of squared error / (r^2 + 0.01 mean(r)^2): what efficiency goes by."""
    relmse_measured: float | None
    """The same with the noise of the reference in it."""
    relmse_median: float | None
    """Median over the pixels, with the noise of the reference in it."""
    relmse_trimmed: float | None
    """Mean without the worst 0.1 % of the pixels, which are the worst by relmse_measured."""
    variance: float | None
    """The part of relmse that differs from seed to seed; None of a single run."""
    bias: float | None
    """The rest of it, the relative square of what all seeds have in common: about 0, or below by
    chance, of a sampler that is right. None of a single run.
    """
    flip: float | None
    """Mean HDR-FLIP of the whole image, emission and the noise of the reference included, [0, 1]."""
    relmse_blurred: float | None
    """relMSE after a blur of both images by 7 x 7 pixels."""
    relmse_blurred31: float | None
    """relMSE after a blur of both images by 31 x 31 pixels."""
    relmse_image: float | None
    """relMSE of the whole image, emission included."""
    relmse_emission: float | None
    """The part of relmse_image that is the antialiasing of emission which the camera sees directly,
    the floor that all samplers share; None where a renderer does not keep it apart.
    """
    efficiency: float | None
    """1 / (relmse x seconds), 1/s."""
    error_curve: tuple[CurvePoint, ...]
    """The error as the image converged."""
    learned: LearnedFigures | None = None
    """What it has learned in the first run, where that is known."""
    ratio_to_uniform: float | None = None
    """Its efficiency, divided by that of `uniform`."""
    ratio_to_light_bvh: float | None = None
    """Its efficiency, divided by that of `light_bvh`."""
    ratio_to_uniform_blurred: float | None = None
    """The same with the errors after the 7 x 7 blur."""
    ratio_to_light_bvh_blurred: float | None = None
    """The same with the errors after the 7 x 7 blur."""
    metrics: dict[str, MetricFigures] = field(default_factory=dict)
    """Errors by the metrics that were asked for, by name, with the noise of the reference in them."""
    intervals: dict[str, Interval] = field(default_factory=dict)
    """95 % intervals, lower and upper end, of the figures above by name; those that are not known,
    as all of a single run, are not there.
    """


@with_field_docs
@dataclass(frozen=True)
class ReferenceFigures:
    """The image that samplers were measured against."""

    sampler: str
    """Description of the sampler, or of the samplers, that rendered it."""
    spp: int
    """Samples per pixel."""
    relmse_of_itself: float | None
    """Estimate of its own relMSE, which is taken off the errors of samplers."""


@with_field_docs
@dataclass(frozen=True)
class ComparisonFigures:
    """The content of report.json."""

    scene: str
    """Name or path of the scene."""
    width: int
    """Pixels."""
    height: int
    """Pixels."""
    max_depth: int
    """Longest path, in edges: 2 is direct light only."""
    threads: int
    """Threads that each run had."""
    seconds: float
    """Time that each run was to have."""
    command: str
    """Command line or Python call that made it; empty if not known."""
    machine: dict[str, str]
    """What ran it, for people to read."""
    measured: str
    """What errors are of: "lit", the light that falls on surfaces, emission that the camera sees
    directly being left out; or "image", all of it, where a renderer does not keep that apart.
    """
    pixels: int
    """Pixels that errors are means over: those of the mask, or all."""
    reference: ReferenceFigures
    """The image that samplers were measured against."""
    samplers: dict[str, SamplerFigures]
    """The figures of each, by name."""


def figures_of_reference(reference: Reference) -> ReferenceFigures:
    """What is said of a reference."""
    return ReferenceFigures(
        reference.sampler, int(reference.spp), _finite(reference.relmse_of_itself)
    )


def figures_of_samplers(
    samplers: Mapping[str, Sequence[SamplerRun]],
    measure: Measure,
    metrics: Mapping[str, Metric],
) -> dict[str, SamplerFigures]:
    """The figures of each sampler, by name.

    metrics: those that were asked for, by name.
    """
    tables = {name: _Table(runs, measure, metrics) for name, runs in samplers.items()}
    return {name: _with_ratios(table, tables) for name, table in tables.items()}


class _Table:
    """The figures of each run of a sampler, and what they come to together."""

    def __init__(
        self, runs: Sequence[SamplerRun], measure: Measure, metrics: Mapping[str, Metric]
    ) -> None:
        self.runs = runs
        self._measure = measure
        rows = [_costs(run) | measure.errors(run) for run in runs]
        self.columns = {name: [row[name] for row in rows] for name in rows[0]}
        self._metrics = {
            name: [measure.by(metric, run) for run in runs] for name, metric in metrics.items()
        }

    def figures(self) -> SamplerFigures:
        """All but the ratios."""
        means: dict[str, float | None] = {}
        found: dict[str, Interval] = {}
        for name, values in self.columns.items():
            means[name] = _finite(float(np.mean(values)))
            _note(found, name, None if means[name] is None else intervals.of_mean(values))
        for name, estimate in (("variance", self._measure.variance), ("bias", self._measure.bias)):
            means[name], interval = self._of_images(estimate)
            _note(found, name, interval)
        efficiency = self.efficiency("relmse")
        if efficiency is not None:
            _note(found, "efficiency", self._interval(efficiency, "relmse"))
        return SamplerFigures(
            repeats=len(self.runs),
            efficiency=efficiency,
            error_curve=_curve(self.runs),
            learned=_of_learned(self.runs[0].learned),
            metrics={name: _metric(values) for name, values in self._metrics.items()},
            intervals=found,
            **means,  # type: ignore[arg-type]  # those that cannot be None are not
        )

    def efficiency(self, error: str) -> float | None:
        """By the error of that name: None unless that is above 0."""
        mean = float(np.mean(self.columns[error])) * float(np.mean(self.columns["seconds"]))
        return _finite(1 / mean) if mean > 0 else None

    def ratio_to(self, other: _Table, error: str) -> tuple[float | None, Interval | None]:
        """Of the efficiencies, and its interval: what repeats of one number share cancels."""
        above, below = self.efficiency(error), other.efficiency(error)
        if above is None or below is None:
            return None, None
        ratio = above / below
        return ratio, intervals.of_product(ratio, self._factors(error, -1) + other._factors(error, 1))

    def _interval(self, efficiency: float, error: str) -> Interval | None:
        return intervals.of_product(efficiency, self._factors(error, -1))

    def _factors(self, error: str, power: int) -> list[tuple[Sequence[float], int]]:
        return [(self.columns[error], power), (self.columns["seconds"], power)]

    def _of_images(
        self, estimate: Callable[[Sequence[np.ndarray]], float]
    ) -> tuple[float | None, Interval | None]:
        """An estimate that takes all images together, and its interval."""
        images = [run.lit_image for run in self.runs]
        if len(images) < 2:
            return None, None
        value = _finite(estimate(images))
        if value is None:
            return None, None
        of_some = partial(_of_some, estimate, images)
        return value, intervals.by_jackknife(len(images), of_some)


def _of_some(
    estimate: Callable[[Sequence[np.ndarray]], float], images: list[np.ndarray], some: list[int]
) -> float:
    return estimate([images[i] for i in some])


def _with_ratios(table: _Table, tables: Mapping[str, _Table]) -> SamplerFigures:
    figures = table.figures()
    ratios, found = {}, dict(figures.intervals)
    for suffix, error in (("", "relmse"), ("_blurred", "relmse_blurred")):
        for baseline in _BASELINES:
            if baseline not in tables:
                continue
            name = f"ratio_to_{baseline}{suffix}"
            ratios[name], interval = table.ratio_to(tables[baseline], error)
            _note(found, name, interval)
    return replace(figures, intervals=found, **ratios)  # type: ignore[arg-type]


def _note(found: dict[str, Interval], name: str, interval: Interval | None) -> None:
    if interval is not None and all(map(math.isfinite, interval)):
        found[name] = interval


def _costs(run: SamplerRun) -> dict[str, float]:
    """What a run took, by the names of `SamplerFigures`."""
    passes = run.seconds - run.setup_seconds
    return {
        "spp": float(run.spp),
        "seconds": float(run.seconds),
        "setup_seconds": float(run.setup_seconds),
        "ns_per_selection": _quotient(1e9 * run.selection_seconds, run.selections),
        "selection_share": _quotient(run.sampler_seconds, passes),
        "own_seconds": run.own_seconds,
        "rays_per_second": _quotient(run.rays or math.nan, passes),
        "accepted_per_point": run.accepted_per_point,
        "nodes_per_point": run.nodes_per_point,
        "lights_tested_per_point": run.lights_tested_per_point,
    }


def _curve(runs: Sequence[SamplerRun]) -> tuple[CurvePoint, ...]:
    """The moments that all runs have, by samples per pixel, and the last one of each."""
    if not all(run.curve for run in runs):
        return ()
    by_spp = [{moment.spp: moment for moment in run.curve[:-1]} for run in runs]
    common = sorted(set.intersection(*(set(moments) for moments in by_spp)))
    rows = [[moments[spp] for moments in by_spp] for spp in common]
    rows.append([run.curve[-1] for run in runs])
    points = []
    for row in rows:
        errors = [moment.relmse for moment in row]
        low, high = intervals.of_mean(errors) or (None, None)
        points.append(
            CurvePoint(
                float(np.mean([moment.spp for moment in row])),
                float(np.mean([moment.seconds for moment in row])),
                _finite(float(np.mean(errors))), low, high,
            )
        )  # fmt: skip
    return tuple(points)


def _metric(values: Sequence[float]) -> MetricFigures:
    low, high = intervals.of_mean(values) or (None, None)
    return MetricFigures(_finite(float(np.mean(values))), low, high)


def _of_learned(learned: Learned | None) -> LearnedFigures | None:
    if learned is None:
        return None
    position = learned.light_position
    if position is not None:
        x, y, z = (float(coordinate) for coordinate in position)
        position = (x, y, z)
    return LearnedFigures(
        int(learned.cell_count), int(learned.memory_size), int(learned.light), position
    )


def _quotient(above: float, below: float) -> float:
    return above / below if below > 0 else math.nan


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
