"""lightcull picks, for a shading point, one light out of millions, and says how probable it was.

>>> import lightcull
>>> scene = lightcull.example_scene("lanterns")
>>> result = lightcull.render(scene, sampler="culled", seconds=10)
>>> result.save("lanterns.exr")

Metres, radians, linear RGB. Arrays are C-contiguous float32 (N, 3), ids uint32.
"""

from ._core import COUNTS, LIGHT, SELECTION, Error
from ._core import VERSION as __version__
from .compare import SAMPLERS, compare
from .images import apply_view, read_image, view_names, write_exr, write_png
from .loaders import UnsupportedWarning, load, open_scene
from .loaders import example_scene as example_scene
from .methods import MethodReport, compare_methods
from .render import Progress, RenderResult, Stats, render
from .report import Comparison
from .sampler import LightSampler, point_lights, triangle_lights
from .scene import Camera, Scene
from .virtual_lights import METHODS

__all__ = [
    "COUNTS",
    "LIGHT",
    "METHODS",
    "SAMPLERS",
    "SELECTION",
    "Camera",
    "Comparison",
    "Error",
    "LightSampler",
    "MethodReport",
    "Progress",
    "RenderResult",
    "Scene",
    "Stats",
    "UnsupportedWarning",
    "__version__",
    "apply_view",
    "compare",
    "compare_methods",
    "example_scene",
    "load",
    "open_scene",
    "point_lights",
    "read_image",
    "render",
    "triangle_lights",
    "view_names",
    "write_exr",
    "write_png",
]
