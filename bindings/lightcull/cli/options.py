"""What the command line understands, and how it explains itself."""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Sequence
from typing import NoReturn

from .._core import Error, instruction_sets
from ..bench import DEFAULT_SAMPLERS as BENCH_SAMPLERS
from ..bench import DEFAULT_SIZE as BENCH_SIZE
from ..bench import DEFAULT_THREADS as BENCH_THREADS
from ..checks import MOST_32_BITS, MOST_64_BITS, MOST_PIXELS
from ..compare import DEFAULT_SAMPLERS, SAMPLERS
from ..sampler import check_description
from ..scenes import NAMES

MITSUBA_PATH = "path"
"""The sampler that is Mitsuba's own integrator."""

_SCENES = "\n".join(f"  {name:10} {description}" for name, description in NAMES.items())

_OVERVIEW = f"""\
Renders scenes lit by up to millions of lights, and compares the ways to choose among them.

SCENE is a file (.glb, .gltf, .obj, .ply), an .xml of Mitsuba's, which Mitsuba then renders with the
integrator lightcull_path, or the name of an example:
{_SCENES}

SAMPLER is the way to choose a light for a point:
  uniform     every light alike
  power       in proportion to its power
  light_bvh   down a tree of clusters (Conty Estevez & Kulla 2018)
  culled      stochastic light culling, resampled: what this project is about
  paper       stochastic light culling as published (Tokuyoshi & Harada 2016)
  clamped     lights with a limited range: biased, for comparison
  exhaustive  weighs every light for every point: slow, the floor for error
  path        Mitsuba's own integrator, for an .xml only
Options follow at colons: culled:sets=16, culled:accepted=32, paper:list=0:error_bound=auto,
light_bvh:importance=means (means over a cluster in place of the published bounds: less noise)."""

_EXAMPLES = """\
examples:
  lightcull render lanterns -o lanterns.exr --seconds 10
  lightcull compare lanterns --samplers uniform,light_bvh,culled --seconds 30 -o report
  lightcull info city

Ctrl-C ends a render after the pass under way and keeps what there is; twice, at once. Exit codes: 0 done, 1 error, 2 wrong usage,
130 interrupted. `lightcull COMMAND --help` says more."""

_RENDER_EXAMPLES = """\
examples:
  lightcull render lanterns -o lanterns.exr               10 seconds, linear radiance
  lightcull render city -o city.png --size 640x360        a picture to look at
  lightcull render room.glb -o room.exr --max-depth 6 --spp 256
  lightcull render cornell -o a.exr --sampler uniform --spp 16 --seed 7

  lightcull render city -o city.exr --spp 4096 --checkpoint city.checkpoint
  lightcull render city -o city.exr --spp 4096 --resume city.checkpoint

A render that was resumed has the same bits as one that never stopped. The checkpoint is whole at any
moment; one of another scene, sampler, size, depth, seed or build is refused.

The same seed gives the same image, whatever the number of threads. An .exr holds what made it:
scene, sampler, seed, samples, seconds."""

_COMPARE_EXAMPLES = """\
examples:
  lightcull compare lanterns --samplers uniform,culled --seconds 20
  lightcull compare city --samplers light_bvh,culled,paper -o report-city
  lightcull compare cornell --samplers culled:sets=16,culled:sets=64 --spp 64
  lightcull compare --host mitsuba scene.xml --samplers path,culled

Builds and refits count as render time. The samplers take turns, so that a noisy machine is fair to
all. A reference is rendered first, for 8 times as long, by a sampler that is not compared (or by
two if all are), and kept in ~/.cache/lightcull. The folder gets index.html, report.json, report.csv
and the images."""

_BENCH_EXAMPLES = """\
examples:
  lightcull bench                                         every example scene and the series
  lightcull bench lanterns --json bench.json
  lightcull bench series --samplers light_bvh,culled --threads 2
  lightcull bench city --targets all --samplers culled

Times are wall time, the median of five repetitions in which the samplers take turns:
  batch    nanoseconds of a selection, many points to a call. All that a pass needs is in it: of
           culled, the sorting of the points AND the pass's refit for every set of ranges
  single   nanoseconds of a selection, one point to a call; the pass's refit is not in it
  ray      nanoseconds of one shadow ray from these points to the lights that the sampler chose
  refit    nanoseconds of a pass's refit, per light and set of ranges; about 0 where there is none
  build s  the build of the sampler, calibration included
Counts: tree nodes visited and lights tested per point. B/light: memory of the sampler.
Points are what camera rays hit; scattered: what paths hit after one bounce and after two; uniform:
anywhere in the scene's bounds. exhaustive has fewer points where there are many lights. --json
writes a list of rows with the keys scene, lights, points (camera, scattered, uniform), sampler,
entry (batch, single), target, threads, ns_per_selection, shadow_ray_ns, nodes_per_point,
lights_tested_per_point, refit_ns_per_light, build_seconds and bytes_per_light. All of it takes
half an hour or so; a scene takes one or two minutes."""

_INFO_EXAMPLES = """\
examples:
  lightcull info lanterns
  lightcull info room.glb                                 also names what is not supported
  lightcull info city --size 3840x2160 --sampler light_bvh

The memory is that of `lightcull render` with the same options, which is set up to find it out."""


_SELFTEST_EXAMPLES = """\
examples:
  lightcull selftest                                      a minute or two
  lightcull selftest --json selftest.json                 and a row for each case and instruction set

Numbers that are hard to compute with: tiny, huge and distant scenes, points on lights and in their
planes, powers over twelve decades, needles, edges of ranges, furnaces. Each case shows our error
beside a closed form or an exhaustive answer, what rounding in single precision (or noise) allows, and
how many of the instruction sets pass, the scalar path among them. It ends with a line `N passed, 0
failed`; the exit code is 1 if any fails."""


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: error: {message} (see {self.prog} --help)\n")


def make_parser() -> argparse.ArgumentParser:
    """The parser of the whole command line."""
    parser = _make(_Parser, "lightcull", _OVERVIEW, _EXAMPLES)
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)

    def add(name: str, summary: str, examples: str) -> argparse.ArgumentParser:
        command: argparse.ArgumentParser = commands.add_parser(
            name,
            help=summary,
            description=f"{summary[0].upper()}{summary[1:]}.\n\n{_OVERVIEW.split(chr(10), 2)[2]}",
            epilog=examples,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        return command

    render = add("render", "render a scene to an image", _RENDER_EXAMPLES)
    _add_sampler(render)
    render.add_argument("--view", help="of a .png: see through this view; default: the first")
    render.add_argument(
        "--exposure", type=_finite, metavar="STOPS", help="of a .png: brighten it; default: 0"
    )
    render.add_argument(
        "--checkpoint", metavar="FILE", help="save the render to go on from later; a new file"
    )
    render.add_argument(
        "--every", type=_positive, default=60.0, metavar="S", help="seconds between; default: 60"
    )
    render.add_argument(
        "--resume", metavar="FILE", help="go on from a checkpoint, and keep it up to date"
    )
    _add_shared(render, seconds=10, output="SCENE.exr", output_help=".exr or .png to write")

    compare = add("compare", "compare samplers in equal time", _COMPARE_EXAMPLES)
    _add_samplers(compare, DEFAULT_SAMPLERS)
    compare.add_argument(
        "--reference-seconds",
        type=_positive,
        metavar="S",
        help="render time of the reference; default: 8 times that of a sampler",
    )
    _add_shared(compare, seconds=30, output="report", output_help="folder to write")

    info = add("info", "say what is in a scene, and what memory it takes", _INFO_EXAMPLES)
    _add_scene(info)
    _add_sampler(info)
    _add_image(info)
    selftest = add("selftest", "check hard cases on this machine", _SELFTEST_EXAMPLES)
    selftest.add_argument("--json", metavar="FILE", help="file to write the results to")
    _add_bench(add("bench", "measure what a selection costs", _BENCH_EXAMPLES))
    return parser


def _add_scene(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("scene", metavar="SCENE", help="file or name of an example")


def _add_sampler(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--sampler", type=_sampler, default="culled", metavar="SAMPLER", help="default: culled"
    )


def _add_image(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--size", type=_size, metavar="WxH", help="pixels; default: 320x240; of an .xml: its own"
    )
    parser.add_argument(
        "--max-depth",
        type=_from_one,
        metavar="N",
        help="longest path, in edges: 2 is direct light only; default: 2; of an .xml: its own",
    )


def _add_samplers(parser: argparse.ArgumentParser, default: Sequence[str]) -> None:
    parser.add_argument(
        "--samplers",
        type=_samplers,
        default=list(default),
        metavar="A,B,...",
        help=f"default: {','.join(default)}",
    )


def _add_bench(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "scenes",
        nargs="*",
        metavar="SCENE",
        help="file, name of an example, or series: lanterns with 1,000 to 1,000,000 lights of the "
        "same total power; default: all examples and the series",
    )
    _add_samplers(parser, BENCH_SAMPLERS)
    parser.add_argument(
        "--size",
        type=_size,
        default=BENCH_SIZE,
        metavar="WxH",
        help="of the image whose points are taken; default: {}x{}".format(*BENCH_SIZE),
    )
    parser.add_argument(
        "--threads",
        type=_thread_counts,
        default=list(BENCH_THREADS),
        metavar="M,N,...",
        help=f"default: {','.join(map(str, BENCH_THREADS))}",
    )
    parser.add_argument(
        "--targets",
        type=_targets,
        metavar="A,B,...",
        help="instruction sets, or all; default: the best that this machine has",
    )
    parser.add_argument("--json", metavar="FILE", help="file to write the rows to")


def _make(
    kind: type[argparse.ArgumentParser], program: str, description: str, epilog: str
) -> argparse.ArgumentParser:
    return kind(
        prog=program,
        description=description,
        epilog=epilog,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )


def _add_shared(
    parser: argparse.ArgumentParser, seconds: float, output: str, output_help: str
) -> None:
    _add_scene(parser)
    _add_image(parser)
    parser.add_argument(
        "--host", choices=["mitsuba"], help="renderer to use; default: mitsuba for an .xml"
    )
    parser.add_argument(
        "--variant", default="scalar_rgb", help="of Mitsuba, for an .xml; default: scalar_rgb"
    )
    budget = parser.add_mutually_exclusive_group()
    budget.add_argument(
        "--seconds", type=_positive, metavar="S", help=f"render time; default: {seconds:g}"
    )
    budget.add_argument("--spp", type=_from_one, metavar="N", help="samples per pixel instead")
    parser.add_argument(
        "--threads", type=_from_zero, default=0, metavar="N", help="default: 0, all there are"
    )
    parser.add_argument("--seed", type=_seed, default=0, metavar="N", help="default: 0")
    parser.add_argument(
        "-o", "--output", metavar="PATH", help=f"{output_help}; default: {output}"
    )
    parser.set_defaults(default_seconds=float(seconds))


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"([1-9][0-9]{0,4})x([1-9][0-9]{0,4})", text)
    if match is None:
        raise argparse.ArgumentTypeError(f"wanted WIDTHxHEIGHT such as 640x360, got {text!r}")
    size = int(match[1]), int(match[2])
    if max(size) > MOST_PIXELS:
        raise argparse.ArgumentTypeError(f"wanted at most {MOST_PIXELS} pixels, got {text!r}")
    return size


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"wanted a number above 0, got {text!r}")
    return value


def _finite(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"wanted a number, got {text!r}")
    return value


def _from_one(text: str) -> int:
    return _whole(text, 1, MOST_32_BITS)


def _from_zero(text: str) -> int:
    return _whole(text, 0, MOST_32_BITS)


def _seed(text: str) -> int:
    return _whole(text, 0, MOST_64_BITS)


def _whole(text: str, least: int, most: int) -> int:
    if not re.fullmatch(r"[0-9]{1,30}", text) or int(text) < least:
        raise argparse.ArgumentTypeError(f"wanted a whole number from {least} up, got {text!r}")
    if int(text) > most:
        raise argparse.ArgumentTypeError(f"wanted at most {most}, got {text!r}")
    return int(text)


def _sampler(text: str) -> str:
    if text == MITSUBA_PATH:  # whether there is a Mitsuba is known later
        return text
    try:
        check_description(text)
    except Error as error:
        raise argparse.ArgumentTypeError(str(error)) from error
    return text


def _samplers(text: str) -> list[str]:
    return [_sampler(description) for description in text.split(",")]


def _thread_counts(text: str) -> list[int]:
    return [_from_one(count) for count in text.split(",")]


def _targets(text: str) -> list[str]:
    available = instruction_sets()
    if text == "all":
        return available
    names = text.split(",")
    for name in names:
        if name not in available:
            raise argparse.ArgumentTypeError(
                f"no instruction set {name!r} here; there are {', '.join(available)} and all"
            )
    return names
