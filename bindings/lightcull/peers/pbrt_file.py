"""Scenes as files that pbrt-v4 reads."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .._core import Error
from ..camera import Camera
from ..images import write_exr
from .exported import Exported, Surface


def write_pbrt(folder: Path, scene: Exported, size: tuple[int, int], max_depth: int) -> Path:
    """Writes scene.pbrt, and what it names, into the folder; max_depth: longest path, in edges.

    Throws Error for what pbrt cannot show as we do: emission and environments that are textured.
    The fall-off of spots and glossy materials become pbrt's, which are a little different.
    """
    path = folder / "scene.pbrt"
    for index, texture in enumerate(scene.textures):
        write_exr(folder / f"texture{index}.exr", texture)
    for index in range(len(scene.surfaces)):
        _write_ply(folder / f"surface{index}.ply", scene, scene.surface == index)
    path.write_text("\n".join(_lines(scene, size, max_depth)) + "\n")
    return path


def _lines(scene: Exported, size: tuple[int, int], max_depth: int) -> Iterator[str]:
    width, height = size
    yield from _camera(scene.camera, width / height)
    yield (
        f'Film "rgb" "integer xresolution" [{width}] "integer yresolution" [{height}] '
        '"string sensor" "cie1931"'
    )
    yield 'PixelFilter "box" "float xradius" [0.5] "float yradius" [0.5]'
    yield 'Sampler "zsobol"'
    yield f'Integrator "path" "integer maxdepth" [{max_depth - 1}] "string lightsampler" "bvh"'
    yield "WorldBegin"
    yield from _lights(scene)
    for index in range(len(scene.textures)):
        yield (
            f'Texture "texture{index}" "spectrum" "imagemap" "string filename" '
            f'"texture{index}.exr" "string encoding" "linear" "string filter" "bilinear"'
        )
    for index, surface in enumerate(scene.surfaces):
        yield "AttributeBegin"
        yield _material(scene.materials[surface.material])
        yield from _emission(surface)
        yield f'Shape "plymesh" "string filename" "surface{index}.ply"'
        yield "AttributeEnd"


def _camera(camera: Camera, aspect: float) -> Iterator[str]:
    fov = camera.vertical_fov  # pbrt has that of the shorter side
    if aspect < 1:
        fov = 2 * math.atan(math.tan(fov / 2) * aspect)
    yield "Scale -1 1 1"  # pbrt's coordinates are left-handed
    yield f"LookAt {_numbers((*camera.origin, *camera.target, *camera.up))}"
    yield (
        f'Camera "perspective" "float fov" [{math.degrees(fov):.9g}] '
        f'"float lensradius" [{camera.aperture_radius:.9g}] '
        f'"float focaldistance" [{camera.focus_distance:.9g}]'
    )


def _lights(scene: Exported) -> Iterator[str]:
    for point in scene.points:
        yield f'LightSource "point" {_rgb("I", point["intensity"])} {_from(point["position"])}'
    for spot in scene.spots:
        outer, inner = math.degrees(spot["outer"]), math.degrees(spot["inner"])
        yield (
            f'LightSource "spot" {_rgb("I", spot["intensity"])} '
            f'{_from_to(spot["position"], spot["direction"])} '
            f'"float coneangle" [{outer:.9g}] "float conedeltaangle" [{outer - inner:.9g}]'
        )
    for sun in scene.directional_lights:
        ends = _from_to((0, 0, 0), sun["direction"])
        yield f'LightSource "distant" {_rgb("L", sun["irradiance"])} {ends}'
    if scene.environment is not None:
        texels = scene.environment["map"]
        if texels.shape[:2] != (1, 1):
            raise Error("pbrt: the environment is a map: only a constant one is exported")
        radiance = texels[0, 0] * np.float32(scene.environment["scale"])
        yield f'LightSource "infinite" {_rgb("L", radiance)}'


def _material(material: dict[str, Any]) -> str:
    color = material["base_color"]
    if material["base_color_texture"] is None:
        reflectance = _rgb("reflectance", color)
    elif min(color) < 1:
        raise Error("pbrt: a material multiplies a texture by a colour, which is not exported")
    else:
        reflectance = f'"texture reflectance" "texture{material["base_color_texture"]}"'
    if not material["metallic_roughness"]:
        return f'Material "diffuse" {reflectance}'
    kind = "conductor" if material["metallic"] > 0.5 else "coateddiffuse"
    alpha = max(material["roughness"] ** 2, 1e-3)
    return (
        f'Material "{kind}" {reflectance} "float roughness" [{alpha:.9g}] '
        '"bool remaproughness" false'
    )


def _emission(surface: Surface) -> Iterator[str]:
    if surface.radiance is None:
        return
    if surface.emission_texture is not None:
        raise Error("pbrt: a mesh emits by a texture, which is not exported")
    two_sided = "true" if surface.two_sided else "false"
    yield f'AreaLightSource "diffuse" {_rgb("L", surface.radiance)} "bool twosided" {two_sided}'


def _numbers(values: Sequence[float] | np.ndarray) -> str:
    return " ".join(f"{float(value):.9g}" for value in values)


def _rgb(name: str, color: Sequence[float] | np.ndarray) -> str:
    return f'"rgb {name}" [{_numbers(color)}]'


def _from(position: Sequence[float]) -> str:
    return f'"point3 from" [{_numbers(position)}]'


def _from_to(position: Sequence[float], direction: Sequence[float]) -> str:
    end = np.add(position, direction)
    return f'{_from(position)} "point3 to" [{_numbers(end)}]'


def _write_ply(path: Path, scene: Exported, chosen: np.ndarray) -> None:
    """The chosen triangles, in binary."""
    used, corners = np.unique(scene.indices[chosen].reshape(-1), return_inverse=True)
    smooth = bool(scene.smooth[chosen].all())
    columns = [scene.positions[used], scene.uvs[used]]
    names = ["x", "y", "z", "u", "v"]
    if smooth:
        columns.append(scene.normals[used])
        names += ["nx", "ny", "nz"]
    faces = np.empty(int(chosen.sum()), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"] = 3
    faces["corners"] = corners.reshape(-1, 3)
    header = [
        "ply", "format binary_little_endian 1.0", f"element vertex {len(used)}",
        *(f"property float {name}" for name in names),
        f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header",
    ]  # fmt: skip
    vertices = np.concatenate(columns, axis=1).astype("<f4")
    path.write_bytes("\n".join(header).encode() + b"\n" + vertices.tobytes() + faces.tobytes())
