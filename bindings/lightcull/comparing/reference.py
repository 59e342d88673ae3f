"""The image that samplers are measured against: rendered once, then kept."""

from __future__ import annotations

import hashlib
import json
import os
import warnings
import zlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from typing import TypeAlias
from zipfile import BadZipFile

import numpy as np

from .. import machine
from .._core import Error
from ..output_files import write_whole_file
from ..rendering.budget import Budget
from ..rendering.job import Job
from ..rendering.settings import RenderSettings
from ..rendering.subject import Subject
from ..report import Reference
from ..report.metrics import relmse_of_mean

ReferenceProgress: TypeAlias = Callable[[float, int, float], None]

_SEEDS = (0x52454641, 0x52454642)
"""Of the two halves; no sampler under test is likely to be given one of them."""


@dataclass(frozen=True)
class ReferenceOrder:
    """What reference is wanted."""

    scene: Subject
    settings: RenderSettings
    """Of which the seed is not used."""
    budget: Budget
    """Of both halves together."""

    @property
    def sampler(self) -> str:
        return self.scene.best_sampler

    def key(self) -> str:
        """What the image depends on, but for how long it was rendered."""
        settings = self.settings
        of_settings = (
            settings.size, settings.max_depth, settings.rr_depth, settings.direct_light,
        )  # fmt: skip
        parts = (self.scene.digest(), self.sampler, of_settings, _SEEDS, machine.build_id())
        return hashlib.blake2b(json.dumps(parts).encode(), digest_size=16).hexdigest()


def reference_for(order: ReferenceOrder, progress: ReferenceProgress) -> Reference:
    """Renders a reference, or takes it from the cache if it was rendered for as long before.

    progress is called with the fraction that is done, the samples per pixel of this half, and the
    seconds left.
    """
    path = _cache_folder() / f"{order.key()}.npz"
    cached = _read(path, order)
    if cached is not None:
        return cached
    halves = [_render_half(order, index, progress) for index in (0, 1)]
    images = [job.image() for job in halves]
    reference = Reference(
        image=(0.5 * (images[0] + images[1])).astype(np.float32),
        sampler=order.sampler,
        spp=sum(job.stats().spp for job in halves),
        relmse_of_itself=relmse_of_mean(*images),
    )
    _write(path, order, reference)
    return reference


def _render_half(order: ReferenceOrder, index: int, progress: ReferenceProgress) -> Job:
    settings = replace(order.settings, seed=_SEEDS[index])
    half = order.budget.times(0.5)
    job = order.scene.new_job(order.sampler, settings, half.spp)
    while not half.is_used(job.stats()):
        job.render_pass()
        stats = job.stats()
        left = half.seconds_left(stats) + (1 - index) * half.seconds_needed(stats)
        progress((index + half.fraction(stats)) / 2, stats.spp, left)
    return job


def _cache_folder() -> Path:
    """As the XDG base directory specification has it."""
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "lightcull" / "references"


def _read(path: Path, order: ReferenceOrder) -> Reference | None:
    if not path.is_file():
        return None
    try:
        with np.load(path, allow_pickle=False) as data:
            if float(data["budget"]) < order.budget.total or str(data["unit"]) != _unit(order):
                return None
            return Reference(
                image=data["image"],
                sampler=order.sampler,
                spp=int(data["spp"]),
                relmse_of_itself=float(data["relmse_of_itself"]),
            )
    except (OSError, EOFError, KeyError, ValueError, BadZipFile, zlib.error) as error:
        warnings.warn(f"{path}: broken, rendered anew: {error}", stacklevel=2)
        return None


def _write(path: Path, order: ReferenceOrder, reference: Reference) -> None:
    data = BytesIO()
    np.savez(
        data,
        image=reference.image,
        spp=reference.spp,
        relmse_of_itself=reference.relmse_of_itself,
        budget=order.budget.total,
        unit=_unit(order),
    )
    try:
        write_whole_file(path, data.getvalue())
    except Error as error:
        warnings.warn(f"the reference is not kept: {error}", stacklevel=2)


def _unit(order: ReferenceOrder) -> str:
    return "seconds" if order.budget.spp is None else "spp"
