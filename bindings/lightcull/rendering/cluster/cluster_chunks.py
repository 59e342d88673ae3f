"""Chunks that workers render."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

from dask import config
from distributed import Client, Future

from ... import _core
from ...scene import Scene
from ..chunk import Chunk, ChunkSums
from ..chunk_job import LocalChunks
from ..settings import RenderSettings
from .flow import Flow
from .order import Order, hash_of
from .scene_transport import bytes_of, check_can_be_sent, source_of
from .worker import Refusal, Sums, kept, render_chunk


class ClusterChunks:
    """Those in which a sampler learns are rendered here, one after the other; what it knows then goes to
    the workers, which render the others.
    """

    def __init__(
        self,
        client: Client,
        local: LocalChunks,
        scene: Scene,
        sampler: str,
        settings: RenderSettings,
        chunk_after: Callable[[int], Chunk | None],
    ) -> None:
        """chunk_after: what comes after so many passes; None: nothing. Throws Error for a scene that
        cannot be sent.
        """
        check_can_be_sent(scene)
        self._client = client
        self._local = local
        self._scene = scene
        self._order = Order(scene.name, scene.digest(), sampler, settings, "")
        self._chunk_after = chunk_after
        self._flow: Flow | None = None

    def render(self, chunk: Chunk) -> ChunkSums:
        if self._local.learning:
            return self._local.render(chunk)
        if self._flow is None:
            self._flow = self._begin(chunk)
        return self._flow.take(chunk, self._understood)

    def learned(self) -> bytes:
        return self._local.learned()

    def resume(self, learned: bytes) -> None:
        self._local.resume(learned)

    def close(self) -> None:
        """Forgets what is on its way."""
        if self._flow is not None:
            self._flow.close()

    def _begin(self, first: Chunk) -> Flow:
        learned = self._local.learned()
        order = Order(**{**vars(self._order), "learned": hash_of(learned)})
        flow = Flow(self._client, order.key(), first.first, self._chunk_after)
        flow.task = render_chunk
        flow.arguments = {
            "order": order.to_dict(),
            "source": source_of(self._scene),
            "contents": None,
            "learned": self._kept(learned) if learned else None,
        }
        if flow.arguments["source"] is None:
            flow.arguments["contents"] = self._kept(bytes_of(self._scene))
        return flow

    def _understood(self, answer: Sums | Refusal) -> ChunkSums | None:
        flow = self._flow
        assert flow is not None
        if answer[0] == "sums":
            _, sums, emission, stats = answer
            return ChunkSums(sums, emission, _core.RenderStats(*stats))
        if answer[0] == "no scene" and flow.arguments["contents"] is None:
            flow.arguments["contents"] = self._kept(bytes_of(self._scene))
        elif answer[0] == "failed":
            flow.refuse(answer[1], answer[2])
        return None

    def _kept(self, data: bytes) -> Future[bytes]:
        """Bytes that go to each worker once, and not with each task."""
        with config.set({"distributed.admin.large-graph-warning-threshold": "1 PB"}):
            return self._client.submit(kept, data, key=f"lightcull-{hash_of(data)}")
