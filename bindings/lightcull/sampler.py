"""Light samplers over arrays of points."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _core, checks
from .scene import Scene


class LightSelector:
    """Chooses lights for points by random ranges that do not change: a pass of a `LightSampler`.

    One pass is not enough: for the ranges of a single pass and set, the mean over u alone is off
    (by a third at some points), however many u there are. Sums converge over passes, or over the
    sets of a pass that has many.

    Points are described by these arrays, alike in `select` and in `prob`:
    positions: float32 (N, 3), metres. normals: float32 (N, 3), unit length, on the side that
    receives light, or 0 in a volume; None: 0 for all. diffuse: float32 (N,), diffuse albedo / pi,
    in any unit, at least 0; None: 1 for all. lobe: (N,) of dtype `lightcull.LOBE`, the glossy part
    of what the surface does with light, in the unit of diffuse: its BSDF times cosine is taken as
    peak / (1 + s^2 (1 / alpha^2 - 1))^2, where s is the sine of the angle between the normal and the
    half vector, of the light's direction and the view. axis: the mirror direction of the view (unit
    length). alpha: GGX roughness, (0, 1]. peak: at least 0; 0: there is none. None: none for all.

    Calls release the GIL and may run in any number of threads.
    """

    def __init__(self, core: _core.LightSelector, description: str) -> None:
        self._core = core
        self.description = description

    def select(
        self,
        positions: np.ndarray,
        normals: np.ndarray | None,
        u: np.ndarray,
        sets: np.ndarray | None = None,
        *,
        diffuse: np.ndarray | None = None,
        lobe: np.ndarray | None = None,
    ) -> np.ndarray:
        """Chooses a light for each point.

        positions, normals, diffuse, lobe: the points, as the class has them. u: float32 (N,),
        random numbers in [0, 1). sets: uint32 (N,), which of the `set_count` sets of random ranges
        each point uses; None: the first.

        Returns (N,) of dtype `lightcull.SELECTION`: light (index), prob (in (0, 1], or 0 where no
        light was chosen, which is no error), mis_prob (for MIS weights: what `prob` says of the
        light), and the receipt, weight_sum and key: an account of all that could have been selected
        at the point, which `prob` needs to say how likely another light was.
        """
        return self._core.select(positions, normals, u, sets, diffuse, lobe)

    def prob(
        self,
        positions: np.ndarray,
        normals: np.ndarray | None,
        selections: np.ndarray,
        lights: np.ndarray | None = None,
        *,
        diffuse: np.ndarray | None = None,
        lobe: np.ndarray | None = None,
    ) -> np.ndarray:
        """The probability of a light at each point, for multiple importance sampling: float32 (N,).

        positions, normals, diffuse, lobe: the points, as they were when `select` was called.
        selections: what it returned for them; only their receipts count, which are valid where prob
        is 0, too. They hold for this pass alone. When a ray that left a point hits a light, the
        receipt is that of the point which the ray left, not of the hit. lights: uint32 (N,), of any
        stride, so that a field of other selections will do; None: those that were selected, with 0
        where none was. A light that was not accepted gets the probability that it would have had,
        had it been accepted: that makes MIS weights sum to one in the mean over passes, so that
        here, too, one pass is not enough.
        """
        return self._core.prob(positions, normals, selections, lights, diffuse, lobe)

    def report(
        self,
        positions: np.ndarray,
        normals: np.ndarray | None,
        selections: np.ndarray,
        visibility: np.ndarray,
    ) -> None:
        """Reports what became of selected lights, to a sampler that learns (`learned`); others do
        not listen.

        selections: what `select` returned for these points, or a part of both; where prob is 0
        nothing is reported. visibility: float32 (N,), the share of the light's rays that arrived,
        in [0, 1]: 0 where a shadow ray was blocked, 1 or a transmittance where not. What was
        learned is used from the next `begin_pass` on.
        """
        self._core.report(positions, normals, selections, visibility)

    def vertex_prob(
        self,
        positions: np.ndarray,
        normals: np.ndarray | None,
        selections: np.ndarray,
        vertices: np.ndarray,
    ) -> np.ndarray:
        """The factor by which to multiply prob at a vertex on the chosen light: float32 (N,).

        1, unless the sampler decides at the vertex (`paper` does): then 0 where the vertex is out
        of range and the light must be skipped. vertices: float32 (N, 3), metres.
        """
        return self._core.vertex_prob(positions, normals, selections, vertices)

    def count(
        self,
        positions: np.ndarray,
        normals: np.ndarray | None,
        sets: np.ndarray | None = None,
        *,
        diffuse: np.ndarray | None = None,
        lobe: np.ndarray | None = None,
    ) -> np.ndarray:
        """What a selection costs at each point, described as in `select`: (N,) of dtype
        `lightcull.COUNTS`: nodes_visited, lights_tested, accepted.
        """
        return self._core.count(positions, normals, sets, diffuse, lobe)

    @property
    def light_count(self) -> int:
        """Number of lights, those of intensity 0 included."""
        return self._core.light_count()

    @property
    def set_count(self) -> int:
        """Number of sets of random ranges in a pass."""
        return self._core.set_count()

    @property
    def needs_receipt(self) -> bool:
        """False if `prob` depends on the point and the light alone, whatever was selected."""
        return self._core.needs_receipt()

    @property
    def wants_reports(self) -> bool:
        """False if `report` need not be called: the sampler does not learn, or not now."""
        return self._core.wants_reports()

    def __repr__(self) -> str:
        return f"<lightcull.LightSampler {self.description!r}: {self.light_count} lights>"


class LightSampler(LightSelector):
    """Picks, for each of many points, one light out of many, and says with what probability.

    lights: a `Scene`, or lights as `triangle_lights`, `point_lights` or `Scene.lights` give them:
    (N,) of dtype `lightcull.LIGHT`, whose fields are center (3), radius, axis (3; unit length),
    cos_theta_o (of the cone of normals about the axis), cos_theta_e (of the largest angle to a
    normal at which it emits), intensity (W/sr, luminance), two_sided, lobe_alpha (0; or of a
    point that emits most into `axis` GGX's alpha, 0.001 to 1, its cos_theta_o being -1) and
    directional (infinitely far: it shines along `axis`, and its intensity is irradiance, W/m^2).
    description: a name, then options, as in "culled", "culled:sets=16", "clamped:error_bound=0.05".
    The names are `lightcull.SAMPLERS`.
    calibration: positions and normals of some hundred points typical of the use, to set the ranges
    of `culled` by. Without them they are drawn from the bounds of the lights; those of a scene come
    from its camera.
    device: "cpu"; or, of `culled` and `paper`, "vulkan", the best that Vulkan knows of, or
    "vulkan:NAME", one whose name holds NAME (`lightcull info` lists them). It chooses as the
    processor does. If it fails later, selections come from the processor, and the next `begin_pass`
    raises, once.

    Calls release the GIL and may run in any number of threads; a `begin_pass` waits for those that
    are under way. Pass 0 has begun when the sampler is made.

    >>> sampler = LightSampler(lightcull.example_scene("lanterns"), "culled")
    >>> for number in range(passes):
    ...     sampler.begin_pass(number)
    ...     u = numbers.random(len(positions), dtype=np.float32)
    ...     chosen = sampler.select(positions, normals, u)
    ...     estimates += light_from(chosen["light"]) / chosen["prob"]
    """

    def __init__(
        self,
        lights: Scene | np.ndarray,
        description: str = "culled",
        *,
        calibration: tuple[np.ndarray, np.ndarray] | None = None,
        device: str = "cpu",
    ) -> None:
        checks.text("description", description)
        checks.text("device", device)
        if isinstance(lights, Scene):
            if calibration is not None:
                raise TypeError("calibration: a scene brings its own")
            core = _core.sampler_of_scene(lights.closed(), description, device)
        else:
            positions, normals = _calibration(calibration)
            if getattr(getattr(lights, "dtype", None), "names", None) == _core.LIGHT.names:
                # What NumPy makes of several arrays of them has another layout in memory.
                lights = lights.astype(_core.LIGHT, copy=False)
            core = _core.sampler_of_lights(lights, description, positions, normals, device)
        super().__init__(core, description)
        self._sampler = core

    def begin_pass(self, number: int) -> None:
        """Draws the random ranges of a pass; equal numbers give equal ranges. Call it anew for every
        pass: one is not enough.
        """
        self._sampler.begin_pass(checks.whole_number("number", number, most=checks.MOST_64_BITS))

    def at_pass(self, number: int) -> LightSelector:
        """The ranges that `begin_pass(number)` would draw, as an object of its own.

        It shares the tree with the sampler and never changes, so that any number of passes can be
        used at once. It selects on the processor.
        """
        checks.whole_number("number", number, most=checks.MOST_64_BITS)
        return LightSelector(self._sampler.at_pass(number), self.description)

    def learned(self) -> bytes:
        """What has been learned and reported; empty if the sampler does not learn."""
        return self._sampler.learned()

    def restore_learned(self, learned: bytes) -> None:
        """Goes on as the sampler would whose `learned` this is, and begins pass 0.

        That one is over the same lights, made with the same description by the same version of
        lightcull; `lightcull.Error` for anything else.
        """
        self._sampler.restore_learned(learned)

    def update(self, lights: np.ndarray, max_growth: float = 2.0) -> tuple[bool, float]:
        """Takes lights that have moved, changed or been switched, and begins pass 0.

        lights: as many as the sampler was made over, in the same order. `culled` and `light_bvh`
        fit their tree to them, in a tenth of the time of building it; it is built anew if it has
        grown looser than max_growth, or a light shines that had no intensity before.

        Returns whether it was built anew, and how loose it had become before that, relative to when
        it was last built: 1 is as tight.
        """
        if lights.dtype.names == _core.LIGHT.names:
            lights = lights.astype(_core.LIGHT, copy=False)
        return self._sampler.update(lights, checks.number("max_growth", max_growth))


def _calibration(given: Any) -> tuple[np.ndarray, np.ndarray | None]:
    if given is None:
        return np.empty((0, 3), np.float32), None
    if not isinstance(given, tuple | list) or len(given) != 2:
        raise TypeError(f"calibration: wanted positions and normals, got {type(given).__name__}")
    return given[0], given[1]


def triangle_lights(
    corners: np.ndarray, radiance: np.ndarray, two_sided: bool = False
) -> np.ndarray:
    """Lights for triangles, (N,) of dtype `lightcull.LIGHT`.

    corners: float32 (N, 3, 3), metres; the front is where they run anticlockwise. radiance: float32
    (N,), luminance, W/(m^2 sr). two_sided: they emit from the back too.
    """
    return _core.triangle_lights(corners, radiance, bool(two_sided))


def point_lights(positions: np.ndarray, intensity: np.ndarray) -> np.ndarray:
    """Lights for points, (N,) of dtype `lightcull.LIGHT`.

    positions: float32 (N, 3), metres. intensity: float32 (N,), luminance, W/sr.
    """
    return _core.point_lights(positions, intensity)


def spot_lights(
    positions: np.ndarray,
    directions: np.ndarray,
    intensity: np.ndarray,
    inner: np.ndarray,
    outer: np.ndarray,
) -> np.ndarray:
    """Lights for spots, (N,) of dtype `lightcull.LIGHT`.

    positions: float32 (N, 3), metres. directions: float32 (N, 3), any length but 0. intensity:
    float32 (N,), luminance, W/sr, up to the angle `inner` from the direction; then it falls to
    nothing at `outer`. inner, outer: float32 (N,), radians, 0 <= inner <= outer <= pi.
    """
    return _core.spot_lights(positions, directions, intensity, inner, outer)


def directional_lights(directions: np.ndarray, irradiance: np.ndarray) -> np.ndarray:
    """Lights for suns, parallel light from infinity: (N,) of dtype `lightcull.LIGHT`.

    directions: float32 (N, 3), the way that the light goes, any length but 0. irradiance: float32
    (N,), luminance, W/m^2, on a surface that faces the light.
    """
    return _core.directional_lights(directions, irradiance)


def bounded_lights(
    box_min: np.ndarray,
    box_max: np.ndarray,
    axes: np.ndarray,
    cos_theta_o: np.ndarray,
    cos_theta_e: np.ndarray,
    power: np.ndarray,
    two_sided: bool = False,
) -> np.ndarray:
    """Lights of which only bounds are known, (N,) of dtype `lightcull.LIGHT`: for emitters of any
    kind.

    box_min, box_max: float32 (N, 3), metres. axes: float32 (N, 3), unit length. Normals are within
    theta_o of the axis, and light leaves within theta_e of them: float32 (N,), as cosines. power:
    float32 (N,), luminance, W. two_sided: they emit from the back too.
    """
    return _core.bounded_lights(
        box_min, box_max, axes, cos_theta_o, cos_theta_e, power, bool(two_sided)
    )


def check_description(description: str) -> None:
    """Throws `lightcull.Error` unless it describes a sampler, with what there is."""
    _core.check_sampler(checks.text("sampler", description))
