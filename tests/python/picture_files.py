"""An OBJ file of the kind that characters come as, made up here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image


def sphere(rows: int = 24) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions, which are its normals, texture coordinates and triangles of a unit sphere."""
    columns = 2 * rows
    v, u = np.meshgrid(np.linspace(0, 1, rows + 1), np.linspace(0, 1, columns + 1), indexing="ij")
    theta, phi = np.pi * (1 - v), 2 * np.pi * u
    points = np.stack(
        [np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)], axis=2
    )
    corner = np.arange((rows + 1) * (columns + 1)).reshape(rows + 1, columns + 1)
    a, b, c, d = corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1]
    triangles = np.concatenate([np.stack([a, b, c], 2), np.stack([a, c, d], 2)]).reshape(-1, 3)
    return points.reshape(-1, 3), np.stack([u, v], 2).reshape(-1, 2), triangles


def ridges(path: Path, count: int = 24) -> None:
    """A normal map of ridges from bottom to top."""
    slope = np.cos(np.linspace(0, 2 * np.pi * count, 512, endpoint=False))
    normal = np.stack([-slope, 0 * slope, np.ones_like(slope)], axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    row = np.uint8(np.round(127.5 * (normal + 1)))
    Image.fromarray(np.tile(row, (8, 1, 1))).save(path)


class ObjText:
    """The text of an OBJ file, of which each part has its material."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self._count = 0

    def add_sphere(
        self, name: str, material: str, center: np.ndarray, axes: np.ndarray, rows: int = 10
    ) -> None:
        """An ellipsoid; axes: its three half axes as columns."""
        points, uvs, triangles = sphere(rows)
        normals = points @ np.linalg.inv(axes)
        self.lines += [f"o {name}", f"usemtl {material}", "s 1"]
        for kind, values in (("v", points @ axes.T + center), ("vt", uvs), ("vn", normals)):
            self.lines += [f"{kind} " + " ".join(f"{x:.5f}" for x in row) for row in values]
        for corners in triangles + 1 + self._count:
            self.lines.append("f " + " ".join(f"{i}/{i}/{i}" for i in corners))
        self._count += len(points)


def along(start: np.ndarray, end: np.ndarray, thickness: float) -> tuple[np.ndarray, np.ndarray]:
    """The middle and the half axes of an ellipsoid between two points."""
    way = (end - start) / 2
    aside = np.cross(way, (0.3, 0.9, 0.31))
    aside *= thickness / np.linalg.norm(aside)
    third = np.cross(way, aside)
    return (start + end) / 2, np.stack([aside, way, third * thickness / np.linalg.norm(third)], axis=1)


def write_spider(folder: Path) -> Path:
    """Eight legs of three parts each, a body, a head with eyes that glow, and a floor: 31 parts of seven
    materials, most of them with images in a folder, named in the way of Windows.
    """
    (folder / "tex").mkdir()
    stripes = np.zeros((64, 64, 3), np.uint8)
    stripes[:] = (120, 60, 20)
    stripes[::16] = stripes[1::16] = stripes[2::16] = (30, 15, 10)
    Image.fromarray(stripes).save(folder / "tex" / "legs.png")
    squares = np.indices((192, 192)) // 16 % 2
    Image.fromarray(np.where(squares[0] == squares[1], 90, 210).astype(np.uint8)).save(
        folder / "tex" / "floor.png"
    )
    ridges(folder / "tex" / "skin.png")
    text = ObjText()
    text.add_sphere("abdomen", "skin", np.array([0, 1.1, -1.2]), np.diag([0.8, 0.7, 1.0]), 20)
    text.add_sphere("head", "head", np.array([0, 0.95, 0.1]), np.diag([0.5, 0.4, 0.5]), 16)
    for i, x in enumerate((-0.24, -0.08, 0.08, 0.24)):
        text.add_sphere(f"eye{i}", "eye", np.array([x, 1.15, 0.46]), 0.07 * np.eye(3), 8)
    for side in (-1, 1):
        for number in range(4):
            angle = np.radians(-50 + 33 * number)
            out = np.array([side * np.cos(angle), 0, -np.sin(angle)])
            joints = [
                np.array([0, 0.9, 0]) + 0.4 * out,
                np.array([0, 1.7, 0]) + 1.2 * out,
                np.array([0, 0.9, 0]) + 2.0 * out,
                np.array([0, 0.02, 0]) + 2.4 * out,
            ]
            for part, (start, end) in enumerate(zip(joints, joints[1:], strict=False)):
                name = f"leg{side}{number}{part}"
                text.add_sphere(name, f"leg{part}", *along(start, end, 0.11 - 0.02 * part))
    text.lines += ["o floor", "usemtl floor"]
    text.lines += [f"v {x} 0 {z}" for x, z in ((-6, 6), (6, 6), (6, -6), (-6, -6))]
    text.lines += ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", "f -4/-4 -3/-3 -2/-2 -1/-1"]
    (folder / "spider.obj").write_text("mtllib spider.mtl\n" + "\n".join(text.lines) + "\n")
    (folder / "spider.mtl").write_text(
        "newmtl skin\nKd 0.35 0.2 0.12\nnorm tex\\skin.png\n"
        "newmtl head\nKd 0.25 0.14 0.08\n"
        "newmtl eye\nKd 0 0 0\nKe 3 0.4 0.1\n"
        "newmtl leg0\nmap_Kd -s 1 3 1 tex\\legs.png\n"
        "newmtl leg1\nmap_Kd tex\\legs.png\n"
        "newmtl leg2\nKd 0.7 0.7 0.7\nmap_Kd tex/legs.png\n"
        "newmtl floor\nmap_Kd tex\\floor.png\n"
    )
    return folder / "spider.obj"
