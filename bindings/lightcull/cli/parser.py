"""What the command line understands."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import NoReturn, get_args

from ..bench import DEFAULT_SAMPLERS as BENCH_SAMPLERS
from ..bench import DEFAULT_SIZE as BENCH_SIZE
from ..bench import DEFAULT_THREADS as BENCH_THREADS
from ..comparing.compare import DEFAULT_SAMPLERS
from ..loaders.gltf import LightUnit
from ..methods.studies import MOST_LIGHTS
from ..rendering.chunk import CLUSTER_CHUNK
from ..rendering.method import METHODS, PATH
from ..rendering.settings import DIRECT_LIGHT, RR_DEPTH
from ..report import METRICS
from . import argument_types as types
from . import help_texts as texts
from .messages import one_line


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: error: {one_line(message)} (see {self.prog} --help)\n")


def make_parser() -> argparse.ArgumentParser:
    """The parser of the whole command line."""
    parser = _make(_Parser, "lightcull", texts.OVERVIEW, texts.EXAMPLES)
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    about = texts.OVERVIEW.split("\n", 2)[2]

    def add(name: str, summary: str, examples: str) -> argparse.ArgumentParser:
        command: argparse.ArgumentParser = commands.add_parser(
            name,
            help=summary,
            description=f"{summary[0].upper()}{summary[1:]}.\n\n{about}",
            epilog=examples,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        return command

    render = add("render", "render a scene to an image", texts.RENDER)
    _add_sampler(render)
    _add_method(render)
    render.add_argument("--view", help="of a .png: see through this view; default: the first")
    render.add_argument(
        "--exposure", type=types.finite, metavar="STOPS", help="of a .png: brighten it; default: 0"
    )
    render.add_argument(
        "--checkpoint", metavar="FILE", help="save the render to go on from later; a new file"
    )
    render.add_argument(
        "--every", type=types.positive, metavar="S", help="seconds between; default: 60"
    )
    render.add_argument(
        "--resume", metavar="FILE", help="go on from a checkpoint, and keep it up to date"
    )
    _add_cluster(render)
    render.add_argument(
        "--frames", type=types.frame_range, metavar="FIRST:LAST",
        help="render frames, one a task of a cluster: signs # in SCENE and PATH are their numbers",
    )  # fmt: skip
    render.add_argument(
        "--camera-path", metavar="FILE", help="of --frames: JSON with a camera for each frame"
    )
    _add_shared(render, seconds=10, output="SCENE.exr", output_help=".exr or .png to write")

    compare = add("compare", "compare samplers in equal time", texts.COMPARE)
    _add_samplers(compare, (*DEFAULT_SAMPLERS, "learned"))
    compare.add_argument(
        "--methods", type=types.method_list, metavar="A,B,...",
        help="compare how light that bounces is found instead; see `lightcull render --help`",
    )  # fmt: skip
    compare.add_argument(
        "--most-lights", type=types.from_one, metavar="N",
        help=f"of --methods: light paths up to which virtual lights are scaled; default: {MOST_LIGHTS}",
    )  # fmt: skip
    compare.add_argument(
        "--reference-seconds",
        type=types.positive,
        metavar="S",
        help="render time of the reference; default: 8 times that of a sampler",
    )
    compare.add_argument(
        "--repeats", type=types.from_one, metavar="N",
        help="runs of each sampler, with seeds of their own, for 95 %% intervals; default: 1",
    )  # fmt: skip
    compare.add_argument(
        "--mask", metavar="FILE",
        help="image, as large as the one that is rendered: pixels that are not black there count",
    )  # fmt: skip
    compare.add_argument(
        "--metrics", type=types.metric_list, metavar="A,B,...",
        help=f"errors that are taken besides, of {', '.join(METRICS)}",
    )  # fmt: skip
    compare.add_argument(
        "--slices", type=types.from_one, metavar="N",
        help="write the samples of each run in N parts, too, as raw images",
    )  # fmt: skip
    _add_cluster(compare)
    _add_shared(compare, seconds=30, output="report", output_help="folder to write")

    info = add("info", "say what is in a scene, and what memory it takes", texts.INFO)
    _add_scene(info)
    _add_sampler(info)
    _add_method(info)
    _add_view(info)
    _add_image(info)
    _add_mitsuba(info)
    selftest = add("selftest", "check hard cases on this machine", texts.SELFTEST)
    selftest.add_argument("--json", metavar="FILE", help="file to write the results to")
    selftest.add_argument(
        "--noise", action="store_true",
        help="instead: is the default sampler ever noisier than the best of the others?",
    )  # fmt: skip
    _add_bench(add("bench", "measure what a selection costs", texts.BENCH))
    return parser


def _add_scene(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("scene", metavar="SCENE", help="file or name of an example")
    parser.add_argument(
        "--virtual-lights", type=types.from_one, metavar="N",
        help="add virtual lights to the scene's: where N light paths meet surfaces for the first "
        "time. Not for an .xml",
    )  # fmt: skip
    parser.add_argument(
        "--gltf-lights", choices=get_args(LightUnit),
        help="unit of the points, spots and suns of a glTF file beside surfaces that emit: candela "
        "and lux, which are divided by 683, as Blender has multiplied them unless told not to, or "
        "watts; default: watts",
    )  # fmt: skip


def _add_view(parser: argparse.ArgumentParser) -> None:
    """What a scene is seen by, and what surrounds it."""
    parser.add_argument(
        "--camera", metavar="NAME", help="camera of the file by name or number, from 0; default: 0"
    )
    parser.add_argument(
        "--camera-from", type=types.vector, metavar="X,Y,Z", help="a camera there instead, metres"
    )
    parser.add_argument(
        "--camera-to", type=types.vector, metavar="X,Y,Z",
        help="where that looks; default: the middle of the scene",
    )  # fmt: skip
    parser.add_argument(
        "--camera-up", type=types.vector, metavar="X,Y,Z", help="what is up there; default: 0,1,0"
    )
    parser.add_argument(
        "--fov", type=types.field_of_view, metavar="DEGREES",
        help="angle that the camera sees from bottom to top; default: its own, or 45",
    )  # fmt: skip
    parser.add_argument(
        "--environment", metavar="FILE|COLOUR|studio|none",
        help="surroundings: an image of latitude and longitude, or a colour: 0.5 or 0.2,0.3,0.5 "
        "(linear), #336699 (sRGB); default: those of the file, or a studio where it has no light, "
        "or one that shows little of what the camera sees",
    )  # fmt: skip
    parser.add_argument(
        "--environment-scale", type=types.positive, metavar="S", help="times that; default: 1"
    )


def _add_mitsuba(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--host", choices=["mitsuba"], help="renderer to use; default: mitsuba for an .xml"
    )
    parser.add_argument("--variant", help="of Mitsuba, for an .xml alone; default: scalar_rgb")
    parser.add_argument(
        "-D", "--define", type=types.definition, action="append", metavar="NAME=VALUE",
        help="of an .xml alone: value of a parameter $NAME, in place of its default",
    )  # fmt: skip


def _add_cluster(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--cluster", metavar="ADDRESS",
        help="share the passes (compare: of the reference) out among the workers of a Dask scheduler, "
        "tcp://HOST:8786, or among N of this machine, local:N; wants lightcull[cluster]",
    )  # fmt: skip
    parser.add_argument(
        "--chunk", type=types.from_one, metavar="N",
        help=f"passes that are added up as one, by a worker; default: {CLUSTER_CHUNK} on a cluster, "
        "else 1",
    )  # fmt: skip


def _add_sampler(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--sampler", type=types.sampler, metavar="SAMPLER",
        help="default: learned; culled where glossy virtual lights are among the lights",
    )  # fmt: skip


def _add_method(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--method", type=types.method, default=PATH, metavar="METHOD",
        help=f"{', '.join(METHODS)}, with options; default: {PATH}",
    )  # fmt: skip


def _add_image(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--size",
        type=types.image_size,
        metavar="WxH",
        help="pixels; default: 320x240; of an .xml: its own",
    )
    parser.add_argument(
        "--max-depth",
        type=types.from_one,
        metavar="N",
        help="longest path, in edges: 2 is direct light only; default: 2; of an .xml: its own",
    )


def _add_samplers(parser: argparse.ArgumentParser, default: Sequence[str]) -> None:
    parser.add_argument(
        "--samplers",
        type=types.sampler_list,
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
    _add_view(parser)
    _add_samplers(parser, BENCH_SAMPLERS)
    parser.add_argument(
        "--size",
        type=types.image_size,
        default=BENCH_SIZE,
        metavar="WxH",
        help="of the image whose points are taken; default: {}x{}".format(*BENCH_SIZE),
    )
    parser.add_argument(
        "--threads",
        type=types.thread_counts,
        default=list(BENCH_THREADS),
        metavar="M,N,...",
        help=f"default: {','.join(map(str, BENCH_THREADS))}",
    )
    parser.add_argument(
        "--targets",
        type=types.instruction_set_list,
        metavar="A,B,...",
        help="instruction sets, or all; default: the best that this machine has",
    )
    parser.add_argument(
        "--device",
        default="cpu",
        metavar="DEVICE",
        help="where culled and paper are measured as well: vulkan, or vulkan:NAME for one whose "
        "name holds NAME",
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
    _add_view(parser)
    _add_image(parser)
    _add_mitsuba(parser)
    budget = parser.add_mutually_exclusive_group()
    budget.add_argument(
        "--seconds", type=types.positive, metavar="S", help=f"render time; default: {seconds:g}"
    )
    budget.add_argument("--spp", type=types.from_one, metavar="N", help="samples per pixel instead")
    parser.add_argument(
        "--threads", type=types.from_zero, default=0, metavar="N", help="default: 0, all there are"
    )
    parser.add_argument("--seed", type=types.seed, default=0, metavar="N", help="default: 0")
    parser.add_argument(
        "--rr-depth", type=types.from_one, metavar="N",
        help=f"edges from which Russian roulette may end a path; default: {RR_DEPTH}; of an .xml: "
        "its own",
    )  # fmt: skip
    parser.add_argument(
        "--direct-light", choices=DIRECT_LIGHT,
        help="sample lights and the BSDF (mis), or one of them alone; default: mis",
    )  # fmt: skip
    parser.add_argument(
        "--hide-emitters", action=argparse.BooleanOptionalAction,
        help="the camera sees neither surfaces that emit, but what is behind them, nor the "
        "environment; default: no; of an .xml: its own",
    )  # fmt: skip
    parser.add_argument("-o", "--output", metavar="PATH", help=f"{output_help}; default: {output}")
    parser.set_defaults(default_seconds=float(seconds))
