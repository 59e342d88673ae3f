"""report.json and report.csv."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import asdict, astuple, fields
from pathlib import Path
from typing import Any

from ..output_files import write_whole_file
from .figures import ComparisonFigures, CurvePoint, SamplerFigures

RUN_COLUMNS = (
    "repeats",
    "spp",
    "seconds",
    "setup_seconds",
    "ns_per_selection",
    "selection_share",
    "own_seconds",
    "rays_per_second",
    "accepted_per_point",
    "nodes_per_point",
    "lights_tested_per_point",
    "rmse",
    "relmse",
    "relmse_measured",
    "relmse_median",
    "relmse_trimmed",
    "variance",
    "bias",
    "flip",
    "relmse_blurred",
    "relmse_blurred31",
    "relmse_image",
    "relmse_emission",
    "efficiency",
    "ratio_to_uniform",
    "ratio_to_light_bvh",
    "ratio_to_uniform_blurred",
    "ratio_to_light_bvh_blurred",
)
"""Columns of report.csv that hold figures of a sampler, by their keys in report.json."""


def write_json(figures: ComparisonFigures, path: Path) -> None:
    """Writes report.json."""
    text = json.dumps(asdict(figures), indent=2, allow_nan=False)
    write_whole_file(path, (text + "\n").encode())


def write_csv(figures: ComparisonFigures, path: Path) -> None:
    """Writes a line for each sampler; a figure that there is not is an empty field.

    A figure whose 95 % interval is known for some sampler is followed by its ends, as in relmse,
    relmse_low, relmse_high. Metrics that were asked for are metric_NAME.
    """
    columns = ("scene", "width", "height", "max_depth", "threads", "measured")
    rows = {name: _row(run) for name, run in figures.samplers.items()}
    present = {key for row in rows.values() for key in row}
    metrics = dict.fromkeys(name for run in figures.samplers.values() for name in run.metrics)
    shown = (*RUN_COLUMNS, *(f"metric_{name}" for name in metrics))
    keys = [k for key in shown for k in (key, f"{key}_low", f"{key}_high") if k in present]
    lines: list[Sequence[Any]] = [(*columns, "sampler", *keys)]
    for name, row in rows.items():
        setting = [getattr(figures, key) for key in columns]
        lines.append([*setting, name, *(row.get(key) for key in keys)])
    write_lines(path, lines)


def _row(run: SamplerFigures) -> dict[str, Any]:
    """The figures of a sampler, and the ends of their intervals where they are known."""
    row = {key: getattr(run, key) for key in RUN_COLUMNS}
    for key, (low, high) in run.intervals.items():
        row |= {f"{key}_low": low, f"{key}_high": high}
    for name, metric in run.metrics.items():
        row[f"metric_{name}"] = metric.value
        if metric.low is not None:
            row |= {f"metric_{name}_low": metric.low, f"metric_{name}_high": metric.high}
    return row


def write_curves_csv(figures: ComparisonFigures, path: Path) -> None:
    """Writes a line for each point of each error curve."""
    lines: list[Sequence[Any]] = [("sampler", *(field.name for field in fields(CurvePoint)))]
    for name, run in figures.samplers.items():
        lines.extend([name, *astuple(point)] for point in run.error_curve)
    write_lines(path, lines)


def write_lines(path: Path, lines: Sequence[Sequence[Any]]) -> None:
    """Writes a CSV file; None is an empty field."""
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows(lines)
    write_whole_file(path, stream.getvalue().encode())
