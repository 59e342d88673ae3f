"""What `lightcull info` says of cameras, and of a scene of Mitsuba's."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..camera import Camera
from ..file_settings import ANY_DEPTH

if TYPE_CHECKING:  # importing it wants Mitsuba, which is optional
    from ..mitsuba import MitsubaScene


def facts_of_mitsuba(scene: MitsubaScene) -> Iterator[tuple[str, str]]:
    """Names and values, one a line."""
    source, written = scene.scene, scene.integrator
    shapes = source.shapes()
    meshes = [shape for shape in shapes if shape.is_mesh()]
    others = Counter(shape.class_name() for shape in shapes if not shape.is_mesh())
    triangles = sum(shape.face_count() for shape in meshes)
    yield "scene", f"{scene.name}, rendered by Mitsuba ({scene.variant})"
    yield "shapes", f"{triangles:,} triangles in {len(meshes):,} meshes" + _counted(others)
    emitters = Counter(emitter.class_name() for emitter in source.emitters())
    yield "emitters", f"{scene.light_count:,}" + _counted(emitters)
    depth = written.max_depth
    yield (
        "integrator",
        f"{written.kind}, max_depth {depth if depth < ANY_DEPTH else 'without limit'}, "
        f"rr_depth {written.rr_depth}" + (", emitters hidden" if written.hide_emitters else ""),
    )
    yield "sampler", f"{scene.best_sampler}, unless told"
    bounds = scene.bounds
    if bounds is not None:
        yield "bounds", f"{vector(bounds[0])} to {vector(bounds[1])} m"
    sensors = source.sensors()
    if not sensors:
        yield "camera", "none"
    for number, sensor in enumerate(sensors):
        width, height = sensor.film().crop_size()
        yield f"camera {number}", f"{sensor.id()!r}, {sensor.class_name()}, {width}x{height}"


def _counted(counts: Counter[str]) -> str:
    return "".join(f", {count:,} {name}" for name, count in counts.items())


def camera_text(camera: Camera) -> str:
    """Where it is, where it looks, and what it sees."""
    height = f"{np.degrees(camera.vertical_fov):.0f} degrees high"
    if camera.orthographic_height > 0:
        height = f"orthographic, {camera.orthographic_height:.4g} m high"
    return f"at {vector(camera.origin)}, towards {vector(camera.target)}, {height}"


def vector(values: Sequence[float] | np.ndarray) -> str:
    """Numbers in brackets."""
    return "(" + ", ".join(f"{value:.4g}" for value in values) + ")"
