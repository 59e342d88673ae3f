"""What can be rendered sampler by sampler, and compared: a scene of ours, or a host's."""

from __future__ import annotations

from typing import Protocol

from ..sampler import check_description
from ..scene import Scene
from .job import SubjectJob
from .own_sampler import SamplerChoice
from .path_job import PathJob
from .settings import RenderSettings


class Subject(Protocol):
    """A scene and the renderer that shows it: what `compare` and `render` take in place of a `Scene`.

    A whole renderer of one's own is compared by a class with these, whose samplers are whatever it
    calls so: strings that it understands. They take turns pass by pass, and the time of a run is
    what its job says.
    """

    @property
    def name(self) -> str:
        """Of the scene, for the report."""

    @property
    def light_count(self) -> int:
        """Number of lights, for the report."""

    def digest(self) -> str:
        """A hash of all that the image depends on, but for sampler and settings: references are
        kept by it.
        """

    def check_sampler(self, description: str) -> None:
        """Raises Error for a description that is not one of a sampler."""

    def new_job(
        self, sampler: str, settings: RenderSettings, spp: int | None = None
    ) -> SubjectJob:
        """A new render. Settings have size (pixels), max_depth, seed, threads, rr_depth and
        direct_light, as `render` documents them; jobs of other seeds are to be independent.
        spp: how many samples it will be asked for; None: that depends on time.
        """

    @property
    def best_sampler(self) -> str:
        """What it is rendered by unless told, and a reference always."""


class OwnSubject:
    """A scene that our own renderer shows."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self.name = scene.name

    @property
    def scene(self) -> Scene:
        return self._scene

    @property
    def light_count(self) -> int:
        return len(self._scene.lights())

    def digest(self) -> str:
        return self._scene.digest()

    def check_sampler(self, description: str) -> None:
        check_description(description)

    def new_job(
        self, sampler: str, settings: RenderSettings, spp: int | None = None
    ) -> SubjectJob:
        return PathJob(self._scene, sampler, settings)

    def new_own_job(
        self, name: str, sampler: SamplerChoice, settings: RenderSettings
    ) -> SubjectJob:
        """name: of the sampler, which is not one of ours."""
        return PathJob(self._scene, sampler, settings, name)

    def try_own(self, name: str, sampler: SamplerChoice) -> None:
        """Raises what a sampler of one's own raises, before anything is rendered in earnest."""
        self.new_own_job(name, sampler, RenderSettings((4, 3), 2, 0, 0)).render_pass()

    @property
    def best_sampler(self) -> str:
        """`learned`; `culled` where glossy points are among the lights, which `learned` refuses."""
        may_be_glossy = self._scene.counts["virtual lights"] > 0
        if may_be_glossy and self._scene.lights()["lobe_alpha"].any():
            return "culled"
        return "learned"


def subject_of(scene: Scene | Subject) -> Subject:
    """The scene with its renderer; a Scene has ours."""
    if isinstance(scene, Scene):
        return OwnSubject(scene)
    if not hasattr(scene, "new_job"):
        raise TypeError(f"scene: wanted a lightcull.Scene, got {scene!r}")
    return scene
