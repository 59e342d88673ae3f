"""How to get at a cluster."""

from __future__ import annotations

import gc
import logging
import re
from collections.abc import Iterator
from contextlib import contextmanager

from distributed import Client, LocalCluster

from ... import machine
from ..._core import Error
from . import local_worker

_PATIENCE = 10.0
"""Seconds in which a scheduler must answer."""


@contextmanager
def connected(cluster: str | Client) -> Iterator[Client]:
    """A client of a cluster by its address, of so many workers on this machine ("local:4"), or one that
    is there already, which stays.
    """
    if isinstance(cluster, Client):
        yield cluster
        return
    with _quiet():
        yield from _connected(cluster)


def _connected(cluster: str) -> Iterator[Client]:
    if match := re.fullmatch(r"local:([1-9][0-9]{0,3})", cluster):
        with _local(int(match[1])) as local, Client(local, set_as_default=False) as client:
            yield client
    else:
        with _client_at(cluster) as client:
            yield client


@contextmanager
def _quiet() -> Iterator[None]:
    """What Dask writes of lost connections is said in one line, and by us."""
    logger = logging.getLogger("distributed")
    before = logger.level
    logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        logger.setLevel(before)


def _local(workers: int) -> LocalCluster:
    """Worker processes that share the processors, and listen to this machine alone."""
    return LocalCluster(
        n_workers=workers, threads_per_worker=max(machine.core_count() // workers, 1),
        host="127.0.0.1", dashboard_address="127.0.0.1:0", silence_logs=50,
        preload=local_worker.__name__,
    )  # fmt: skip


def _client_at(address: str) -> Client:
    """Certificates, where the address is of tls, are those of Dask's configuration."""
    try:
        return Client(address, timeout=_PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError, RuntimeError) as error:
        reason = " ".join(str(error).split())[:200]
    # The client that was not let in is closed now: as rubbish it would be so at any time, also within
    # the start of another one, which waits for ever then.
    gc.collect()
    raise Error(f"cluster: {address}: no scheduler answers: {reason}")
