"""Writes a report into a folder."""

from __future__ import annotations

import io
import re
from pathlib import Path

from ..images import view_names, write_exr
from ..output_files import write_whole_file
from . import page, pictures, plots, tables
from .comparison import Comparison


def write(comparison: Comparison, folder: str | Path) -> Path:
    """Writes index.html, report.json, report.csv, error_curves.csv, error_curves.png, of the reference
    and of each sampler's first run NAME.png and NAME.exr, and of those that have learned
    NAME_cells.png and NAME_visibility.png, into `folder`, which is made if need be.

    Returns the path of index.html.
    """
    folder = Path(folder)
    figures = comparison.figures
    view = view_names()[0]
    exposure = pictures.exposure_for(comparison.reference.image)

    images = _images(comparison, view, exposure)
    for name, png in images["image"].items():
        write_whole_file(folder / f"{file_stem(name)}.png", png)
    _write_exrs(comparison, folder)
    learned = _pictures_of_learned(comparison)
    for name, of_sampler in learned.items():
        for what, png in of_sampler.items():
            write_whole_file(folder / f"{file_stem(name)}_{what}.png", png)
    curves = io.BytesIO()
    plots.error_against_time(figures).savefig(curves, dpi=150, format="png")
    write_whole_file(folder / "error_curves.png", curves.getvalue())
    tables.write_json(figures, folder / "report.json")
    tables.write_csv(figures, folder / "report.csv")
    tables.write_curves_csv(figures, folder / "error_curves.csv")

    index = folder / "index.html"
    shown_with = f"{view}, exposure {exposure:+g} stops"
    write_whole_file(index, page.render(figures, images, learned, shown_with).encode())
    return index


def file_stem(name: str) -> str:
    """A sampler's description as part of a file name: "culled:sets=16" is culled_sets-16."""
    return re.sub(r"[^\w.+-]", "-", name.replace(":", "_"))


def _images(comparison: Comparison, view: str, exposure: float) -> dict[str, dict[str, bytes]]:
    reference = comparison.reference.image
    linear = {page.REFERENCE: reference}
    linear.update({name: runs[0].image for name, runs in comparison.samplers.items()})
    images = {
        "image": {
            name: pictures.encode_png(pictures.display(image, view, exposure))
            for name, image in linear.items()
        }
    }
    for kind in pictures.ERROR_MAPS:
        images[kind.key] = {
            name: pictures.encode_png(
                pictures.to_palette(kind, pictures.error_values(kind, runs, comparison.measure))
            )
            for name, runs in comparison.samplers.items()
        }
    return images


def _pictures_of_learned(comparison: Comparison) -> dict[str, dict[str, bytes]]:
    """PNG files "cells" and "visibility" of each sampler that has learned."""
    all_learned = {name: runs[0].learned for name, runs in comparison.samplers.items()}
    return {
        name: {
            "cells": pictures.encode_png(pictures.cell_picture(learned.cells, learned.normals)),
            "visibility": pictures.encode_png(pictures.visibility_picture(learned.visibility)),
        }
        for name, learned in all_learned.items()
        if learned is not None
    }


def _write_exrs(comparison: Comparison, folder: Path) -> None:
    reference = comparison.reference
    about = {"scene": comparison.scene, "max_depth": str(comparison.max_depth)}
    write_exr(
        str(folder / f"{page.REFERENCE}.exr"),
        reference.image,
        metadata={**about, "sampler": reference.sampler, "spp": str(reference.spp)},
    )
    for name, runs in comparison.samplers.items():
        run = runs[0]
        write_exr(
            str(folder / f"{file_stem(name)}.exr"),
            run.image,
            metadata={**about, "sampler": name, "spp": str(run.spp), "seconds": f"{run.seconds:g}"},
        )
