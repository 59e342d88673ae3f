"""What the command line understands, and how it explains itself."""

from __future__ import annotations

import argparse
import re
from typing import NoReturn

from .._core import Error
from ..compare import DEFAULT_SAMPLERS, SAMPLERS
from ..sampler import check_description
from ..scenes import NAMES

_SCENES = "\n".join(f"  {name:10} {description}" for name, description in NAMES.items())

_OVERVIEW = f"""\
Renders scenes lit by up to millions of lights, and compares the ways to choose among them.

SCENE is a file (.glb, .gltf, .obj, .ply) or the name of an example:
{_SCENES}

SAMPLER is the way to choose a light for a point:
  uniform     every light alike
  power       in proportion to its power
  light_bvh   down a tree of clusters (Conty Estevez & Kulla 2018)
  culled      stochastic light culling, resampled: what this project is about
  paper       stochastic light culling as published (Tokuyoshi & Harada 2016)
  clamped     lights with a limited range: biased, for comparison
  exhaustive  weighs every light for every point: slow, the floor for error
Options follow at colons: culled:sets=16, culled:accepted=32, paper:list=0:error_bound=auto,
light_bvh:importance=means (means over a cluster in place of the published bounds: less noise)."""

_EXAMPLES = """\
examples:
  lightcull render lanterns -o lanterns.exr --seconds 10
  lightcull compare lanterns --samplers uniform,light_bvh,culled --seconds 30 -o report
  lightcull info city

Ctrl-C ends a render early and keeps what there is. Exit codes: 0 done, 1 error, 2 wrong usage,
130 interrupted. `lightcull COMMAND --help` says more."""

_RENDER_EXAMPLES = """\
examples:
  lightcull render lanterns -o lanterns.exr               10 seconds, linear radiance
  lightcull render city -o city.png --size 640x360        a picture to look at
  lightcull render room.glb -o room.exr --max-depth 6 --spp 256
  lightcull render cornell -o a.exr --sampler uniform --spp 16 --seed 7

The same seed gives the same image, whatever the number of threads. An .exr holds what made it:
scene, sampler, seed, samples, seconds."""

_COMPARE_EXAMPLES = """\
examples:
  lightcull compare lanterns --samplers uniform,culled --seconds 20
  lightcull compare city --samplers light_bvh,culled,paper -o report-city
  lightcull compare cornell --samplers culled:sets=16,culled:sets=64 --spp 64

Builds and refits count as render time. The samplers take turns, so that a noisy machine is fair to
all. A reference is rendered first, for 8 times as long, by a sampler that is not compared (or by
two if all are), and kept in ~/.cache/lightcull. The folder gets index.html, report.json, report.csv
and the images."""

_INFO_EXAMPLES = """\
examples:
  lightcull info lanterns
  lightcull info room.glb                                 also names what is not supported"""


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
        command.add_argument("scene", metavar="SCENE", help="file or name of an example")
        return command

    render = add("render", "render a scene to an image", _RENDER_EXAMPLES)
    render.add_argument(
        "--sampler", type=_sampler, default="culled", metavar="SAMPLER", help="default: culled"
    )
    render.add_argument("--view", help="of a .png: see through this view; default: the first")
    render.add_argument(
        "--exposure", type=float, metavar="STOPS", help="of a .png: brighten it; default: 0"
    )
    _add_shared(render, seconds=10, output="SCENE.exr", output_help=".exr or .png to write")

    compare = add("compare", "compare samplers in equal time", _COMPARE_EXAMPLES)
    compare.add_argument(
        "--samplers",
        type=_samplers,
        default=list(DEFAULT_SAMPLERS),
        metavar="A,B,...",
        help=f"default: {','.join(DEFAULT_SAMPLERS)}",
    )
    compare.add_argument(
        "--reference-seconds",
        type=_positive,
        metavar="S",
        help="render time of the reference; default: 8 times that of a sampler",
    )
    _add_shared(compare, seconds=30, output="report", output_help="folder to write")

    add("info", "say what is in a scene", _INFO_EXAMPLES)
    return parser


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
    parser.add_argument(
        "--size", type=_size, default=(320, 240), metavar="WxH", help="pixels; default: 320x240"
    )
    parser.add_argument(
        "--max-depth",
        type=_from_one,
        default=2,
        metavar="N",
        help="longest path, in edges: 2 is direct light only; default: 2",
    )
    budget = parser.add_mutually_exclusive_group()
    budget.add_argument(
        "--seconds", type=_positive, metavar="S", help=f"render time; default: {seconds:g}"
    )
    budget.add_argument("--spp", type=_from_one, metavar="N", help="samples per pixel instead")
    parser.add_argument(
        "--threads", type=_from_zero, default=0, metavar="N", help="default: 0, all there are"
    )
    parser.add_argument("--seed", type=_from_zero, default=0, metavar="N", help="default: 0")
    parser.add_argument(
        "-o", "--output", metavar="PATH", help=f"{output_help}; default: {output}"
    )
    parser.set_defaults(default_seconds=float(seconds))


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"([1-9]\d{0,4})x([1-9]\d{0,4})", text)
    if match is None:
        raise argparse.ArgumentTypeError(f"wanted WIDTHxHEIGHT such as 640x360, got {text!r}")
    return int(match[1]), int(match[2])


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"wanted a number above 0, got {text!r}")
    return value


def _from_one(text: str) -> int:
    if not text.isascii() or not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"wanted a whole number from 1 up, got {text!r}")
    return int(text)


def _from_zero(text: str) -> int:
    if not text.isascii() or not text.isdecimal():
        raise argparse.ArgumentTypeError(f"wanted a whole number from 0 up, got {text!r}")
    return int(text)


def _sampler(text: str) -> str:
    try:
        check_description(text)
    except Error as error:
        raise argparse.ArgumentTypeError(str(error)) from error
    return text


def _samplers(text: str) -> list[str]:
    return [_sampler(description) for description in text.split(",")]
