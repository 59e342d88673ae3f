"""Random numbers and noise for the example scenes: the same in every build and version of NumPy."""

from __future__ import annotations

import numpy as np


class Chance:
    """Random numbers that all come from Generator.random(), whose stream does not change; the other
    methods of NumPy's generators may."""

    def __init__(self, seed: int) -> None:
        self._generator = np.random.default_rng(seed)

    def uniform(self, low: float = 0.0, high: float = 1.0, shape: int | tuple = ()) -> np.ndarray:
        """In [low, high)."""
        return low + (high - low) * self._generator.random(shape)

    def normal(self, shape: int | tuple = ()) -> np.ndarray:
        """Of mean 0 and deviation 1, by Box and Muller's transform."""
        radius = np.sqrt(-2 * np.log(1 - self._generator.random(shape)))
        return radius * np.cos(2 * np.pi * self._generator.random(shape))

    def log_normal(self, sigma: float, shape: int | tuple = ()) -> np.ndarray:
        """Of median 1; sigma is the deviation of the logarithm."""
        return np.exp(sigma * self.normal(shape))

    def pick(self, options: np.ndarray, shape: int | tuple = ()) -> np.ndarray:
        """Any of the options alike."""
        options = np.asarray(options)
        return options[np.floor(self.uniform(0, len(options), shape)).astype(np.int64)]

    def directions(self, count: int) -> np.ndarray:
        """(count, 3) points of the unit sphere."""
        y, angle = self.uniform(-1, 1, count), self.uniform(0, 2 * np.pi, count)
        radius = np.sqrt(1 - y * y)
        return np.column_stack((radius * np.cos(angle), y, radius * np.sin(angle)))


class Noise:
    """Smooth noise in the plane, of mean about 0 and reach about 1, a feature for each unit."""

    SIZE = 64

    def __init__(self, chance: Chance) -> None:
        self._table = chance.uniform(-1, 1, (self.SIZE, self.SIZE))

    def __call__(self, x: np.ndarray, y: np.ndarray, octaves: int = 1) -> np.ndarray:
        total = np.zeros(np.broadcast(x, y).shape)
        for octave in range(octaves):
            frequency = 2.0**octave
            total += self._smooth(x * frequency + 17.3 * octave, y * frequency) / frequency
        return total

    def _smooth(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        column, row = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
        u, v = _ease(x - column), _ease(y - row)

        def at(i: np.ndarray, j: np.ndarray) -> np.ndarray:
            return self._table[j % self.SIZE, i % self.SIZE]

        lower = at(column, row) * (1 - u) + at(column + 1, row) * u
        upper = at(column, row + 1) * (1 - u) + at(column + 1, row + 1) * u
        return lower * (1 - v) + upper * v


def _ease(t: np.ndarray) -> np.ndarray:
    return t * t * (3 - 2 * t)
