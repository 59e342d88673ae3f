"""Scenes from files."""

from __future__ import annotations

import json
import warnings
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import lightcull
from gltf_file import GltfFile
from lightcull.loaders.model import Triangles, transformed


def load_quietly(path: Path) -> lightcull.Scene:
    """Loads a file that is supported in full."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return lightcull.load(path)


def warning_of(path: Path) -> str:
    """What the one warning says."""
    with pytest.warns(lightcull.UnsupportedWarning) as caught:
        lightcull.load(path)
    assert len(caught) == 1
    return str(caught[0].message)


def look(scene: lightcull.Scene, max_depth: int = 1, spp: int = 4) -> np.ndarray:
    return lightcull.render(scene, spp=spp, size=(16, 16), max_depth=max_depth).image


def emitting(**material: object) -> GltfFile:
    """A square that emits, seen from the front so that it fills the middle of the image."""
    file = GltfFile()
    file.node(mesh=file.quad(file.add("materials", material)))
    file.camera(translation=[0, 0, 2])
    return file


@pytest.mark.parametrize("ending", [".glb", ".gltf"])
def test_gltf_emission(tmp_path: Path, ending: str) -> None:
    file = emitting(
        emissiveFactor=[1.0, 0.5, 0.25],
        extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 8.0}},
        pbrMetallicRoughness={"baseColorFactor": [0.0, 0.0, 0.0, 1.0]},
    )
    file.document["extensionsUsed"] = ["KHR_materials_emissive_strength"]
    scene = load_quietly(file.write(tmp_path / f"a{ending}"))
    assert scene.name == "a"
    lights = scene.lights()
    assert len(lights) == 2
    np.testing.assert_allclose(lights["axis"], [[0, 0, 1]] * 2, atol=1e-6)
    assert not lights["two_sided"].any()
    np.testing.assert_allclose(look(scene)[8, 8], [8, 4, 2], rtol=1e-5)
    assert scene.camera.vertical_fov == pytest.approx(1)
    np.testing.assert_allclose(scene.camera.origin, [0, 0, 2])


def test_gltf_buffer_in_a_file_of_its_own(tmp_path: Path) -> None:
    file = emitting(emissiveFactor=[1.0, 1.0, 1.0])
    path = file.write(tmp_path / "a.gltf")
    document = json.loads(path.read_text())
    document["buffers"][0]["uri"] = "a.bin"
    (tmp_path / "a.bin").write_bytes(file.data)
    path.write_text(json.dumps(document))
    assert len(load_quietly(path).lights()) == 2


def test_gltf_emissive_texture_and_its_orientation(tmp_path: Path) -> None:
    pixels = np.zeros((4, 4, 3), np.uint8)
    pixels[:2, 2:] = (255, 188, 0)  # the right upper quarter; 188 is half as bright as 255
    file = GltfFile()
    texture = file.texture(pixels)
    file.node(
        mesh=file.quad(
            file.add("materials", {"emissiveFactor": [1, 1, 1], "emissiveTexture": texture})
        )
    )
    file.camera(translation=[0, 0, 2])
    image = look(load_quietly(file.write(tmp_path / "a.glb")))
    np.testing.assert_allclose(image[5, 10], [1, 0.5, 0], atol=0.01)
    for row, column in ((5, 5), (10, 5), (10, 10)):
        assert not image[row, column].any()


def test_gltf_double_sided_emission(tmp_path: Path) -> None:
    file = emitting(emissiveFactor=[1, 1, 1], doubleSided=True)
    assert load_quietly(file.write(tmp_path / "a.glb")).lights()["two_sided"].all()


def test_gltf_punctual_lights(tmp_path: Path) -> None:
    file = GltfFile()
    file.node(mesh=file.quad())
    file.camera(translation=[0, 0, 2])
    quarter_turn = [-np.sqrt(0.5), 0, 0, np.sqrt(0.5)]  # about x: -Z becomes -Y
    lamp = file.add(
        "nodes",
        {
            "extensions": file.light(
                type="spot", color=[1, 0.5, 0], intensity=4, spot={"outerConeAngle": 0.5}
            ),
            "rotation": quarter_turn,
        },
    )
    file.node(children=[lamp], translation=[0, 3, 1])
    file.node(extensions=file.light(type="point", intensity=2), translation=[1, 2, 3])
    file.node(
        extensions=file.light(type="directional", color=[0.2, 1, 1], intensity=3),
        rotation=quarter_turn,
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scene = lightcull.load(file.write(tmp_path / "a.glb"))
    spot, point, sun = scene.lights()
    assert scene.counts["spots"] == scene.counts["points"] == 1
    assert scene.counts["directional lights"] == 1
    assert list(scene.lights()["directional"]) == [False, False, True]
    np.testing.assert_allclose(sun["axis"], [0, -1, 0], atol=1e-6)
    assert sun["intensity"] == pytest.approx(3 * (0.2126 * 0.2 + 0.7152 + 0.0722), rel=1e-4)
    np.testing.assert_allclose(spot["center"], [0, 3, 1], atol=1e-6)
    np.testing.assert_allclose(spot["axis"], [0, -1, 0], atol=1e-6)
    np.testing.assert_allclose(spot["cos_theta_e"], np.cos(0.5), rtol=1e-5)
    np.testing.assert_allclose(point["center"], [1, 2, 3])
    assert point["intensity"] == pytest.approx(2)


def lamps_and_a_panel(generator: str) -> GltfFile:
    """A point of 683 * 2 and a sun of 683 * 3, as Blender writes 2 W/sr and 3 W/m^2, and a panel of
    a radiance of 5.
    """
    file = emitting(emissiveFactor=[1, 1, 1], extensions={
        "KHR_materials_emissive_strength": {"emissiveStrength": 5}
    })  # fmt: skip
    file.document["asset"]["generator"] = generator
    file.node(extensions=file.light(type="point", intensity=683 * 2), translation=[1, 2, 3])
    file.node(extensions=file.light(type="directional", intensity=683 * 3))
    return file


BLENDER = "Khronos glTF Blender I/O v4.2.57"


def test_gltf_lights_of_blender_beside_panels_ask_for_their_unit(tmp_path: Path) -> None:
    path = lamps_and_a_panel(BLENDER).write(tmp_path / "a.glb")
    text = warning_of(path)
    assert "683 times as bright" in text
    assert "--gltf-lights" in text
    for unit, factor in (("watts", 683.0), ("candela", 1.0)):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            lights = lightcull.load(path, gltf_lights=unit).lights()
        of_panel, point, sun = lights["intensity"][:2], *lights["intensity"][2:]
        assert point == pytest.approx(2 * factor, rel=1e-5)
        assert sun == pytest.approx(3 * factor, rel=1e-5)
        np.testing.assert_allclose(of_panel, 5 * 2, rtol=1e-5)


def test_gltf_lights_ask_for_no_unit_where_nothing_is_odd(tmp_path: Path) -> None:
    file = lamps_and_a_panel("another program")
    alone = GltfFile()
    alone.document["asset"]["generator"] = BLENDER
    alone.node(mesh=alone.quad())
    alone.camera(translation=[0, 0, 2])
    alone.node(extensions=alone.light(type="directional", intensity=683))
    panel = emitting(emissiveFactor=[1, 1, 1])
    panel.document["asset"]["generator"] = BLENDER
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name, one in (("a", file), ("b", alone), ("c", panel)):
            lightcull.load(one.write(tmp_path / f"{name}.glb"))


def test_the_unit_of_gltf_lights_is_one_of_two_and_of_gltf_alone(tmp_path: Path) -> None:
    path = lamps_and_a_panel(BLENDER).write(tmp_path / "a.glb")
    with pytest.raises(lightcull.Error, match="wanted candela or watts, got 'lux'"):
        lightcull.load(path, gltf_lights="lux")  # type: ignore[arg-type]
    with pytest.raises(lightcull.Error, match="is for a .glb or .gltf"):
        lightcull.load(write_obj(tmp_path, "newmtl a"), gltf_lights="watts")
    with pytest.raises(lightcull.Error, match="is for a .glb or .gltf"):
        lightcull.open_scene("cornell", gltf_lights="watts")


def test_gltf_spots_with_a_hard_edge_are_lit(tmp_path: Path) -> None:
    # Blender's exporter writes equal angles.
    file = GltfFile()
    file.node(mesh=file.quad(), scale=[20, 20, 1])
    file.camera(translation=[0, 0, 2])
    angle = np.radians(22.5)
    spot = {"innerConeAngle": angle, "outerConeAngle": angle}
    for x in (-0.3, 0.3):
        light = file.light(type="spot", intensity=4, spot=spot)
        file.node(extensions=light, translation=[x, 0, 1])  # it looks down -Z at the quad
    scene = lightcull.load(file.write(tmp_path / "a.glb"))

    def mean(sampler: str, spp: int) -> float:
        return float(lightcull.render(scene, sampler, spp=spp, size=(24, 24), seed=1).image.mean())

    # Where one of them shines, uniform chooses the other half of the time: its error is 0.3 %.
    expected = mean("uniform", 1024)
    assert expected > 0
    for sampler in ("exhaustive", "culled", "light_bvh"):
        assert mean(sampler, 64) == pytest.approx(expected, rel=0.015)


def test_gltf_nodes_place_and_mirror(tmp_path: Path) -> None:
    file = GltfFile()
    quad = file.quad(file.add("materials", {"emissiveFactor": [1, 1, 1]}))
    file.node(mesh=quad, translation=[5, 0, 0], scale=[2, 1, 1])
    file.node(mesh=quad, scale=[-1, 1, 1])
    file.camera(translation=[0, 0, 2])
    lights = load_quietly(file.write(tmp_path / "a.glb")).lights()
    np.testing.assert_allclose(lights["intensity"], [4, 4, 2, 2], rtol=1e-5)
    np.testing.assert_allclose(lights["axis"], [[0, 0, 1]] * 4, atol=1e-6)
    np.testing.assert_allclose(lights["center"][:2, 0], 5, atol=0.8)


def test_gltf_normals_are_used_and_turned(tmp_path: Path) -> None:
    """A surface whose normals lean towards the light is brighter than one that leans away."""

    def brightness(lean: float, **node: object) -> float:
        file = GltfFile()
        material = file.add("materials", {"pbrMetallicRoughness": {"metallicFactor": 0.0}})
        normals = np.float32([[np.sin(lean), 0, np.cos(lean)]] * 4)
        quad = file.quad(material, attributes={"NORMAL": file.accessor(normals)})
        file.node(mesh=quad, **node)
        file.node(extensions=file.light(type="point", intensity=9), translation=[-3, 0, 3])
        file.camera(translation=[0, 0, 2])
        scene = load_quietly(file.write(tmp_path / "a.glb"))
        return float(look(scene, max_depth=2)[8, 8].mean())

    towards, away = brightness(-0.6), brightness(0.6)
    assert towards > 2 * away
    half_a_turn = {"rotation": [0, 0, 1, 0]}
    assert brightness(0.6, **half_a_turn) == pytest.approx(towards, rel=0.01)
    mirrored = {"scale": [-1, 1, 1]}
    assert brightness(0.6, **mirrored) == pytest.approx(towards, rel=0.01)


def test_normals_stay_normal_where_a_node_stretches() -> None:
    square = Triangles(
        np.array([[0, 0, 0], [1, -1, 0], [1, -1, 1], [0, 0, 1.0]]),
        np.array([[0, 1, 2], [0, 2, 3]]),
        np.array([[1, 1, 0.0]] * 4),
    )
    for stretch in ([2.0, 1, 1], [-2.0, 1, 1], [1, 3, -2.0]):
        normals = transformed(square, np.diag([*stretch, 1])).normals
        assert normals is not None
        expected = np.array([1 / stretch[0], 1 / stretch[1], 0])
        expected /= np.linalg.norm(expected)
        np.testing.assert_allclose(normals, [expected] * 4, atol=1e-6)


def test_lights_are_in_the_order_of_nodes_and_primitives(tmp_path: Path) -> None:
    file = GltfFile()
    meshes = []
    for first in (1, 3):
        quads = [file.quad(file.add("materials", {"emissiveFactor": [n, n, n]}))
                 for n in (first / 8, (first + 1) / 8)]  # fmt: skip
        primitives = [file.document["meshes"][quad]["primitives"][0] for quad in quads]
        meshes.append(file.add("meshes", {"primitives": primitives}))
    child = file.add("nodes", {"mesh": meshes[0]})
    file.node(children=[child], mesh=meshes[1])
    file.camera(translation=[0, 0, 2])
    path = file.write(tmp_path / "a.glb")
    for _ in range(3):
        intensity = load_quietly(path).lights()["intensity"][::2]
        np.testing.assert_allclose(intensity, np.array([1, 2, 3, 4]) / 4, rtol=1e-5)


def test_gltf_base_colour_and_metallic_roughness_textures(tmp_path: Path) -> None:
    file = GltfFile()
    left_red = np.zeros((1, 2, 3), np.uint8)
    left_red[0] = [[255, 0, 0], [0, 255, 0]]
    rough = np.full((1, 1, 3), 255, np.uint8)
    rough[..., 2] = 0
    material = file.add(
        "materials",
        {
            "pbrMetallicRoughness": {
                "baseColorTexture": file.texture(left_red),
                "metallicRoughnessTexture": file.texture(rough),
            }
        },
    )
    file.node(mesh=file.quad(material))
    file.node(extensions=file.light(type="point", intensity=9), translation=[0, 0, 3])
    file.camera(translation=[0, 0, 2])
    scene = load_quietly(file.write(tmp_path / "a.glb"))
    assert scene.counts["textures"] == 2
    image = look(scene, max_depth=2)
    assert image[8, 4, 0] > 5 * image[8, 4, 1]
    assert image[8, 11, 1] > 5 * image[8, 11, 0]


def test_gltf_names_everything_that_is_not_supported(tmp_path: Path) -> None:
    file = GltfFile()
    glass = file.add(
        "materials",
        {
            "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}},
            "occlusionTexture": {"index": 0},
        },
    )
    quad = file.quad(glass)
    lines = file.quad(mode=1)
    file.texture(np.zeros((1, 1, 3), np.uint8))
    file.add("samplers", {"wrapS": 33071})
    file.add("animations", {"channels": [], "samplers": []})
    file.node(mesh=quad)
    file.node(mesh=lines, children=[file.add("nodes", {"mesh": quad})])
    file.camera()
    file.node(extensions=file.light(type="point", range=5))
    message = warning_of(file.write(tmp_path / "a.glb"))
    for thing in (
        "KHR_materials_transmission (1)", "occlusion maps (1)",
        "primitives that are not triangles (1)", "textures that are not repeated (1)",
        "animations (1)", "ranges of lights (1)",
    ):  # fmt: skip
        assert thing in message
    assert "\n" not in message
    assert "no camera" not in message
    with pytest.warns(lightcull.UnsupportedWarning):
        assert lightcull.load(tmp_path / "a.glb").triangle_count == 4


def test_gltf_names_the_rest_of_it_too(tmp_path: Path) -> None:
    file = GltfFile()
    texture = file.texture(np.zeros((1, 1, 3), np.uint8))
    metallic_roughness = {"baseColorTexture": {**texture, "texCoord": 1}}
    material = {"pbrMetallicRoughness": metallic_roughness, "occlusionTexture": texture}
    morph = {"POSITION": file.accessor(np.zeros((4, 3), np.float32))}
    file.node(mesh=file.quad(file.add("materials", material), targets=[morph]))
    untextured = file.quad(0)
    del file.document["meshes"][untextured]["primitives"][0]["attributes"]["TEXCOORD_0"]
    file.node(mesh=untextured)
    file.add("skins", {"joints": [0]})
    file.document["scenes"].append({"nodes": [0]})
    file.node(extensions=file.light(type="sun"))
    message = warning_of(file.write(tmp_path / "a.glb"))
    for thing in (
        "occlusion maps (1)", "morph targets (1)", "skins (1)",
        "scenes besides the one shown (1)",
        "textures on meshes without texture coordinates (2)", "sun lights (1)",
        "no camera: one is placed", "no light: a studio surrounds it",
    ):  # fmt: skip
        assert thing in message


@pytest.mark.parametrize(
    ("name", "shape", "said"),
    [
        ("TEXCOORD_0", (3, 2), "textures on meshes without texture coordinates (1)"),
        ("TEXCOORD_0", (4, 4), "textures on meshes without texture coordinates (1)"),
        ("NORMAL", (3, 3), "normals that are not one for each position (1)"),
        ("NORMAL", (4, 2), "normals that are not one for each position (1)"),
    ],
)
def test_gltf_attributes_that_do_not_fit_are_left_out(
    tmp_path: Path, name: str, shape: tuple[int, int], said: str
) -> None:
    file = GltfFile()
    texture = file.texture(np.zeros((1, 1, 3), np.uint8))
    material = file.add("materials", {"pbrMetallicRoughness": {"baseColorTexture": texture}})
    values = file.accessor(np.ones(shape, np.float32))
    file.node(mesh=file.quad(material, attributes={name: values}))
    assert said in warning_of(file.write(tmp_path / "a.glb"))


@pytest.mark.parametrize("columns", [2, 4])
def test_gltf_positions_have_three_coordinates(tmp_path: Path, columns: int) -> None:
    file = GltfFile()
    positions = file.accessor(np.ones((4, columns), np.float32))
    file.node(mesh=file.quad(attributes={"POSITION": positions}))
    with pytest.raises(lightcull.Error, match="mesh 'quad': is not made of triangles and of posit"):
        lightcull.load(file.write(tmp_path / "a.glb"))


@pytest.mark.parametrize("ending", ["obj", "ply"])
def test_points_alone_are_nothing_to_render(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"a.{ending}"
    if ending == "obj":
        path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\n")
    else:
        path.write_text(PLY.split("element face")[0].format(colors="") + "end_header\n" + "0 0 0\n" * 3)
    message = "holds no triangles|no primitive"
    with warnings.catch_warnings(), pytest.raises(lightcull.Error, match=message):
        warnings.simplefilter("ignore")
        lightcull.load(path)


def test_gltf_required_extensions_are_required(tmp_path: Path) -> None:
    file = emitting(emissiveFactor=[1, 1, 1])
    file.document["extensionsRequired"] = ["EXT_of_geometry", "KHR_lights_punctual"]
    # Nothing of the triangles depends on it.
    file.document["nodes"][0]["extensions"] = {"EXT_of_geometry": {}}
    assert "EXT_of_geometry (1)" in warning_of(file.write(tmp_path / "a.glb"))
    for part in ("meshes", "bufferViews"):
        file.document[part][0]["extensions"] = {"EXT_of_geometry": {}}
        with pytest.raises(lightcull.Error, match="needs EXT_of_geometry, which is not support"):
            lightcull.load(file.write(tmp_path / "a.glb"))
        del file.document[part][0]["extensions"]


def test_gltf_image_that_cannot_be_read(tmp_path: Path) -> None:
    file = GltfFile()
    image = file.add("images", {"uri": "nowhere.png"})
    texture = {"index": file.add("textures", {"source": image})}
    material = {"emissiveFactor": [1, 1, 1], "emissiveTexture": texture}
    file.node(mesh=file.quad(file.add("materials", material)))
    message = warning_of(file.write(tmp_path / "a.gltf"))
    assert "missing file 'nowhere.png' (1)" in message
    # Factors are white where textures are nearly black: without them nothing is known to emit.
    assert "no light" in message


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("a.glb", b"", "a.glb: is not a binary glTF file: too short"),
        ("a.glb", b"x" * 100, "a.glb: is not a binary glTF 2.0 file"),
        ("a.glb", b"glTg\2\0\0\0\x18\0\0\0\4\0\0\0JSON{}  ", "a.glb: is not a binary glTF 2.0 file"),
        ("a.glb", b"glTF\1\0\0\0\x18\0\0\0\4\0\0\0JSON{}  ", "a.glb: is glTF 1.0, and only glTF 2.0"),
        ("a.glb", b"glTF\2\0\0\0\x18\0\0\0\4\0\0\0JSOM{}  ", "a.glb: is not a binary glTF 2.0 file"),
        ("a.glb", b"glTF\2\0\0\0\x18\0\0\0\4\0\0\0JSON{}  ", "a.glb: holds no triangles"),
        ("a.gltf", b"{", "a.gltf: its JSON is broken"),
        ("a.gltf", b"[]", "a.gltf: its JSON is not an object"),
        (
            "a.gltf",
            b'{"nodes": [{"mesh": 0}], "meshes": [{}]}',
            "a.gltf: makes no sense: KeyError: 'primitives'",
        ),
        ("a.gltf", b'{"asset": {"version": "1.0"}}', "a.gltf: is glTF 1.0, and only glTF 2.0 is read"),
        ("a.gltf", b'{"asset": {"version": "2.0"}}', "a.gltf: holds no triangles"),
        ("a.obj", b"hello\n", "a.obj: holds no triangles; .* OBJ statement 'hello'"),
        ("a.ply", b"hello\n", "a.ply: cannot be read"),
        ("a.fbx", b"", "a.fbx: wanted a name that ends in .glb, .gltf, .obj, .ply, .usd"),
    ],
)
def test_broken_files(tmp_path: Path, name: str, data: bytes, message: str) -> None:
    (tmp_path / name).write_bytes(data)
    with (
        warnings.catch_warnings(),
        pytest.raises(lightcull.Error, match=message) as error,
    ):
        warnings.simplefilter("ignore")
        lightcull.load(tmp_path / name)
    assert "\n" not in str(error.value)


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(lightcull.Error, match=r"nowhere.glb: no such file"):
        lightcull.load(tmp_path / "nowhere.glb")


OBJ = """\
mtllib a.mtl
v -1 0 -1
v -1 0 1
v 1 0 1
v 1 0 -1
vt 0 1
vt 0 0
vt 1 0
vt 1 1
usemtl {material}
f 1/1 2/2 3/3 4/4
"""


def write_obj(folder: Path, mtl: str, extra: str = "") -> Path:
    (folder / "a.mtl").write_text(mtl)
    (folder / "a.obj").write_text(OBJ.format(material="m") + extra)
    return folder / "a.obj"


def test_obj_diffuse_colour_in_white_surroundings(tmp_path: Path) -> None:
    path = write_obj(tmp_path, "newmtl m\nKd 0.8 0.4 0.2\n")
    message = warning_of(path)
    assert "left out" not in message
    assert "no camera: one is placed" in message
    assert "no light: a studio surrounds it" in message
    with pytest.warns(lightcull.UnsupportedWarning):
        scene = lightcull.load(path, environment=(1, 1, 1))
    # A white environment shows a diffuse surface in its own colour.
    image = look(scene, max_depth=2, spp=256)
    np.testing.assert_allclose(image[8, 8], [0.8, 0.4, 0.2], rtol=0.05)
    np.testing.assert_allclose(image[0, 0], [1, 1, 1])


def test_obj_textures_and_emission(tmp_path: Path) -> None:
    texels = np.zeros((8, 8, 3), np.uint8)
    texels[:4] = 255  # the upper half, v from 0.5 to 1, is at z < 0
    Image.fromarray(texels).save(tmp_path / "glow map.png")
    path = write_obj(tmp_path, "newmtl m\nKd 0 0 0\nKe 2 4 6\nmap_Ke glow map.png\n")
    assert "left out" not in warning_of(path)
    scene = lightcull.load(path, camera=lightcull.Camera((0, 2.5, 2), (0, 0, 0)))
    assert len(scene.lights()) == 2
    image = look(scene)
    brightest = np.unravel_index(image[..., 2].argmax(), (16, 16))
    np.testing.assert_allclose(image[brightest], [2, 4, 6], rtol=1e-4)
    assert image[12, 8].max() < 0.1


def test_obj_names_what_is_not_supported(tmp_path: Path) -> None:
    path = write_obj(
        tmp_path,
        "newmtl m\nKd 1 1 1\nKs 0.5 0.5 0.5\nPm 0.5\nmap_Bump bumps.png\nmap_Kd gone.png\n",
        extra="l 1 2\nl 2 3\nmtllib b.mtl\n",
    )
    message = warning_of(path)
    for thing in (
        "ks of materials (1)", "pm of materials (1)", "map_bump of materials (1)",
        "missing file 'gone.png' (1)", "OBJ statement 'l' (2)", "missing file 'b.mtl' (1)",
    ):  # fmt: skip
        assert thing in message


def test_obj_of_triangles_alone(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert "left out" not in warning_of(tmp_path / "a.obj")


def test_obj_without_its_materials(tmp_path: Path) -> None:
    path = write_obj(tmp_path, "")
    (tmp_path / "a.mtl").unlink()
    assert "missing file 'a.mtl' (1)" in warning_of(path)


PLY = """\
ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
{colors}element face 1
property list uchar int vertex_indices
end_header
0 0 0{color}
1 0 0{color}
0 1 0{color}
3 0 1 2
"""


def test_ply(tmp_path: Path) -> None:
    path = tmp_path / "a.ply"
    path.write_text(PLY.format(colors="", color=""))
    assert "left out" not in warning_of(path)
    with pytest.warns(lightcull.UnsupportedWarning):
        scene = lightcull.load(path)
    assert scene.triangle_count == 1
    assert scene.has_environment
    np.testing.assert_allclose(scene.bounds, [[0, 0, 0], [1, 1, 0]])
