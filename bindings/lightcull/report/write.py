"""Writes a report into a folder."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from .._core import Error
from ..images import view_names, write_exr
from ..output_files import write_whole_file
from . import page, pictures, plots, tables
from .comparison import Comparison


_LONGEST_STEM = 120
"""Of what follows there has to be room in the name of a file."""


def write(comparison: Comparison, folder: str | Path) -> Path:
    """Writes index.html, report.json, report.csv, error_curves.csv, error_curves.png, of the reference
    and of each sampler's first run NAME.png and NAME.exr, and of those that have learned
    NAME_cells.png and NAME_visibility.png, into `folder`, which is made if need be.

    Of each sampler the error maps, means over its runs, are NAME_error.exr, NAME_blurred.exr,
    NAME_flip.exr and NAME_metric_METRIC.exr of metrics that were asked for; slices, if those were,
    are NAME_run1_slice1.exr and so on.

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
    _write_error_maps(comparison, folder)
    _write_slices(comparison, folder)
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


_FURTHER_FILE = re.compile(r"(?P<stem>.+)_(error|blurred|flip|metric_.+|run\d+_slice\d+)")
"""What else there is of a sampler beside its image."""


def check_names(names: Sequence[str]) -> None:
    """Error unless samplers of these names have files of their own."""
    stems: dict[str, str] = {page.REFERENCE: "the reference"}
    for name in names:
        stem = file_stem(name)
        if not stem or len(stem.encode()) > _LONGEST_STEM:
            raise Error(f"sampler {name!r}: files cannot be called so: 1 to {_LONGEST_STEM} bytes")
        if stem in stems:
            raise Error(f"sampler {name!r}: its files would be those of {stems[stem]}")
        stems[stem] = f"sampler {name!r}"
    for stem, name in stems.items():
        further = _FURTHER_FILE.fullmatch(stem)
        if further is not None and further["stem"] in stems:
            raise Error(f"{name}: its files would be those of {stems[further['stem']]}")


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


def _write_error_maps(comparison: Comparison, folder: Path) -> None:
    for name, runs in comparison.samplers.items():
        maps = {
            kind.key: pictures.error_values(kind, runs, comparison.measure)
            for kind in pictures.ERROR_MAPS
        }
        for metric in comparison.metrics:
            maps[f"metric_{file_stem(metric)}"] = comparison.error_map(name, comparison.metrics[metric])
        for key, values in maps.items():
            grey = np.repeat(values[..., None], 3, axis=2).astype(np.float32)
            about = {"scene": comparison.scene, "sampler": name, "error": key}
            write_exr(str(folder / f"{file_stem(name)}_{key}.exr"), grey, metadata=about)


def _write_slices(comparison: Comparison, folder: Path) -> None:
    for name, runs in comparison.samplers.items():
        for i, run in enumerate(runs, 1):
            for j, part in enumerate(run.slices, 1):
                about = {"scene": comparison.scene, "sampler": name, "spp": str(part.spp),
                         "seconds": f"{part.seconds:g}"}  # fmt: skip
                path = folder / f"{file_stem(name)}_run{i}_slice{j}.exr"
                write_exr(str(path), part.image, metadata=about)
