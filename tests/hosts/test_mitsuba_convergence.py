"""The error falls as one over the root of the samples: ranges are drawn anew in every pass."""

from __future__ import annotations

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed")

import lightcull.mitsuba  # noqa: E402, F401
import mitsuba_scenes as scenes  # noqa: E402

SPP = (4, 32, 256, 1024)
REPEATS = {4: 12, 32: 6, 256: 3, 1024: 2}


def image_error(scene, integrator, spp: int) -> float:
    """Root of the mean squared error of the brightness of the image, blurred over all pixels of a
    block of 8 x 8: what pixels have in common does not average out of it.
    """
    found = []
    for seed in range(REPEATS[spp]):
        pixels = np.array(mi.render(scene, integrator=integrator, spp=spp, seed=seed + 1))
        height, width = pixels.shape[:2]
        found.append(pixels.reshape(height // 8, 8, width // 8, 8, 3).mean(axis=(1, 3)))
    error = np.stack(found) - reference(scene)
    return float(np.sqrt((error**2).mean()))


_references: dict[int, np.ndarray] = {}


def reference(scene) -> np.ndarray:
    """By Mitsuba's own path, whose error is a small part of that of 1,024 samples."""
    if id(scene) not in _references:
        path = mi.load_dict({"type": "path", "max_depth": 2})
        pixels = np.array(mi.render(scene, integrator=path, spp=16384, seed=77))
        height, width = pixels.shape[:2]
        blocks = pixels.reshape(height // 8, 8, width // 8, 8, 3).mean(axis=(1, 3))
        _references[id(scene)] = blocks
    return _references[id(scene)]


@pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"])
def test_error_falls_with_the_root_of_the_samples(variant: str) -> None:
    mi.set_variant(variant)
    scene = mi.load_dict(scenes.round_lamps())
    integrator = mi.load_dict(
        {"type": "lightcull_path", "max_depth": 2, "sets": 4, "error_bound": 8.0}
    )
    errors = [image_error(scene, integrator, spp) for spp in SPP]
    slope = np.polyfit(np.log(SPP), np.log(errors), 1)[0]
    assert -0.6 < slope < -0.4, errors
