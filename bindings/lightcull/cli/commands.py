"""What the commands do. Each returns False if Ctrl-C ended it early."""

from __future__ import annotations

import argparse
import shlex
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from .. import _core, memory
from .._core import Error
from ..comparing.compare import DEFAULT_SAMPLERS, compare
from ..images import apply_view, check_format
from ..loaders import open_scene
from ..methods import compare_methods
from ..methods.studies import MOST_LIGHTS
from ..output_files import check_output, check_writable, make_folder
from ..rendering.memory_need import MemoryNeed, memory_need
from ..rendering.method import PATH
from ..rendering.path_job import PathJob
from ..rendering.render import render
from ..rendering.settings import RenderSettings
from ..rendering.virtual_light_job import VirtualLightJob
from ..report import ComparisonFigures
from ..scene import Scene
from . import bench, selftest
from .bars import Bars
from .texts import one_line

if TYPE_CHECKING:
    from ..mitsuba.mitsuba_scene import MitsubaScene

_SIZE, _MAX_DEPTH = (320, 240), 2
_BOUNCED_DEPTH = 3
"""Of methods that find bounced light alone."""

Command: TypeAlias = Callable[[argparse.Namespace, Sequence[str], Console], bool]


def _render(options: argparse.Namespace, arguments: Sequence[str], messages: Console) -> bool:
    default = f"{Path(options.scene).stem or 'image'}.exr"
    output = Path(default if options.output is None else options.output)
    _check_output(output, options)
    if options.every is not None and options.checkpoint is None and options.resume is None:
        raise Error("--every: only with --checkpoint or --resume")
    with _warnings_to(messages):
        scene = _open(options)
        with Bars(messages) as bars, _named_checkpoint(options):
            result = render(
                scene,
                options.sampler,
                method=options.method,
                progress=bars,
                checkpoint=options.checkpoint,
                every=options.every,
                resume=options.resume,
                **_shared(options),
            )
        make_folder(output.parent)
        result.save(output, options.view, options.exposure or 0.0)
    stats = result.stats
    height, width = result.image.shape[:2]
    lights = (
        f"{len(scene.lights()):,} lights"
        if isinstance(scene, Scene)
        else f"{scene.light_count:,} emitters of Mitsuba's"
    )
    print(
        f"{output}: {width}x{height}, {stats.spp} samples per pixel in {stats.seconds:.1f} s, "
        f"{options.sampler} among {lights}"
        + (f", bounces by {options.method}" if options.method != PATH else "")
        + (", interrupted" if result.interrupted else "")
    )
    return not result.interrupted


def _open(options: argparse.Namespace) -> Scene | MitsubaScene:
    """A scene of ours or, for an .xml file, of Mitsuba's, with the size and depth that it says."""
    is_xml = Path(options.scene).suffix.lower() == ".xml"
    if options.host is None and not is_xml:
        if options.variant is not None:
            raise Error(f"{options.scene}: --variant is for an .xml scene of Mitsuba's")
        options.size = options.size or _SIZE
        bounces = getattr(options, "method", PATH) != PATH or getattr(options, "methods", None)
        options.max_depth = options.max_depth or (_BOUNCED_DEPTH if bounces else _MAX_DEPTH)
        return _open_ours(options)
    if not is_xml:
        raise Error(f"{options.scene}: --host mitsuba is for an .xml scene of Mitsuba's")
    if options.virtual_lights is not None:
        raise Error(f"{options.scene}: --virtual-lights is not for a scene of Mitsuba's")
    # Here, because importing it wants Mitsuba, which is optional.
    from ..mitsuba.mitsuba_scene import DEFAULT_VARIANT, depth_of_file, load_file

    scene = load_file(options.scene, options.variant or DEFAULT_VARIANT)
    options.size = options.size or scene.size
    options.max_depth = options.max_depth or depth_of_file(options.scene)
    return scene


def _open_ours(options: argparse.Namespace) -> Scene:
    scene = open_scene(options.scene)
    if options.virtual_lights is not None:
        scene.add_virtual_lights(options.virtual_lights)
    return scene


def _check_output(output: Path, options: argparse.Namespace) -> None:
    if check_format(output) == ".exr" and (options.view or options.exposure is not None):
        raise Error(f"{output}: --view and --exposure are for a .png; an .exr stays linear")
    if check_format(output) == ".png":  # what a broken configuration of views throws, it throws now
        apply_view(np.zeros((1, 1, 3), np.float32), options.view, options.exposure or 0.0)
    check_output(output)
    for other in (options.checkpoint, options.resume):
        if other is not None and Path(other).resolve() == output.resolve():
            raise Error(f"{output}: cannot be the image and the checkpoint")


def _compare_methods(
    options: argparse.Namespace, arguments: Sequence[str], messages: Console
) -> bool:
    folder = Path("report" if options.output is None else options.output)
    check_writable(folder)
    if options.spp is not None:
        raise Error("--spp: methods are compared in equal time, give --seconds")
    for name in ("samplers", "reference_seconds"):
        if getattr(options, name) is not None:
            raise Error(f"--{name.replace('_', '-')}: not with --methods")
    with _warnings_to(messages):
        scene = _open(options)
        if not isinstance(scene, Scene):
            raise Error("--methods: not for a scene of another renderer")
        with messages.status("") as status:
            report = compare_methods(
                scene,
                options.methods,
                seconds=options.seconds or options.default_seconds,
                size=options.size,
                max_depth=options.max_depth,
                seed=options.seed,
                threads=options.threads,
                most_lights=options.most_lights or MOST_LIGHTS,
                folder=folder,
                command=shlex.join(["lightcull", *arguments]),
                progress=status.update,
            )
    for study in report.studies:
        print(f"{study.title}: {study.finding}")
    print(folder / "index.html")
    return True


def _compare(options: argparse.Namespace, arguments: Sequence[str], messages: Console) -> bool:
    if options.methods is not None:
        return _compare_methods(options, arguments, messages)
    if options.most_lights is not None:
        raise Error("--most-lights: only with --methods")
    folder = Path("report" if options.output is None else options.output)
    check_writable(folder)
    with _warnings_to(messages):
        scene = _open(options)
        with Bars(messages) as bars:
            comparison = compare(
                scene,
                options.samplers or DEFAULT_SAMPLERS,
                reference_seconds=options.reference_seconds,
                folder=folder,
                command=shlex.join(["lightcull", *arguments]),
                progress=bars,
                **_shared(options),
            )
    Console().print(_results(comparison.figures))
    print(f"{folder / 'index.html'}" + (": interrupted" if comparison.interrupted else ""))
    return not comparison.interrupted


def _results(report: ComparisonFigures) -> Table:
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
    for name, figures in report.samplers.items():
        values = ((getattr(figures, key), form) for key, form in columns.values())
        table.add_row(name, *("-" if v is None else form.format(v) for v, form in values))
    return table


def _info(options: argparse.Namespace, arguments: Sequence[str], messages: Console) -> bool:
    by_paths = options.method == PATH
    depth = options.max_depth or (_MAX_DEPTH if by_paths else _BOUNCED_DEPTH)
    settings = RenderSettings(options.size or _SIZE, depth, 0, 0)
    with _warnings_to(messages):
        scene = _open_ours(options)
    # Before anything else takes memory that a render does not.
    job = (
        PathJob(scene, options.sampler, settings)
        if by_paths
        else VirtualLightJob(scene, options.method, options.sampler, settings)
    )
    need = memory_need(job, settings.size)
    table = Table(show_header=False, box=None)
    ways = options.sampler if by_paths else f"{options.sampler} and {options.method}"
    memory_fact = ("memory", _memory(need, ways, settings))
    for name, value in (*_facts(scene), memory_fact, *_devices()):
        table.add_row(name, value)
    Console(highlight=False).print(table)
    return True


def _devices() -> Iterator[tuple[str, str]]:
    """What selections can run on."""
    yield "device", f"cpu: {_core.instruction_set()}"
    try:
        devices = _core.vulkan_devices()
    except Error as error:
        yield "no device", str(error)
        return
    for name, problem in devices:
        what = ": ".join(filter(None, ("vulkan", name, problem)))
        yield "no device" if problem else "device", what


def _memory(need: MemoryNeed, ways: str, settings: RenderSettings) -> str:
    width, height = settings.size
    parts = {
        "program": need.program,
        "scene": need.scene,
        "Embree's tree": need.bvh,
        "sampler": need.sampler,
        "image": need.image,
        "paths": need.paths,
    }
    if need.virtual_lights:
        parts["virtual lights"] = need.virtual_lights
    return (
        f"{memory.text(need.peak)} at most to render {width}x{height} by {ways}: "
        + ", ".join(f"{name} {memory.text(size)}" for name, size in parts.items())
        + f"; {memory.text(need.setup)} while it is set up"
    )


def _facts(scene: Scene) -> Iterator[tuple[str, str]]:
    lights, counts, bounds = scene.lights(), scene.counts, scene.bounds
    triangles = len(lights) - counts["points"] - counts["spots"] - counts["virtual lights"]
    yield "scene", scene.name
    yield "triangles", f"{scene.triangle_count:,} in {counts['meshes']:,} meshes"
    yield "materials", f"{counts['materials']:,}, textures {counts['textures']:,}"
    yield (
        "lights",
        f"{len(lights):,}: {triangles:,} triangles, {counts['points']:,} points, "
        f"{counts['spots']:,} spots"
        + (f", {counts['virtual lights']:,} virtual lights" if counts["virtual lights"] else ""),
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
def _named_checkpoint(options: argparse.Namespace) -> Iterator[None]:
    """Says what stays of a render that is stopped at once."""
    path = options.checkpoint or options.resume
    try:
        yield
    except KeyboardInterrupt:
        if path is None or not Path(path).exists():
            raise
        raise KeyboardInterrupt(f"stopped at once: {path} is as it was saved last") from None


@contextmanager
def _warnings_to(messages: Console) -> Iterator[None]:
    """Shows warnings as lines of their own."""
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        warnings.showwarning = lambda message, *_: messages.print(
            f"lightcull: warning: {one_line(message)}", style="yellow", markup=False
        )
        yield


COMMANDS: dict[str, Command] = {
    "render": _render,
    "compare": _compare,
    "info": _info,
    "bench": _bench,
    "selftest": selftest.run,
}
