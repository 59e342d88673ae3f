"""The workers that take part in a render, as they come and go."""

from __future__ import annotations

import time
import warnings
from contextlib import suppress

from distributed import Client, Future

from ... import machine
from ..cluster_access import ClusterError
from .lost import check_alive
from .worker import build_id

_SECONDS_BETWEEN = 0.25
_LONGEST_ANSWER = 5.0
"""Seconds in which an answer that is there comes here."""
_PATIENCE = 60.0
"""Seconds without any worker."""


class Pool:
    """Those of our build, which each of them is asked for when it comes."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self._asked: dict[str, Future[str]] = {}
        self._good: set[str] = set()
        self._refused: dict[str, str] = {}
        """Why, by address."""
        self._next = self._seen = time.monotonic()

    @property
    def addresses(self) -> list[str]:
        """Who takes part now."""
        return sorted(self._good)

    def refuse(self, address: str, why: str) -> None:
        """Leaves a worker out from now on, and says so."""
        if address in self._refused:
            return
        self._refused[address] = why
        self._good.discard(address)
        warnings.warn(f"cluster: worker {address} is left out: {why}", stacklevel=2)

    def refresh(self) -> None:
        """Looks who is there, from time to time. Throws ClusterError where nobody has been for long, or all
        that are there are left out.
        """
        check_alive(self._client)
        now = time.monotonic()
        if now < self._next:
            return
        self._next = now + _SECONDS_BETWEEN
        there = set(self._client.nthreads())
        self._good &= there
        for address in set(self._asked) - there:
            del self._asked[address]
        for address in there - self._good - set(self._refused):
            self._ask(address)
        self._check_somebody(there, now)

    def _ask(self, address: str) -> None:
        """Asks it, or takes its answer."""
        if address not in self._asked:
            self._asked[address] = self._client.submit(
                build_id, workers=[address], allow_other_workers=False, pure=False, priority=1
            )
        answer = self._asked[address]
        if not answer.done():
            return
        del self._asked[address]
        if answer.status == "error":
            self.refuse(address, f"it has no lightcull that works: {answer.exception()}")
            return
        with suppress(TimeoutError):  # as of one that has died since
            theirs, ours = answer.result(timeout=_LONGEST_ANSWER), machine.build_id()
            if theirs == ours:
                self._good.add(address)
            else:
                self.refuse(address, f"it has lightcull {theirs}, not {ours}")

    def _check_somebody(self, there: set[str], now: float) -> None:
        if there and there <= set(self._refused):
            address = min(there)
            raise ClusterError(f"cluster: no worker is left: {address}: {self._refused[address]}")
        if there:
            self._seen = now
        elif now - self._seen > _PATIENCE:
            raise ClusterError(f"cluster: there has been no worker for {_PATIENCE:.0f} s")
