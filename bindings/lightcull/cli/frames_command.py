"""lightcull render --frames."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console

from .._core import Error
from ..output_files import make_folder
from ..rendering.cluster_access import ClusterError, connected
from ..rendering.frame_series import FrameSeries, numbered
from ..rendering.interruption import Interruption
from ..rendering.progress import Progress
from ..rendering.result import RenderResult
from .options import FramesOptions
from .progress_bars import Bars

FrameResults = Iterator[tuple[int, RenderResult]]


def run(options: FramesOptions, messages: Console) -> bool:
    """Renders frames, and writes each as it comes. False if Ctrl-C ended it early."""
    series = options.series
    start, done = time.monotonic(), series.first - 1
    with Bars(messages) as bars, Interruption() as interruption, _results(options) as results:
        try:
            while done < series.last and not interruption.asked:
                number, result = next(results)
                _write(options, number, result)
                done = number
                bars(_progress(series, done, result, time.monotonic() - start))
        except ClusterError as error:
            raise Error(f"{error}; go on with --frames {done + 1}:{series.last}") from error
    count = done - series.first + 1
    print(f"{options.output}: {count} frames in {time.monotonic() - start:.1f} s" + _rest(series, done))
    return done == series.last


def _rest(series: FrameSeries, done: int) -> str:
    return "" if done == series.last else f", interrupted: go on with --frames {done + 1}:{series.last}"


def _write(options: FramesOptions, number: int, result: RenderResult) -> None:
    path = Path(numbered(options.output, number))
    make_folder(path.parent)
    result.save(path, options.view, options.exposure)


def _progress(series: FrameSeries, done: int, result: RenderResult, seconds: float) -> Progress:
    count, total = done - series.first + 1, series.last - series.first + 1
    left = (total - count) * seconds / count
    return Progress("frames", count / total, result.stats.spp, left)


@contextmanager
def _results(options: FramesOptions) -> Iterator[FrameResults]:
    """Frames in their order, rendered here or by a cluster."""
    if options.cluster is None:
        yield options.series.results()
        return
    with connected(options.cluster) as client:
        # Here, because importing it wants Dask, which is optional.
        from ..rendering.cluster.frame_tasks import frame_results

        yield frame_results(client, options.series)
