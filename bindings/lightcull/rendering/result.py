"""A rendered image."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np

from .. import _core
from ..field_docs import with_field_docs
from ..images import save_image
from .method import PATH
from .statistics import Stats


@with_field_docs
@dataclass(frozen=True)
class RenderResult:
    """An image and what made it."""

    image: np.ndarray
    """float32 (H, W, 3), linear RGB, row 0 at the top."""
    stats: Stats
    """What it took."""
    scene: str
    """Name of the scene."""
    sampler: str
    """Description of the sampler."""
    max_depth: int
    """Longest path, in edges."""
    seed: int
    """Of the random numbers."""
    interrupted: bool
    """Ctrl-C came before it was done; the image is what there was by then."""
    method: str = PATH
    """Description of the method; see `render`."""

    def metadata(self) -> dict[str, str]:
        """What made the image, in words, for an image file."""
        return {
            "scene": self.scene,
            "method": self.method,
            "sampler": self.sampler,
            "seed": str(self.seed),
            "samples": str(self.stats.spp),
            "seconds": f"{self.stats.seconds:.3f}",
            "max_depth": str(self.max_depth),
            "software": f"lightcull {_core.VERSION}",
        }

    def save(
        self, path: str | os.PathLike[str], view: str | None = None, exposure: float = 0.0
    ) -> None:
        """Writes an .exr (float32, linear) or, through a view, a .png.

        view: one of `view_names()`; None: the first. exposure: stops. Of a .png only.
        """
        save_image(path, self.image, self.metadata(), view, exposure)
