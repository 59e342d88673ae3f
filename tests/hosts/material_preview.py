"""A scene of Mitsuba's of the kind that materials are shown in, made up here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

import lightcull


def checks(path: Path, dark: int, bright: int, squares: int = 8) -> None:
    """A chessboard as an image."""
    which = np.indices((16 * squares, 16 * squares)) // 16 % 2
    Image.fromarray(np.where(which[0] == which[1], dark, bright).astype(np.uint8)).save(path)


def dimples(path: Path, waves: int = 12, depth: float = 0.25) -> None:
    """A normal map of bumps in rows."""
    at = np.linspace(0, 2 * np.pi * waves, 512, endpoint=False)
    u, v = np.meshgrid(at, at[::-1])
    normal = np.stack([-depth * np.cos(u) * np.sin(v), -depth * np.sin(u) * np.cos(v), np.ones_like(u)], 2)
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    Image.fromarray(np.uint8(np.round(127.5 * (normal + 1)))).save(path)


def write_material_preview(folder: Path, material: str) -> Path:
    """A ball on a stand before a chessboard that bends up to a wall, in a sky with a window: a scene of
    Mitsuba's. material: of the ball.
    """
    checks(folder / "checks.png", 60, 200, 16)
    dimples(folder / "dimples.png")
    sky = np.ones((128, 256, 3), np.float32) * np.linspace(0.9, 0.2, 128, dtype=np.float32)[:, None, None]
    sky[24:56, 32:64] = (14, 12, 10)
    lightcull.write_exr(folder / "sky.exr", sky)
    _write_backdrop(folder / "backdrop.obj")
    path = folder / "preview.xml"
    path.write_text(f"""<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="6"/></integrator>
<sensor type="perspective">
  <float name="fov" value="30"/><string name="fov_axis" value="y"/>
  <transform name="to_world"><lookat origin="0, 2.6, 7" target="0, 0.9, 0" up="0, 1, 0"/></transform>
  <film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="48"/></film>
</sensor>
<emitter type="envmap"><string name="filename" value="sky.exr"/></emitter>
<shape type="obj"><string name="filename" value="backdrop.obj"/>
  <bsdf type="twosided"><bsdf type="diffuse"><texture name="reflectance" type="bitmap">
    <string name="filename" value="checks.png"/>
  </texture></bsdf></bsdf>
</shape>
<shape type="sphere"><point name="center" x="0" y="1.1" z="0"/><float name="radius" value="1"/>{material}</shape>
<shape type="cylinder"><point name="p0" x="0" y="0" z="0"/><point name="p1" x="0" y="0.2" z="0"/>
  <float name="radius" value="0.7"/>
  <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.3"/></bsdf></bsdf>
</shape>
</scene>""")
    return path


def _write_backdrop(path: Path) -> None:
    """A floor that bends up to a wall behind, with its normals."""
    bend = np.linspace(0, np.pi / 2, 9)
    profile = [(6.0, 0.0, 0.0)] + [(-3 - 2 * np.sin(a), 2 - 2 * np.cos(a), a) for a in bend] + [(-5.0, 8.0, np.pi / 2)]
    lengths = np.cumsum([0, *(np.hypot(b[0] - a[0], b[1] - a[1]) for a, b in zip(profile, profile[1:], strict=False))])
    lines = []
    for (z, y, a), length in zip(profile, lengths, strict=True):
        for x in (-8, 8):
            lines.append(f"v {x} {y:.5f} {z:.5f}\nvn 0 {np.cos(a):.5f} {np.sin(a):.5f}\nvt {(x + 8) / 16:.5f} {length / 16:.5f}")
    for i in range(1, 2 * len(profile) - 2, 2):
        lines.append("f " + " ".join(f"{k}/{k}/{k}" for k in (i, i + 1, i + 3, i + 2)))
    path.write_text("\n".join(lines) + "\n")
