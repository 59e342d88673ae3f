"""Uses an installed lightcull as a newcomer would: renders, by itself and within Mitsuba, writes and
reads images. Then names the libraries that the process has loaded, one a line.

Usage: installed_render.py FOLDER VARIANT    where to write images, and a variant of Mitsuba
"""

import sys
from pathlib import Path

import lightcull
import lightcull.mitsuba  # before mitsuba: it has a library for it that bare systems lack
import mitsuba as mi
import numpy as np
from PIL import Image

folder = Path(sys.argv[1])

# A path tracer with learned light sampling, Embree, OpenColorIO's view, OpenImageIO's PNG.
lightcull.render(lightcull.example_scene("cornell"), spp=4, size=(32, 24)).save(
    str(folder / "cornell.png")
)
assert (folder / "cornell.png").stat().st_size > 500

# What the page on files promises to read.
for kind in ("png", "jpg", "webp", "tiff", "bmp", "tga"):
    Image.new("RGB", (8, 4), (128, 128, 128)).save(folder / f"gray.{kind}")
    pixels = lightcull.read_image(folder / f"gray.{kind}")
    assert pixels.shape == (4, 8, 3) and np.allclose(pixels, 0.2158, atol=0.005), kind
lightcull.write_exr(folder / "gray.exr", pixels)
assert np.array_equal(lightcull.read_image(folder / "gray.exr"), pixels)

mi.set_variant(sys.argv[2])


def mitsuba_mean(integrator: str) -> float:
    description = mi.cornell_box()
    description["sensor"]["film"] |= {"width": 24, "height": 24}
    description["integrator"] = {"type": integrator}
    return np.mean(np.array(mi.render(mi.load_dict(description), spp=256, seed=1)))


path, ours = mitsuba_mean("path"), mitsuba_mean("lightcull_path")
assert abs(ours / path - 1) < 0.03, (ours, path)  # each is off by 0.4 % or so

maps = Path("/proc/self/maps").read_text().splitlines()
print(*sorted({line.split(maxsplit=5)[5] for line in maps if ".so" in line}), sep="\n")
