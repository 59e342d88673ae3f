"""lightcull compare."""

from __future__ import annotations

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from ..comparing.compare import compare
from ..methods import compare_methods
from ..report import ComparisonFigures
from ..report.page import text_of
from .options import CompareMethodsOptions, CompareOptions
from .progress_bars import Bars
from .tables import print_table


def run(options: CompareOptions, messages: Console) -> bool:
    """Compares samplers, writes the report and prints a table. False if Ctrl-C ended it early."""
    with Bars(messages) as bars:
        comparison = compare(
            options.scene,
            options.samplers,
            seconds=options.seconds,
            spp=options.spp,
            size=options.size,
            max_depth=options.max_depth,
            seed=options.seed,
            threads=options.threads,
            rr_depth=options.rr_depth,
            direct_light=options.direct_light,
            hide_emitters=options.hide_emitters,
            reference_seconds=options.reference_seconds,
            repeats=options.repeats,
            mask=options.mask,
            metrics=options.metrics,
            slices=options.slices,
            cluster=options.cluster,
            chunk=options.chunk,
            folder=options.folder,
            command=options.command,
            progress=bars,
        )
    print_table(_table(comparison.figures))
    index = options.folder / "index.html"
    print(f"{index}: interrupted" if comparison.interrupted else index)
    return not comparison.interrupted


_COLUMNS = {
    "spp": "spp",
    "s": "seconds",
    "ns/select": "ns_per_selection",
    "relMSE": "relmse",
    "of lamps": "relmse_emission",
    "x uniform": "ratio_to_uniform",
    "x light_bvh": "ratio_to_light_bvh",
}
"""What is printed of a sampler's figures, by heading."""


def _table(figures: ComparisonFigures) -> Table:
    """Intervals stand below their figures, so that there is room for names."""
    table = Table(box=SIMPLE, padding=(0, 1, 0, 0))
    table.add_column("sampler", overflow="fold", min_width=10)
    for heading in _COLUMNS:
        table.add_column(heading, justify="right", no_wrap=True)
    for name, run in figures.samplers.items():
        cells = [text_of(run, key) for key in _COLUMNS.values()]
        table.add_row(name, *("\n".join(filter(None, cell)) for cell in cells))
    return table


def run_methods(options: CompareMethodsOptions, messages: Console) -> bool:
    """Compares methods, writes the report and prints what each study found."""
    with messages.status("") as status:
        report = compare_methods(
            options.scene,
            options.methods,
            seconds=options.seconds,
            size=options.size,
            max_depth=options.max_depth,
            seed=options.seed,
            threads=options.threads,
            most_lights=options.most_lights,
            folder=options.folder,
            command=options.command,
            progress=status.update,
        )
    for study in report.studies:
        print(f"{study.title}: {study.finding}")
    print(options.folder / "index.html")
    return True
