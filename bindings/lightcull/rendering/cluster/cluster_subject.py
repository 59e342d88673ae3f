"""A scene that a cluster renders."""

from __future__ import annotations

from contextlib import ExitStack

from distributed import Client

from ...scene import Scene
from ..cluster_access import sampler_on_cluster
from ..job import SubjectJob
from ..settings import RenderSettings
from ..subject import OwnSubject
from .cluster_job import cluster_job


class ClusterSubject(OwnSubject):
    """A scene of ours, whose renders are shared out until `jobs` are closed."""

    def __init__(self, client: Client, scene: Scene, chunk: int, jobs: ExitStack) -> None:
        super().__init__(scene)
        self._client = client
        self._chunk = chunk
        self._jobs = jobs

    def new_job(
        self, sampler: str, settings: RenderSettings, spp: int | None = None
    ) -> SubjectJob:
        job = cluster_job(self._client, self._scene, sampler, settings, self._chunk, spp)
        return self._jobs.enter_context(job)

    @property
    def best_sampler(self) -> str:
        return sampler_on_cluster(super().best_sampler)
