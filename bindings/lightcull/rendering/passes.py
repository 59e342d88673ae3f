"""Rendering pass by pass until a budget is used up."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np

from .budget import Budget
from .interruption import Interruption
from .job import Job
from .progress import Progress, ProgressCallback


def run_passes(
    job: Job,
    budget: Budget,
    progress: ProgressCallback | None,
    keep: Callable[[], None] | None = None,
) -> bool:
    """Renders pass by pass until the budget is used up. True if Ctrl-C came before that."""
    with Interruption() as interruption:
        try:
            while not interruption.asked and not budget.is_used(job.stats()):
                job.render_pass()
                if keep is not None:
                    keep()
                if progress is not None:
                    stats = job.stats()
                    left = budget.seconds_left(stats)
                    progress(Progress(job.sampler, budget.fraction(stats), stats.spp, left))
        except KeyboardInterrupt:
            if interruption.asked or job.stats().spp == 0:
                raise
            return True
        return interruption.asked


def warn_of_nonsense(scene: str, image: np.ndarray) -> None:
    """Warns the caller's caller of an image that is black, or not of numbers."""
    if not image.any():
        warnings.warn(f"{scene}: the image is black: no light is seen", stacklevel=3)
    elif not np.isfinite(image).all():
        count = np.count_nonzero(~np.isfinite(image).all(axis=2))
        warnings.warn(f"{scene}: {count} pixels are not finite", stacklevel=3)
