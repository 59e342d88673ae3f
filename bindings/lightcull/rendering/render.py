"""Rendering: one image by one sampler."""

from __future__ import annotations

import os

from .. import checks, machine
from .._core import Error
from ..scene import Scene
from .budget import Budget
from .checkpoint import Keeper, RenderKey
from .job import Job
from .method import PATH, check_method
from .passes import run_passes, warn_of_nonsense
from .path_job import PathJob
from .progress import ProgressCallback
from .result import RenderResult
from .settings import RenderSettings, settings_of
from .subject import Subject, subject_of
from .virtual_light_job import VirtualLightJob


def render(
    scene: Scene | Subject,
    sampler: str | None = None,
    *,
    method: str = PATH,
    seconds: float | None = None,
    spp: int | None = None,
    size: tuple[int, int] | None = None,
    max_depth: int | None = None,
    seed: int = 0,
    threads: int = 0,
    rr_depth: int | None = None,
    direct_light: str = "mis",
    progress: ProgressCallback | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    every: float | None = None,
    resume: str | os.PathLike[str] | None = None,
) -> RenderResult:
    """Renders a scene, for `seconds` of wall time (at least one sample) or `spp` samples per pixel.

    scene: ours, or a `lightcull.mitsuba.MitsubaScene`. sampler: a description as in `LightSampler`;
    None: "learned", or "culled" where glossy virtual lights are among the lights. size: width and
    height, pixels. max_depth: longest path, in edges: 1 sees emitters only, 2 direct light. size,
    max_depth and rr_depth are those of the scene's file if it is one of Mitsuba's, else 320x240, 2
    and 5. method:
    how light that bounces is found: "path" by paths; "vpl_all", "vpl_culled", "vpl_clamped" and
    "vpl_grid" by virtual lights where light paths meet surfaces, which wants a max_depth of 3 to 5
    (`lightcull render --help` has their options); the sampler is then for direct light. rr_depth:
    Russian roulette may end a path from this many edges on. direct_light: "mis" samples lights and
    the BSDF, "lights" or "bsdf" one of them alone. threads: 0 for all; the image does not depend on
    it. progress: called between passes; what it raises ends the render.

    checkpoint: a file to which the render is saved every `every` seconds (60 unless told) and at
    its end, from which it can go on; whatever happens, the old one or the new one is there whole. It
    must not be there before. resume: such a file to go on from, and to save to where checkpoint
    names no other. The image has the same bits as if it had never stopped; seconds and spp count
    from the first start. A file of another scene, sampler, size, max_depth, seed or build of
    lightcull is an Error.

    Ctrl-C ends the render after the pass under way, and what there is is saved and returned. One
    more, before that pass is over, is a KeyboardInterrupt.
    """
    budget = Budget(spp, seconds)
    size, max_depth, rr_depth = settings_of(scene, size, max_depth, rr_depth)
    settings = RenderSettings(size, max_depth, seed, threads, rr_depth, direct_light)
    subject = subject_of(scene)
    if sampler is None:
        sampler = subject.best_sampler
    job: Job
    if every is not None and checkpoint is None and resume is None:
        raise Error("every: only with checkpoint or resume")
    if check_method(method) != PATH:
        if not isinstance(scene, Scene):
            raise Error(f"{method}: not for a scene of another renderer")
        if checkpoint is not None or resume is not None:
            raise Error(f"checkpoint and resume: not for {method}")
        job = VirtualLightJob(scene, method, sampler, settings)
        interrupted = run_passes(job, budget, progress)
    elif isinstance(scene, Scene):
        job, interrupted = _by_paths(
            scene, sampler, budget, settings, progress, checkpoint=checkpoint, every=every,
            resume=resume,
        )  # fmt: skip
    else:
        if checkpoint is not None or resume is not None:
            raise Error("checkpoint and resume: not for a scene of another renderer")
        job = subject.new_job(sampler, settings, spp)
        interrupted = run_passes(job, budget, progress)
    image = job.image()
    warn_of_nonsense(scene.name, image)
    return RenderResult(
        image, job.stats(), scene.name, sampler, settings.max_depth, settings.seed, interrupted,
        method,
    )  # fmt: skip


def _by_paths(
    scene: Scene,
    sampler: str,
    budget: Budget,
    settings: RenderSettings,
    progress: ProgressCallback | None,
    *,
    checkpoint: str | os.PathLike[str] | None,
    every: float | None,
    resume: str | os.PathLike[str] | None,
) -> tuple[Job, bool]:
    """The render, and whether Ctrl-C ended it; saved on the way and at the end if that is wanted."""
    key = RenderKey(
        scene.name, scene.digest(), checks.text("sampler", sampler), settings.size,
        settings.max_depth, settings.rr_depth, settings.direct_light, settings.seed,
        machine.build_id(),
    )  # fmt: skip
    keeper = Keeper(key, checkpoint=checkpoint, every=every, resume=resume)
    before = keeper.before
    if before is not None and budget.spp is not None and before.stats.passes > budget.spp:
        raise Error(
            f"{resume}: has {before.stats.passes} samples per pixel already, and {budget.spp} were "
            "wanted"
        )
    job = PathJob(scene, sampler, settings)
    if before is not None:
        job.resume(before)
    interrupted = run_passes(job, budget, progress, lambda: keeper.after_pass(job.checkpoint))
    keeper.save(job.checkpoint)
    return job, interrupted
