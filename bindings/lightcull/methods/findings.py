"""What a comparison of methods found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

Cell: TypeAlias = float | int | str | None


@dataclass(frozen=True)
class Table:
    """Rows of figures."""

    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]


@dataclass(frozen=True)
class Curve:
    """A line of a plot."""

    name: str
    x: Sequence[float]
    y: Sequence[float]


@dataclass(frozen=True)
class Plot:
    """Curves on logarithmic axes."""

    x_label: str
    y_label: str
    curves: tuple[Curve, ...]


@dataclass(frozen=True)
class Picture:
    """An image, and what is said below it."""

    name: str
    image: np.ndarray
    """float32 (H, W, 3), linear RGB."""
    caption: str
    is_chart: bool = False
    """A figure in colours, [0, 1] as on the screen: not shown through a view, and no EXR of it."""


@dataclass(frozen=True)
class Study:
    """One question, and the figures that answer it."""

    key: str
    title: str
    finding: str
    """In a sentence, with its figures."""
    note: str
    """How it was measured."""
    table: Table
    plot: Plot | None = None
    figures: dict[str, float] = field(default_factory=dict)
    """Those that the finding is made of."""
    pictures: tuple[Picture, ...] = ()


@dataclass(frozen=True)
class MethodReport:
    """A comparison of methods on one scene."""

    scene: str
    width: int
    height: int
    command: str
    machine: dict[str, str]
    studies: tuple[Study, ...]

    def figures(self) -> dict[str, Any]:
        """All but the pictures, for methods.json."""
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
