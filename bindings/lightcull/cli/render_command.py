"""lightcull render."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console

from ..output_files import make_folder
from ..rendering.method import PATH
from ..rendering.render import render
from ..rendering.result import RenderResult
from ..scene import Scene
from .options import RenderOptions
from .progress_bars import Bars


def run(options: RenderOptions, messages: Console) -> bool:
    """Renders, writes the image and says so. False if Ctrl-C ended it early."""
    with Bars(messages) as bars, _named_checkpoint(options):
        result = render(
            options.scene,
            options.sampler,
            method=options.method,
            seconds=options.seconds,
            spp=options.spp,
            size=options.size,
            max_depth=options.max_depth,
            seed=options.seed,
            threads=options.threads,
            rr_depth=options.rr_depth,
            direct_light=options.direct_light,
            hide_emitters=options.hide_emitters,
            progress=bars,
            checkpoint=options.checkpoint,
            every=options.every,
            resume=options.resume,
            cluster=options.cluster,
            chunk=options.chunk,
        )
    make_folder(options.output.parent)
    result.save(options.output, options.view, options.exposure)
    print(_summary(options, result))
    return not result.interrupted


def _summary(options: RenderOptions, result: RenderResult) -> str:
    stats, scene = result.stats, options.scene
    height, width = result.image.shape[:2]
    lights = (
        f"{len(scene.lights()):,} lights"
        if isinstance(scene, Scene)
        else f"{scene.light_count:,} emitters of Mitsuba's"
    )
    return (
        f"{options.output}: {width}x{height}, {stats.spp} samples per pixel in "
        f"{stats.seconds:.1f} s, {result.sampler} among {lights}"
        + (f", bounces by {options.method}" if options.method != PATH else "")
        + (", interrupted" if result.interrupted else "")
    )


@contextmanager
def _named_checkpoint(options: RenderOptions) -> Iterator[None]:
    """Says what stays of a render that is stopped at once."""
    path = options.checkpoint or options.resume
    try:
        yield
    except KeyboardInterrupt:
        if path is None or not Path(path).exists():
            raise
        raise KeyboardInterrupt(f"stopped at once: {path} is as it was saved last") from None
