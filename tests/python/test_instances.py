"""What stands in many places is kept once."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lightcull
from gltf_file import GltfFile
from picture_files import sphere
from test_usd_files import write

COUNT = 12
VIEW = lightcull.Camera((0.0, 9.0, 14.0), (0.0, 0.0, 0.0))


def turned(number: int) -> tuple[list[float], list[float], list[float]]:
    """Translation, rotation and scale of an instance, some of them mirrored."""
    x, z = divmod(number, 4)
    mirrored = -1.0 if number % 3 == 0 else 1.0
    return (
        [3.0 * x - 3.0, 0.0, 2.5 * z - 4.0],
        [0.0, float(np.sin(0.4 * number)), 0.0, float(np.cos(0.4 * number))],
        [mirrored, 0.5 + 0.1 * z, 1.2],
    )


def ball(file: GltfFile, **material: Any) -> int:
    positions, uvs, triangles = sphere(24)
    attributes = {
        "POSITION": file.accessor(np.float32(positions)),
        "NORMAL": file.accessor(np.float32(positions)),
        "TEXCOORD_0": file.accessor(np.float32(uvs)),
    }
    pixels = np.zeros((8, 16, 3), np.uint8) + 60
    pixels[:, 8:] = 200
    model = {"baseColorTexture": file.texture(pixels), "metallicFactor": 0.0}
    primitive = {
        "attributes": attributes,
        "indices": file.accessor(np.uint32(triangles.ravel())),
        "material": file.add("materials", {"pbrMetallicRoughness": model, **material}),
    }
    return file.add("meshes", {"primitives": [primitive]})


def by_nodes(file: GltfFile, mesh: int) -> None:
    for number in range(COUNT):
        t, r, s = turned(number)
        file.node(mesh=mesh, translation=t, rotation=r, scale=s)


def by_extension(file: GltfFile, mesh: int) -> None:
    t, r, s = (file.accessor(np.float32(v)) for v in zip(*map(turned, range(COUNT)), strict=True))
    attributes = {"TRANSLATION": t, "ROTATION": r, "SCALE": s}
    extension = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    file.node(mesh=mesh, extensions=extension)


def loaded(path: Path) -> lightcull.Scene:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return lightcull.load(path, environment=(1, 1, 1), camera=VIEW)


def picture(scene: lightcull.Scene) -> np.ndarray:
    return lightcull.render(scene, spp=64, size=(32, 24), max_depth=3, seed=1).image


@pytest.mark.parametrize("place", [by_nodes, by_extension])
def test_of_gltf(tmp_path: Path, place: Callable[[GltfFile, int], None]) -> None:
    file = GltfFile()
    place(file, ball(file))
    scene = loaded(file.write(tmp_path / "a.glb"))
    apart = GltfFile()
    for number in range(COUNT):
        t, r, s = turned(number)
        apart.node(mesh=ball(apart), translation=t, rotation=r, scale=s)
    copies = loaded(apart.write(tmp_path / "b.glb"))
    assert (scene.counts["meshes"], scene.counts["instances"]) == (1, COUNT)
    assert (copies.counts["meshes"], copies.counts["instances"]) == (COUNT, 0)
    assert scene.triangle_count == copies.triangle_count
    np.testing.assert_allclose(scene.bounds, copies.bounds, atol=0.5)
    assert scene.closed().memory_size().data < copies.closed().memory_size().data / 3
    # Some 5 standard errors of a pixel.
    np.testing.assert_allclose(picture(scene), picture(copies), atol=0.06)


def test_what_emits_is_a_light_in_each_place(tmp_path: Path) -> None:
    file = GltfFile()
    mesh = ball(file, emissiveFactor=[1, 1, 1])
    by_nodes(file, mesh)
    scene = loaded(file.write(tmp_path / "a.glb"))
    assert scene.counts["instances"] == 0
    assert len(scene.lights()) >= scene.triangle_count > 0


def test_of_usd(tmp_path: Path) -> None:
    pytest.importorskip("pxr")
    positions, _, triangles = sphere(12)
    mesh = f"""
        point3f[] points = [{", ".join(str(tuple(map(float, p))) for p in positions)}]
        int[] faceVertexCounts = {[3] * len(triangles)}
        int[] faceVertexIndices = {triangles.ravel().tolist()}
        uniform token subdivisionScheme = "none"
    """
    instancer = f"""
    def PointInstancer "many" {{
        rel prototypes = </many/ball>
        int[] protoIndices = {[0] * COUNT}
        point3f[] positions = [{", ".join(str(tuple(turned(i)[0])) for i in range(COUNT))}]
        def Mesh "ball" {{
            {mesh}
        }}
    }}
    class Xform "model" {{
        def Mesh "ball" {{
            {mesh}
        }}
    }}
    """
    references = "".join(
        f"""
    def Xform "copy{i}" (
        instanceable = true
        prepend inherits = </model>
    ) {{
        double3 xformOp:translate = ({3 * i}, 5, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"]
        color3f[] primvars:displayColor = [({color}, 0.2, 0.2)]
    }}"""
        for i, color in enumerate((0.2, 0.2, 0.9))
    )
    scene = loaded(write(tmp_path, instancer, references))
    # A ball that has another colour is another mesh.
    assert (scene.counts["meshes"], scene.counts["instances"]) == (3, COUNT + 3)
    assert scene.triangle_count == (COUNT + 3) * len(triangles)


def test_in_python() -> None:
    positions, _, triangles = sphere(8)
    scene = lightcull.Scene(recorded=True)
    mesh = scene.add_shared_mesh(positions, triangles, normals=positions)
    for x in (-2.0, 2.0):
        scene.add_instance(mesh, np.array([[1, 0, 0, x], [0, 2, 0, 0], [0, 0, 1, 0]]))
    np.testing.assert_allclose(scene.bounds, [[-3, -2, -1], [3, 2, 1]], atol=1e-6)
    assert scene.counts["instances"] == 2
    with pytest.raises(lightcull.Error, match="makes the mesh flat"):
        scene.add_instance(mesh, np.zeros((4, 4)))
    with pytest.raises(TypeError, match="transform: wanted"):
        scene.add_instance(mesh, np.eye(3))
    with pytest.raises(lightcull.Error, match="is shared: instances of it stay"):
        scene.set_mesh_positions(mesh, positions)
    again = lightcull.Scene()
    from lightcull.scene_record import replay

    assert scene.record is not None
    replay(scene.record.to_bytes(), again)
    assert again.digest() == scene.digest()
    for each in (scene, again):
        each.set_environment((1, 1, 1))
        each.set_camera((0, 2, 9), (0, 0, 0))
    np.testing.assert_array_equal(picture(scene), picture(again))
