"""The figures of a comparison, worked out once for JSON, CSV and HTML alike."""

from __future__ import annotations

import math
from typing import Any

from . import metrics
from .model import Comparison, SamplerRun

BASELINES = {"ratio_to_uniform": "uniform", "ratio_to_light_bvh": "light_bvh"}
"""Ratios of efficiency, and the sampler whose efficiency divides. With `_blurred` after the key:
the same with the error after the 7 x 7 blur."""


def compute(comparison: Comparison) -> dict[str, Any]:
    """The content of report.json: what it means is in the page's definitions.

    None stands for a figure that there is not: a baseline that is not in the run, a division by 0,
    what a host does not tell.
    """
    reference = comparison.reference
    samplers = {name: _of_run(run, reference.image) for name, run in comparison.samplers.items()}
    for suffix, error in (("", "relmse"), ("_blurred", "relmse_blurred")):
        efficiencies = {
            name: _efficiency(run[error], run["seconds"]) for name, run in samplers.items()
        }
        for name, figures in samplers.items():
            for key, baseline in BASELINES.items():
                figures[key + suffix] = _ratio(efficiencies[name], efficiencies.get(baseline))
    return {
        "scene": comparison.scene,
        "width": comparison.width,
        "height": comparison.height,
        "max_depth": comparison.max_depth,
        "threads": comparison.threads,
        "seconds": comparison.seconds,
        "command": comparison.command,
        "machine": dict(comparison.machine),
        "reference": {
            "sampler": reference.sampler,
            "spp": int(reference.spp),
            "relmse_of_itself": _finite(reference.relmse_of_itself),
        },
        "samplers": samplers,
    }


def _of_run(run: SamplerRun, reference_image: Any) -> dict[str, Any]:
    relmse = _finite(metrics.relmse(run.image, reference_image))
    return {
        "spp": int(run.spp),
        "seconds": float(run.seconds),
        "setup_seconds": float(run.setup_seconds),
        "ns_per_selection": _ratio(1e9 * run.selection_seconds, run.selections),
        "selection_share": _ratio(run.sampler_seconds, run.seconds - run.setup_seconds),
        "rays_per_second": _ratio(run.rays or None, run.seconds - run.setup_seconds),
        "accepted_per_point": _finite(run.accepted_per_point),
        "nodes_per_point": _finite(run.nodes_per_point),
        "lights_tested_per_point": _finite(run.lights_tested_per_point),
        "rmse": metrics.rmse(run.image, reference_image),
        "relmse": relmse,
        "flip": metrics.flip(run.image, reference_image),
        "relmse_blurred": _finite(metrics.relmse_blurred(run.image, reference_image)),
        "relmse_blurred31": _finite(
            metrics.relmse_blurred(run.image, reference_image, metrics.WIDE_BLUR_SIZE)
        ),
        "efficiency": _efficiency(relmse, run.seconds),
        "error_curve": [[float(seconds), _finite(error)] for seconds, error in run.curve],
    }


def _efficiency(error: float | None, seconds: float) -> float | None:
    return None if error is None else _finite(metrics.efficiency(error, seconds))


def _ratio(above: float | None, below: float | None) -> float | None:
    if above is None or below is None or below <= 0:
        return None
    return _finite(above / below)


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
