"""lightcull compare."""

from __future__ import annotations

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from ..comparing.compare import compare
from ..methods import compare_methods
from ..report import ComparisonFigures
from .options import CompareMethodsOptions, CompareOptions
from .progress_bars import Bars


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
            reference_seconds=options.reference_seconds,
            folder=options.folder,
            command=options.command,
            progress=bars,
        )
    Console().print(_table(comparison.figures))
    index = options.folder / "index.html"
    print(f"{index}: interrupted" if comparison.interrupted else index)
    return not comparison.interrupted


def _table(figures: ComparisonFigures) -> Table:
    table = Table("sampler", box=SIMPLE)
    for heading in ("spp", "seconds", "ns/select", "relMSE", "x uniform", "x light_bvh"):
        table.add_column(heading, justify="right", no_wrap=True)
    for name, sampler in figures.samplers.items():
        table.add_row(
            name,
            f"{sampler.spp:,}",
            f"{sampler.seconds:.2f}",
            _number(sampler.ns_per_selection, ".0f"),
            _number(sampler.relmse, ".3g"),
            _number(sampler.ratio_to_uniform, ".3g"),
            _number(sampler.ratio_to_light_bvh, ".3g"),
        )
    return table


def _number(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)


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
