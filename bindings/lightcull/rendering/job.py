"""What any render that goes pass by pass offers, whoever renders."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from .statistics import Stats


class Job(Protocol):
    """A render that goes pass by pass, and its clock."""

    sampler: str
    """Its description."""

    def render_pass(self) -> None:
        """Adds some samples to every pixel."""

    def image(self) -> np.ndarray:
        """The mean of the samples so far: float32 (H, W, 3)."""

    def stats(self) -> Stats:
        """What it took so far."""


class SubjectJob(Job, Protocol):
    """A render of a `Subject`: a class of one's own derives from this, and has the four of `Job` at
    least; what else it knows it tells by the others.
    """

    def lit(self) -> np.ndarray | None:
        """The part of `image()` that is not `emission()`; None where that is not kept apart."""
        return None

    def emission(self) -> np.ndarray | None:
        """The part of `image()` that the camera sees of emitters directly: float32 (H, W, 3); None
        where it is not kept apart.
        """
        return None

    def mean_counts(self) -> SelectionCounts | None:
        """Mean cost of one selection; None where nobody counts."""
        return None

    def learned_view(self) -> LearnedView | None:
        """What was learned, as the image's pixels see it; None where nothing was, or a host does not
        tell.
        """
        return None


class SelectionCounts(Protocol):
    """What `_core.MeanCounts` has."""

    @property
    def accepted(self) -> float: ...
    @property
    def nodes_visited(self) -> float: ...
    @property
    def lights_tested(self) -> float: ...


class LearnedView(Protocol):
    """What `_core.LearnedView` has."""

    def cells(self) -> np.ndarray: ...
    def visibility(self) -> np.ndarray: ...
    def normals(self) -> np.ndarray: ...
    @property
    def light(self) -> int: ...
    @property
    def light_position(self) -> tuple[float, float, float] | None: ...
    @property
    def cell_count(self) -> int: ...
    @property
    def memory_size(self) -> int: ...
