"""Pictures by our own renderer of scenes that Mitsuba shows, beside Mitsuba's."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed")

import lightcull  # noqa: E402
from lightcull.mitsuba import import_scene, load_file  # noqa: E402
from material_preview import write_material_preview  # noqa: E402

METAL = """<bsdf type="principled">
  <rgb name="base_color" value="0.9, 0.6, 0.3"/>
  <float name="metallic" value="1"/><float name="roughness" value="0.4"/>
</bsdf>"""
RELIEF = """<bsdf type="normalmap">
  <texture name="normalmap" type="bitmap">
    <string name="filename" value="dimples.png"/><boolean name="raw" value="true"/>
  </texture>
  <bsdf type="diffuse"><rgb name="reflectance" value="0.7, 0.3, 0.2"/></bsdf>
</bsdf>"""


def blocks(image: np.ndarray) -> np.ndarray:
    """The means of squares of 8 x 8 pixels."""
    return image[..., :3].reshape(6, 8, 8, 8, 3).mean(axis=(1, 3))


@pytest.mark.parametrize(("material", "of_mean"), [(METAL, 0.02), (RELIEF, 0.01)])
def test_a_material_preview(tmp_path: Path, material: str, of_mean: float) -> None:
    path = write_material_preview(tmp_path, material)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", "preview: round shapes are made of triangles$")
        ours = import_scene(load_file(path))
    found = blocks(lightcull.render(ours, spp=256, seed=1).image)
    expected = blocks(np.array(mi.render(mi.load_file(str(path)), spp=256, seed=7)))
    # Metals differ a little by their models, and round shapes by their corners.
    np.testing.assert_allclose(found, expected, rtol=0.08, atol=0.015)
    assert found.mean() == pytest.approx(expected.mean(), rel=of_mean)
