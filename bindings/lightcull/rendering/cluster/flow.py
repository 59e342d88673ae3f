"""Chunks on their way: some ahead of the one that is wanted next, and each taken once."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from distributed import Client, Future, KilledWorker

from ..cluster_access import ClusterError
from ..chunk import Chunk
from .lost import named_loss
from .pool import Pool

Found = TypeVar("Found")

_AHEAD = 2
"""Chunks for each worker: one that it renders, and one that it has next."""
_TRIES = 4
"""Of a chunk whose workers die; Dask tries each a few times by itself."""
_SECONDS_BETWEEN = 0.005
_LONGEST_TRANSFER = 60.0
"""Seconds in which sums that are there come here."""


@dataclass
class _Sent:
    """A chunk that was sent."""

    chunk: Chunk
    future: Future[Any]
    workers: list[str]
    """Who may render it."""
    number: int = 0
    """Of the try."""
    deaths: int = 0


class Flow:
    """Sends chunks and takes what comes back. So many are on their way that no worker waits, and no more:
    memory does not depend on how many there are in all.
    """

    def __init__(
        self, client: Client, key: str, first: int, chunk_after: Callable[[int], Chunk | None]
    ) -> None:
        """key: by which chunks are known. first: number of the first pass. chunk_after: what comes
        after so many passes; None: nothing.
        """
        self._client = client
        self._key = key
        self._end = first
        """Passes that were sent."""
        self._chunk_after = chunk_after
        self._pool = Pool(client)
        self._sent: dict[int, _Sent] = {}
        self.task: Callable[..., Any]
        """What renders a chunk, of `first`, `count` and the arguments."""
        self.arguments: dict[str, Any] = {}

    def take(self, chunk: Chunk, understood: Callable[[Any], Found | None]) -> Found:
        """Waits for a chunk. understood: what an answer holds, or None where the chunk is to be sent
        again.
        """
        with named_loss():
            while True:
                self._pool.refresh()
                self._send_ahead()
                sent = self._sent.get(chunk.first)
                answer = None if sent is None else self._answer_to(sent)
                if sent is not None and answer is not None:
                    found = understood(answer)
                    if found is not None:
                        self._sent.pop(chunk.first).future.release()
                        return found
                    self._send_again(sent)
                time.sleep(_SECONDS_BETWEEN)

    def refuse(self, address: str, why: str) -> None:
        """Leaves a worker out."""
        self._pool.refuse(address, why)

    def close(self) -> None:
        """Forgets what is on its way, so that the cluster does, too."""
        for sent in self._sent.values():
            sent.future.release()
        self._sent.clear()
        self.arguments = {}

    def _send_ahead(self) -> None:
        workers = self._pool.addresses
        for sent in self._sent.values():
            if not sent.future.done() and not set(sent.workers) & set(workers):
                self._send_again(sent)
        while len(self._sent) < _AHEAD * len(workers):
            chunk = self._chunk_after(self._end)
            if chunk is None:
                return
            self._sent[chunk.first] = _Sent(chunk, self._submit(chunk, workers, 0), workers)
            self._end = chunk.end

    def _send_again(self, sent: _Sent) -> None:
        if workers := self._pool.addresses:
            sent.future.release()
            sent.number += 1
            sent.workers = workers
            sent.future = self._submit(sent.chunk, workers, sent.number)

    def _submit(self, chunk: Chunk, workers: list[str], number: int) -> Future[Any]:
        return self._client.submit(
            self.task, first=chunk.first, count=chunk.count, **self.arguments,
            key=f"lightcull-{self._key}-{chunk.first}-{chunk.count}-{number}",
            workers=workers, allow_other_workers=False, priority=-chunk.first,
        )  # fmt: skip

    def _answer_to(self, sent: _Sent) -> Any | None:
        """What has come; None: nothing yet."""
        if not sent.future.done():
            return None
        if sent.future.status == "error":
            self._take_error(sent, sent.future.exception())
            return None
        try:
            return sent.future.result(timeout=_LONGEST_TRANSFER)
        except TimeoutError:  # whoever held it has died meanwhile, and it is rendered again
            return None

    def _take_error(self, sent: _Sent, error: BaseException) -> None:
        if not isinstance(error, KilledWorker):
            raise ClusterError(f"cluster: {type(error).__name__}: {error}") from error
        if not self._pool.addresses:
            return  # until there is somebody who may try
        sent.deaths += 1
        if sent.deaths == _TRIES:
            chunk = sent.chunk
            raise ClusterError(
                f"cluster: passes {chunk.first} to {chunk.end - 1}: all workers died of them, "
                f"{error.last_worker.address} last: is there enough memory?"
            ) from error
        self._send_again(sent)
