"""What selections cost: times and counts of work by sampler, kind of points and thread count."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from statistics import median
from typing import TypeAlias

import numpy as np

from . import _core
from ._core import Error
from .sampler import check_description
from .scene import Scene
from .scenes.random_numbers import Chance

DEFAULT_SAMPLERS = (
    "light_bvh", "light_bvh:importance=means", "culled", "learned", "exhaustive",
)  # fmt: skip
DEFAULT_SIZE = (640, 480)
DEFAULT_THREADS = (1, 2)
POINTS = ("camera", "scattered", "uniform")
ENTRIES = ("batch", "single")

_REPETITIONS = 5
_MAX_DEPTH = 4
"""Longest path of the renderer that is imitated: samplers are calibrated for two bounces."""
_ROUNDS = 24
"""In which a sampler that learns does so, before it is measured."""
_MOST_WORK = 1e8
"""Lights weighed in one repetition by a sampler that weighs them all."""


@dataclass(frozen=True)
class Row:
    """What one sampler costs in one setting. Times are wall time, on `threads` threads."""

    scene: str
    lights: int
    points: str
    """"camera": what camera rays hit; "scattered": what paths hit after one bounce and after two,
    a batch each; "uniform": uniform in the bounds of the scene, facing anywhere, in any order."""
    sampler: str
    device: str
    """As in `LightSampler`."""
    entry: str
    """"batch": many points in a call, as the renderer asks; "single": one point in a call, on the
    processor alone."""
    target: str
    """Instruction set."""
    threads: int
    ns_per_selection: float
    """Of a batch all that a pass needs is in it: the refit for its random ranges and the sorting of
    its points, divided by its points. Of single points it is the call alone."""
    selections_per_second: float
    """The same the other way round: how devices are compared."""
    shadow_ray_ns: float | None
    """Of one shadow ray from these points to the lights that the sampler chose; None: it chose
    none."""
    rays_arrived: float | None
    """Share of those that reach their light."""
    nodes_per_point: float
    """Tree nodes visited for a point."""
    lights_tested_per_point: float
    """Lights whose range or importance was computed for a point."""
    refit_ns_per_light: float
    """Of begin_pass(), for each light and each set of random ranges; about 0 where there are
    none."""
    build_seconds: float
    """Of the sampler, calibration included."""
    cells: int
    """Of a sampler that learns, after 24 rounds at these points and those before; 0: it does not."""
    publish_seconds: float
    """Of begin_pass(), mean of these rounds: it makes what was reported count."""
    bytes_per_light: float
    """Memory that the sampler keeps."""


Progress: TypeAlias = Callable[[str], None]


def bench(
    scene: Scene,
    samplers: Sequence[str] = DEFAULT_SAMPLERS,
    *,
    size: tuple[int, int] = DEFAULT_SIZE,
    threads: Sequence[int] = DEFAULT_THREADS,
    targets: Sequence[str] | None = None,
    device: str = "cpu",
    progress: Progress | None = None,
) -> Iterator[Row]:
    """Measures what a selection costs each sampler in a scene; `Row` says what is measured.

    Each time is the median of five repetitions, in each of which the samplers take turns, so that
    a noisy machine is fair to all. Counts of work stand beside the times, which do not depend on
    the machine's mood. samplers: descriptions as in `LightSampler`. size: of the image whose points
    are taken, pixels; there are as many uniform points. A sampler that weighs every light
    (exhaustive) gets as many as it can take in reasonable time. threads: numbers of threads, each
    measured. targets: names of instruction sets, each measured; None: the best. device: as in
    `LightSampler`; one that `culled` and `paper` are measured on as well, in turn with the
    processor.

    Rows come as they are measured. progress: called with what is measured next.
    """
    for description in samplers:
        check_description(description)
    if any(count < 1 for count in threads):
        raise Error(f"threads: wanted numbers from 1 up, got {list(threads)}")
    if scene.bounds is None or len(scene.lights()) == 0:
        raise Error(f"{scene.name}: there are no surfaces or no lights to choose among")
    if device != "cpu" and not any(map(_runs_on_devices, samplers)):
        raise Error(f"{device}: none of the samplers is culled or paper, which alone run there")
    best = _core.instruction_sets()[0]
    try:
        for count in threads:
            setting = _Setting(scene, size, count, tuple(targets or [best]), device)
            yield from _rows(setting, samplers, progress)
    finally:
        _core.use_instruction_set(best)


@dataclass(frozen=True)
class _Setting:
    scene: Scene
    size: tuple[int, int]
    threads: int
    targets: tuple[str, ...]
    device: str


@dataclass
class _Times:
    """Of one sampler for one kind of points, in seconds, a value for each repetition."""

    refit: list[float] = field(default_factory=list)
    selection: dict[str, list[float]] = field(default_factory=lambda: {e: [] for e in ENTRIES})
    """Of one, by entry."""
    shadow_ray: list[float] = field(default_factory=list)
    """Of one."""
    arrived: list[float] = field(default_factory=list)
    """Share of shadow rays."""


class _Contender:
    """A sampler under test, and its points, which carry its sets."""

    def __init__(self, setting: _Setting, sampler: str, device: str) -> None:
        self.sampler = sampler
        self._device = device
        self._setting = setting
        self._light_count = len(setting.scene.lights())
        self._timed = _core.TimedSampler(
            setting.scene.closed(), sampler, *setting.size, _MAX_DEPTH, setting.threads, device
        )
        self._kind = ""
        self._batches: list[_core.BenchPoints] = []
        self._publish_seconds = 0.0
        self._round = 0

    def take_points(self, kind: str) -> None:
        """Goes on with points of this kind."""
        if kind == "camera":
            batches = [self._timed.path_points(1)]
        elif kind == "scattered":
            batches = [self._timed.path_points(2), self._timed.path_points(3)]
        else:
            batches = [self._timed.points(*_uniform_points(self._setting))]
        if self.sampler == "exhaustive":
            batches = [batch.thinned(int(_MOST_WORK / self._light_count)) for batch in batches]
        self._kind = kind
        self._batches = [batch for batch in batches if len(batch) > 0]
        self._learn()

    def _learn(self) -> None:
        if not self._timed.wants_reports():
            return
        seconds = 0.0
        for _ in range(_ROUNDS):
            self._round += 1
            for batch in self._batches:
                self._timed.learn(batch, self._round)
            seconds += self._timed.begin_pass(self._round)
        self._publish_seconds = seconds / _ROUNDS

    @property
    def point_count(self) -> int:
        return sum(map(len, self._batches))

    def repeat(self, number: int, times: _Times) -> None:
        """Measures everything once more, in the pass of that number."""
        refit = self._timed.begin_pass(number)
        batch = refit + sum(map(self._timed.select_batch, self._batches))
        if self._device == "cpu":
            single = sum(map(self._timed.select_single, self._batches))
            times.selection["single"].append(single / self.point_count)
        rays = [self._timed.trace_shadow_rays(points) for points in self._batches]
        ray_count = sum(count for _, count, _ in rays)
        times.refit.append(refit)
        times.selection["batch"].append(batch / self.point_count)
        if ray_count > 0:
            times.shadow_ray.append(sum(seconds for seconds, _, _ in rays) / ray_count)
            times.arrived.append(sum(arrived for _, _, arrived in rays) / ray_count)

    def rows(self, target: str, times: _Times) -> list[Row]:
        nodes, lights_tested = self._mean_counts()
        sets = self._timed.set_count()
        return [
            Row(
                scene=self._setting.scene.name,
                lights=self._light_count,
                points=self._kind,
                sampler=self.sampler,
                device=self._device,
                entry=entry,
                target=target,
                threads=self._setting.threads,
                ns_per_selection=1e9 * median(seconds),
                selections_per_second=1 / median(seconds),
                shadow_ray_ns=1e9 * median(times.shadow_ray) if times.shadow_ray else None,
                rays_arrived=median(times.arrived) if times.arrived else None,
                nodes_per_point=nodes,
                lights_tested_per_point=lights_tested,
                refit_ns_per_light=1e9 * median(times.refit) / (self._light_count * sets),
                build_seconds=self._timed.build_seconds(),
                cells=self._timed.cell_count(),
                publish_seconds=self._publish_seconds,
                bytes_per_light=self._timed.memory_size() / self._light_count,
            )
            for entry, seconds in times.selection.items()
            if seconds
        ]

    def _mean_counts(self) -> tuple[float, float]:
        """Nodes visited and lights tested per point."""
        weights = [len(batch) / self.point_count for batch in self._batches]
        counts = [self._timed.counts(batch) for batch in self._batches]
        return (
            float(np.dot(weights, [c.nodes_visited for c in counts])),
            float(np.dot(weights, [c.lights_tested for c in counts])),
        )


def _runs_on_devices(sampler: str) -> bool:
    return sampler.split(":")[0] in ("culled", "paper")


def _rows(setting: _Setting, samplers: Sequence[str], progress: Progress | None) -> Iterator[Row]:
    def say(what: str) -> None:
        if progress is not None:
            lights = len(setting.scene.lights())
            progress(f"{setting.scene.name}, {lights:,} lights, threads {setting.threads}: {what}")

    contenders = []
    for sampler in dict.fromkeys(samplers):
        say(f"building {sampler}")
        contenders.append(_Contender(setting, sampler, "cpu"))
        if setting.device != "cpu" and _runs_on_devices(sampler):
            contenders.append(_Contender(setting, sampler, setting.device))
    for kind in POINTS:
        say(f"{kind} points")
        for contender in contenders:
            contender.take_points(kind)
        if not all(contender.point_count for contender in contenders):
            warnings.warn(f"{setting.scene.name}: there are no {kind} points", stacklevel=3)
            continue
        for target in setting.targets:
            _core.use_instruction_set(target)
            for contender, times in zip(contenders, _measure(contenders), strict=True):
                yield from contender.rows(target, times)


def _measure(contenders: Sequence[_Contender]) -> list[_Times]:
    all_times = [_Times() for _ in contenders]
    for number in range(_REPETITIONS):
        for contender, times in zip(contenders, all_times, strict=True):
            contender.repeat(number, times)
    return all_times


def _uniform_points(setting: _Setting) -> tuple[np.ndarray, np.ndarray]:
    """Positions and normals, float32 (N, 3) each, for as many points as there are pixels."""
    bounds = setting.scene.bounds
    assert bounds is not None
    count = setting.size[0] * setting.size[1]
    chance = Chance(count)
    positions = chance.uniform(bounds[0], bounds[1], (count, 3))
    return positions.astype(np.float32), chance.directions(count).astype(np.float32)
