"""What glTF files of other programs have beyond the core of glTF 2.0."""

from __future__ import annotations

import json
import warnings
from pathlib import Path

import DracoPy
import meshopt
import numpy as np
import pytest
from PIL import Image

import lightcull
from gltf_file import GltfFile
from test_loaders import load_quietly, look, warning_of

WHITE = {"pbrMetallicRoughness": {"metallicFactor": 0.0}}


def shown(file: GltfFile, path: Path) -> np.ndarray:
    """A picture of a file that is supported in full, all of whose light comes from what emits."""
    return look(load_quietly(file.write(path)))


def in_white(file: GltfFile, path: Path) -> np.ndarray:
    """The mean of the picture's middle in white surroundings: the albedo of what is diffuse."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scene = lightcull.load(file.write(path), environment=(1, 1, 1))
    return look(scene, max_depth=2, spp=128)[5:11, 5:11].mean((0, 1))


def quarters(file: GltfFile) -> dict[str, int]:
    """A texture of four colours: row 0, the top, red and green; the other blue and white."""
    pixels = np.zeros((32, 32, 3), np.uint8)
    pixels[:16, :16, 0] = pixels[:16, 16:, 1] = pixels[16:, :16, 2] = 255
    pixels[16:, 16:] = 255
    return file.texture(pixels)


def glowing(file: GltfFile, texture: dict[str, object], **extra: object) -> None:
    """A square that emits a texture, and fills the picture's middle."""
    material = {"emissiveFactor": [1, 1, 1], "emissiveTexture": texture}
    file.node(mesh=file.quad(file.add("materials", material), **extra))
    file.camera(translation=[0, 0, 2])


RED, GREEN, BLUE = [1, 0, 0], [0, 1, 0], [0, 0, 1]


def test_a_texture_is_scaled_turned_and_moved(tmp_path: Path) -> None:
    # glTF's coordinates run down from the upper left corner.
    for transform, upper_left, upper_right in (
        ({}, RED, GREEN),
        ({"offset": [0.5, 0.0]}, GREEN, RED),
        ({"offset": [0.0, 0.5]}, BLUE, [1, 1, 1]),
        # Turned anticlockwise about the origin by KHR_texture_transform's matrix: (u, v) reads
        # (v, -u).
        ({"rotation": np.pi / 2}, BLUE, RED),
        ({"scale": [0.5, 0.5]}, RED, RED),
    ):
        file = GltfFile()
        extension = {"extensions": {"KHR_texture_transform": transform}}
        glowing(file, {**quarters(file), **extension})
        file.document["extensionsRequired"] = ["KHR_texture_transform"]
        image = shown(file, tmp_path / "a.glb")
        np.testing.assert_allclose(image[5, 5], upper_left, atol=0.01, err_msg=str(transform))
        np.testing.assert_allclose(image[5, 10], upper_right, atol=0.01, err_msg=str(transform))


def test_a_texture_takes_other_texture_coordinates(tmp_path: Path) -> None:
    file = GltfFile()
    middle = file.accessor(np.full((4, 2), 0.75, np.float32))
    glowing(file, {**quarters(file), "texCoord": 1}, attributes={"TEXCOORD_1": middle})
    np.testing.assert_allclose(shown(file, tmp_path / "a.glb")[8, 8], [1, 1, 1], atol=0.01)


def test_textures_by_two_sets_of_coordinates_are_named(tmp_path: Path) -> None:
    file = GltfFile()
    texture = quarters(file)
    uvs = file.accessor(np.zeros((4, 2), np.float32))
    factors = {"baseColorTexture": {**texture, "texCoord": 1}}
    material = {"emissiveFactor": [1, 1, 1], "emissiveTexture": texture, "pbrMetallicRoughness": factors}
    file.node(mesh=file.quad(file.add("materials", material), attributes={"TEXCOORD_1": uvs}))
    said = warning_of(file.write(tmp_path / "a.glb"))
    assert "textures with other coordinates than the material's first (1)" in said


def test_quantized_positions_normals_and_texture_coordinates(tmp_path: Path) -> None:
    file = GltfFile()
    corners = np.int16([[-1000, -1000, 0], [1000, -1000, 0], [1000, 1000, 0], [-1000, 1000, 0]])
    positions = file.accessor(np.pad(corners, ((0, 0), (0, 1))), columns=3)
    uvs = file.accessor(np.uint8([[0, 255], [255, 255], [255, 0], [0, 0]]), normalized=True)
    normals = file.accessor(np.int8([[0, 0, 127, 0]] * 4), columns=3, normalized=True)
    attributes = {"POSITION": positions, "TEXCOORD_0": uvs, "NORMAL": normals}
    material = {"emissiveFactor": [1, 1, 1], "emissiveTexture": quarters(file)}
    quad = file.quad(file.add("materials", material), attributes=attributes)
    file.node(mesh=quad, scale=[0.001, 0.001, 0.001])
    file.camera(translation=[0, 0, 2])
    file.document["extensionsRequired"] = ["KHR_mesh_quantization"]
    image = shown(file, tmp_path / "a.glb")
    np.testing.assert_allclose(image[5, 5], RED, atol=0.01)
    np.testing.assert_allclose(image[10, 5], BLUE, atol=0.01)


@pytest.mark.parametrize("name", ["EXT_meshopt_compression", "KHR_meshopt_compression"])
def test_meshopt_compression(tmp_path: Path, name: str) -> None:
    file = GltfFile()
    glowing(file, quarters(file))
    for accessor in file.document["accessors"]:
        view = file.document["bufferViews"][accessor["bufferView"]]
        raw = file.data[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
        count, stride = accessor["count"], view["byteLength"] // accessor["count"]
        if accessor["type"] == "SCALAR":
            mode, rows = "TRIANGLES", np.frombuffer(raw, np.uint32)
        else:
            mode, rows = "ATTRIBUTES", np.frombuffer(raw, np.float32).reshape(count, -1)
        encoded = meshopt.encode_gltf_buffer(rows, mode)
        compressed = file.document["bufferViews"][file.view(encoded)]
        view["extensions"] = {
            name: {**compressed, "byteLength": len(encoded), "byteStride": stride, "count": count, "mode": mode}
        }
        view["byteOffset"] = 10**6  # nothing is there
    file.document["extensionsRequired"] = [name]
    image = shown(file, tmp_path / "a.glb")
    np.testing.assert_allclose(image[5, 5], RED, atol=0.01)
    np.testing.assert_allclose(image[5, 10], GREEN, atol=0.01)


def test_draco_compression(tmp_path: Path) -> None:
    file = GltfFile()
    corners = np.float32([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    data = DracoPy.encode(
        corners,
        np.uint32([[0, 1, 2], [0, 2, 3]]),
        tex_coord=np.array([[0, 1], [1, 1], [1, 0], [0, 0.0]]),
        quantization_bits=14,
    )
    by_name = {0: "POSITION", 3: "TEXCOORD_0"}
    ids = {by_name[a["attribute_type"]]: a["unique_id"] for a in DracoPy.decode(data).attributes}
    extension = {"bufferView": file.view(data), "attributes": ids}
    glowing(file, quarters(file), extensions={"KHR_draco_mesh_compression": extension})
    for accessor in file.document["accessors"]:
        del accessor["bufferView"]  # all is in the extension
    file.document["extensionsRequired"] = ["KHR_draco_mesh_compression"]
    image = shown(file, tmp_path / "a.glb")
    np.testing.assert_allclose(image[5, 5], RED, atol=0.01)
    np.testing.assert_allclose(image[10, 5], BLUE, atol=0.01)


def test_instances_of_a_lamp(tmp_path: Path) -> None:
    file = GltfFile()
    quad = file.quad(file.add("materials", {"emissiveFactor": [1, 1, 1]}))
    turn = np.float32([[0, 0, 0, 1], [0, np.sqrt(0.5), 0, np.sqrt(0.5)], [0, 0, 0, 1]])
    attributes = {
        "TRANSLATION": file.accessor(np.float32([[0, 0, 0], [5, 0, 0], [0, 5, 0]])),
        "ROTATION": file.accessor(turn),
        "SCALE": file.accessor(np.float32([[1, 1, 1], [1, 1, 1], [2, 1, 1]])),
    }
    file.node(
        mesh=quad, translation=[0, 0, 1], extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    )
    file.camera(translation=[0, 0, 20])
    file.document["extensionsRequired"] = ["EXT_mesh_gpu_instancing"]
    lights = load_quietly(file.write(tmp_path / "a.glb")).lights()
    # Two triangles each, of 2 m^2, and twice that.
    np.testing.assert_allclose(lights["intensity"], [2, 2, 2, 2, 4, 4], rtol=1e-5)
    np.testing.assert_allclose(lights["axis"][::2], [[0, 0, 1], [1, 0, 0], [0, 0, 1]], atol=1e-6)
    np.testing.assert_allclose(lights["center"][::2, 1].round() // 5, [0, 0, 1])


def test_unlit_is_diffuse_and_said(tmp_path: Path) -> None:
    file = GltfFile()
    color = {"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.4, 0.2, 1]}}
    material = file.add("materials", {**color, "extensions": {"KHR_materials_unlit": {}}})
    file.node(mesh=file.quad(material))
    file.camera(translation=[0, 0, 2])
    file.document["extensionsRequired"] = ["KHR_materials_unlit"]
    said = warning_of(file.write(tmp_path / "a.glb"))
    assert "shown as far as can be: KHR_materials_unlit as a diffuse surface (1)" in said
    assert "left out" not in said
    np.testing.assert_allclose(in_white(file, tmp_path / "a.glb"), [0.8, 0.4, 0.2], rtol=0.02)


@pytest.mark.parametrize(
    ("model", "albedo"),
    [
        # F0 of 0.04, no metal: diffuse, and 4 % and more by the layer on top of it.
        ({"diffuseFactor": [0.6, 0.3, 0.1, 1], "specularFactor": [0.04] * 3, "glossinessFactor": 0},
         [0.6, 0.3, 0.1]),
        # All specular: a metal of that colour.
        ({"diffuseFactor": [0, 0, 0, 1], "specularFactor": [0.9, 0.6, 0.3], "glossinessFactor": 0.8},
         [0.9, 0.6, 0.3]),
    ],
)  # fmt: skip
def test_specular_glossiness(
    tmp_path: Path, model: dict[str, object], albedo: list[float]
) -> None:
    file = GltfFile()
    extension = {"KHR_materials_pbrSpecularGlossiness": model}
    file.node(mesh=file.quad(file.add("materials", {"extensions": extension})))
    file.camera(translation=[0, 0, 2])
    assert "left out" not in warning_of(file.write(tmp_path / "a.glb"))
    np.testing.assert_allclose(in_white(file, tmp_path / "a.glb"), albedo, atol=0.06)


@pytest.mark.parametrize(("mode", "count"), [(5, 4), (6, 4)])
def test_fans_and_strips(tmp_path: Path, mode: int, count: int) -> None:
    corners = np.float32([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    order = [0, 1, 3, 2] if mode == 5 else [0, 1, 2, 3]
    for indexed in (False, True):
        file = GltfFile()
        material = file.add("materials", {"emissiveFactor": [1, 1, 1]})
        positions = file.accessor(corners if indexed else corners[order])
        primitive = {"attributes": {"POSITION": positions}, "mode": mode, "material": material}
        if indexed:
            primitive["indices"] = file.accessor(np.uint32(order))
        file.node(mesh=file.add("meshes", {"primitives": [primitive]}))
        file.camera(translation=[0, 0, 2])
        lights = load_quietly(file.write(tmp_path / "a.glb")).lights()
        np.testing.assert_allclose(lights["intensity"], [2, 2], rtol=1e-6)
        np.testing.assert_allclose(lights["axis"], [[0, 0, 1]] * 2, atol=1e-6)


def test_sparse_accessors(tmp_path: Path) -> None:
    file = GltfFile()
    glowing(file, quarters(file))
    uvs = file.document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"]
    accessor = file.document["accessors"][uvs]
    accessor["sparse"] = {
        "count": 4,
        "indices": {"bufferView": file.view(np.uint8([0, 1, 2, 3]).tobytes()), "componentType": 5121},
        "values": {"bufferView": file.view(np.full((4, 2), 0.75, np.float32).tobytes())},
    }
    for without_view in (False, True):
        if without_view:
            del accessor["bufferView"]
        np.testing.assert_allclose(shown(file, tmp_path / "a.glb")[8, 8], [1, 1, 1], atol=0.01)


def masked(tmp_path: Path, mode: str, **material: object) -> tuple[np.ndarray, np.ndarray]:
    """What is seen of a square, and of a panel behind it that glows green, through each half: alpha
    0.25 at the left, 0.75 at the right.
    """
    file = GltfFile()
    pixels = np.full((16, 32, 4), 255, np.uint8)
    pixels[:, :16, 3], pixels[:, 16:, 3] = 64, 191
    color = {"baseColorFactor": [1, 1, 1, 1], "baseColorTexture": file.texture(pixels)}
    front = {"alphaMode": mode, "pbrMetallicRoughness": color, "emissiveFactor": [1, 0, 0], **material}
    file.node(mesh=file.quad(file.add("materials", front)))
    back = file.quad(file.add("materials", {"emissiveFactor": [0, 1, 0]}))
    file.node(mesh=back, translation=[0, 0, -1], scale=[4, 4, 1])
    file.camera(translation=[0, 0, 2])
    image = look(load_quietly(file.write(tmp_path / "a.glb")), spp=1024)
    return image[7:9, 4:6].mean((0, 1)), image[7:9, 10:12].mean((0, 1))


def test_a_mask_cuts_a_surface_and_what_it_emits(tmp_path: Path) -> None:
    left, right = masked(tmp_path, "MASK")
    np.testing.assert_allclose(left, GREEN, atol=1e-6)
    np.testing.assert_allclose(right, RED, atol=1e-6)
    left, _ = masked(tmp_path, "MASK", alphaCutoff=0.2)
    np.testing.assert_allclose(left, RED, atol=1e-6)
    left, _ = masked(tmp_path, "OPAQUE")
    np.testing.assert_allclose(left, RED, atol=1e-6)


def test_blending_is_by_chance(tmp_path: Path) -> None:
    left, right = masked(tmp_path, "BLEND")
    # 4096 samples: a standard deviation of 0.007.
    np.testing.assert_allclose(left, [0.25, 0.75, 0], atol=0.03)
    np.testing.assert_allclose(right, [0.75, 0.25, 0], atol=0.03)


def test_vertex_colours(tmp_path: Path) -> None:
    for colors, normalized in (
        (np.float32([[0.8, 0.4, 0.2]] * 4), False),
        (np.uint8([[204, 102, 51, 255]] * 4), True),
        (np.uint16([[52428, 26214, 13107, 65535]] * 4), True),
    ):
        file = GltfFile()
        attributes = {"COLOR_0": file.accessor(colors, normalized=normalized)}
        material = {"extensions": {"KHR_materials_unlit": {}}}
        file.node(mesh=file.quad(file.add("materials", material), attributes=attributes))
        file.camera(translation=[0, 0, 2])
        np.testing.assert_allclose(in_white(file, tmp_path / "a.glb"), [0.8, 0.4, 0.2], rtol=0.02)


def test_names_of_files_are_percent_encoded(tmp_path: Path) -> None:
    file = GltfFile()
    pixels = np.full((4, 4, 3), 255, np.uint8)
    Image.fromarray(pixels).save(tmp_path / "a b.png")
    texture = {"index": file.add("textures", {"source": file.add("images", {"uri": "a%20b.png"})})}
    glowing(file, texture)
    path = file.write(tmp_path / "a.gltf")
    document = json.loads(path.read_text())
    document["buffers"][0]["uri"] = "d%C3%A4ta%20file.bin"
    (tmp_path / "däta file.bin").write_bytes(file.data)
    path.write_text(json.dumps(document))
    np.testing.assert_allclose(look(load_quietly(path))[8, 8], [1, 1, 1], atol=1e-5)
    (tmp_path / "däta file.bin").unlink()
    with pytest.raises(lightcull.Error, match="buffer 0: its file 'd%C3%A4ta%20file.bin' is missing"):
        lightcull.load(path)


def test_extensions_of_looks_are_no_reason_to_refuse_a_file(tmp_path: Path) -> None:
    file = GltfFile()
    glass = {"extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}}
    file.node(mesh=file.quad(file.add("materials", glass)))
    file.document["extensionsRequired"] = ["KHR_materials_transmission"]
    assert "KHR_materials_transmission (1)" in warning_of(file.write(tmp_path / "a.glb"))


def test_a_texture_of_several_materials_is_there_once(tmp_path: Path) -> None:
    file = GltfFile()
    texture = quarters(file)
    for x in (0, 3):
        factors = {"baseColorTexture": texture, "metallicFactor": 0.0}
        file.node(
            mesh=file.quad(file.add("materials", {"pbrMetallicRoughness": factors})),
            translation=[x, 0, 0],
        )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scene = lightcull.load(file.write(tmp_path / "a.glb"))
    assert scene.counts["textures"] == 1


@pytest.mark.parametrize(("dtype", "size"), [(np.uint8, 3), (np.uint16, 6), (np.float32, 12)])
def test_a_texel_takes_the_memory_of_its_bits(dtype: type, size: int) -> None:
    scene = lightcull.Scene()
    before = scene.closed().memory_size().data
    scene = lightcull.Scene()
    scene.add_texture(np.ones((64, 64, 3), dtype))
    assert scene.closed().memory_size().data - before == 64 * 64 * size
