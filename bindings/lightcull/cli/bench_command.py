"""lightcull bench."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from itertools import groupby

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from ..bench import Row, bench
from ..output_files import write_whole_file
from ..scene import Scene
from .options import BenchOptions
from .tables import print_table


def run(options: BenchOptions, messages: Console) -> bool:
    """Measures, prints a table for each scene and writes the JSON. False if Ctrl-C ended it."""
    rows: list[Row] = []
    completed = True
    try:
        for make_scene in options.scenes:
            _bench(make_scene(), options, messages, rows)
    except KeyboardInterrupt:
        if not rows:
            raise
        completed = False
    if options.json is not None:
        text = json.dumps([asdict(row) for row in rows], indent=2, allow_nan=False)
        write_whole_file(options.json, (text + "\n").encode())
    return completed


def _bench(scene: Scene, options: BenchOptions, messages: Console, rows: list[Row]) -> None:
    """Adds the rows of a scene, as far as they go, and prints them."""
    first = len(rows)
    try:
        with messages.status(scene.name) as status:
            for row in bench(
                scene,
                options.samplers,
                size=options.size,
                threads=options.threads,
                targets=options.targets,
                device=options.device,
                progress=status.update,
            ):
                rows.append(row)
    finally:
        _print(rows[first:])


_COLUMNS = (
    "batch", "per s", "single", "ray", "arrive", "nodes", "lights", "refit", "build s", "B/light",
)  # fmt: skip


def _print(rows: Sequence[Row]) -> None:
    """A table for each setting, with a line for each sampler and both entries in it."""
    for setting, of_setting in groupby(rows, key=_setting):
        table = Table(title=setting, title_justify="left", box=SIMPLE, padding=0)
        table.add_column("sampler", overflow="fold")
        for heading in _COLUMNS:
            table.add_column(heading, justify="right", no_wrap=True)
        for name, entries in groupby(of_setting, key=_name):
            table.add_row(name, *_cells(list(entries)))
        print_table(table, highlight=False)


def _setting(row: Row) -> str:
    threads = f"{row.threads} thread{'s' if row.threads > 1 else ''}"
    return f"{row.scene}, {row.lights:,} lights: {row.points} points, {threads}, {row.target}"


def _name(row: Row) -> str:
    return row.sampler if row.device == "cpu" else f"{row.sampler} on {row.device}"


def _cells(entries: Sequence[Row]) -> Iterator[str]:
    batch, *single = entries
    yield _short(batch.ns_per_selection)
    yield _short(batch.selections_per_second)
    yield _short(single[0].ns_per_selection) if single else "-"
    yield "-" if batch.shadow_ray_ns is None else _short(batch.shadow_ray_ns)
    yield "-" if batch.rays_arrived is None else f"{batch.rays_arrived:.0%}"
    yield f"{batch.nodes_per_point:.1f}"
    yield _short(batch.lights_tested_per_point, decimals=1)
    yield _short(batch.refit_ns_per_light, decimals=2)
    yield f"{batch.build_seconds:.2f}"
    yield _short(batch.bytes_per_light)


def _short(value: float, decimals: int = 0) -> str:
    if value >= 1e6:
        return f"{value / 1e6:.2f}M"
    return f"{value / 1e3:.1f}k" if value >= 1e4 else f"{value:,.{decimals}f}"
