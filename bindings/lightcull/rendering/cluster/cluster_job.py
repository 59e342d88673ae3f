"""Renders of a scene that a cluster shares."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from distributed import Client

from ...scene import Scene
from ..chunk import Chunk, chunk_after
from ..chunk_job import ChunkJob, LocalChunks
from ..path_job import PathJob
from ..settings import RenderSettings
from .cluster_chunks import ClusterChunks


@contextmanager
def cluster_job(
    client: Client,
    scene: Scene,
    sampler: str,
    settings: RenderSettings,
    size: int,
    limit: int | None,
) -> Iterator[ChunkJob]:
    """A render in chunks of `size` passes, `limit` passes in all. None: that depends on time."""

    def following(passes: int) -> Chunk | None:
        return chunk_after(passes, size, limit)

    local = PathJob(scene, sampler, settings)
    source = ClusterChunks(client, LocalChunks(local), scene, sampler, settings, following)
    try:
        yield ChunkJob(sampler, settings, source, local.setup_seconds, size, limit)
    finally:
        source.close()
