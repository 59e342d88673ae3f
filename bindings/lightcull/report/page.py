"""index.html: one file that shows a comparison, and loads nothing."""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from . import pictures, plots
from .errors import METRICS
from .figures import ComparisonFigures, SamplerFigures
from .intervals import Interval

REFERENCE = "reference"
_FLOORS_ABOVE = 2
"""Noises of the reference that an error that is sure of itself is large."""
_NAMED = 2
"""Samplers that a headline names besides the best, at most."""
_METRIC = "metric "
"""Before the name of a metric that was asked for, as the key of its column."""
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
    Column("spp", "samples / pixel", "high"),
    Column("relmse", "relMSE", "low"),
    Column("efficiency", "efficiency, 1/s", "high"),
    Column("ratio_to_uniform", "× uniform", "high"),
    Column("ratio_to_light_bvh", "× light_bvh", "high"),
    Column("relmse_blurred", "relMSE after 7 × 7 blur", "low"),
    Column("ratio_to_uniform_blurred", "× uniform, blurred", "high"),
    Column("ratio_to_light_bvh_blurred", "× light_bvh, blurred", "high"),
    Column("relmse_blurred31", "relMSE after 31 × 31 blur", "low"),
)
DETAIL_COLUMNS = (
    Column("relmse_measured", "relMSE, noise of the reference in it", "low"),
    Column("relmse_median", "median", "low"),
    Column("relmse_trimmed", "relMSE without the worst 0.1 % of pixels", "low"),
    Column("variance", "variance", "low"),
    Column("bias", "bias, squared"),
    Column("relmse_image", "relMSE of the whole image", "low"),
    Column("relmse_emission", "of it lamps seen directly"),
    Column("rmse", "RMSE", "low"),
    Column("flip", "FLIP of the whole image", "low"),
)
COST_COLUMNS = (
    Column("seconds", "time, s"),
    Column("setup_seconds", "set-up, s"),
    Column("ns_per_selection", "ns / selection", "low"),
    Column("selection_share", "selection, % of time", "low", 0.01),
    Column("own_seconds", "in calls of one’s own, s"),
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
    import jinja2

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
            {"title": title, "columns": columns, "rows": _rows(figures, columns)}
            for title, columns in (
                ("Errors and efficiency", ERROR_COLUMNS),
                ("Errors in detail", (*DETAIL_COLUMNS, *_asked_for(figures))),
                ("Costs", _shown(figures, COST_COLUMNS)),
            )
        ],
        near_floor=_near_floor(figures),
        colors=plots.sampler_colors(names),
        plot=plots.to_svg(plots.error_against_time(figures)),
        layers=[{"key": "image", "title": "Image"}, *(vars(kind) for kind in pictures.ERROR_MAPS)],
        gradient=_gradient(),
        scale=max(1, 1120 // figures.width),
        values={
            kind.key: {
                name: f"{kind.figure} {' '.join(text_of(run, kind.figure_key)).strip()}"
                for name, run in runs
            }
            for kind in pictures.ERROR_MAPS
        },
        learned={
            name: {what: _data_address(png) for what, png in of_sampler.items()}
            for name, of_sampler in learned.items()
        },
        unknown="rgb({}, {}, {})".format(*pictures.UNKNOWN),
        repeats=max(run.repeats for run in figures.samplers.values()),
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


UNSURE_DIGITS = 2
"""Of a figure of a single run, of which nobody knows how sure it is."""


def known(value: float | None, interval: Interval | None) -> tuple[str, str]:
    """A number with as many digits as are known, and what its 95 % interval adds and takes: "12.3"
    and "± 0.4"; "" where there is no interval.

    The half width has one significant digit, or two where the first is 1. Of a lopsided interval it
    is the wider half.
    """
    if value is None:
        return significant(None), ""
    if interval is None:
        return significant(float(f"{value:.{UNSURE_DIGITS - 1}e}"), UNSURE_DIGITS), ""
    half = max(interval[1] - value, value - interval[0])
    if half <= 0:
        return _grouped(int(value)) if float(value).is_integer() else significant(value), ""
    rounded = float(f"{half:.1e}")
    last = math.floor(math.log10(rounded)) - (1 if f"{rounded:e}"[0] == "1" else 0)
    largest = max(abs(value), rounded)
    exponent = math.floor(math.log10(largest))
    if exponent >= 6 or exponent < -4:
        power = f"{THIN}×{THIN}10{_superscript(exponent)}"
        decimals = max(exponent - last, 0)
        scaled, spread = value / 10**exponent, half / 10**exponent
        return f"{scaled:.{decimals}f}{power}", f"±{THIN}{spread:.{decimals}f}{power}"
    decimals = max(-last, 0)
    texts = [f"{round(x, -last):,.{decimals}f}".replace(",", NARROW) for x in (value, half)]
    return texts[0], f"±{THIN}{texts[1]}"


def text_of(run: SamplerFigures, key: str, unit: float = 1.0) -> tuple[str, str]:
    """The text of a figure, and that of its interval."""
    value, interval = _figure(run, key)
    if key == "spp" and interval is None and value is not None:  # counted, and surely so
        interval = (value, value)
    return known(
        None if value is None else value / unit,
        None if interval is None else (interval[0] / unit, interval[1] / unit),
    )


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
    """One sentence on who won by how much, as far as that is known."""
    samplers = figures.samplers
    *others, best = _ranked(figures)
    run = samplers[best]
    if not others:
        return best
    if run.repeats > 1 and not _is_apart(figures, "efficiency", best):
        rivals = [name for name in others if not _part(figures, "efficiency", best, name)]
        others_text = " and ".join(rivals) if len(rivals) <= _NAMED else f"{len(rivals)} others"
        return f"{best} and {others_text} do not differ in efficiency beyond chance"
    gains = [
        f"{significant(ratio, 2)} times" + _range(run, f"ratio_to_{baseline}") + f" {baseline}"
        for baseline in ("uniform", "light_bvh")
        if baseline != best and (ratio := getattr(run, f"ratio_to_{baseline}")) is not None
    ]
    doubt = "" if run.repeats > 1 else ", by one run each"
    if not gains:
        return f"{best} is the most efficient of {len(samplers)}{doubt}"
    return f"{best} is {' and '.join(gains)} in efficiency{doubt}"


def _range(run: SamplerFigures, key: str) -> str:
    """An interval in words."""
    interval = run.intervals.get(key)
    if interval is None or interval[0] == interval[1]:
        return ""
    low, high = (significant(end, 2) for end in interval)
    return f" ({low} to {high})"


def _part(figures: ComparisonFigures, key: str, one: str, other: str) -> bool:
    """Whether the 95 % intervals of a figure of two samplers have nothing in common."""
    a, b = (_figure(figures.samplers[name], key)[1] for name in (one, other))
    return a is not None and b is not None and (a[1] < b[0] or b[1] < a[0])


def _is_apart(figures: ComparisonFigures, key: str, name: str) -> bool:
    """Whether the interval of a sampler is apart from that of every other that has the figure."""
    return all(
        _part(figures, key, name, other)
        for other, run in figures.samplers.items()
        if other != name and _figure(run, key)[0] is not None
    )


def _best(figures: ComparisonFigures, column: Column) -> str | None:
    """The sampler whose figure is the best, where that is more than chance."""
    values = {name: _figure(run, column.key)[0] for name, run in figures.samplers.items()}
    there = {name: value for name, value in values.items() if value is not None}
    if not column.better or len(there) < 2:
        return None
    pick = max if column.better == "high" else min
    best = pick(there, key=lambda name: there[name])
    return best if _is_apart(figures, column.key, best) else None


def _rows(figures: ComparisonFigures, columns: Sequence[Column]) -> list[dict[str, Any]]:
    """A row of a table for each sampler: its cells' text, and which are the best."""
    best = {column.key: _best(figures, column) for column in columns}
    rows = []
    for name, run in figures.samplers.items():
        cells = []
        for column in columns:
            text, spread = text_of(run, column.key, column.unit)
            cells.append({"text": text, "spread": spread, "best": best[column.key] == name})
        rows.append({"name": name, "cells": cells})
    return rows


def _asked_for(figures: ComparisonFigures) -> list[Column]:
    """Columns of the metrics that were asked for. Of functions nobody knows what is better."""
    names = dict.fromkeys(name for run in figures.samplers.values() for name in run.metrics)
    return [Column(f"{_METRIC}{name}", name, "low" if name in METRICS else "") for name in names]


def _figure(run: SamplerFigures, key: str) -> tuple[float | None, Interval | None]:
    """A figure, or a metric that was asked for, and its interval."""
    if not key.startswith(_METRIC):
        return getattr(run, key), run.intervals.get(key)
    metric = run.metrics[key.removeprefix(_METRIC)]
    if metric.low is None or metric.high is None:
        return metric.value, None
    return metric.value, (metric.low, metric.high)


def _shown(figures: ComparisonFigures, columns: Sequence[Column]) -> list[Column]:
    """Without what concerns samplers of one's own, where there are none."""
    has_own = any(run.own_seconds is not None for run in figures.samplers.values())
    return [column for column in columns if has_own or column.key != "own_seconds"]


def _near_floor(figures: ComparisonFigures) -> list[str]:
    """Samplers whose error is not well above that of the reference."""
    floor = figures.reference.relmse_of_itself or 0.0
    return [
        name
        for name, run in figures.samplers.items()
        if (run.relmse_measured or 0) < _FLOORS_ABOVE * floor
    ]


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
