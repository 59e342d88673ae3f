"""All methods for the same time, against the path tracer's reference: figure 4 of [TH16]."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..rendering.job import Job
from ..rendering.method import PATH
from ..rendering.path_job import PathJob
from ..rendering.virtual_light_job import VirtualLightJob
from .findings import Curve, Picture, Plot, Study, Table
from .measure import DIRECT_SAMPLER, Bench, relative_rmse

_EFFORT = 16
"""Of the reference, as a multiple of what each method has."""
_MOMENT_RATIO = 1.5
"""Between one moment at which the error is taken and the next."""


def equal_time(bench: Bench, methods: Sequence[str]) -> Study:
    """Each method for bench.seconds, in turns."""
    reference, bounced = _reference(bench)
    racers = [_Racer(bench, method, bounced) for method in methods]
    while (racer := min(racers, key=lambda r: r.seconds)).seconds < bench.seconds:
        racer.render_pass()
        bench.report("equal time", min(racer.seconds / bench.seconds, 1.0))
    rows = []
    for racer in racers:
        found = racer.bounced()
        brightness = float(found.mean() / bounced.mean()) if bounced.mean() else 0.0
        rows.append(
            (racer.method, racer.job.stats().spp, racer.seconds, relative_rmse(found, bounced),
             brightness)
        )  # fmt: skip
    pictures = [Picture("reference", reference, "path tracer")]
    pictures += [
        Picture(r.method, r.job.image(), f"RMSE / mean {row[3]:.3f}")
        for r, row in zip(racers, rows, strict=True)
    ]
    best = min(rows, key=lambda row: row[3])
    return Study(
        key="equal_time",
        title="Error in equal time",
        finding=f"{best[0]} has the least error: an RMSE of {best[3]:.3f} of the mean of the light "
        "that bounced.",
        note=f"As figure 4 of [TH16]. Each method renders for {bench.seconds:g} s of wall time, in "
        "turns; the reference is the path tracer's, for "
        f"{_EFFORT} times as long. Errors are of light that bounced: direct light, which all find "
        "alike, is subtracted to the bit, of the reference too; its time is not. Brightness: bounced light over that of the "
        "reference; below 1 it is missing. New virtual lights in each pass.",
        table=Table(
            ("method", "passes", "time, s", "RMSE / mean", "brightness of bounced light"),
            tuple(rows),
        ),
        plot=Plot(
            "seconds", "RMSE / mean",
            tuple(Curve(r.method, [c[0] for c in r.curve], [c[1] for c in r.curve]) for r in racers),
        ),
        figures={f"brightness_{row[0]}": row[4] for row in rows},
        pictures=tuple(pictures),
    )  # fmt: skip


class _Racer:
    """A method, and beside it direct light with the same random numbers, which costs it nothing."""

    def __init__(self, bench: Bench, method: str, reference: np.ndarray) -> None:
        self.method = method
        self.job: Job = (
            PathJob(bench.scene, DIRECT_SAMPLER, bench.settings)
            if method == PATH
            else VirtualLightJob(bench.scene, method, DIRECT_SAMPLER, bench.settings)
        )
        self._direct = PathJob(bench.scene, DIRECT_SAMPLER, replace(bench.settings, max_depth=2))
        self.curve: list[tuple[float, float]] = []
        self._reference = reference
        self._next_moment = 0.0

    @property
    def seconds(self) -> float:
        return self.job.stats().seconds

    def render_pass(self) -> None:
        self.job.render_pass()
        self._direct.render_pass()
        if self.seconds >= self._next_moment:
            self.curve.append((self.seconds, relative_rmse(self.bounced(), self._reference)))
            self._next_moment = self.seconds * _MOMENT_RATIO

    def bounced(self) -> np.ndarray:
        """float64 (H, W, 3): what is not direct light."""
        return self.job.image().astype(np.float64) - self._direct.image()


def _reference(bench: Bench) -> tuple[np.ndarray, np.ndarray]:
    """The image, and what of it is not direct light: float64 (H, W, 3). With random numbers that no
    method has, and the same for both, so that the noise of direct light is not in the latter."""
    settings = replace(bench.settings, seed=(bench.settings.seed + 1) % 2**64)
    full = PathJob(bench.scene, DIRECT_SAMPLER, settings)
    direct = PathJob(bench.scene, DIRECT_SAMPLER, replace(settings, max_depth=2))
    while (seconds := full.stats().seconds) < _EFFORT * bench.seconds:
        full.render_pass()
        direct.render_pass()
        bench.report("reference", min(seconds / (_EFFORT * bench.seconds), 1.0))
    image = full.image().astype(np.float64)
    return image, image - direct.image()
