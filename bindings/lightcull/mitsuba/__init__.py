"""Mitsuba 3 with lightcull: the integrators `lightcull_path` and `lightcull_volpath`, and what goes
with them.

Importing this makes the plugins known to Mitsuba, in whichever variants are set before or after:

>>> import lightcull.mitsuba
>>> import mitsuba as mi
>>> mi.set_variant("scalar_rgb")
>>> scene = mi.load_dict(mi.cornell_box() | {"integrator": {"type": "lightcull_path"}})
>>> image = mi.render(scene, spp=64)

`lightcull_path` takes the parameters of Mitsuba's `path`, and these: light_sampler (a description
as `lightcull.LightSampler` takes it; default: learned, or culled with one of the following),
error_bound (a number or "auto") and sets (a power of 4), which are added to it; and keep_learned. It
renders in scalar_rgb, scalar_spectral, llvm_ad_rgb and llvm_ad_spectral. In the latter two it has
derivatives by emission, materials and textures. For these, and within another integrator such as
`aov`, light_bvh:importance=means chooses lights, whatever light_sampler says. An integrator keeps
its light sampler from one render to the next, for as long as the lights are the same and the camera
sees the same; what it has learned, only with keep_learned, since images then depend on those before.
Any thread may render; in LLVM variants, renders that are called at once take turns.

`lightcull_volpath` is to `volpath` what `lightcull_path` is to `path`, in the same variants. It takes
the parameters of `volpath` alone: light_bvh:importance=means chooses lights. It has no derivatives.

`import_scene` takes a Mitsuba scene to lightcull's own renderer.

Importing this raises lightcull.Error if Mitsuba is missing or of another version.
"""

from .host import mitsuba as _mitsuba
from .importer import import_scene
from .merge import merge_emitters
from .mitsuba_scene import MitsubaScene
from .scene_file import load_file

__all__ = ["MitsubaScene", "import_scene", "load_file", "merge_emitters"]

_mitsuba()
