"""One method at work, and what it costs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from ..rendering.path_job import PathJob
from ..rendering.settings import RenderSettings
from ..rendering.virtual_light_job import LightCounts, VirtualLightJob
from ..scene import Scene

DIRECT_SAMPLER = "culled"
TIME = "Time is that of processors, all threads together, for"
"""In notes."""
Report: TypeAlias = Callable[[str, float], None]
"""Called with what is being done, and the fraction of it, [0, 1]."""


@dataclass(frozen=True)
class Bench:
    """Where methods are measured."""

    scene: Scene
    settings: RenderSettings
    most_lights: int
    seconds: float
    """That methods get where they race."""
    report: Report

    def light_numbers(self) -> list[int]:
        """1024 and on by factors of 4 to `most_lights`, at least two."""
        numbers = [1024]
        while numbers[-1] * 4 <= self.most_lights or len(numbers) < 2:
            numbers.append(numbers[-1] * 4)
        return numbers

    @property
    def pixels(self) -> int:
        width, height = self.settings.size
        return width * height

    def sized(self, divisor: int) -> Bench:
        """With an image of 1 / divisor of the width and the height."""
        width, height = self.settings.size
        size = max(width // divisor, 8), max(height // divisor, 8)
        return replace(self, settings=replace(self.settings, size=size))


@dataclass(frozen=True)
class Measured:
    """A method after some passes."""

    bounced: np.ndarray
    """float64 (H, W, 3): what is not direct light."""
    counts: LightCounts
    lights_of_pixels: np.ndarray
    """float64 (H, W, 2): lights listed and accepted."""

    @property
    def seconds(self) -> float:
        """Of processors, a pass: ranges, culling, shading and shadows, with what they need to be built."""
        return self.counts.lighting_seconds + self.counts.build_seconds


def measure(bench: Bench, method: str, passes: int = 1) -> Measured:
    """Renders some passes. Methods with as many lights have the same ones in each pass."""
    job = VirtualLightJob(bench.scene, method, DIRECT_SAMPLER, bench.settings)
    for _ in range(passes):
        job.render_pass()
    bounced = job.image() - direct_light(bench, passes)
    return Measured(bounced, job.light_counts(), job.lights_of_pixels())


def direct_light(bench: Bench, passes: int) -> np.ndarray:
    """float64 (H, W, 3): to the bit what a method's passes have of it."""
    job = PathJob(bench.scene, DIRECT_SAMPLER, replace(bench.settings, max_depth=2))
    for _ in range(passes):
        job.render_pass()
    return job.image().astype(np.float64)


def exponent(x: list[float], y: list[float]) -> float:
    """Of the power law that goes through points best."""
    return float(np.polyfit(np.log(x), np.log(np.maximum(y, 1e-12)), 1)[0])


def relative_rmse(image: np.ndarray, reference: np.ndarray) -> float:
    """RMSE over the mean of the reference."""
    mean = float(reference.mean())
    return float(np.sqrt(np.mean((image - reference) ** 2))) / mean if mean > 0 else 0.0
