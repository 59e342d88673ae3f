"""What can be rendered sampler by sampler, and compared: a scene of ours, or a host's."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from ..sampler import check_description
from ..scene import Scene
from .job import CountingJob
from .path_job import PathJob
from .settings import RenderSettings

_CULLED, _CLUSTERS = "culled", "light_bvh:importance=means"
"""The samplers of least noise for many lights."""
_FEW_LIGHTS = 200
"""With so few, weighing all of them for each point costs little."""


class Subject(Protocol):
    """A scene, and the renderer that shows it."""

    @property
    def name(self) -> str: ...
    @property
    def light_count(self) -> int: ...
    def digest(self) -> str:
        """A hash of all that the image depends on, but for sampler and settings."""

    def check_sampler(self, description: str) -> None:
        """Raises Error for a description that is not one of a sampler."""

    def new_job(
        self, sampler: str, settings: RenderSettings, spp: int | None = None
    ) -> CountingJob:
        """spp: how many samples it will be asked for; None: that depends on time."""

    def reference_samplers(self, under_test: Sequence[str]) -> tuple[str, str]:
        """What renders the two halves of a reference."""


class OwnSubject:
    """A scene that our own renderer shows."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self.name = scene.name

    @property
    def light_count(self) -> int:
        return len(self._scene.lights())

    def digest(self) -> str:
        return self._scene.digest()

    def check_sampler(self, description: str) -> None:
        check_description(description)

    def new_job(self, sampler: str, settings: RenderSettings, spp: int | None = None) -> PathJob:
        return PathJob(self._scene, sampler, settings)

    def reference_samplers(self, under_test: Sequence[str]) -> tuple[str, str]:
        return samplers_of_reference(under_test, self.light_count)


def samplers_of_reference(under_test: Sequence[str], light_count: int) -> tuple[str, str]:
    """Of our own renderer's samplers, as `best_not_under_test`."""
    best_first = ["exhaustive"] if light_count <= _FEW_LIGHTS else []
    return best_not_under_test([*best_first, _CULLED, _CLUSTERS], under_test)


def best_not_under_test(best_first: Sequence[str], under_test: Sequence[str]) -> tuple[str, str]:
    """The best sampler that is not under test, for both halves; if all are, the last two, so that
    what one has wrong shows as noise of the reference.
    """
    families = {description.split(":")[0] for description in under_test}
    free = [sampler for sampler in best_first if sampler.split(":")[0] not in families]
    return (free[0], free[0]) if free else (best_first[-2], best_first[-1])
