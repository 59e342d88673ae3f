"""index.html: one file that shows a comparison, and loads nothing."""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import jinja2

from . import pictures, plots
from .figures import ComparisonFigures

REFERENCE = "reference"
NARROW, THIN = "\u202f", "\u2009"


@dataclass(frozen=True)
class Column:
    """A column of a table of the page."""

    key: str
    title: str
    better: str = ""
    """"low" or "high": which value is the best; empty where none is."""
    unit: float = 1.0
    """What one in the table stands for."""


ERROR_COLUMNS = (
    Column("seconds", "time, s"),
    Column("spp", "samples / pixel", "high"),
    Column("rmse", "RMSE", "low"),
    Column("flip", "FLIP", "low"),
    Column("relmse", "relMSE", "low"),
    Column("relmse_blurred", "relMSE after 7 × 7 blur", "low"),
    Column("relmse_blurred31", "relMSE after 31 × 31 blur", "low"),
    Column("efficiency", "efficiency, 1/s", "high"),
    Column("ratio_to_uniform", "× uniform", "high"),
    Column("ratio_to_light_bvh", "× light_bvh", "high"),
    Column("ratio_to_uniform_blurred", "× uniform, blurred", "high"),
    Column("ratio_to_light_bvh_blurred", "× light_bvh, blurred", "high"),
)
COST_COLUMNS = (
    Column("setup_seconds", "set-up, s"),
    Column("ns_per_selection", "ns / selection", "low"),
    Column("selection_share", "selection, % of time", "low", 0.01),
    Column("rays_per_second", "M rays / s", "high", 1e6),
    Column("accepted_per_point", "lights accepted / point"),
    Column("nodes_per_point", "nodes / point"),
    Column("lights_tested_per_point", "lights tested / point"),
)


def render(
    figures: ComparisonFigures,
    images: dict[str, dict[str, bytes]],
    learned: dict[str, dict[str, bytes]],
    view: str,
) -> str:
    """The page.

    images: PNG files by layer ("image" or the key of an error map), then by name ("reference" or the
    sampler); learned: PNG files "cells" and "visibility" of samplers that have learned; view: what
    the images were made with.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("lightcull.report", "."),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    names, runs = list(figures.samplers), figures.samplers.items()
    return environment.get_template("comparison.html").render(
        figures=figures,
        headline=_headline(figures),
        tables=[
            {"columns": columns, "rows": _rows(figures, columns)}
            for columns in (ERROR_COLUMNS, COST_COLUMNS)
        ],
        near_floor=_near_floor(figures),
        colors=plots.sampler_colors(names),
        plot=plots.to_svg(plots.error_against_time(figures)),
        layers=[{"key": "image", "title": "Image"}, *(vars(kind) for kind in pictures.ERROR_MAPS)],
        gradient=_gradient(),
        scale=max(1, 1120 // figures.width),
        values={
            kind.key: {
                name: f"{kind.figure} {significant(getattr(run, kind.figure_key))}"
                for name, run in runs
            }
            for kind in pictures.ERROR_MAPS
        },
        learned={
            name: {what: _data_address(png) for what, png in of_sampler.items()}
            for name, of_sampler in learned.items()
        },
        unknown="rgb({}, {}, {})".format(*pictures.UNKNOWN),
        significant=significant,
        grouped=_grouped,
        view=view,
        data=_script_data(names, images, figures),
    )


def significant(value: float | None, digits: int = 3) -> str:
    """A number for people: so many significant digits, grouped, a dash for None."""
    if value is None:
        return "–"
    if value == 0:
        return "0"
    exponent = math.floor(math.log10(abs(value)))
    if exponent >= 6 or exponent < -4:
        mantissa = f"{value:.{digits - 1}e}"
        head, power = mantissa.split("e")
        return f"{head}{THIN}×{THIN}10{_superscript(int(power))}"
    decimals = max(0, digits - 1 - exponent)
    return f"{value:,.{decimals}f}".replace(",", NARROW)


def _text(value: float | None, unit: float) -> str:
    if isinstance(value, int):
        return _grouped(value)
    return significant(None if value is None else value / unit)


def _grouped(number: int) -> str:
    return f"{number:,}".replace(",", NARROW)


def _superscript(number: int) -> str:
    return str(number).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def _ranked(figures: ComparisonFigures) -> list[str]:
    """Samplers from the least to the most efficient."""
    samplers = figures.samplers
    return sorted(samplers, key=lambda name: samplers[name].efficiency or math.inf)


def _first_pair(figures: ComparisonFigures) -> tuple[str, str]:
    """What the page shows at first, left and right: the worst and the best."""
    ranked = _ranked(figures)
    return (ranked[0], ranked[-1]) if len(ranked) > 1 else (ranked[0], REFERENCE)


def _headline(figures: ComparisonFigures) -> str:
    """One sentence on who won by how much."""
    samplers = figures.samplers
    best = _ranked(figures)[-1]
    run = samplers[best]
    gains = [
        f"{significant(ratio, 2)} times {baseline}"
        for baseline in ("uniform", "light_bvh")
        if baseline != best and (ratio := getattr(run, f"ratio_to_{baseline}")) is not None
    ]
    if not gains:
        return f"{best} is the most efficient of {len(samplers)}" if len(samplers) > 1 else best
    return f"{best} is " + " and ".join(gains) + " in efficiency"


def _rows(figures: ComparisonFigures, columns: Sequence[Column]) -> list[dict[str, Any]]:
    """A row of a table for each sampler: its cells' text, and which are the best."""
    samplers = figures.samplers
    best = {}
    for column in columns:
        all_values = (getattr(run, column.key) for run in samplers.values())
        values = [value for value in all_values if value is not None]
        if column.better and len(samplers) > 1 and values:
            best[column.key] = max(values) if column.better == "high" else min(values)
    return [
        {
            "name": name,
            "cells": [
                {
                    "text": _text(getattr(run, column.key), column.unit),
                    "best": column.key in best and getattr(run, column.key) == best[column.key],
                }
                for column in columns
            ],
        }
        for name, run in samplers.items()
    ]


def _near_floor(figures: ComparisonFigures) -> list[str]:
    """Samplers whose error is not well above that of the reference."""
    floor = figures.reference.relmse_of_itself or 0.0
    return [name for name, run in figures.samplers.items() if (run.relmse or 0) < 10 * floor]


def _gradient() -> str:
    colors = pictures.palette()[:: 255 // 15]
    return ", ".join("rgb({}, {}, {})".format(*color) for color in colors)


def _data_address(png: bytes) -> str:
    return "data:image/png;base64," + base64.b64encode(png).decode("ascii")


def _script_data(
    names: list[str], images: dict[str, dict[str, bytes]], figures: ComparisonFigures
) -> str:
    """What the page's script reads. JSON in a <script> must not hold "</"."""
    encoded = {
        layer: {name: _data_address(png) for name, png in of_layer.items()}
        for layer, of_layer in images.items()
    }
    left, right = _first_pair(figures)
    data = {
        "samplers": names,
        "left": left,
        "right": right,
        "images": encoded,
        "width": figures.width,
        "height": figures.height,
    }
    return json.dumps(data).replace("</", "<\\/")
