"""Files of every format that are cut off or changed at random: each loads, or gives one line.

A few of each here; LIGHTCULL_BROKEN_FILES=500 tries as many as that.
"""

from __future__ import annotations

import base64
import json
import os
import resource
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import DracoPy
import meshopt
import numpy as np
import pytest
from PIL import Image

import lightcull
from gltf_file import GltfFile

COUNT = int(os.environ.get("LIGHTCULL_BROKEN_FILES", "20"))
MOST_BYTES = 1 << 30


def whole_gltf(path: Path) -> None:
    file = GltfFile()
    pixels = np.random.default_rng(1).integers(0, 256, (24, 24, 4), np.uint8)
    factors = {"baseColorTexture": file.texture(pixels), "roughnessFactor": 0.5}
    emission = {"emissiveFactor": [1, 1, 1], "emissiveTexture": factors["baseColorTexture"]}
    material = file.add(
        "materials", {"pbrMetallicRoughness": factors, "alphaMode": "MASK", **emission}
    )
    colors = file.accessor(np.uint8([[255, 128, 0, 255]] * 4), normalized=True)
    quad = file.quad(material, attributes={"COLOR_0": colors})
    file.node(mesh=quad, children=[file.add("nodes", {"mesh": quad, "scale": [2, 1, 1]})])
    places = file.accessor(np.float32([[0, 0, 0], [3, 0, 0]]))
    instancing = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}}
    file.node(mesh=quad, extensions=instancing)
    file.node(extensions=file.light(type="point"))
    file.camera(translation=[0, 0, 5])
    file.write(path)


def whole_draco(path: Path) -> None:
    file = GltfFile()
    grid = np.stack(np.meshgrid(np.arange(6), np.arange(6)), -1).reshape(-1, 2)
    points = np.pad(grid, ((0, 0), (0, 1))).astype(np.float32)
    first = np.concatenate([np.arange(6 * row, 6 * row + 5) for row in range(5)])
    faces = np.stack([first, first + 1, first + 7], axis=1).astype(np.uint32)
    data = DracoPy.encode(points, faces)
    extension = {"bufferView": file.view(data), "attributes": {"POSITION": 0}}
    quad = file.quad(extensions={"KHR_draco_mesh_compression": extension})
    file.node(mesh=quad)
    file.write(path)


def whole_meshopt(path: Path) -> None:
    file = GltfFile()
    corners = np.random.default_rng(2).random((300, 3), np.float32)
    positions = file.accessor(corners)
    view = file.document["bufferViews"][file.document["accessors"][positions]["bufferView"]]
    encoded = meshopt.encode_gltf_buffer(corners, "ATTRIBUTES")
    compressed = file.document["bufferViews"][file.view(encoded)]
    extension = {**compressed, "byteLength": len(encoded), "byteStride": 12, "count": 300, "mode": "ATTRIBUTES"}
    view["extensions"] = {"EXT_meshopt_compression": extension}
    primitive = {"attributes": {"POSITION": positions}}
    file.node(mesh=file.add("meshes", {"primitives": [primitive]}))
    file.write(path)


def whole_obj(path: Path) -> None:
    Image.new("RGBA", (8, 8), (255, 0, 0, 128)).save(path.parent / "a.png")
    (path.parent / "a.mtl").write_text("newmtl a\nKd 1 1 1\nmap_Kd -s 1 1 a.png\nmap_d a.png\nKe 1 1 1\n")
    corners = "".join(f"v {x} {y} {x * y} 1 0.5 0.25\nvt {x} {y}\n" for x in range(4) for y in range(4))
    faces = "".join(f"f {i}/{i}/1 {i + 1}/{i + 1}/1 {i + 5}/{i + 5}/-1 -1/-2/1\n" for i in range(1, 8))
    path.write_text(f"mtllib a.mtl\n{corners}vn 0 0 1\nusemtl a\ng b\ns 1\n{faces}f 1 2 3 4 8 7 6\n")


def whole_ply(path: Path, form: str) -> None:
    header = f"ply\nformat {form} 1.0\nelement vertex 12\n"
    header += "".join(f"property float {name}\n" for name in ("x", "y", "z", "s", "t"))
    header += "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    header += "element face 6\nproperty list uchar int vertex_indices\nend_header\n"
    dtype = np.dtype([("floats", "<f4", 5), ("bytes", "u1", 3)])
    points = np.zeros(12, dtype)
    points["floats"] = np.random.default_rng(3).random((12, 5))
    faces = [(0, 1, 2), (3, 4, 5, 6), (7, 8, 9), (1, 2, 3), (4, 5, 6, 7, 8), (9, 10, 11)]
    if form == "ascii":
        rows = [" ".join(map(str, (*p["floats"], *p["bytes"]))) for p in points]
        rows += [" ".join(map(str, (len(face), *face))) for face in faces]
        path.write_text(header + "\n".join(rows) + "\n")
        return
    data = b"".join(bytes([len(f)]) + np.array(f, "<i4").tobytes() for f in faces)
    path.write_bytes(header.encode() + points.tobytes() + data)


USD = """#usda 1.0
(
    upAxis = "Z"
)
def Mesh "m" (prepend apiSchemas = ["MaterialBindingAPI"]) {
    point3f[] points = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
    normal3f[] normals = [(0, 0, 1), (0, 0, 1), (0, 0, 1), (0, 0, 1)]
    int[] faceVertexCounts = [3, 3]
    int[] faceVertexIndices = [0, 1, 2, 0, 2, 3]
    texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (interpolation = "vertex")
    rel material:binding = </red>
    def GeomSubset "part" {
        int[] indices = [1]
    }
}
def PointInstancer "many" {
    int[] protoIndices = [0, 0]
    point3f[] positions = [(0, 0, 0), (5, 0, 0)]
    rel prototypes = [</m>]
}
def Material "red" {
    token outputs:surface.connect = </red/s.outputs:surface>
    def Shader "s" {
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:emissiveColor = (3, 0, 0)
        float inputs:opacity = 0.5
        token outputs:surface
    }
}
def SphereLight "l" {
    float inputs:intensity = 5
}
def DomeLight "d" {
    float inputs:intensity = 5
}
def Camera "c" {
    float focalLength = 50
}
"""


def whole_usd(path: Path) -> None:
    from pxr import Sdf

    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.ImportFromString(USD)
    layer.Export(str(path))  # as text, or as USD's binary form


FORMATS: dict[str, tuple[str, Callable[[Path], None]]] = {
    "glb": ("glb", whole_gltf),
    "gltf": ("gltf", whole_gltf),
    "draco": ("glb", whole_draco),
    "meshopt": ("glb", whole_meshopt),
    "obj": ("obj", whole_obj),
    "ply": ("ply", lambda path: whole_ply(path, "binary_little_endian")),
    "ascii ply": ("ply", lambda path: whole_ply(path, "ascii")),
    "usda": ("usda", whole_usd),
    "usdc": ("usdc", whole_usd),
}


def broken(whole: bytes, random: np.random.Generator) -> bytes:
    """Cut off, or with some bytes changed, or with a piece taken out or put in twice."""
    data = bytearray(whole)
    kind = random.integers(4)
    place = int(random.integers(len(data)))
    length = int(random.integers(1, 40))
    if kind == 0:
        return bytes(data[:place])
    if kind == 1:
        for at in random.integers(len(data), size=int(random.integers(1, 9))):
            data[at] = random.integers(256)
    elif kind == 2:
        del data[place : place + length]
    else:
        data[place:place] = data[place : place + length]
    # Digits become others, too: counts, offsets and indices.
    if random.random() < 0.5:
        digits = [i for i, byte in enumerate(data) if 48 <= byte <= 57]
        for i in random.choice(digits, size=min(3, len(digits))):
            data[i] = 48 + random.integers(10)
    return bytes(data)


@pytest.mark.parametrize("name", FORMATS)
def test_broken_files_give_one_line(
    tmp_path: Path, name: str, capfd: pytest.CaptureFixture[str]
) -> None:
    ending, write = FORMATS[name]
    if ending.startswith("usd"):
        pytest.importorskip("pxr")
    whole_path, path = tmp_path / f"whole.{ending}", tmp_path / f"broken.{ending}"
    write(whole_path)
    whole = whole_path.read_bytes()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", lightcull.UnsupportedWarning)
        lightcull.load(whole_path)
    random = np.random.default_rng(sorted(FORMATS).index(name))
    loaded, slowest = 0, 0.0
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(COUNT):
        data = broken(whole, random)
        path.write_bytes(data)
        start = time.process_time()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.simplefilter("ignore", lightcull.UnsupportedWarning)
            try:
                lightcull.load(path)
                loaded += 1
            except lightcull.Error as error:
                assert len(str(error).splitlines()) == 1
                assert str(error).startswith(f"{path}: ")
        slowest = max(slowest, time.process_time() - start)
    print(f"{name}: {loaded} of {COUNT} loaded, the slowest took {slowest:.2f} s")
    output = capfd.readouterr()
    if ending == "usdc":
        return  # usd-core itself takes memory and time for what they promise, and prints of some
    assert output.err == ""
    assert 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) < MOST_BYTES
    if COUNT > 100:  # where somebody looks
        assert slowest < 3.0, output.out


def test_small_files_promise_no_memory(tmp_path: Path) -> None:
    """Counts of millions of millions in a few bytes."""
    data = base64.b64encode(bytes(64)).decode()
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": 64, "uri": f"data:application/octet-stream;base64,{data}"}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    }
    compressed = {"buffer": 0, "byteLength": 64, "byteStride": 12, "count": 10**12, "mode": "ATTRIBUTES"}
    accessor = {"componentType": 5126, "count": 10**12, "type": "VEC3"}
    view = {"buffer": 0, "byteLength": 64, "extensions": {"EXT_meshopt_compression": compressed}}
    for more in (
        {"accessors": [accessor]},
        {"accessors": [{**accessor, "bufferView": 0}], "bufferViews": [view]},
    ):
        (tmp_path / "a.gltf").write_text(json.dumps({**document, **more}))
        with pytest.raises(lightcull.Error, match="promises 12000000000000 bytes"):
            lightcull.load(tmp_path / "a.gltf")
