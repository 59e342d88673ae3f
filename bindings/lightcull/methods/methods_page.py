"""The report's folder: index.html, report.json, a CSV file for each study, and a PNG and an EXR for
each picture.
"""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..images import view_names, write_exr
from ..output_files import write_whole_file
from ..report import page, pictures, plots, tables
from ..report.write import file_stem
from .findings import Cell, MethodReport, Plot

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def write(report: MethodReport, folder: Path) -> Path:
    """Writes all of it; returns the path of index.html."""
    import jinja2

    images: dict[str, str] = {}
    view = view_names()[0]
    for study in report.studies:
        if not study.pictures:
            continue
        exposure = pictures.exposure_for(study.pictures[0].image.astype(np.float32))
        for picture in study.pictures:
            stem = file_stem(picture.name)
            png = pictures.encode_png(
                np.round(255 * picture.image).astype(np.uint8)
                if picture.is_chart
                else pictures.display(picture.image, view, exposure)
            )
            write_whole_file(folder / f"{stem}.png", png)
            if not picture.is_chart:
                write_exr(str(folder / f"{stem}.exr"), picture.image.astype(np.float32))
            images[picture.name] = base64.b64encode(png).decode("ascii")
    write_whole_file(
        folder / "report.json", (json.dumps(report.figures(), indent=2) + "\n").encode()
    )
    for study in report.studies:
        tables.write_lines(folder / f"{study.key}.csv", [study.table.columns, *study.table.rows])
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("lightcull.methods", "."),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    text = environment.get_template("methods.html").render(
        report=report,
        images=images,
        plots={s.key: plots.to_svg(draw(s.plot)) for s in report.studies if s.plot is not None},
        cell=_cell,
    )
    write_whole_file(folder / "index.html", text.encode())
    return folder / "index.html"


def draw(plot: Plot) -> Figure:
    """Log-log."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    figure = Figure(figsize=(7.0, 3.8), layout="constrained")
    axes: Any = figure.subplots()
    axes.set(xscale="log", yscale="log", xlabel=plot.x_label, ylabel=plot.y_label)
    colors = plots.sampler_colors([curve.name for curve in plot.curves])
    for curve in plot.curves:
        axes.plot(
            curve.x, curve.y, color=colors[curve.name], linewidth=2, marker="o", markersize=3.5,
            label=curve.name,
        )  # fmt: skip
    axes.grid(which="major", color="#e6e8eb", linewidth=0.8)
    axes.legend(frameon=False)
    for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        axis.set_minor_formatter(NullFormatter())  # its labels would overlap
        if high < 100 * low:
            axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    return figure


def _cell(value: Cell) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, int):
        return f"{value:,}".replace(",", page.NARROW)
    return page.significant(value)
