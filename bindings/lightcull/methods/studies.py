"""All studies of a comparison of methods: `lightcull compare --methods`."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

from .. import checks, machine
from .._core import Error
from ..output_files import check_writable
from ..rendering.method import PATH, check_method
from ..rendering.settings import RenderSettings
from ..rendering.virtual_light_job import VirtualLightJob
from ..scene import Scene
from . import hierarchy, methods_page, race, scaling, volumes
from .findings import MethodReport
from .measure import Bench

MOST_LIGHTS = 1048576


def compare_methods(
    scene: Scene,
    methods: Sequence[str],
    *,
    seconds: float = 10.0,
    size: tuple[int, int] = (320, 240),
    max_depth: int = 3,
    seed: int = 0,
    threads: int = 0,
    most_lights: int = MOST_LIGHTS,
    folder: str | os.PathLike[str] | None = None,
    command: str = "",
    progress: Callable[[str], object] | None = None,
) -> MethodReport:
    """Compares methods: those named for `seconds` each against the path tracer, and how virtual
    lights scale from 1024 to `most_lights` light paths, with any culling volume, shadow map and grid.

    methods: descriptions as in `render`. size: width and height, pixels. max_depth: 3 to 5.
    threads: 0 for all. folder: where index.html, report.json, a CSV file of each study's
    table and pictures are written; None: none.
    command: what the report says made it. progress: called with what is being done, in words.
    """
    if isinstance(methods, str):
        raise TypeError(f"methods: wanted several, got {methods!r}")
    if not methods:
        raise Error("methods: wanted one at least")
    if not isinstance(scene, Scene):
        raise TypeError(f"scene: wanted a lightcull.Scene, got {scene!r}")
    for method in methods:
        check_method(method)
    if checks.whole_number("most_lights", most_lights, 1) > 2**26:
        raise Error("most_lights: wanted at most 67108864")
    if not checks.number("seconds", seconds) > 0:
        raise Error(f"seconds: wanted more than 0, got {seconds}")
    if folder is not None:
        check_writable(folder)

    def report(stage: str, fraction: float) -> None:
        if progress is not None:
            progress(f"{stage}, {fraction:.0%}")

    settings = RenderSettings(size, max_depth, seed, threads)
    for method in ("vpl_all", *methods):
        if method != PATH:  # what it refuses, it refuses now
            VirtualLightJob(scene, method, "uniform", settings)
    bench = Bench(scene, settings, most_lights, seconds, report)
    studies = (
        race.equal_time(bench, tuple(dict.fromkeys(methods))),
        scaling.tiled_lighting(bench),
        volumes.spheroids(bench),
        volumes.splatting(bench),
        scaling.shadow_maps(bench),
        hierarchy.grid(bench),
    )
    result = MethodReport(scene.name, *size, command, machine.describe(), studies)
    if folder is not None:
        methods_page.write(result, Path(folder))
    return result
