"""Frames that workers render, each of them one."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from distributed import Client, get_worker

from ..._core import Error
from ..chunk import Chunk
from ..frame_series import FrameSeries
from ..result import RenderResult
from ..statistics import Stats
from .flow import Flow
from .order import hash_of


def frame_results(client: Client, series: FrameSeries) -> Iterator[tuple[int, RenderResult]]:
    """All frames, in their order."""

    def following(done: int) -> Chunk | None:
        return Chunk(done, 1) if done <= series.last else None

    hashes = {
        str(number): series.file_hash(number) for number in range(series.first, series.last + 1)
    }
    plain = series.to_dict()
    key = hash_of(json.dumps([plain, hashes], sort_keys=True).encode())
    flow = Flow(client, key, series.first, following)
    flow.task = render_frame
    flow.arguments = {"series": plain, "hashes": hashes}

    def understood(answer: Any) -> RenderResult | None:
        if answer[0] == "failed":
            flow.refuse(answer[1], answer[2])
            return None
        _, image, stats, scene, sampler = answer
        settings = series.settings
        return RenderResult(
            image, Stats(**stats), scene, sampler, settings.max_depth, settings.seed, False
        )

    try:
        for number in range(series.first, series.last + 1):
            yield number, flow.take(Chunk(number, 1), understood)
    finally:
        flow.close()


def render_frame(
    first: int, count: int, series: dict[str, Any], hashes: dict[str, str]
) -> tuple[Any, ...]:
    """What a worker does: the image of frame `first`, float32 (H, W, 3), its statistics, the names of its
    scene and of its sampler; or its address, and why it gives nothing.
    """
    frames = FrameSeries.from_dict(series)
    try:
        if frames.file_hash(first) != hashes[str(first)]:
            raise Error(f"{frames.scene_name(first)}: is not there, or another file here")
        result = frames.render(first)
    except MemoryError:
        return "failed", get_worker().address, "it has not enough memory"
    except Error as error:
        return "failed", get_worker().address, str(error)
    return "image", result.image, vars(result.stats), result.scene, result.sampler
