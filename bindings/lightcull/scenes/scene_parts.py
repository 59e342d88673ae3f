"""Shapes, materials and skies into scenes."""

from __future__ import annotations

import numpy as np

from ..scene import Scene
from .geometry import Shape


def add(scene: Scene, name: str, shape: Shape, material: int) -> None:
    """Adds a shape that does not emit."""
    scene.add_mesh(
        _floats(shape.positions),
        shape.indices,
        normals=None if shape.normals is None else _floats(shape.normals),
        uvs=None if shape.uvs is None else _floats(shape.uvs),
        material=material,
        name=name,
    )


def add_lights(
    scene: Scene,
    name: str,
    shape: Shape,
    radiance: np.ndarray,
    *,
    two_sided: bool = False,
    texture: np.ndarray | None = None,
) -> None:
    """Adds a shape each of whose triangles is a light.

    radiance: (3,), or (M, 3) for M triangles; texture: (H, W, 3) that multiplies it by the shape's
    uvs, or none.
    """
    scene.add_light_mesh(
        _floats(shape.positions),
        shape.indices,
        radiance=_floats(radiance) if radiance.ndim == 2 else tuple(map(float, radiance)),
        two_sided=two_sided,
        texture=None if texture is None else scene.add_texture(_floats(texture)),
        uvs=None if texture is None else _floats(shape.uvs),
        name=name,
    )


def diffuse(scene: Scene, base_color: np.ndarray, texture: np.ndarray | None = None) -> int:
    """A diffuse material; texture: (H, W, 3), or none."""
    texture_id = None if texture is None else scene.add_texture(_floats(texture))
    return scene.add_material(
        kind="diffuse", base_color=tuple(map(float, base_color)), base_color_texture=texture_id
    )


def glossy(
    scene: Scene, base_color: np.ndarray, roughness: float, metallic: float = 0.0,
    texture: np.ndarray | None = None,
) -> int:  # fmt: skip
    """A metallic-roughness material; texture: (H, W, 3) that multiplies the colour, or none."""
    texture_id = None if texture is None else scene.add_texture(_floats(texture))
    return scene.add_material(
        kind="metallic_roughness",
        base_color=tuple(map(float, base_color)),
        metallic=metallic,
        roughness=roughness,
        base_color_texture=texture_id,
    )


def sky(scene: Scene, zenith: np.ndarray, horizon: np.ndarray, ground: np.ndarray) -> None:
    """Surrounds the scene by a sky that runs from the horizon to the zenith, over dark ground."""
    rows = 64
    height = np.cos(np.pi * (np.arange(rows) + 0.5) / rows)[:, None]
    above = horizon + (zenith - horizon) * np.clip(height, 0, 1) ** 0.4
    column = np.where(height > 0, above, ground)
    scene.set_environment(_floats(np.repeat(column[:, None], 2 * rows, axis=1)))


def _floats(values: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(values, dtype=np.float32)
