"""Fronts of houses for the `city` scene: walls with rows of windows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Face:
    """The outside of a wall: an upright rectangle."""

    corner: np.ndarray
    """(3,) its lower left corner, seen from outside."""
    right: np.ndarray
    """(3,) unit vector to the right, level."""
    width: float
    height: float

    @property
    def outward(self) -> np.ndarray:
        """(3,) its unit normal."""
        return np.cross(self.right, (0.0, 1.0, 0.0))

    def points(
        self, across: np.ndarray, up: np.ndarray, out: np.ndarray | float = 0.0
    ) -> np.ndarray:
        """(..., 3) from metres to the right of the corner, above it, and in front of the wall."""
        across, up, out = np.broadcast_arrays(across, up, out)
        return (
            self.corner
            + across[..., None] * self.right
            + up[..., None] * np.array((0.0, 1.0, 0.0))
            + out[..., None] * self.outward
        )

    def rectangles(
        self,
        left: np.ndarray,
        right: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        out: float = 0.0,
    ) -> np.ndarray:
        """(K, 4, 3) corners of rectangles that face out, `out` metres in front of the wall."""
        across = np.stack(np.broadcast_arrays(left, right, right, left), axis=-1)
        up = np.stack(np.broadcast_arrays(low, low, high, high), axis=-1)
        return self.points(across, up, out).reshape(-1, 4, 3)


@dataclass(frozen=True)
class Grid:
    """Rows of equal openings in a wall: `columns` cells across the whole face, `rows` cells of
    `cell_height` from `bottom` up, each with an opening in its middle."""

    bottom: float
    cell_height: float
    rows: int
    columns: int
    opening_width: float
    opening_height: float
    sill: float
    """From the bottom of the cell to the opening, metres."""

    def openings(self, face: Face) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """left, right, low, high of each, metres, (rows * columns,)."""
        cell = face.width / self.columns
        column, row = np.meshgrid(np.arange(self.columns), np.arange(self.rows))
        left = (column.ravel() + 0.5) * cell - 0.5 * self.opening_width
        low = self.bottom + row.ravel() * self.cell_height + self.sill
        return left, left + self.opening_width, low, low + self.opening_height


def pierced_wall(face: Face, grid: Grid, depth: float) -> np.ndarray:
    """(K, 4, 3) quadrilaterals: the wall about the openings of the grid, and the reveals, `depth`
    metres deep, behind which panes can be put."""
    left, right, low, high = grid.openings(face)
    cell = face.width / grid.columns
    centre = 0.5 * (left + right)
    cell_left, cell_right = centre - 0.5 * cell, centre + 0.5 * cell
    cell_low = low - grid.sill
    cell_high = cell_low + grid.cell_height

    def reveal(a0: np.ndarray, u0: np.ndarray, a1: np.ndarray, u1: np.ndarray) -> np.ndarray:
        corners = [(a0, u0, 0.0), (a1, u1, 0.0), (a1, u1, -depth), (a0, u0, -depth)]
        return np.stack([face.points(*corner) for corner in corners], axis=1)

    return np.concatenate(
        (
            face.rectangles(cell_left, left, cell_low, cell_high),
            face.rectangles(right, cell_right, cell_low, cell_high),
            face.rectangles(left, right, cell_low, low),
            face.rectangles(left, right, high, cell_high),
            reveal(left, low, right, low),
            reveal(right, low, right, high),
            reveal(right, high, left, high),
            reveal(left, high, left, low),
        )
    )
