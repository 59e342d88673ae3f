"""Rendering: one image by one sampler."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from .. import checks, machine
from .._core import Error
from ..scene import Scene
from .budget import Budget
from .checkpoint import Keeper, RenderKey
from .chunk import CLUSTER_CHUNK
from .chunk_job import ChunkJob, LocalChunks
from .cluster_access import (
    ClusterChoice,
    ClusterError,
    check_cluster,
    connected,
    sampler_on_cluster,
)
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
    hide_emitters: bool | None = None,
    progress: ProgressCallback | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    every: float | None = None,
    resume: str | os.PathLike[str] | None = None,
    cluster: ClusterChoice | None = None,
    chunk: int | None = None,
) -> RenderResult:
    """Renders a scene, for `seconds` of wall time (at least one sample) or `spp` samples per pixel.

    scene: ours, or a `lightcull.mitsuba.MitsubaScene`. sampler: a description as in `LightSampler`;
    None: "learned", or "culled" where glossy virtual lights are among the lights. size: width and
    height, pixels. max_depth: longest path, in edges: 1 sees emitters only, 2 direct light. size,
    max_depth, rr_depth and hide_emitters are those of the scene's file if it is one of Mitsuba's, else
    320x240, 2, 5 and False. method:
    how light that bounces is found: "path" by paths; "vpl_all", "vpl_culled", "vpl_clamped" and
    "vpl_grid" by virtual lights where light paths meet surfaces, which wants a max_depth of 3 to 5
    (`lightcull render --help` has their options); the sampler is then for direct light. rr_depth:
    Russian roulette may end a path from this many edges on. direct_light: "mis" samples lights and
    the BSDF, "lights" or "bsdf" one of them alone. hide_emitters: the camera sees neither triangles that
    emit, through which its rays go on, nor the environment; mirrors do. threads: 0 for all; the image
    does not depend on it. progress: called between passes; what it raises ends the render.

    checkpoint: a file to which the render is saved every `every` seconds (60 unless told) and at
    its end, from which it can go on; whatever happens, the old one or the new one is there whole. It
    must not be there before. resume: such a file to go on from, and to save to where checkpoint
    names no other. The image has the same bits as if it had never stopped; seconds and spp count
    from the first start. A file of another scene, sampler, size, max_depth, seed or build of
    lightcull is an Error.

    cluster: shares the passes out among the workers of Dask, of which lightcull[cluster] is needed: the
    address of a scheduler, "local:4" for so many processes of this machine, or a `distributed.Client`.
    Workers may come, go and die meanwhile. The scene is one that was opened by `open_scene`, or made as
    `Scene(recorded=True)`. sampler None is then "learned:rounds=32", since this machine alone renders
    as long as a sampler learns. seconds are those of wall time; threads, those of each worker, 0 being
    as many as Dask gives it. core/docs/cluster.md says more.

    chunk: passes that are added up before they are added to the others, as workers do: 16 on a cluster,
    else 1. The image has the same bits wherever it was rendered in chunks of that many.

    Ctrl-C ends the render after the pass (or chunk) under way, and what there is is saved and returned.
    One more, before that is over, is a KeyboardInterrupt.
    """
    budget = Budget(spp, seconds)
    size, max_depth, rr_depth, hide_emitters = settings_of(
        scene, size, max_depth, rr_depth, hide_emitters
    )
    settings = RenderSettings(
        size, max_depth, seed, threads, rr_depth, direct_light, hide_emitters=hide_emitters
    )
    subject = subject_of(scene)
    if cluster is not None:
        check_cluster(cluster)
    if sampler is None:
        sampler = subject.best_sampler
        if cluster is not None:
            sampler = sampler_on_cluster(sampler)
    job: Job
    if every is not None and checkpoint is None and resume is None:
        raise Error("every: only with checkpoint or resume")
    if check_method(method) != PATH:
        if not isinstance(scene, Scene):
            raise Error(f"{method}: not for a scene of another renderer")
        if cluster is not None or chunk is not None:
            raise Error(f"cluster and chunk: not for {method}")
        if checkpoint is not None or resume is not None:
            raise Error(f"checkpoint and resume: not for {method}")
        job = VirtualLightJob(scene, method, sampler, settings)
        interrupted = run_passes(job, budget, progress)
    elif isinstance(scene, Scene):
        default_chunk = 1 if cluster is None else CLUSTER_CHUNK
        size_of_chunk = default_chunk if chunk is None else checks.whole_number("chunk", chunk, 1)
        job, interrupted = _by_paths(
            scene, sampler, budget, settings, progress, checkpoint=checkpoint, every=every,
            resume=resume, cluster=cluster, chunk=size_of_chunk,
        )  # fmt: skip
    else:
        if cluster is not None or chunk is not None:
            raise Error("cluster and chunk: not for a scene of another renderer")
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
    cluster: ClusterChoice | None,
    chunk: int,
) -> tuple[Job, bool]:
    """The render, and whether Ctrl-C ended it; saved on the way and at the end if that is wanted."""
    key = RenderKey(
        scene.name, scene.digest(), checks.text("sampler", sampler), settings.size,
        settings.max_depth, settings.rr_depth, settings.direct_light, settings.hide_emitters,
        settings.seed, chunk, machine.build_id(),
    )  # fmt: skip
    keeper = Keeper(key, checkpoint=checkpoint, every=every, resume=resume)
    before = keeper.before
    if before is not None and budget.spp is not None and before.stats.passes > budget.spp:
        raise Error(
            f"{resume}: has {before.stats.passes} samples per pixel already, and {budget.spp} were "
            "wanted"
        )
    with _path_job(scene, sampler, settings, cluster, chunk, budget.spp) as job:
        if before is not None:
            job.resume(before)
        try:
            interrupted = run_passes(
                job, budget, progress, lambda: keeper.after_pass(job.checkpoint)
            )
        except ClusterError as error:
            raise Error(f"{error}{keeper.save_after(job.checkpoint)}") from error
        keeper.save(job.checkpoint)
    return job, interrupted


@contextmanager
def _path_job(
    scene: Scene,
    sampler: str,
    settings: RenderSettings,
    cluster: ClusterChoice | None,
    chunk: int,
    spp: int | None,
) -> Iterator[PathJob | ChunkJob]:
    """A render by paths, wherever and however it is to be."""
    if cluster is not None:
        with connected(cluster) as client:
            # Here, because importing it wants Dask, which is optional.
            from .cluster.cluster_job import cluster_job

            with cluster_job(client, scene, sampler, settings, chunk, spp) as shared:
                yield shared
    elif chunk > 1:
        job = PathJob(scene, sampler, settings)
        yield ChunkJob(sampler, settings, LocalChunks(job), job.setup_seconds, chunk, spp)
    else:
        yield PathJob(scene, sampler, settings)
