"""lightcull picks, for a shading point, one light out of millions, and says how probable it was.

>>> import lightcull
>>> scene = lightcull.example_scene("lanterns")
>>> result = lightcull.render(scene, seconds=10)
>>> result.save("lanterns.exr")

Metres, radians, linear RGB. Arrays are C-contiguous float32 (N, 3), ids uint32.
"""

# The package from the bottom up, where each line imports from those above it only:
#   _core (compiled), checks, machine, memory, images, output_files
#   scene, sampler    what is rendered, and what chooses its lights
#   surroundings, views   what is around a scene, and from where it is seen, where no file says
#   scenes, loaders   scenes made by code and from files
#   rendering         one image; report: the figures and the page of a comparison
#   peers             other renderers, of which the same scene is shown
#   comparing, methods, bench, selftest   measurements made of renders and selections
#   mitsuba           scenes of Mitsuba's, rendered there or here
#   cli               the command
#
# Large packages for reports and files (flip_evaluator, jinja2, matplotlib, Pillow) are imported by
# the functions that use them, so that `import lightcull` and a render wait for none of them.

from ._core import COUNTS, LIGHT, LOBE, SELECTION, Error
from ._core import VERSION as __version__
from .camera import Camera, View
from .comparing.compare import SAMPLERS, compare
from .images import apply_view, read_image, view_names, write_exr, write_png
from .loaders import UnsupportedWarning, example_scene, load, open_scene
from .methods import MethodReport, compare_methods
from .rendering.frames import Frames
from .rendering.job import SubjectJob
from .rendering.method import METHODS
from .rendering.own_sampler import OwnSampler, SamplerLibrary
from .rendering.progress import Progress
from .rendering.render import render
from .rendering.result import RenderResult
from .rendering.statistics import Stats
from .rendering.subject import Subject
from .report import Comparison
from .sampler import (
    LightSampler,
    LightSelector,
    bounded_lights,
    directional_lights,
    point_lights,
    spot_lights,
    triangle_lights,
)
from .scene import Scene

__all__ = [
    "COUNTS",
    "LIGHT",
    "LOBE",
    "METHODS",
    "SAMPLERS",
    "SELECTION",
    "Camera",
    "Comparison",
    "Error",
    "Frames",
    "LightSampler",
    "LightSelector",
    "MethodReport",
    "OwnSampler",
    "Progress",
    "RenderResult",
    "SamplerLibrary",
    "Scene",
    "Stats",
    "Subject",
    "SubjectJob",
    "UnsupportedWarning",
    "View",
    "__version__",
    "apply_view",
    "bounded_lights",
    "compare",
    "compare_methods",
    "directional_lights",
    "example_scene",
    "load",
    "open_scene",
    "point_lights",
    "read_image",
    "render",
    "spot_lights",
    "triangle_lights",
    "view_names",
    "write_exr",
    "write_png",
]
