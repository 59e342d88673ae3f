"""The figures of a comparison, worked out once for JSON, CSV, the page and the command alike.

None stands for a figure that there is not: a baseline that is not in the run, a division by 0, what a
host does not tell.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from . import metrics
from .runs import Learned, Reference, SamplerRun

_UNIFORM, _LIGHT_BVH = "uniform", "light_bvh"
"""The samplers whose efficiency divides that of the others."""


@dataclass(frozen=True)
class LearnedFigures:
    """What a sampler has learned came to, and the light whose visibility is shown."""

    cells: int
    """Cells that there are, seen or not."""
    bytes: int
    """Memory that they take."""
    light: int
    """Index of the light."""
    light_position: tuple[float, float, float]
    """Metres."""


@dataclass(frozen=True)
class SamplerFigures:
    """What one sampler came to. Errors are against the reference, as `metrics` defines them; times are
    wall time.
    """

    spp: int
    """Samples per pixel."""
    seconds: float
    """Render time, `setup_seconds` included."""
    setup_seconds: float
    """Time before the first sample: builds, pilots."""
    ns_per_selection: float | None
    """Time of a thread for one choice of a light, nanoseconds."""
    selection_share: float | None
    """The share of the passes' time that went to refits and to choosing lights, [0, 1]."""
    rays_per_second: float | None
    """Camera, shadow and scattered rays for each second of the passes."""
    accepted_per_point: float | None
    """Lights weighed with a weight above 0, mean over shading points."""
    nodes_per_point: float | None
    """Tree nodes visited, mean over shading points."""
    lights_tested_per_point: float | None
    """Lights whose range or importance was computed, mean over shading points."""
    rmse: float
    relmse: float | None
    flip: float
    """Mean HDR-FLIP, [0, 1]."""
    relmse_blurred: float | None
    """relMSE after a blur of both images by 7 x 7 pixels."""
    relmse_blurred31: float | None
    """relMSE after a blur of both images by 31 x 31 pixels."""
    efficiency: float | None
    """1 / (relMSE x seconds), 1/s."""
    error_curve: tuple[tuple[float, float | None], ...]
    """(seconds, relMSE) as the image converged."""
    learned: LearnedFigures | None = None
    """What it has learned, where that is known."""
    ratio_to_uniform: float | None = None
    """Its efficiency, divided by that of `uniform`."""
    ratio_to_light_bvh: float | None = None
    """Its efficiency, divided by that of `light_bvh`."""
    ratio_to_uniform_blurred: float | None = None
    """The same with the errors after the 7 x 7 blur."""
    ratio_to_light_bvh_blurred: float | None = None
    """The same with the errors after the 7 x 7 blur."""


@dataclass(frozen=True)
class ReferenceFigures:
    """The image that samplers were measured against."""

    sampler: str
    """Description of the sampler, or of the samplers, that rendered it."""
    spp: int
    """Samples per pixel."""
    relmse_of_itself: float | None
    """Estimate of its own relMSE."""


@dataclass(frozen=True)
class ComparisonFigures:
    """The content of report.json. What is not said here is as in `Comparison`."""

    scene: str
    width: int
    height: int
    max_depth: int
    threads: int
    seconds: float
    command: str
    machine: dict[str, str]
    reference: ReferenceFigures
    samplers: dict[str, SamplerFigures]
    """By description."""


def figures_of_reference(reference: Reference) -> ReferenceFigures:
    """What is said of a reference."""
    return ReferenceFigures(
        reference.sampler, int(reference.spp), _finite(reference.relmse_of_itself)
    )


def figures_of_runs(
    runs: dict[str, SamplerRun], reference_image: np.ndarray
) -> dict[str, SamplerFigures]:
    """The figures of each sampler, by description.

    reference_image: float32 (H, W, 3), as the images of the runs.
    """
    alone = {name: _of_run(run, reference_image) for name, run in runs.items()}
    blurred = {name: _efficiency(run.relmse_blurred, run.seconds) for name, run in alone.items()}
    plain = {name: run.efficiency for name, run in alone.items()}
    return {
        name: replace(
            run,
            ratio_to_uniform=_ratio(plain[name], plain.get(_UNIFORM)),
            ratio_to_light_bvh=_ratio(plain[name], plain.get(_LIGHT_BVH)),
            ratio_to_uniform_blurred=_ratio(blurred[name], blurred.get(_UNIFORM)),
            ratio_to_light_bvh_blurred=_ratio(blurred[name], blurred.get(_LIGHT_BVH)),
        )
        for name, run in alone.items()
    }


def _of_run(run: SamplerRun, reference_image: np.ndarray) -> SamplerFigures:
    relmse = _finite(metrics.relmse(run.image, reference_image))
    return SamplerFigures(
        spp=int(run.spp),
        seconds=float(run.seconds),
        setup_seconds=float(run.setup_seconds),
        ns_per_selection=_ratio(1e9 * run.selection_seconds, run.selections),
        selection_share=_ratio(run.sampler_seconds, run.seconds - run.setup_seconds),
        rays_per_second=_ratio(run.rays or None, run.seconds - run.setup_seconds),
        accepted_per_point=_finite(run.accepted_per_point),
        nodes_per_point=_finite(run.nodes_per_point),
        lights_tested_per_point=_finite(run.lights_tested_per_point),
        rmse=metrics.rmse(run.image, reference_image),
        relmse=relmse,
        flip=metrics.flip(run.image, reference_image),
        relmse_blurred=_finite(metrics.relmse_blurred(run.image, reference_image)),
        relmse_blurred31=_finite(
            metrics.relmse_blurred(run.image, reference_image, metrics.WIDE_BLUR_SIZE)
        ),
        efficiency=_efficiency(relmse, run.seconds),
        error_curve=tuple((float(seconds), _finite(error)) for seconds, error in run.curve),
        learned=_of_learned(run.learned),
    )


def _of_learned(learned: Learned | None) -> LearnedFigures | None:
    if learned is None:
        return None
    x, y, z = (float(coordinate) for coordinate in learned.light_position)
    return LearnedFigures(
        int(learned.cell_count), int(learned.memory_size), int(learned.light), (x, y, z)
    )


def _efficiency(error: float | None, seconds: float) -> float | None:
    return None if error is None else _finite(metrics.efficiency(error, seconds))


def _ratio(above: float | None, below: float | None) -> float | None:
    if above is None or below is None or below <= 0:
        return None
    return _finite(above / below)


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
