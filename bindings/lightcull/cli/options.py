"""What a command line asks for, resolved: defaults are filled in, the scene is open, and what can be
refused before anything is rendered has been. The commands read these records and nothing else.
"""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np

from .. import bench
from .._core import Error
from ..images import apply_view, check_format, read_image
from ..methods.studies import MOST_LIGHTS
from ..output_files import check_output, check_writable
from ..rendering.budget import Budget
from ..rendering.frame_series import FrameSeries, numbered, read_camera_path
from ..rendering.method import PATH
from ..rendering.settings import MAX_DEPTH, RR_DEPTH, SIZE, RenderSettings, Wanted, settings_of
from ..scene import Scene
from .bench_scenes import SceneMaker, scene_makers
from .scene_option import BOUNCED_DEPTH, AnyScene, named_source, open_any
from .view_option import look_of


@dataclass(frozen=True)
class RenderOptions:
    """A render. What is not said here is as in `lightcull.render`."""

    scene: AnyScene
    sampler: str | None
    method: str
    seconds: float | None
    spp: int | None
    size: tuple[int, int]
    max_depth: int
    seed: int
    threads: int
    rr_depth: int
    direct_light: str
    hide_emitters: bool
    output: Path
    view: str | None
    """The view of a .png; None: the first."""
    exposure: float
    """The exposure of a .png, stops."""
    checkpoint: str | None
    every: float | None
    resume: str | None
    cluster: str | None
    chunk: int | None


@dataclass(frozen=True)
class FramesOptions:
    """A render of frames."""

    series: FrameSeries
    cluster: str | None
    output: str
    """Name of a file, with # for the number of the frame."""
    view: str | None
    exposure: float


@dataclass(frozen=True)
class CompareOptions:
    """A comparison of samplers. What is not said here is as in `lightcull.compare`."""

    scene: AnyScene
    samplers: tuple[str, ...] | None
    seconds: float | None
    spp: int | None
    size: tuple[int, int]
    max_depth: int
    seed: int
    threads: int
    rr_depth: int
    direct_light: str
    hide_emitters: bool
    reference_seconds: float | None
    repeats: int
    mask: np.ndarray | None
    metrics: tuple[str, ...]
    slices: int
    cluster: str | None
    chunk: int | None
    folder: Path
    command: str


@dataclass(frozen=True)
class CompareMethodsOptions:
    """A comparison of methods. The fields are as in `lightcull.compare_methods`."""

    scene: Scene
    methods: tuple[str, ...]
    seconds: float
    size: tuple[int, int]
    max_depth: int
    seed: int
    threads: int
    most_lights: int
    folder: Path
    command: str


@dataclass(frozen=True)
class InfoOptions:
    """What is asked about: a scene, and a render of it that is only set up."""

    scene: AnyScene
    sampler: str | None
    method: str
    settings: RenderSettings


@dataclass(frozen=True)
class BenchOptions:
    """Measurements of selections. What is not said here is as in `lightcull.bench.bench`."""

    scenes: tuple[SceneMaker, ...]
    samplers: tuple[str, ...]
    size: tuple[int, int]
    threads: tuple[int, ...]
    targets: tuple[str, ...] | None
    device: str
    json: Path | None
    """The file that the rows go to; None: none."""


@dataclass(frozen=True)
class SelftestOptions:
    """A run of the hard cases, or of the battery of noise."""

    noise: bool

    json: Path | None
    """The file that the results go to; None: none."""


Options: TypeAlias = (
    RenderOptions
    | FramesOptions
    | CompareOptions
    | CompareMethodsOptions
    | InfoOptions
    | BenchOptions
    | SelftestOptions
)


def resolve(parsed: argparse.Namespace, arguments: Sequence[str]) -> Options:
    """Resolves what the parser made of the arguments. Throws Error for what makes no sense."""
    return _RESOLVERS[parsed.command](parsed, shlex.join(["lightcull", *arguments]))


def _render(parsed: argparse.Namespace, command: str) -> RenderOptions | FramesOptions:
    if parsed.frames is not None:
        return _frames(parsed)
    if parsed.camera_path is not None:
        raise Error("--camera-path: only with --frames")
    default = f"{Path(parsed.scene).stem or 'image'}.exr"
    output = Path(default if parsed.output is None else parsed.output)
    _check_image_output(output, parsed)
    if parsed.every is not None and parsed.checkpoint is None and parsed.resume is None:
        raise Error("--every: only with --checkpoint or --resume")
    scene = open_any(parsed)
    size, max_depth, rr_depth, hide_emitters = _settings(
        scene, parsed, _default_depth(parsed.method)
    )
    return RenderOptions(
        scene=scene,
        sampler=parsed.sampler,
        method=parsed.method,
        seconds=_seconds(parsed),
        spp=parsed.spp,
        size=size,
        max_depth=max_depth,
        seed=parsed.seed,
        threads=parsed.threads,
        rr_depth=rr_depth,
        direct_light=parsed.direct_light or "mis",
        hide_emitters=hide_emitters,
        output=output,
        view=parsed.view,
        exposure=parsed.exposure or 0.0,
        checkpoint=parsed.checkpoint,
        every=parsed.every,
        resume=parsed.resume,
        cluster=parsed.cluster,
        chunk=parsed.chunk,
    )


def _frames(parsed: argparse.Namespace) -> FramesOptions:
    for name in ("checkpoint", "every", "resume", "chunk"):
        if getattr(parsed, name) is not None:
            raise Error(f"--{name}: not with --frames, each of which is written when it is done")
    if parsed.method != PATH or Path(parsed.scene).suffix.lower() == ".xml":
        raise Error("--frames: for paths in scenes of ours only")
    first, last = parsed.frames
    cameras = {} if parsed.camera_path is None else read_camera_path(parsed.camera_path)
    missing = set(range(first, last + 1)) - set(cameras)
    if cameras and missing:
        raise Error(f"{parsed.camera_path}: has no camera for frame {min(missing)}")
    output = parsed.output or f"{Path(parsed.scene.replace('#', '')).stem.strip('.')}.####.exr"
    if "#" not in output:
        raise Error(f"{output}: wanted signs # in it, for the number of a frame")
    for number in (first, last):
        _check_image_output(Path(numbered(output, number)), parsed)
    series = FrameSeries(
        first=first,
        last=last,
        source=named_source(parsed),
        cameras=cameras,
        sampler=parsed.sampler,
        settings=RenderSettings(
            parsed.size or SIZE, parsed.max_depth or MAX_DEPTH, parsed.seed, parsed.threads,
            parsed.rr_depth or RR_DEPTH, parsed.direct_light or "mis",
            hide_emitters=bool(parsed.hide_emitters),
        ),
        budget=Budget(parsed.spp, _seconds(parsed)),
    )  # fmt: skip
    return FramesOptions(series, parsed.cluster, output, parsed.view, parsed.exposure or 0.0)


def _check_image_output(output: Path, parsed: argparse.Namespace) -> None:
    if check_format(output) == ".exr" and (parsed.view or parsed.exposure is not None):
        raise Error(f"{output}: --view and --exposure are for a .png; an .exr stays linear")
    if check_format(output) == ".png":  # what a broken configuration of views throws, it throws now
        apply_view(np.zeros((1, 1, 3), np.float32), parsed.view, parsed.exposure or 0.0)
    check_output(output)
    for other in (parsed.checkpoint, parsed.resume):
        if other is not None and Path(other).resolve() == output.resolve():
            raise Error(f"{output}: cannot be the image and the checkpoint")


def _compare(parsed: argparse.Namespace, command: str) -> CompareOptions | CompareMethodsOptions:
    if parsed.methods is not None:
        return _compare_methods(parsed, command)
    if parsed.most_lights is not None:
        raise Error("--most-lights: only with --methods")
    folder = _report_folder(parsed)
    scene = open_any(parsed)
    size, max_depth, rr_depth, hide_emitters = _settings(scene, parsed, MAX_DEPTH)
    return CompareOptions(
        scene=scene,
        samplers=parsed.samplers and tuple(parsed.samplers),
        seconds=_seconds(parsed),
        spp=parsed.spp,
        size=size,
        max_depth=max_depth,
        seed=parsed.seed,
        threads=parsed.threads,
        rr_depth=rr_depth,
        direct_light=parsed.direct_light or "mis",
        hide_emitters=hide_emitters,
        reference_seconds=parsed.reference_seconds,
        repeats=parsed.repeats or 1,
        mask=_mask(parsed.mask, size),
        metrics=tuple(parsed.metrics or ()),
        slices=parsed.slices or 0,
        cluster=parsed.cluster,
        chunk=parsed.chunk,
        folder=folder,
        command=command,
    )


def _mask(path: str | None, size: tuple[int, int]) -> np.ndarray | None:
    if path is None:
        return None
    image = read_image(path, linear_data=True)
    if image.shape[:2] != (size[1], size[0]):
        height, width = image.shape[:2]
        raise Error(f"{path}: a mask of {width}x{height} for an image of {size[0]}x{size[1]}")
    mask = np.asarray((image > 0).any(axis=2))
    if not mask.any():
        raise Error(f"{path}: a mask that is black: no pixel counts")
    return mask


def _compare_methods(parsed: argparse.Namespace, command: str) -> CompareMethodsOptions:
    folder = _report_folder(parsed)
    if parsed.spp is not None:
        raise Error("--spp: methods are compared in equal time, give --seconds")
    for name in _OF_SAMPLERS:
        if getattr(parsed, name) is not None:
            raise Error(f"--{name.replace('_', '-')}: not with --methods")
    scene = open_any(parsed)
    size, max_depth, *_ = _settings(scene, parsed, BOUNCED_DEPTH)
    if not isinstance(scene, Scene):
        raise Error("--methods: not for a scene of another renderer")
    return CompareMethodsOptions(
        scene=scene,
        methods=tuple(parsed.methods),
        seconds=parsed.seconds or parsed.default_seconds,
        size=size,
        max_depth=max_depth,
        seed=parsed.seed,
        threads=parsed.threads,
        most_lights=parsed.most_lights or MOST_LIGHTS,
        folder=folder,
        command=command,
    )


_OF_SAMPLERS = ("samplers", "reference_seconds", "rr_depth", "direct_light", "hide_emitters",
                "repeats", "mask", "metrics", "slices", "cluster", "chunk")  # fmt: skip
"""Options of a comparison of samplers alone."""


def _report_folder(parsed: argparse.Namespace) -> Path:
    folder = Path("report" if parsed.output is None else parsed.output)
    check_writable(folder)
    return folder


def _info(parsed: argparse.Namespace, command: str) -> InfoOptions:
    scene = open_any(parsed)
    size, depth, rr_depth, _ = settings_of(
        scene, parsed.size, parsed.max_depth, None, None, _default_depth(parsed.method)
    )
    if not isinstance(scene, Scene) and (parsed.sampler or parsed.method != PATH):
        raise Error(f"{parsed.scene}: --sampler and --method are not for an .xml scene of Mitsuba's")
    settings = RenderSettings(size, depth, seed=0, threads=0, rr_depth=rr_depth)
    return InfoOptions(scene, parsed.sampler, parsed.method, settings)


def _bench(parsed: argparse.Namespace, command: str) -> BenchOptions:
    return BenchOptions(
        json=_json_file(parsed),
        scenes=tuple(scene_makers(parsed.scenes, look_of(parsed))),
        samplers=tuple(parsed.samplers or bench.DEFAULT_SAMPLERS),
        size=parsed.size,
        threads=tuple(parsed.threads),
        targets=None if parsed.targets is None else tuple(parsed.targets),
        device=parsed.device,
    )


def _selftest(parsed: argparse.Namespace, command: str) -> SelftestOptions:
    return SelftestOptions(parsed.noise, _json_file(parsed))


def _json_file(parsed: argparse.Namespace) -> Path | None:
    if parsed.json is None:
        return None
    check_output(parsed.json)
    return Path(parsed.json)


def _seconds(parsed: argparse.Namespace) -> float | None:
    """The render time; None where samples per pixel are given instead."""
    return None if parsed.spp is not None else parsed.seconds or parsed.default_seconds


def _settings(
    scene: AnyScene, parsed: argparse.Namespace, default_depth: int
) -> Wanted:
    return settings_of(
        scene, parsed.size, parsed.max_depth, parsed.rr_depth, parsed.hide_emitters, default_depth
    )


def _default_depth(method: str) -> int:
    return MAX_DEPTH if method == PATH else BOUNCED_DEPTH


_RESOLVERS: dict[str, Callable[[argparse.Namespace, str], Options]] = {
    "render": _render,
    "compare": _compare,
    "info": _info,
    "bench": _bench,
    "selftest": _selftest,
}
