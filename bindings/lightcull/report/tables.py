"""report.json and report.csv."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

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


def write_json(figures: dict[str, Any], path: Path) -> None:
    """Writes report.json; figures as from `figures.compute`."""
    path.write_text(json.dumps(figures, indent=2, allow_nan=False) + "\n", encoding="utf-8")


def write_csv(figures: dict[str, Any], path: Path) -> None:
    """Writes a line for each sampler; a figure that there is not is an empty field."""
    with path.open("w", newline="", encoding="utf-8") as stream:
        lines = csv.writer(stream, lineterminator="\n")
        lines.writerow(
            ("scene", "width", "height", "max_depth", "threads", "sampler", *RUN_COLUMNS)
        )
        for name, run in figures["samplers"].items():
            setting = [figures[key] for key in ("scene", "width", "height", "max_depth", "threads")]
            lines.writerow([*setting, name, *(run[key] for key in RUN_COLUMNS)])


def write_curves_csv(figures: dict[str, Any], path: Path) -> None:
    """Writes a line for each point of each error curve."""
    with path.open("w", newline="", encoding="utf-8") as stream:
        lines = csv.writer(stream, lineterminator="\n")
        lines.writerow(("sampler", "seconds", "relmse"))
        for name, run in figures["samplers"].items():
            lines.writerows([name, *point] for point in run["error_curve"])
