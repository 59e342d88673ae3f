"""USD: lights by their closed forms, meshes, materials and cameras."""

from __future__ import annotations

import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import lightcull
from test_loaders import look, warning_of

pytest.importorskip("pxr")

FLOOR = """
def Mesh "floor" {
    point3f[] points = [(-9, 0, -9), (-9, 0, 9), (9, 0, 9), (9, 0, -9)]
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    uniform token subdivisionScheme = "none"
}
"""
CAMERA = """
def Camera "camera" {
    float focalLength = 500
    float verticalAperture = 5
    double3 xformOp:translate = (0, 0.5, 2)
    float xformOp:rotateX = -14.036243
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateX"]
}
"""


def write(folder: Path, *prims: str, metadata: str = "") -> Path:
    path = folder / "a.usda"
    path.write_text(f'#usda 1.0\n(\n    upAxis = "Y"\n    metersPerUnit = 1\n{metadata})\n' + "\n".join(prims))
    return path


def load(path: Path, **options: Any) -> lightcull.Scene:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", lightcull.UnsupportedWarning)
        return lightcull.load(path, **options)


def light(kind: str, values: str, *, height: float = 3.0, apis: str = "") -> str:
    """A light above the origin that shines down."""
    schemas = f'(prepend apiSchemas = ["{apis}"])' if apis else ""
    return f"""
def {kind} "light" {schemas} {{
    {values}
    double3 xformOp:translate = (0, {height}, 0)
    float xformOp:rotateX = -90
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateX"]
}}
"""


def irradiance(folder: Path, *prims: str) -> float:
    """What falls on the floor at the origin, by its radiance: albedo 0.5 / pi of it."""
    scene = load(write(folder, FLOOR, CAMERA, *prims))
    image = lightcull.render(scene, "exhaustive", spp=256, size=(8, 8), max_depth=2, seed=1).image
    return float(image.mean()) * math.pi / 0.5


@pytest.mark.parametrize(
    ("prim", "expected"),
    [
        # A sphere's is pi L (r / h)^2; a disk's pi L r^2 / (r^2 + h^2), both seen from below.
        (light("SphereLight", "float inputs:radius = 0.5\nfloat inputs:intensity = 10"),
         math.pi * 10 * (0.5 / 3) ** 2),
        (light("SphereLight", "float inputs:radius = 0.5\nfloat inputs:intensity = 10\nbool treatAsPoint = 1"),
         math.pi * 10 * (0.5 / 3) ** 2),
        (light("SphereLight", "float inputs:radius = 0.5\nfloat inputs:exposure = 3\nbool inputs:normalize = 1"),
         8 / (4 * math.pi * 0.25) * math.pi * (0.5 / 3) ** 2),
        (light("DiskLight", "float inputs:radius = 1\nfloat inputs:intensity = 10"), math.pi * 10 / 10),
        (light("DiskLight", "float inputs:radius = 1\nfloat inputs:intensity = 10\nbool inputs:normalize = 1"),
         1.0),
        # Seen from far, a rectangle of 2 x 1 is a point of 2 L.
        (light("RectLight", "float inputs:width = 2\nfloat inputs:height = 1\nfloat inputs:intensity = 500",
               height=30), 2 * 500 / 900),
        # A cylinder across: L times what is seen of it, length times width.
        (light("CylinderLight", "float inputs:length = 2\nfloat inputs:radius = 0.25\n"
               "float inputs:intensity = 500", height=30), 2 * 0.5 * 500 / 900),
        (light("DistantLight", "float inputs:intensity = 3\nfloat inputs:angle = 2\nbool inputs:normalize = 1"),
         3.0),
        (light("DistantLight", "float inputs:intensity = 300\nfloat inputs:angle = 2"),
         300.0 * math.pi * math.sin(math.radians(1)) ** 2),
        (light("DistantLight", "float inputs:intensity = 3\nfloat inputs:angle = 0"), 3.0),
        (light("DomeLight", "float inputs:intensity = 0.7"), 0.7 * math.pi),
    ],
)  # fmt: skip
def test_lights(tmp_path: Path, prim: str, expected: float) -> None:
    assert irradiance(tmp_path, prim) == pytest.approx(expected, rel=0.015)


def test_the_colour_of_a_light_by_its_temperature(tmp_path: Path) -> None:
    from pxr import UsdLux

    values = (
        "float inputs:intensity = 3\nfloat inputs:angle = 0\ncolor3f inputs:color = (1, 0.5, 1)\n"
        "bool inputs:enableColorTemperature = 1\nfloat inputs:colorTemperature = 3000"
    )
    scene = load(write(tmp_path, FLOOR, CAMERA, light("DistantLight", values)))
    image = lightcull.render(scene, "uniform", spp=1, size=(8, 8), max_depth=2).image
    expected = 3 * 0.5 / math.pi * np.array([1, 0.5, 1]) * UsdLux.BlackbodyTemperatureAsRgb(3000)
    np.testing.assert_allclose(image[4, 4], expected, rtol=1e-4)


def test_a_cone_makes_a_spot(tmp_path: Path) -> None:
    values = (
        "float inputs:radius = 0.1\nfloat inputs:intensity = 1000\n"
        "float inputs:shaping:cone:angle = 30\nfloat inputs:shaping:cone:softness = 0.5"
    )
    path = write(tmp_path, FLOOR, light("SphereLight", values, apis="ShapingAPI"))
    assert "shaped lights as spots (1)" in warning_of(path)
    (spot,) = load(path).lights()
    np.testing.assert_allclose(spot["axis"], [0, -1, 0], atol=1e-6)
    # All of it up to 15 degrees, and nothing from 30 on.
    assert spot["cos_theta_o"] == pytest.approx(math.cos(math.radians(15)), rel=1e-5)
    assert spot["cos_theta_e"] == pytest.approx(math.cos(math.radians(15)), rel=1e-5)
    assert spot["intensity"] == pytest.approx(1000 * math.pi * 0.01, rel=1e-5)


def test_the_map_of_a_dome_has_z_in_its_middle(tmp_path: Path) -> None:
    """By OpenEXR's convention, which UsdLux follows: +Z in the middle, +X a quarter to the left."""
    texels = np.zeros((8, 64, 3), np.float32)
    texels[:, 24:40] = (1, 0, 0)
    texels[:, 8:24] = (0, 1, 0)
    lightcull.write_exr(tmp_path / "sky.exr", texels)
    for turn, of_z, of_x in ((0, [1, 0, 0], [0, 1, 0]), (90, [0, 0, 0], [1, 0, 0])):
        dome = f"""
def DomeLight "dome" {{
    asset inputs:texture:file = @sky.exr@
    float xformOp:rotateY = {turn}
    uniform token[] xformOpOrder = ["xformOp:rotateY"]
}}
"""
        for direction, expected in (((0, 0, 1), of_z), ((1, 0, 0), of_x)):
            scene = load(write(tmp_path, FLOOR, dome))
            scene.set_camera((0, 5, 0), (direction[0], 5, direction[2]), vertical_fov=0.2)
            np.testing.assert_allclose(look(scene)[8, 8], expected, atol=1e-5)


@pytest.mark.parametrize(
    ("kind", "pole", "up", "tilted"),
    [
        ("DomeLight", "", "Y", False),
        ("DomeLight", "", "Z", True),
        ("DomeLight_1", "", "Y", False),
        ("DomeLight_1", "", "Z", False),
        ("DomeLight_1", "Y", "Z", True),
        ("DomeLight_1", "Z", "Z", False),
        ("DomeLight_1", "Z", "Y", True),
    ],
)
def test_the_pole_of_a_dome(tmp_path: Path, kind: str, pole: str, up: str, tilted: bool) -> None:
    axis = f'uniform token poleAxis = "{pole}"' if pole else ""
    path = tmp_path / "a.usda"
    path.write_text(f'#usda 1.0\n(\nupAxis = "{up}"\n)\n{FLOOR}def {kind} "dome" {{\n{axis}\n}}\n')
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        lightcull.load(path)
    assert any("tilt of the dome light" in str(w.message) for w in caught) == tilted


def test_units_up_axis_and_the_camera(tmp_path: Path) -> None:
    path = tmp_path / "a.usda"
    camera = CAMERA.replace("(0, 0.5, 2)", "(0, -200, 50)").replace("-14.036243", "75.963757")
    points = 'def Mesh "floor" {\npoint3f[] points = [(-900, -900, 0), (900, -900, 0), (900, 900, 0)]\n'
    mesh = points + "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]\n}\n"
    path.write_text('#usda 1.0\n(\nupAxis = "Z"\nmetersPerUnit = 0.01\n)\n' + mesh + camera)
    scene = load(path)
    np.testing.assert_allclose(scene.bounds, [[-9, 0, -9], [9, 0, 9]], atol=1e-5)
    np.testing.assert_allclose(scene.camera.origin, [0, 0.5, 2], atol=1e-5)
    away = np.subtract(scene.camera.target, scene.camera.origin)
    np.testing.assert_allclose(away / away[2], [0, 0.25, 1], atol=1e-5)
    assert scene.camera.vertical_fov == pytest.approx(2 * math.atan(0.005), rel=1e-5)


def test_cameras_are_chosen_by_their_names(tmp_path: Path) -> None:
    flat = (
        'def Camera "flat" {\n    token projection = "orthographic"\n    float verticalAperture = 50\n'
        "    double3 xformOp:translate = (0, 40, 0)\n    float xformOp:rotateX = -90\n"
        '    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateX"]\n}\n'
    )
    path = tmp_path / "a.usda"
    path.write_text("#usda 1.0\n(\nmetersPerUnit = 0.1\n)\n" + FLOOR + CAMERA + flat)
    scene = load(path)
    assert [camera.name for camera in scene.cameras] == ["camera", "flat"]
    assert scene.camera == scene.cameras[0]
    scene = load(path, camera="flat")
    # An aperture of 50 is 5 units of the stage, each of 0.1 m.
    assert scene.camera.orthographic_height == pytest.approx(0.5)
    np.testing.assert_allclose(scene.camera.origin, [0, 4, 0], atol=1e-6)
    np.testing.assert_allclose(scene.camera.target, [0, 3, 0], atol=1e-6)


def material(name: str, inputs: str, extra: str = "") -> str:
    return f"""
def Material "{name}" {{
    token outputs:surface.connect = </{name}/surface.outputs:surface>
    def Shader "surface" {{
        uniform token info:id = "UsdPreviewSurface"
        {inputs}
        token outputs:surface
    }}
    {extra}
}}
"""


SQUARE = """
def Mesh "square" (prepend apiSchemas = ["MaterialBindingAPI"]) {{
    point3f[] points = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    uniform token subdivisionScheme = "none"
    {values}
}}
"""
TEXTURE = """
    def Shader "image" {{
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @{file}@
        float2 inputs:st.connect = </{name}/place.outputs:result>
        float3 outputs:rgb
    }}
    def Shader "place" {{
        uniform token info:id = "UsdTransform2d"
        float2 inputs:in.connect = </{name}/reader.outputs:result>
        float2 inputs:translation = (0.5, 0)
        float2 outputs:result
    }}
    def Shader "reader" {{
        uniform token info:id = "UsdPrimvarReader_float2"
        string inputs:varname = "st"
        float2 outputs:result
    }}
"""


def write_glowing_square(folder: Path, image: str, interpolation: str) -> Path:
    """A square that emits what an image shows."""
    glow = material(
        "glow",
        "color3f inputs:emissiveColor.connect = </glow/image.outputs:rgb>",
        TEXTURE.format(file=image, name="glow"),
    )
    corners = "[(0, 0), (1, 0), (1, 1), (0, 1)]"
    values = (
        "rel material:binding = </glow>\n"
        f'texCoord2f[] primvars:st = {corners} (interpolation = "{interpolation}")'
    )
    return write(folder, SQUARE.format(values=values), glow)


def seen_from_the_front(scene: lightcull.Scene, **options: int) -> np.ndarray:
    scene.set_camera((0, 0, 2), (0, 0, 0), vertical_fov=1.0)
    return look(scene, **options)


def test_a_material_that_emits_a_texture(tmp_path: Path) -> None:
    pixels = np.zeros((16, 32, 3), np.uint8)
    pixels[:, :16, 0] = pixels[:, 16:, 1] = 255
    Image.fromarray(pixels).save(tmp_path / "halves.png")
    path = write_glowing_square(tmp_path, "halves.png", "faceVarying")
    assert "left out" not in warning_of(path)
    image = seen_from_the_front(load(path))
    # It is moved by half.
    np.testing.assert_allclose(image[8, 5], [0, 1, 0], atol=0.01)
    np.testing.assert_allclose(image[8, 10], [1, 0, 0], atol=0.01)


def test_subsets_of_a_mesh_have_materials_of_their_own(tmp_path: Path) -> None:
    mesh = """
def Mesh "two" (prepend apiSchemas = ["MaterialBindingAPI"]) {
    point3f[] points = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
    int[] faceVertexCounts = [3, 3]
    int[] faceVertexIndices = [0, 1, 2, 0, 2, 3]
    rel material:binding = </red>
    def GeomSubset "part" (prepend apiSchemas = ["MaterialBindingAPI"]) {
        uniform token elementType = "face"
        uniform token familyName = "materialBind"
        int[] indices = [1]
        rel material:binding = </blue>
    }
}
"""
    red = material("red", "color3f inputs:emissiveColor = (3, 0, 0)")
    blue = material("blue", "color3f inputs:emissiveColor = (0, 0, 5)")
    image = seen_from_the_front(load(write(tmp_path, mesh, red, blue)))
    np.testing.assert_allclose(image[10, 10], [3, 0, 0], rtol=1e-5)
    np.testing.assert_allclose(image[5, 5], [0, 0, 5], rtol=1e-5)


def test_opacity_is_a_cut_out(tmp_path: Path) -> None:
    thin = material("thin", "float inputs:opacity = 0.25\ncolor3f inputs:emissiveColor = (1, 1, 1)")
    square = SQUARE.format(values="rel material:binding = </thin>")
    assert seen_from_the_front(load(write(tmp_path, square, thin)), spp=1024)[
        7:9, 7:9
    ].mean() == pytest.approx(0.25, abs=0.03)


def test_display_colours_and_orientation(tmp_path: Path) -> None:
    values = 'color3f[] primvars:displayColor = [(0.8, 0.4, 0.2)] (interpolation = "constant")'
    image = seen_from_the_front(
        load(write(tmp_path, SQUARE.format(values=values)), environment=(1, 1, 1)),
        max_depth=2,
        spp=256,
    )
    np.testing.assert_allclose(image[5:11, 5:11].mean((0, 1)), [0.8, 0.4, 0.2], rtol=0.02)
    glow = material("glow", "color3f inputs:emissiveColor = (1, 1, 1)")
    values = 'rel material:binding = </glow>\nuniform token orientation = "leftHanded"'
    lights = load(write(tmp_path, SQUARE.format(values=values), glow)).lights()
    np.testing.assert_allclose(lights["axis"], [[0, 0, -1]] * 2, atol=1e-6)


def test_instances_and_what_is_hidden(tmp_path: Path) -> None:
    glow = material("glow", "color3f inputs:emissiveColor = (1, 1, 1)")
    instancer = """
def PointInstancer "many" {
    int[] protoIndices = [0, 0, 0]
    point3f[] positions = [(0, 0, 0), (5, 0, 0), (10, 0, 0)]
    float3[] scales = [(1, 1, 1), (2, 1, 1), (1, 1, 1)]
    rel prototypes = [</many/square>]
    SQUARE
}
def Xform "away" {
    token visibility = "invisible"
    HIDDEN
}
"""
    square = SQUARE.format(values="rel material:binding = </glow>")
    text = instancer.replace("SQUARE", square).replace("HIDDEN", square)
    lights = load(write(tmp_path, text, glow)).lights()
    np.testing.assert_allclose(lights["intensity"], [2, 2, 4, 4, 2, 2], rtol=1e-5)
    np.testing.assert_allclose(lights["center"][::2, 0].round(), [0, 5, 10], atol=1)


def test_a_mesh_light(tmp_path: Path) -> None:
    values = "float inputs:intensity = 6\nbool inputs:normalize = 1\nfloat light:dummy = 1"
    mesh = SQUARE.format(values=values).replace("MaterialBindingAPI", "MeshLightAPI")
    lights = load(write(tmp_path, mesh)).lights()
    np.testing.assert_allclose(lights["intensity"], [3, 3], rtol=1e-5)  # 6 / 4 m^2 on 2 m^2 each


def test_a_package_with_its_texture(tmp_path: Path) -> None:
    from pxr import Sdf, UsdUtils

    Image.new("RGB", (4, 4), (255, 0, 0)).save(tmp_path / "red.png")
    path = write_glowing_square(tmp_path, "red.png", "vertex")
    UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(str(path)), str(tmp_path / "a.usdz"))
    (tmp_path / "red.png").unlink()
    np.testing.assert_allclose(
        seen_from_the_front(load(tmp_path / "a.usdz"))[8, 8], [1, 0, 0], atol=1e-5
    )


def test_broken_stages_are_one_line(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    for ending, data in (
        ("usda", b""), ("usda", b"#usda 1.0\ndef Mesh {"), ("usdc", b"PXR-USDC"), ("usdz", b"PK"),
        ("usd", b"hello"), ("usda", b'#usda 1.0\ndef Xform "a" {}\n'),
    ):  # fmt: skip
        path = tmp_path / f"a.{ending}"
        path.write_bytes(data)
        with pytest.raises(lightcull.Error, match=rf"a\.{ending}: ") as caught:
            load(path)
        assert len(str(caught.value).splitlines()) == 1
    assert capfd.readouterr().err == ""
