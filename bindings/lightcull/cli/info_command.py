"""lightcull info."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from .. import _core, memory
from .._core import Error
from ..rendering.memory_need import MemoryNeed, memory_need
from ..rendering.method import PATH
from ..rendering.path_job import PathJob
from ..rendering.settings import RenderSettings
from ..rendering.subject import OwnSubject
from ..rendering.virtual_light_job import VirtualLightJob
from ..scene import Scene
from .mitsuba_facts import camera_text, facts_of_mitsuba, vector
from .options import InfoOptions


def run(options: InfoOptions, messages: Console) -> bool:
    """Prints what is in a scene, what memory a render of it takes, and the devices there are."""
    scene, settings, by_paths = options.scene, options.settings, options.method == PATH
    if not isinstance(scene, Scene):
        _print(facts_of_mitsuba(scene))
        return True
    sampler = options.sampler or OwnSubject(scene).best_sampler
    # Before anything else takes memory that a render does not.
    job = (
        PathJob(scene, sampler, settings)
        if by_paths
        else VirtualLightJob(scene, options.method, sampler, settings)
    )
    need = memory_need(job, settings.size)
    ways = sampler if by_paths else f"{sampler} and {options.method}"
    memory_fact = ("memory", _memory(need, ways, settings))
    _print((*_facts(scene), memory_fact, *_devices()))
    return True


def _print(facts: Iterable[tuple[str, str]]) -> None:
    table = Table(show_header=False, box=None)
    for name, value in facts:
        table.add_row(name, Text(value))
    Console(highlight=False).print(table)


def _devices() -> Iterator[tuple[str, str]]:
    """What selections can run on."""
    yield "device", f"cpu: {_core.instruction_set()}"
    try:
        devices = _core.vulkan_devices()
    except Error as error:
        yield "no device", str(error)
        return
    for name, problem in devices:
        what = ": ".join(filter(None, ("vulkan", name, problem)))
        yield "no device" if problem else "device", what


def _memory(need: MemoryNeed, ways: str, settings: RenderSettings) -> str:
    width, height = settings.size
    parts = {
        "program": need.program,
        "scene": need.scene,
        "Embree's tree": need.bvh,
        "sampler": need.sampler,
        "image": need.image,
        "paths": need.paths,
    }
    if need.learned:
        parts["what is learned at most"] = need.learned
    if need.virtual_lights:
        parts["virtual lights"] = need.virtual_lights
    return (
        f"{memory.text(need.peak)} at most to render {width}x{height} by {ways}: "
        + ", ".join(f"{name} {memory.text(size)}" for name, size in parts.items())
        + f"; {memory.text(need.setup)} while it is set up"
    )


def _facts(scene: Scene) -> Iterator[tuple[str, str]]:
    lights, counts, bounds = scene.lights(), scene.counts, scene.bounds
    emitters = scene.closed().emitter_count()
    further = len(lights) - emitters
    rarer = {kind: counts[kind] for kind in ("directional lights", "virtual lights")}
    triangles = emitters - counts["points"] - counts["spots"] - sum(rarer.values())
    yield "scene", scene.name
    instances = f", {counts['instances']:,} instances" if counts["instances"] else ""
    yield "triangles", f"{scene.triangle_count:,} in {counts['meshes']:,} meshes" + instances
    yield "materials", f"{counts['materials']:,}, textures {counts['textures']:,}"
    yield (
        "lights",
        f"{len(lights):,}: {triangles:,} triangles, {counts['points']:,} points, "
        f"{counts['spots']:,} spots"
        + "".join(f", {count:,} {kind}" for kind, count in rarer.items() if count)
        + (f"; {further:,} further parts of triangles" if further else ""),
    )
    for name, unit, of in (
        ("intensity", "W/sr", ~lights["directional"]),
        ("irradiance", "W/m^2 of directional lights", lights["directional"]),
    ):
        strong = lights["intensity"][of & (lights["intensity"] > 0)]
        if len(strong):
            low, middle, high = np.quantile(strong, (0, 0.5, 1))
            yield name, f"{low:.3g} to {high:.3g} {unit}, median {middle:.3g}"
    yield "environment", "yes" if scene.has_environment else "no"
    if bounds is not None:
        yield "bounds", f"{vector(bounds[0])} to {vector(bounds[1])} m"
    yield "camera", camera_text(scene.camera)
    for number, camera in enumerate(scene.cameras):
        yield f"camera {number}", f"{camera.name!r}, {camera_text(camera)}"
