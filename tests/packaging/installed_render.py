"""Uses an installed lightcull as a newcomer would: renders, by itself and within Mitsuba, writes and
reads images. Then names the libraries that the process has loaded, one a line.

Usage: installed_render.py FOLDER    where to write images
"""

import sys
from pathlib import Path

import lightcull
import lightcull.mitsuba
import mitsuba as mi
import numpy as np

folder = Path(sys.argv[1])

# The path tracer with learned light sampling, Embree, and OpenColorIO's view.
lightcull.render(lightcull.example_scene("cornell"), spp=4, size=(32, 24)).save(
    str(folder / "cornell.png")
)

# A texture in each format that is promised goes through OpenImageIO and comes back.
for name in ("gray.png", "gray.jpg", "gray.webp", "gray.tiff", "gray.bmp", "gray.tga"):
    from PIL import Image

    Image.new("RGB", (8, 4), (128, 128, 128)).save(folder / name)
    pixels = lightcull.read_image(str(folder / name))
    assert pixels.shape == (4, 8, 3), name
    assert np.allclose(pixels, 0.2158, atol=0.005), name
lightcull.write_exr(str(folder / "gray.exr"), pixels)
assert np.allclose(lightcull.read_image(str(folder / "gray.exr")), pixels, atol=1e-3)

mi.set_variant("scalar_rgb")
scene = mi.cornell_box()
scene["sensor"]["film"] |= {"width": 24, "height": 24}
scene = mi.load_dict(scene)
means = [
    np.mean(np.array(mi.render(scene, integrator=mi.load_dict({"type": name}), spp=64)))
    for name in ("path", "lightcull_path")
]
assert abs(means[1] / means[0] - 1) < 0.05, means

maps = Path("/proc/self/maps").read_text().splitlines()
print(*sorted({line.split(maxsplit=5)[5] for line in maps if ".so" in line}), sep="\n")
