"""Pictures of files as people have them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import lightcull
from picture_files import write_spider


def test_a_spider(tmp_path: Path) -> None:
    seen_from = lightcull.Camera((3.2, 3.0, 4.2), (0.0, 0.7, -0.2))
    with pytest.warns(lightcull.UnsupportedWarning, match="a studio surrounds it") as caught:
        scene = lightcull.load(write_spider(tmp_path), camera=seen_from)
    assert "supported" not in str(caught[0].message)
    assert (scene.counts["materials"], scene.counts["textures"]) == (7, 4)
    image = lightcull.render(scene, spp=16, size=(160, 120), max_depth=2, seed=1).image
    red, green, _ = np.moveaxis(image, 2, 0)
    glow = image.max(axis=2) > 2
    assert 5 < glow.sum() < 60 and red[glow].mean() > 5 * green[glow].mean()  # the eyes
    floor = image[95:, :60].mean(axis=2)
    assert np.quantile(floor, 0.9) > 4 * np.quantile(floor, 0.1)  # the squares
    stripes = red[60:110, 70:90]  # down a leg, which is brown between black stripes
    assert np.quantile(stripes, 0.95) > 2.5 * np.quantile(stripes, 0.05)
    assert (image.mean(axis=2) < 0.002).mean() < 0.02  # next to nothing is black
