"""Normal maps of files: a map of one normal shades as a surface that is turned by as much."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import lightcull
from gltf_file import GltfFile
from test_loaders import look, warning_of
from test_obj_ply_files import obj
from test_usd_files import SQUARE, TEXTURE, material, write

TEXEL = np.uint8([185, 150, 220])
"""To the right and, less, up."""
SUN = np.array([0.6, -0.2, 0.7])
"""From where it shines on a square that faces +Z."""


def normal(scale: float = 1.0) -> np.ndarray:
    """What the texel says."""
    n = (2.0 * TEXEL / 255.0 - 1.0) * (scale, scale, 1)
    return n / np.linalg.norm(n)


def image(path: Path) -> Path:
    Image.fromarray(np.tile(TEXEL, (4, 4, 1))).save(path)
    return path


def in_the_sun(scene: lightcull.Scene) -> np.ndarray:
    """The middle of a square about the origin, seen from +Z."""
    scene.add_directional_light(-SUN, (1, 1, 1))
    scene.set_camera((0, 0, 2), (0, 0, 0), vertical_fov=0.1)
    return look(scene, max_depth=2)[8, 8]


def loaded(path: Path, **options: Any) -> lightcull.Scene:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", lightcull.UnsupportedWarning)
        return lightcull.load(path, environment="none", **options)


def gltf(folder: Path, material: dict[str, Any], turned: np.ndarray, uvs: np.ndarray) -> np.ndarray:
    """A square whose normal is turned from +Z, of a material that is a little glossy."""
    file = GltfFile()
    look = {"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.6}}
    if "normalTexture" in material:
        texture = file.texture(np.tile(TEXEL, (4, 4, 1)))
        material = {"normalTexture": {**texture, **material["normalTexture"]}}
    axis = np.cross([0, 0, 1], turned)
    quaternion = np.append(axis, 1 + turned[2])
    attributes = {"TEXCOORD_0": file.accessor(np.float32(uvs))}
    quad = file.quad(file.add("materials", look | material), attributes=attributes)
    file.node(mesh=quad, rotation=list(quaternion / np.linalg.norm(quaternion)))
    file.camera(translation=[0, 0, 2])
    path = file.write(folder / "a.glb")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scene = lightcull.load(path, environment="none")
    return in_the_sun(scene)


@pytest.mark.parametrize("scale", [None, 0.5])
@pytest.mark.parametrize("mirrored", [False, True])
def test_gltf(tmp_path: Path, scale: float | None, mirrored: bool) -> None:
    uvs = np.array([[0, 1], [1, 1], [1, 0], [0, 0]])  # downwards
    expected_normal = normal(1.0 if scale is None else scale)
    if mirrored:
        uvs[:, 0] = 1 - uvs[:, 0]
        expected_normal[0] *= -1
    slot = {} if scale is None else {"scale": scale}
    mapped = gltf(tmp_path, {"normalTexture": slot}, np.array([0, 0, 1.0]), uvs)
    turned = gltf(tmp_path, {}, expected_normal, uvs)
    np.testing.assert_allclose(mapped, turned, rtol=2e-3)
    assert not np.allclose(mapped, gltf(tmp_path, {}, np.array([0, 0, 1.0]), uvs), rtol=0.05)


def test_mtl(tmp_path: Path) -> None:
    image(tmp_path / "relief.png")
    path = obj(tmp_path, "newmtl a\nKd 0.8 0.8 0.8\nnorm relief.png\n")
    towards = SUN / np.linalg.norm(SUN)
    np.testing.assert_allclose(
        in_the_sun(loaded(path)), 0.8 / np.pi * (normal() @ towards), rtol=2e-3
    )
    bumps = obj(tmp_path, "newmtl a\nmap_Bump relief.png\n")
    assert "map_bump of materials" in warning_of(bumps)


@pytest.mark.parametrize("strength", [1.0, 0.5])
def test_usd(tmp_path: Path, strength: float) -> None:
    def usd(numbers: str, connected: str) -> Path:
        texture = TEXTURE.format(file="relief.png", name="m").replace(
            "float3 outputs:rgb", f"{numbers}\nfloat3 outputs:rgb"
        )
        inputs = f"color3f inputs:diffuseColor = (0, 0, 0)\nfloat inputs:roughness = 0.6\n{connected}"
        values = (
            "rel material:binding = </m>\n"
            "texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] "
            '(interpolation = "vertex")'
        )
        return write(tmp_path, SQUARE.format(values=values), material("m", inputs, texture))

    pytest.importorskip("pxr")
    image(tmp_path / "relief.png")
    connection = "normal3f inputs:normal.connect = </m/image.outputs:rgb>"
    s = strength
    numbers = f"float4 inputs:scale = ({2 * s}, {2 * s}, 2, 1)\nfloat4 inputs:bias = (-{s}, -{s}, -1, 0)"
    path = usd(numbers, connection)
    # What is black has the highlight alone, which is that of a plane that is turned as much.
    mapped = in_the_sun(loaded(path))
    scene = lightcull.Scene()
    black = scene.add_material("metallic_roughness", base_color=(0, 0, 0), roughness=0.6)
    n = normal(strength)
    across = np.cross([0, 1, 0], n) / np.linalg.norm(np.cross([0, 1, 0], n))
    up = np.cross(n, across)
    corners = np.array([-across - up, across - up, across + up, up - across])
    scene.add_mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]), material=black)
    np.testing.assert_allclose(mapped, in_the_sun(scene), rtol=5e-3)
    assert "normal maps without a scale of 2" in warning_of(usd("", connection))
