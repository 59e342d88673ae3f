"""A scheduler that is gone."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from distributed import CancelledError, Client
from distributed.comm.core import CommClosedError

from ..cluster_access import ClusterError


def check_alive(client: Client) -> None:
    """Throws ClusterError if the connection to the scheduler is lost."""
    if client.status != "running":
        raise _gone()


@contextmanager
def named_loss() -> Iterator[None]:
    """What Dask raises where the connection breaks, or has been broken since, becomes a ClusterError."""
    try:
        yield
    except (CancelledError, CommClosedError, OSError, TimeoutError) as error:
        raise _gone() from error


def _gone() -> ClusterError:
    return ClusterError("cluster: the connection to the scheduler is lost")
