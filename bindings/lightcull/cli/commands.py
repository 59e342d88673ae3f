"""What the commands do. Each returns False if Ctrl-C ended it early."""

from __future__ import annotations

import argparse
import json
import shlex
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from .._core import Error
from ..compare import compare
from ..images import check_format, check_writable, view_names
from ..loaders import open_scene
from ..render import render
from ..scene import Scene
from . import bench
from .bars import Bars

Command: TypeAlias = Callable[[argparse.Namespace, Sequence[str], Console], bool]


def _render(options: argparse.Namespace, arguments: Sequence[str], messages: Console) -> bool:
    output = Path(options.output or f"{Path(options.scene).stem}.exr")
    _check_output(output, options)
    with _warnings_to(messages):
        scene = open_scene(options.scene)
        with Bars(messages) as bars:
            result = render(scene, options.sampler, progress=bars, **_shared(options))
        result.save(output, options.view, options.exposure or 0.0)
    stats = result.stats
    width, height = options.size
    print(
        f"{output}: {width}x{height}, {stats.spp} samples per pixel in {stats.seconds:.1f} s, "
        f"{options.sampler} among {len(scene.lights()):,} lights"
        + (", interrupted" if result.interrupted else "")
    )
    return not result.interrupted


def _check_output(output: Path, options: argparse.Namespace) -> None:
    if check_format(output) == ".exr" and (options.view or options.exposure is not None):
        raise Error(f"{output}: --view and --exposure are for a .png; an .exr stays linear")
    if options.view and options.view not in view_names():
        raise Error(f"no view {options.view!r}; there are {', '.join(view_names())}")
    if output.is_dir():
        raise Error(f"{output}: is a folder; wanted the name of a file")
    check_writable(output.parent)


def _compare(options: argparse.Namespace, arguments: Sequence[str], messages: Console) -> bool:
    folder = Path(options.output or "report")
    check_writable(folder)
    with _warnings_to(messages):
        scene = open_scene(options.scene)
        with Bars(messages) as bars:
            comparison = compare(
                scene,
                options.samplers,
                reference_seconds=options.reference_seconds,
                folder=folder,
                command=shlex.join(["lightcull", *arguments]),
                progress=bars,
                **_shared(options),
            )
    Console().print(_results(json.loads((folder / "report.json").read_text())))
    print(f"{folder / 'index.html'}" + (": interrupted" if comparison.interrupted else ""))
    return not comparison.interrupted


def _results(report: dict[str, Any]) -> Table:
    columns = {
        "spp": ("spp", "{:,}"),
        "seconds": ("seconds", "{:.2f}"),
        "ns/select": ("ns_per_selection", "{:.0f}"),
        "relMSE": ("relmse", "{:.3g}"),
        "x uniform": ("ratio_to_uniform", "{:.3g}"),
        "x light_bvh": ("ratio_to_light_bvh", "{:.3g}"),
    }
    table = Table("sampler", box=SIMPLE)
    for heading in columns:
        table.add_column(heading, justify="right", no_wrap=True)
    for name, figures in report["samplers"].items():
        values = ((figures[key], form) for key, form in columns.values())
        table.add_row(name, *("-" if v is None else form.format(v) for v, form in values))
    return table


def _info(options: argparse.Namespace, arguments: Sequence[str], messages: Console) -> bool:
    with _warnings_to(messages):
        scene = open_scene(options.scene)
    table = Table(show_header=False, box=None)
    for name, value in _facts(scene):
        table.add_row(name, value)
    Console(highlight=False).print(table)
    return True


def _facts(scene: Scene) -> Iterator[tuple[str, str]]:
    lights, counts, bounds = scene.lights(), scene.counts, scene.bounds
    triangles = len(lights) - counts["points"] - counts["spots"]
    yield "scene", scene.name
    yield "triangles", f"{scene.triangle_count:,} in {counts['meshes']:,} meshes"
    yield "materials", f"{counts['materials']:,}, textures {counts['textures']:,}"
    yield (
        "lights",
        f"{len(lights):,}: {triangles:,} triangles, {counts['points']:,} points, "
        f"{counts['spots']:,} spots",
    )
    strong = lights["intensity"][lights["intensity"] > 0]
    if len(strong):
        low, middle, high = np.quantile(strong, (0, 0.5, 1))
        yield "intensity", f"{low:.3g} to {high:.3g} W/sr, median {middle:.3g}"
    yield "environment", "yes" if scene.has_environment else "no"
    if bounds is not None:
        yield "bounds", f"{_vector(bounds[0])} to {_vector(bounds[1])} m"
    camera = scene.camera
    yield (
        "camera",
        f"at {_vector(camera.origin)}, towards {_vector(camera.target)}, "
        f"{np.degrees(camera.vertical_fov):.0f} degrees high",
    )


def _bench(options: argparse.Namespace, arguments: Sequence[str], messages: Console) -> bool:
    with _warnings_to(messages):
        return bench.run(options, messages)


def _vector(values: Sequence[float] | np.ndarray) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in values) + ")"


def _shared(options: argparse.Namespace) -> dict[str, Any]:
    by_time = options.spp is None
    return {
        "seconds": (options.seconds or options.default_seconds) if by_time else None,
        "spp": options.spp,
        "size": options.size,
        "max_depth": options.max_depth,
        "seed": options.seed,
        "threads": options.threads,
    }


@contextmanager
def _warnings_to(messages: Console) -> Iterator[None]:
    """Shows warnings as lines of their own."""
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        warnings.showwarning = lambda message, *_: messages.print(
            f"lightcull: warning: {message}", style="yellow", markup=False
        )
        yield


COMMANDS: dict[str, Command] = {
    "render": _render,
    "compare": _compare,
    "info": _info,
    "bench": _bench,
}
