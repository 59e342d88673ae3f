"""Clusters, for those who are asked to use one: here, because what uses Dask wants it installed."""

from __future__ import annotations

import importlib.util
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, TypeAlias

from .. import checks
from .._core import Error

if TYPE_CHECKING:
    from distributed import Client

ClusterChoice: TypeAlias = "str | Client"
"""An address such as "tcp://host:8786", "local:4" for workers on this machine, or a Dask client."""

class ClusterError(Error):
    """What ends a render on a cluster, which may go on elsewhere."""


def sampler_on_cluster(best: str) -> str:
    """What a cluster renders by unless told, for what is best on one machine: `learned` comes to rest
    early, since nobody else can help as long as it learns.
    """
    return "learned:rounds=32" if best == "learned" else best


def check_cluster(cluster: object) -> None:
    """Throws Error without Dask, and TypeError for what is no cluster."""
    if importlib.util.find_spec("distributed") is None:
        raise Error("cluster: wants Dask: pip install 'lightcull[cluster]'")
    from distributed import Client

    if isinstance(cluster, str):
        checks.text("cluster", cluster)
    elif not isinstance(cluster, Client) or cluster.asynchronous:
        raise TypeError(f"cluster: wanted an address or a distributed.Client, got {cluster!r}")


def connected(cluster: ClusterChoice) -> AbstractContextManager[Client]:
    """A client of a cluster."""
    check_cluster(cluster)
    from .cluster.connection import connected as connect

    return connect(cluster)
