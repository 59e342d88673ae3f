"""Other renderers among the samplers of a scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from .. import machine
from ..rendering.job import SubjectJob
from ..rendering.own_sampler import SamplerChoice
from ..rendering.settings import RenderSettings
from ..rendering.subject import OwnSubject
from ..scene import Scene
from . import cycles, pbrt
from .job import Peer, PeerJob
from .processor_time import ProcessorTimeJob

_CHECKS: dict[str, Callable[[str], object]] = {"cycles": cycles.check, "pbrt": pbrt.check}
_MAKERS: dict[str, Callable[[Scene, str, RenderSettings], Peer]] = {
    "cycles": cycles.Cycles,
    "pbrt": pbrt.Pbrt,
}


def is_peer(description: str) -> bool:
    """Whether that is another renderer, by its name."""
    return _name(description) in _MAKERS


def _name(description: str) -> str:
    return description.split(":")[0]


class SubjectWithPeers(OwnSubject):
    """A scene of ours that others show, too: all by the time of processors, over the number of
    threads.
    """

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        self._peers: dict[tuple[str, RenderSettings], Peer] = {}

    def check_sampler(self, description: str) -> None:
        if is_peer(description):
            _CHECKS[_name(description)](description)
        else:
            super().check_sampler(description)

    def new_job(
        self, sampler: str, settings: RenderSettings, spp: int | None = None
    ) -> SubjectJob:
        if not is_peer(sampler):
            make = super().new_job
            return _by_processors(lambda: make(sampler, settings, spp), settings)
        key = (sampler, replace(settings, seed=0))
        if key not in self._peers:
            self._peers[key] = _MAKERS[_name(sampler)](self._scene, *key)
        return PeerJob(self._peers[key], settings.seed, spp)

    def new_own_job(
        self, name: str, sampler: SamplerChoice, settings: RenderSettings
    ) -> SubjectJob:
        make = super().new_own_job
        return _by_processors(lambda: make(name, sampler, settings), settings)


def _by_processors(make: Callable[[], SubjectJob], settings: RenderSettings) -> SubjectJob:
    return ProcessorTimeJob(make, settings.threads or machine.core_count())
