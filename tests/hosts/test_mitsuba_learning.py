"""Shadow rays are reported: `learned` spends few samples on lights that a wall hides."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed")

import lightcull.mitsuba  # noqa: E402, F401
import mitsuba_scenes as scenes  # noqa: E402

RENDERS, SPP = 6, 32


def noise(scene: Any, **options: Any) -> float:
    """Variance of the pixels over the square of their means, of all renders but the first."""
    integrator = mi.load_dict({"type": "lightcull_path", "max_depth": 3, **options})
    images = np.stack(
        [
            np.array(mi.render(scene, integrator=integrator, spp=SPP, seed=seed))
            for seed in range(RENDERS + 1)
        ]
    )[1:]
    mean = images.mean(axis=0)
    relative = images.var(axis=0, ddof=1) / (mean**2 + 0.01 * mean.mean() ** 2)
    return float(np.minimum(relative, 10).mean())


@pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"])
def test_it_learns_within_a_render_and_goes_on_if_told_to(variant: str) -> None:
    """Usual are 0.66 and 0.4; where nothing is reported, both are about 1."""
    mi.set_variant(variant)
    scene = mi.load_dict(scenes.lamps_behind_a_wall())
    culled = noise(scene, light_sampler="culled")
    anew = noise(scene, light_sampler="learned:rounds=300:memory=16") / culled
    kept = noise(scene, light_sampler="learned", keep_learned=True) / culled
    assert anew < 0.85
    assert kept < 0.6
