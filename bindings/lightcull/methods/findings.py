"""What a comparison of methods found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from ..field_docs import with_field_docs

Cell: TypeAlias = float | int | str | None


@with_field_docs
@dataclass(frozen=True)
class Table:
    """Rows of figures."""

    columns: tuple[str, ...]
    """Their headings."""
    rows: tuple[tuple[Cell, ...], ...]
    """As many cells in each as there are columns."""


@with_field_docs
@dataclass(frozen=True)
class Curve:
    """A line of a plot."""

    name: str
    """What it is called in the legend."""
    x: Sequence[float]
    """As the plot's axis."""
    y: Sequence[float]
    """As the plot's axis, as many."""


@with_field_docs
@dataclass(frozen=True)
class Plot:
    """Curves on logarithmic axes."""

    x_label: str
    """What is along it, with its unit."""
    y_label: str
    """What is along it, with its unit."""
    curves: tuple[Curve, ...]
    """In the order of the legend."""


@with_field_docs
@dataclass(frozen=True)
class Picture:
    """An image, and what is said below it."""

    name: str
    """Of which its files are named."""
    image: np.ndarray
    """float32 (H, W, 3), linear RGB."""
    caption: str
    """What is said below it."""
    is_chart: bool = False
    """A figure in colours, [0, 1] as on the screen: not shown through a view, and no EXR of it."""


@with_field_docs
@dataclass(frozen=True)
class Study:
    """One question, and the figures that answer it."""

    key: str
    """By which report.json has it, and the name of its CSV file."""
    title: str
    """In a few words."""
    finding: str
    """In a sentence, with its figures."""
    note: str
    """How it was measured."""
    table: Table
    """Its figures."""
    plot: Plot | None = None
    """Some of them, drawn; None: none."""
    figures: dict[str, float] = field(default_factory=dict)
    """Those that the finding is made of."""
    pictures: tuple[Picture, ...] = ()
    """What was rendered."""


@with_field_docs
@dataclass(frozen=True)
class MethodReport:
    """A comparison of methods on one scene."""

    scene: str
    """Name or path of the scene."""
    width: int
    """Pixels."""
    height: int
    """Pixels."""
    command: str
    """Command line or Python call that made it; empty if not known."""
    machine: dict[str, str]
    """What ran it, for people to read."""
    studies: tuple[Study, ...]
    """Each with a question, and the figures that answer it."""

    def figures(self) -> dict[str, Any]:
        """All but the pictures, for report.json."""
        return {
            "scene": self.scene,
            "width": self.width,
            "height": self.height,
            "command": self.command,
            "machine": self.machine,
            "studies": {
                study.key: {
                    "title": study.title,
                    "finding": study.finding,
                    "note": study.note,
                    "figures": study.figures,
                    "columns": list(study.table.columns),
                    "rows": [list(row) for row in study.table.rows],
                }
                for study in self.studies
            },
        }
