"""Rendering a scene in which things move, frame by frame."""

from __future__ import annotations

from .. import checks
from ..scene import Scene
from .budget import Budget
from .passes import run_passes, warn_of_nonsense
from .path_job import PathJob
from .progress import ProgressCallback
from .result import RenderResult
from .settings import RR_DEPTH, RenderSettings
from .subject import subject_of


class Frames:
    """Renders a scene again and again, by paths, while things in it move (`Scene.set_mesh_positions`,
    `set_light_positions`, `set_light_directions`).

    What was built for the first frame is fitted to the next ones, in a fraction of the time. A
    sampler that learns goes on from what it knows, which counts for little after a move. The
    parameters are those of `render`.

    >>> frames = Frames(scene, size=(640, 360))
    >>> for number, positions in enumerate(animation):
    ...     scene.set_light_positions(positions)
    ...     frames.render(spp=16).save(f"frame{number}.exr")
    """

    def __init__(
        self,
        scene: Scene,
        sampler: str | None = None,
        *,
        size: tuple[int, int] = (320, 240),
        max_depth: int = 2,
        seed: int = 0,
        threads: int = 0,
        rr_depth: int = RR_DEPTH,
        direct_light: str = "mis",
        hide_emitters: bool = False,
    ) -> None:
        if not isinstance(scene, Scene):
            raise TypeError(f"scene: wanted a lightcull.Scene, got {scene!r}")
        self._settings = RenderSettings(
            size, max_depth, seed, threads, rr_depth, direct_light, hide_emitters=hide_emitters
        )
        self._scene = scene
        self._sampler = subject_of(scene).best_sampler if sampler is None else sampler
        checks.text("sampler", self._sampler)
        self._job: PathJob | None = None
        self._next_seed = self._settings.seed
        self.rebuilt = False
        """Whether the sampler's tree was built anew for the last frame: lights had moved too far for
        the old one, or shone where they had not."""

    def render(
        self,
        *,
        seconds: float | None = None,
        spp: int | None = None,
        progress: ProgressCallback | None = None,
    ) -> RenderResult:
        """Renders the next frame, of the scene as it is now, for `seconds` of wall time or `spp`
        samples per pixel. The first frame has the seed, each one after it the next number.
        """
        budget = Budget(spp, seconds)
        seed = self._next_seed
        if self._job is None:
            self._job = PathJob(self._scene, self._sampler, self._settings)
            self.rebuilt = True
        else:
            self.rebuilt = self._job.restart(seed)
        self._next_seed = (seed + 1) % (checks.MOST_64_BITS + 1)
        interrupted = run_passes(self._job, budget, progress)
        image = self._job.image()
        warn_of_nonsense(self._scene.name, image)
        return RenderResult(
            image, self._job.stats(), self._scene.name, self._sampler, self._settings.max_depth,
            seed, interrupted,
        )  # fmt: skip
