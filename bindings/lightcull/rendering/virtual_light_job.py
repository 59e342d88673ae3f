"""Rendering by virtual lights: what bounces off surfaces is light that comes from there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import _core, checks, memory
from .._core import Error
from ..scene import Scene
from .method import check_method
from .settings import RR_DEPTH, RenderSettings
from .statistics import Stats


@dataclass(frozen=True)
class LightCounts:
    """What virtual lights took: means over passes, and over pixels that show a surface."""

    lights: float
    """Virtual lights of a pass."""
    listed: float
    """Lights in the list of a pixel's tile, or that the traversal of vpl_grid found."""
    accepted: float
    """Of them, those in whose range the pixel is; of vpl_grid those that give it something."""
    shadow_rays: float
    """Per pixel."""
    map_points: float
    """Per virtual light: points splatted into its shadow map."""
    error_bound: float
    """Of vpl_culled and vpl_clamped: given, or found in the first pass."""
    generation_seconds: float
    """Per pass, as the following: of processors, all threads together."""
    build_seconds: float
    """Of vpl_grid its hierarchy, of shadows=maps the maps."""
    lighting_seconds: float
    """Ranges, culling, shading and shadows."""
    filter_seconds: float

    @property
    def false_discovery_rate(self) -> float:
        """The part of the listed lights in whose range the pixel is not."""
        return 1.0 - self.accepted / self.listed if self.listed else 0.0


class VirtualLightJob:
    """A render by virtual lights that goes pass by pass, and its clock."""

    def __init__(self, scene: Scene, method: str, sampler: str, settings: RenderSettings) -> None:
        self.method = check_method(method)
        self.sampler = checks.text("sampler", sampler)
        if (settings.rr_depth, settings.direct_light) != (RR_DEPTH, "mis"):
            raise Error(f"{method}: rr_depth and direct_light are for paths")
        if settings.max_depth < 3:
            raise Error(
                f"{method}: max_depth is {settings.max_depth}: virtual lights give what bounces, "
                "from max_depth 3 on"
            )
        self._scene = scene.closed()
        self._renderer = _core.VirtualLightRenderer(
            self._scene, method, sampler, *settings.size, settings.max_depth, settings.seed,
            settings.threads, settings.hide_emitters,
        )  # fmt: skip
        self._memory = self._renderer.virtual_light_memory()
        memory.check(f"{method}: its virtual lights need", self._memory.lights)
        memory.check(f"{method}: its image needs", self._memory.image)

    def render_pass(self) -> None:
        """Adds one sample to every pixel, by new virtual lights. Ctrl-C drops the pass."""
        self._renderer.render_pass()

    def image(self) -> np.ndarray:
        """The mean of the passes so far: float32 (H, W, 3)."""
        return self._renderer.image()

    def stats(self) -> Stats:
        return Stats.of(self._renderer.stats(), self._renderer.setup_seconds())

    def memory_size(self) -> tuple[_core.SceneMemory, _core.RendererMemory, int, int]:
        """Bytes, of the scene, of direct light, of virtual lights, and of those what is there
        already.
        """
        virtual_lights = self._memory.lights + self._memory.image
        direct = self._renderer.memory_size()
        return self._scene.memory_size(), direct, virtual_lights, self._memory.kept

    def lights_of_pixels(self) -> np.ndarray:
        """float64 (H, W, 2): listed and accepted lights of each pixel, means over the passes."""
        return self._renderer.lights_of_pixels() / max(self._renderer.stats().passes, 1)

    def light_counts(self) -> LightCounts:
        """After the first pass."""
        stats = self._renderer.virtual_light_stats()
        passes, pixels = self._renderer.stats().passes, max(stats.pixels, 1)
        return LightCounts(
            lights=stats.lights / passes,
            listed=stats.listed / pixels,
            accepted=stats.accepted / pixels,
            shadow_rays=stats.shadow_rays / pixels,
            map_points=stats.map_points / max(stats.lights, 1),
            error_bound=stats.error_bound,
            generation_seconds=stats.generation_seconds / passes,
            build_seconds=stats.build_seconds / passes,
            lighting_seconds=stats.lighting_seconds / passes,
            filter_seconds=stats.filter_seconds / passes,
        )
