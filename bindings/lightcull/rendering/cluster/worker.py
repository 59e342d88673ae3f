"""What workers do. Each of these is called by name, with plain values, bytes and arrays, and gives such
back. What goes wrong is told, not raised: whoever asked could not say where it happened.
"""

from __future__ import annotations

import threading
from dataclasses import replace
from typing import Any, Literal, TypeAlias

import numpy as np
from distributed import get_worker

from ... import machine
from ..._core import Error
from ...scene import Scene
from ..chunk import Chunk
from ..path_job import PathJob
from .order import Order
from .scene_transport import from_bytes, from_source

Sums: TypeAlias = "tuple[Literal['sums'], np.ndarray, np.ndarray | None, tuple[Any, ...]]"
"""A chunk's sums, those of emission, and what is in STATS."""
Refusal: TypeAlias = "tuple[Literal['no scene', 'failed'], str, str]"
"""The address of a worker, and why it gives nothing."""

STATS = ("passes", "seconds", "sampler_seconds", "selection_seconds", "selections", "rays")
"""What is told of a chunk, in the order of `RenderStats`."""


def build_id() -> str:
    """Which lightcull this is."""
    return machine.build_id()


def kept(data: bytes) -> bytes:
    """Bytes that many tasks want: where a worker dies that held them, the scheduler has them again."""
    return data


def render_chunk(
    order: dict[str, Any],
    first: int,
    count: int,
    source: dict[str, Any] | None,
    contents: bytes | None,
    learned: bytes | None,
) -> Sums | Refusal:
    """Renders some passes. source: where the scene may be had from here. contents: the scene itself;
    None: it is asked for ("no scene") where it is needed.
    """
    with _LOCK:
        try:
            job = _BENCH.job_of(Order.from_dict(order), source, contents, learned)
            sums = job.render_chunk(Chunk(first, count))
        except _NoScene as reason:
            return "no scene", get_worker().address, str(reason)
        except MemoryError:
            return "failed", get_worker().address, "it has not enough memory"
        except Error as error:
            return "failed", get_worker().address, str(error)
    return "sums", sums.sums, sums.emission, tuple(getattr(sums.stats, name) for name in STATS)


class _NoScene(Exception):
    """The scene is not here."""


class _Bench:
    """The scene and the render that this process is at: those that come again need not be made."""

    def __init__(self) -> None:
        self._scene: Scene | None = None
        self._digest = ""
        self._job: PathJob | None = None
        self._key = ""

    def job_of(
        self,
        order: Order,
        source: dict[str, Any] | None,
        contents: bytes | None,
        learned: bytes | None,
    ) -> PathJob:
        key = order.key()
        if self._job is None or self._key != key:
            self._job = None  # before there are two
            scene = self._scene_of(order, source, contents)
            threads = order.settings.threads or get_worker().state.nthreads
            job = PathJob(scene, order.sampler, replace(order.settings, threads=threads))
            if learned:
                job.take_learned(learned)
            self._job, self._key = job, key
        return self._job

    def _scene_of(
        self, order: Order, source: dict[str, Any] | None, contents: bytes | None
    ) -> Scene:
        if self._scene is None or self._digest != order.digest:
            self._scene = None
            self._scene = _made(order, source, contents)
            self._digest = order.digest
        return self._scene


def _made(order: Order, source: dict[str, Any] | None, contents: bytes | None) -> Scene:
    if contents is not None:
        return from_bytes(contents, order.scene, order.digest)
    try:
        if source is None:
            raise Error("it has no name")
        return from_source(source, order.scene, order.digest)
    except Error as error:
        raise _NoScene(str(error)) from error


_LOCK = threading.Lock()
_BENCH = _Bench()
