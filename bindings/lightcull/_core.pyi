"""The compiled part. What arrays are, its users' docstrings say."""

from collections.abc import Sequence
from typing import Any, Final, Protocol

import numpy as np

VERSION: Final[str]
BUILD: Final[str]
NO_TEXTURE: Final[int]

LIGHT: Final[np.dtype[np.void]]
"""Of a light: center (3,), radius, axis (3,), cos_theta_o, cos_theta_e, intensity, lobe_alpha
(float32), two_sided and directional (bool); metres, W/sr. `axis` is a unit vector, and the normals of
the light lie within theta_o of it; it emits up to theta_e from its normal. A directional light shines
along it from infinity, and its intensity is irradiance, W/m^2.
"""
LOBE: Final[np.dtype[np.void]]
"""Of the glossy lobe of a surface: axis (3,), alpha, peak (float32). `axis` is the mirror direction
of the view, a unit vector; alpha is in (0, 1]; the peak is the lobe's value at the axis, in units
of `diffuse`, and 0 where there is no glossy part.
"""
SELECTION: Final[np.dtype[np.void]]
"""Of a selection: light (uint32), prob, mis_prob, weight_sum (float32), key (uint32)."""
COUNTS: Final[np.dtype[np.void]]
"""Of what a selection costs: nodes_visited, lights_tested, accepted (uint32)."""

class Error(RuntimeError):
    """What lightcull throws: one line that names the thing at fault."""

def read_image(path: str, linear_data: bool = False) -> np.ndarray: ...
def read_stored_image(path: str) -> np.ndarray:
    """uint8 or uint16 (H, W, 3) or (H, W) as in the file, else float32 (H, W, 3), linear RGB."""

def read_layer(path: str, name: str) -> np.ndarray: ...

def read_obj(text: bytes, material_count: int, /) -> list[dict[str, Any]]:
    """The meshes of an OBJ file, one for each material, and for each of having normals and texture
    coordinates or not: "material" (-1: none), "positions" (N, 3), "indices" (M, 3), and "normals",
    "uvs" and "colors" or None. In the text materials must have whole numbers below the count for
    names.
    """

def write_exr(
    path: str, image: np.ndarray, half: bool = False, metadata: dict[str, str] = ...
) -> None: ...
def write_png(path: str, image: np.ndarray, metadata: dict[str, str] = ...) -> None: ...
def write_whole_file(path: str, data: bytes) -> None:
    """Writes a file that appears under its name whole or not at all."""

def view_names() -> list[str]: ...
def apply_view(image: np.ndarray, view: str, exposure_stops: float = 0.0) -> np.ndarray: ...

def triangle_lights(
    corners: np.ndarray, radiance: np.ndarray, two_sided: bool = False
) -> np.ndarray: ...
def point_lights(positions: np.ndarray, intensity: np.ndarray) -> np.ndarray: ...
def spot_lights(
    positions: np.ndarray,
    directions: np.ndarray,
    intensity: np.ndarray,
    inner: np.ndarray,
    outer: np.ndarray,
) -> np.ndarray: ...
def directional_lights(directions: np.ndarray, irradiance: np.ndarray) -> np.ndarray: ...
def bounded_lights(
    box_min: np.ndarray,
    box_max: np.ndarray,
    axes: np.ndarray,
    cos_theta_o: np.ndarray,
    cos_theta_e: np.ndarray,
    power: np.ndarray,
    two_sided: bool = False,
) -> np.ndarray: ...

class SceneMemory:
    """Bytes."""

    @property
    def data(self) -> int: ...
    @property
    def bvh(self) -> int: ...

class Scene:
    def __init__(self) -> None: ...
    def add_texture(self, texels: np.ndarray, linear_data: bool, /) -> int: ...
    def add_material(
        self,
        metallic_roughness: bool,
        base_color: Any,
        metallic: float,
        roughness: float,
        base_color_texture: int,
        metallic_roughness_texture: int,
        opacity: float,
        opacity_texture: int,
        opacity_threshold: float,
        normal_texture: int,
        normal_scale: float,
        /,
    ) -> int: ...
    def add_mesh(
        self,
        name: str,
        positions: np.ndarray,
        indices: np.ndarray,
        normals: np.ndarray | None,
        uvs: np.ndarray | None,
        colors: np.ndarray | None,
        material: int,
        radiance: Any,
        face_radiance: np.ndarray | None,
        texture: int,
        two_sided: bool,
        shared: bool,
        /,
    ) -> int: ...
    def add_instance(self, mesh: int, transform: Sequence[float], /) -> None: ...
    def add_point_light(self, position: Any, intensity: Any, /) -> None: ...
    def add_spot_light(
        self, position: Any, direction: Any, intensity: Any, inner: float, outer: float, /
    ) -> None: ...
    def add_directional_light(self, direction: Any, irradiance: Any, /) -> None: ...
    def set_environment(self, map: np.ndarray, scale: Any, rotation: float, /) -> None: ...
    def set_camera(
        self,
        origin: Any,
        target: Any,
        up: Any,
        vertical_fov: float,
        aperture_radius: float,
        focus_distance: float,
        orthographic_height: float,
        /,
    ) -> None: ...
    def commit(self) -> None: ...
    def set_mesh_positions(
        self, mesh: int, positions: np.ndarray, normals: np.ndarray | None, /
    ) -> None: ...
    def set_light_positions(self, positions: np.ndarray, /) -> None: ...
    def set_light_directions(self, directions: np.ndarray, /) -> None: ...
    def refit(self) -> tuple[bool, float]:
        """Whether Embree's tree was built anew, and how loose it had become before that."""

    def contents(self) -> dict[str, Any]:
        """What was added, as it is now, as scene_contents.cpp names it."""

    def lights(self) -> np.ndarray: ...
    def light_count(self) -> int: ...
    def emitter_count(self) -> int: ...
    def triangle_count(self) -> int: ...
    def has_environment(self) -> bool: ...
    def memory_size(self) -> SceneMemory: ...

def sampler_of_lights(
    lights: np.ndarray,
    description: str,
    positions: np.ndarray,
    normals: np.ndarray | None,
    device: str,
    /,
) -> LightSampler: ...
def sampler_of_scene(scene: Scene, description: str, device: str, /) -> LightSampler: ...
def vulkan_devices() -> list[tuple[str, str]]:
    """Names, best first, each with why it cannot be used; empty if it can."""


def check_sampler(description: str, /) -> None:
    """Throws Error unless it describes a sampler."""



class Preview:
    def __init__(self, scene: Scene, /) -> None: ...
    def distances(self, origins: np.ndarray, directions: np.ndarray, /) -> np.ndarray: ...
    def memory_size(self) -> SceneMemory:
        """What it takes besides the scene."""

    def look(
        self,
        origin: Any,
        target: Any,
        up: Any,
        vertical_fov: float,
        aperture_radius: float,
        focus_distance: float,
        orthographic_height: float,
        width: int,
        height: int,
        passes: int,
        /,
    ) -> np.ndarray: ...

class LightSelector:
    def select(
        self,
        positions: np.ndarray,
        normals: np.ndarray | None,
        u: np.ndarray,
        sets: np.ndarray | None,
        diffuse: np.ndarray | None,
        lobe: np.ndarray | None,
        /,
    ) -> np.ndarray: ...
    def select_single(
        self,
        positions: np.ndarray,
        normals: np.ndarray | None,
        u: np.ndarray,
        sets: np.ndarray | None,
        diffuse: np.ndarray | None,
        lobe: np.ndarray | None,
        /,
    ) -> np.ndarray:
        """As select(), one call of the library for each point."""

    def prob(
        self,
        positions: np.ndarray,
        normals: np.ndarray | None,
        selections: np.ndarray,
        lights: np.ndarray | None,
        diffuse: np.ndarray | None,
        lobe: np.ndarray | None,
        /,
    ) -> np.ndarray: ...
    def vertex_prob(
        self,
        positions: np.ndarray,
        normals: np.ndarray | None,
        selections: np.ndarray,
        vertices: np.ndarray,
        /,
    ) -> np.ndarray: ...
    def count(
        self,
        positions: np.ndarray,
        normals: np.ndarray | None,
        sets: np.ndarray | None,
        diffuse: np.ndarray | None,
        lobe: np.ndarray | None,
        /,
    ) -> np.ndarray: ...
    def light_count(self) -> int: ...
    def set_count(self) -> int: ...
    def needs_receipt(self) -> bool: ...
    def wants_reports(self) -> bool: ...
    def report(
        self,
        positions: np.ndarray,
        normals: np.ndarray | None,
        selections: np.ndarray,
        visibility: np.ndarray,
        /,
    ) -> None: ...

class LightSampler(LightSelector):
    def learned(self) -> bytes: ...
    def restore_learned(self, learned: bytes, /) -> None: ...
    def begin_pass(self, number: int, /) -> None: ...
    def at_pass(self, number: int, /) -> LightSelector: ...
    def update(self, lights: np.ndarray, max_growth: float, /) -> tuple[bool, float]: ...

class RenderStats:
    def __init__(
        self,
        passes: int,
        seconds: float,
        sampler_seconds: float,
        selection_seconds: float,
        selections: int,
        rays: int,
    ) -> None: ...
    @property
    def passes(self) -> int: ...
    @property
    def seconds(self) -> float: ...
    @property
    def sampler_seconds(self) -> float: ...
    @property
    def selection_seconds(self) -> float: ...
    @property
    def selections(self) -> int: ...
    @property
    def rays(self) -> int: ...

class MeanCounts:
    @property
    def nodes_visited(self) -> float: ...
    @property
    def lights_tested(self) -> float: ...
    @property
    def accepted(self) -> float: ...

class RendererMemory:
    """Bytes."""

    @property
    def sampler(self) -> int: ...
    @property
    def learned(self) -> int:
        """What the sampler may still come to by learning, at most."""

    @property
    def film(self) -> int: ...
    @property
    def paths(self) -> int:
        """Once a pass has been rendered."""

class LearnedView:
    """What a sampler has learned, as the pixels of an image see it."""

    def cells(self) -> np.ndarray:
        """int32 (H, W): the cell that the pixel's point lies in; -1 where there is none."""

    def visibility(self) -> np.ndarray:
        """float32 (H, W): the share of shadow rays to the cluster of `light` that is taken to arrive,
        [0, 1]; not a number where nothing is known.
        """

    def normals(self) -> np.ndarray:
        """float32 (H, W, 3): towards the camera, unit length; 0 where nothing is seen."""

    @property
    def light(self) -> int:
        """The light whose visibility differs most from pixel to pixel, of some hundreds."""

    @property
    def light_position(self) -> tuple[float, float, float] | None:
        """Metres; None for a directional light."""

    @property
    def cell_count(self) -> int:
        """The cells there are, seen or not."""

    @property
    def memory_size(self) -> int:
        """Bytes that they take."""

class SamplerLibrary:
    def __init__(self, path: str, description: str, /) -> None: ...
    @property
    def path(self) -> str: ...
    @property
    def description(self) -> str: ...

class ObjectSampler(Protocol):
    """What a renderer takes for a sampler: a Python object, which throws nothing."""

    set_count: int
    needs_receipt: bool
    def begin_pass(self, number: int, /) -> None: ...
    def select(
        self,
        positions: np.ndarray,
        normals: np.ndarray,
        u: np.ndarray,
        sets: np.ndarray,
        diffuse: np.ndarray,
        lobe: np.ndarray,
        /,
    ) -> np.ndarray:
        """(N,) of dtype SELECTION."""

    def prob(
        self,
        positions: np.ndarray,
        normals: np.ndarray,
        selections: np.ndarray,
        lights: np.ndarray,
        diffuse: np.ndarray,
        lobe: np.ndarray,
        /,
    ) -> float:
        """Of arrays of one point."""

class Renderer:
    def __init__(
        self,
        scene: Scene,
        sampler: str | SamplerLibrary | ObjectSampler,
        width: int,
        height: int,
        max_depth: int,
        seed: int,
        threads: int,
        rr_depth: int,
        direct_light: str,
        emission_apart: bool,
        even_numbers: bool,
        hide_emitters: bool,
    ) -> None: ...
    def render_pass(self) -> bool: ...
    def restart(self, seed: int, /) -> tuple[bool, float]:
        """Whether the sampler was built anew, and how loose it had become before that."""

    def image(self) -> np.ndarray: ...
    def emission(self) -> np.ndarray:
        """The part of the image that the camera sees of emitters directly: float32 (H, W, 3). An
        Error unless emission is kept apart.
        """

    def lit(self) -> np.ndarray:
        """The rest of the image; the same holds."""

    def sums(self) -> np.ndarray:
        """float64 (H, W, 3), over the passes."""

    def learned(self) -> bytes:
        """What the sampler has learned; empty if it does not."""

    def emission_sums(self) -> np.ndarray:
        """Those of emission() alone; the same holds as of that."""

    def learning(self) -> bool:
        """Whether passes depend on those before them."""

    def begin_part(self, first_pass: int, learned: bytes) -> None:
        """Begins a part of the image, from a pass of that number on, whose sums and statistics are its
        own, but for the number of passes. learned: of a renderer like this one; empty: none.
        """

    def restore(self, stats: RenderStats, sums: np.ndarray, learned: bytes, /) -> None:
        """Goes on from stats(), sums() and learned() of a renderer like this one."""

    def stats(self) -> RenderStats: ...
    def mean_counts(self) -> MeanCounts | None:
        """None where the sampler does not tell."""

    def learned_view(self) -> LearnedView | None:
        """None where nothing was learned."""

    def memory_size(self) -> RendererMemory: ...
    def setup_seconds(self) -> float: ...

class VirtualLightStats:
    """Sums over all passes; seconds of processors."""

    @property
    def lights(self) -> int: ...
    @property
    def generation_seconds(self) -> float: ...
    @property
    def build_seconds(self) -> float: ...
    @property
    def lighting_seconds(self) -> float: ...
    @property
    def filter_seconds(self) -> float: ...
    @property
    def pixels(self) -> int: ...
    @property
    def listed(self) -> int: ...
    @property
    def accepted(self) -> int: ...
    @property
    def shadow_rays(self) -> int: ...
    @property
    def error_bound(self) -> float: ...
    @property
    def map_points(self) -> int: ...

class VirtualLightMemory:
    """Bytes."""

    @property
    def lights(self) -> int: ...
    @property
    def image(self) -> int: ...
    @property
    def kept(self) -> int: ...

class VirtualLightRenderer:
    def __init__(
        self,
        scene: Scene,
        method: str,
        sampler: str,
        width: int,
        height: int,
        max_depth: int,
        seed: int,
        threads: int,
        hide_emitters: bool,
    ) -> None: ...
    def render_pass(self) -> bool: ...
    def image(self) -> np.ndarray: ...
    def stats(self) -> RenderStats: ...
    def lights_of_pixels(self) -> np.ndarray:
        """uint32 (H, W, 2): listed and accepted, over the passes."""

    def virtual_light_stats(self) -> VirtualLightStats: ...
    def memory_size(self) -> RendererMemory: ...
    def virtual_light_memory(self) -> VirtualLightMemory: ...
    def setup_seconds(self) -> float: ...

def add_virtual_lights(scene: Scene, light_paths: int, bounces: int, seed: int) -> None: ...
def check_virtual_light_method(method: str, /) -> None:
    """Raises Error for a description that VirtualLightRenderer does not take."""

def instruction_sets() -> list[str]:
    """The instruction sets that selection can use on this machine, best first."""

def instruction_set() -> str:
    """The one in use."""

def use_instruction_set(name: str) -> None:
    """Makes all samplers use one of instruction_sets(). Only while none is at work."""

class BenchPoints:
    """Points, random numbers, and the lights chosen for them last."""

    def __len__(self) -> int: ...
    def thinned(self, count: int, /) -> BenchPoints: ...

class TimedSampler:
    """A sampler of a scene. What works returns how many seconds of wall time it took."""

    def __init__(
        self,
        scene: Scene,
        description: str,
        width: int,
        height: int,
        max_depth: int,
        threads: int,
        device: str = "cpu",
    ) -> None: ...
    def begin_pass(self, number: int, /) -> float: ...
    def select_batch(self, points: BenchPoints, /) -> float: ...
    def select_single(self, points: BenchPoints, /) -> float: ...
    def trace_shadow_rays(self, points: BenchPoints, /) -> tuple[float, int, int]:
        """To the lights chosen last: seconds, how many rays there were, and how many arrived."""

    def wants_reports(self) -> bool: ...
    def learn(self, points: BenchPoints, round: int, /) -> None:
        """Selects by random numbers of the round, and reports what shadow rays find."""

    def cell_count(self) -> int: ...

    def path_points(self, depth: int, /) -> BenchPoints: ...
    def points(self, positions: np.ndarray, normals: np.ndarray, /) -> BenchPoints: ...
    def counts(self, points: BenchPoints, /) -> MeanCounts: ...
    def build_seconds(self) -> float: ...
    def set_count(self) -> int: ...
    def memory_size(self) -> int: ...
