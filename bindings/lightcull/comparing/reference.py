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
from typing import Any, TypeAlias
from zipfile import BadZipFile

import numpy as np

from .. import machine
from .._core import Error
from ..output_files import write_whole_file
from ..rendering.budget import Budget
from ..rendering.job import SubjectJob
from ..rendering.settings import RenderSettings
from ..rendering.subject import Subject
from ..report import Reference

ReferenceProgress: TypeAlias = Callable[[float, int, float], None]

_FORMAT = 2
"""Of what is kept."""
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
    chunk: int | None = None
    """Passes of a chunk where a cluster renders it, in whose seconds there is more; None: this machine
    does.
    """

    @property
    def sampler(self) -> str:
        return self.scene.best_sampler

    def key(self) -> str:
        """What the image depends on, but for how long it was rendered."""
        settings = self.settings
        of_settings = (
            settings.size, settings.max_depth, settings.rr_depth, settings.direct_light,
            settings.hide_emitters,
        )  # fmt: skip
        parts = (self.scene.digest(), self.sampler, of_settings, _SEEDS, _FORMAT, machine.build_id())
        if self.chunk is not None:
            parts = (*parts, self.chunk)
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
    reference = Reference(
        halves=np.stack([job.image() for job in halves]),
        sampler=order.sampler,
        spp=sum(job.stats().spp for job in halves),
        lit=_stacked([job.lit() for job in halves]),
        emission=_stacked([job.emission() for job in halves]),
    )
    _write(path, order, reference)
    return reference


def _stacked(halves: list[np.ndarray | None]) -> np.ndarray | None:
    known = [half for half in halves if half is not None]
    return np.stack(known) if known else None


def _render_half(order: ReferenceOrder, index: int, progress: ReferenceProgress) -> SubjectJob:
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
                halves=data["halves"],
                sampler=order.sampler,
                spp=int(data["spp"]),
                lit=data["lit"] if "lit" in data else None,
                emission=data["emission"] if "emission" in data else None,
            )
    except (OSError, EOFError, KeyError, ValueError, BadZipFile, zlib.error) as error:
        warnings.warn(f"{path}: broken, rendered anew: {error}", stacklevel=2)
        return None


def _write(path: Path, order: ReferenceOrder, reference: Reference) -> None:
    data = BytesIO()
    arrays = {"halves": reference.halves, "lit": reference.lit, "emission": reference.emission}
    known: dict[str, Any] = {name: part for name, part in arrays.items() if part is not None}
    known |= {"spp": reference.spp, "budget": order.budget.total, "unit": _unit(order)}
    np.savez(data, **known)
    try:
        write_whole_file(path, data.getvalue())
    except Error as error:
        warnings.warn(f"the reference is not kept: {error}", stacklevel=2)


def _unit(order: ReferenceOrder) -> str:
    return "seconds" if order.budget.spp is None else "spp"
