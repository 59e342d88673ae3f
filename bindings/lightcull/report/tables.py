"""report.json and report.csv."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ..output_files import write_whole_file
from .figures import ComparisonFigures

RUN_COLUMNS = (
    "spp",
    "seconds",
    "setup_seconds",
    "ns_per_selection",
    "selection_share",
    "rays_per_second",
    "accepted_per_point",
    "nodes_per_point",
    "lights_tested_per_point",
    "rmse",
    "relmse",
    "flip",
    "relmse_blurred",
    "relmse_blurred31",
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
    """Writes a line for each sampler; a figure that there is not is an empty field."""
    columns = ("scene", "width", "height", "max_depth", "threads")
    lines: list[Sequence[Any]] = [(*columns, "sampler", *RUN_COLUMNS)]
    for name, run in figures.samplers.items():
        setting = [getattr(figures, key) for key in columns]
        lines.append([*setting, name, *(getattr(run, key) for key in RUN_COLUMNS)])
    _write_lines(path, lines)


def write_curves_csv(figures: ComparisonFigures, path: Path) -> None:
    """Writes a line for each point of each error curve."""
    lines: list[Sequence[Any]] = [("sampler", "seconds", "relmse")]
    for name, run in figures.samplers.items():
        lines.extend([name, *point] for point in run.error_curve)
    _write_lines(path, lines)


def _write_lines(path: Path, lines: Sequence[Sequence[Any]]) -> None:
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows(lines)
    write_whole_file(path, stream.getvalue().encode())
