"""OBJ and PLY as other programs write them."""

from __future__ import annotations

import struct
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import lightcull
from test_loaders import look, warning_of

CORNERS = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
UVS = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
FACE = "usemtl a\nf 1/1 2/2 3/3 4/4\n"


def load(path: Path, **options: Any) -> lightcull.Scene:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", lightcull.UnsupportedWarning)
        return lightcull.load(path, **options)


def emitted(path: Path) -> np.ndarray:
    """What the middle of a square from -1 to 1 in the plane z = 0 emits in each of its quarters: upper
    left, upper right, lower left, lower right.
    """
    scene = load(path)
    scene.set_camera((0, 0, 2), (0, 0, 0), vertical_fov=1.0)
    image = look(scene)
    return np.array([image[5, 5], image[5, 10], image[10, 5], image[10, 10]])


def quarters(path: Path) -> None:
    """Red and green in the upper row, blue and white in the lower one."""
    pixels = np.zeros((32, 32, 3), np.uint8)
    pixels[:16, :16, 0] = pixels[:16, 16:, 1] = pixels[16:, :16, 2] = 255
    pixels[16:, 16:] = 255
    Image.fromarray(pixels).save(path)


QUARTERS = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])


def obj(folder: Path, mtl: str, text: str = "mtllib a.mtl\n" + CORNERS + UVS + FACE) -> Path:
    (folder / "a.mtl").write_text(mtl)
    (folder / "a.obj").write_text(text)
    return folder / "a.obj"


@pytest.mark.parametrize(
    "map_of",
    [
        "quad.png",
        "tex\\quad.png",
        "C:\\Users\\me\\quad.png",
        "tex/QUAD.PNG",
        "-s 1.0 1.0 1.0 quad.png",
        "-s 1 1 quad.png",
        "-o 0 0 -s 1 1 1 -bm 0.5 -clamp on -mm 0 1 quad.png",
        "-imfchan r -blendu on quad.png",
        "my quad.png",
        "\tmy quad.png ",
        "-o 1 quad.png",
    ],
)
def test_maps_of_materials_by_every_name(tmp_path: Path, map_of: str) -> None:
    (tmp_path / "tex").mkdir()
    for name in ("quad.png", "my quad.png", "tex/quad.png"):
        quarters(tmp_path / name)
    path = obj(tmp_path, f"newmtl a\n  Kd 0 0 0\n\tKe 1 1 1\n map_Ke {map_of}\n")
    assert "left out" not in warning_of(path)
    np.testing.assert_allclose(emitted(path), QUARTERS, atol=0.01)


def test_maps_are_scaled_and_moved(tmp_path: Path) -> None:
    quarters(tmp_path / "quad.png")
    path = obj(tmp_path, "newmtl a\nKe 1 1 1\nmap_Ke -s 0.5 0.5 -o 0.5 0 quad.png\n")
    np.testing.assert_allclose(emitted(path), [[1, 1, 1]] * 4, atol=0.01)
    said = warning_of(obj(tmp_path, "newmtl a\nKe 1 1 1\nmap_Ke -s 2 2 quad.png\nmap_Kd quad.png\n"))
    assert "textures with other coordinates than the material's first (1)" in said


def test_comments_and_blanks_of_materials_are_not_materials(tmp_path: Path) -> None:
    mtl = "# Blender MTL File: 'None'\n# Material Count: 1\n\nnewmtl a # mine\n  Ke 1 2 3 # W\n"
    path = obj(tmp_path, mtl)
    assert "left out" not in warning_of(path)
    np.testing.assert_allclose(emitted(path), [[1, 2, 3]] * 4, rtol=1e-5)


def test_missing_maps_are_named_and_not_fatal(tmp_path: Path) -> None:
    path = obj(tmp_path, "newmtl a\nKe 1 2 3\nmap_Ke gone.png\nmap_Kd gone too.png\n")
    said = warning_of(path)
    for name in ("gone.png", "gone too.png"):
        assert f"missing file '{name}' (1)" in said
    np.testing.assert_allclose(emitted(path), [[1, 2, 3]] * 4, rtol=1e-5)


@pytest.mark.parametrize(
    "line", ["mtllib a.mtl b.mtl", "mtllib b.mtl a.mtl", "mtllib a.mtl\n  mtllib b.mtl",
             "mtllib gone.mtl a.mtl b.mtl"],
)  # fmt: skip
def test_several_libraries(tmp_path: Path, line: str) -> None:
    (tmp_path / "b.mtl").write_text("newmtl my lamp\nKe 4 5 6\n")
    uses = CORNERS + UVS + "usemtl a\nf 1/1 2/2 3/3\n usemtl my lamp\n f 1/1 3/3 4/4\n"
    path = obj(tmp_path, "newmtl a\nKe 1 2 3\n", f"{line}\n{uses}")
    said = warning_of(path)
    assert ("missing file 'gone.mtl' (1)" in said) == ("gone" in line)
    # The diagonal runs from the lower left to the upper right.
    np.testing.assert_allclose(emitted(path)[[0, 3]], [[4, 5, 6], [1, 2, 3]], rtol=1e-5)


def test_a_library_with_blanks_in_its_name(tmp_path: Path) -> None:
    (tmp_path / "my room.mtl").write_text("newmtl a\nKe 1 2 3\n")
    text = "mtllib my room.mtl\n" + CORNERS + UVS + FACE
    np.testing.assert_allclose(emitted(obj(tmp_path, "", text)), [[1, 2, 3]] * 4, rtol=1e-5)


def test_materials_that_no_library_has_are_named(tmp_path: Path) -> None:
    said = warning_of(obj(tmp_path, "newmtl A\nKd 1 0 0\n"))
    assert "material 'a', which no MTL file has (1)" in said


def test_without_materials_all_is_grey_with_texture_coordinates_or_not(tmp_path: Path) -> None:
    digests = set()
    for text in (CORNERS + "f 1 2 3 4\n", CORNERS + UVS + "f 1/1 2/2 3/3 4/4\n"):
        scene = load(obj(tmp_path, "", text), environment=(1, 1, 1))
        scene.set_camera((0, 0, 2), (0, 0, 0), vertical_fov=1.0)
        image = look(scene, max_depth=2, spp=256)
        assert image[5:11, 5:11].mean() == pytest.approx(0.5, rel=0.02)
        assert scene.counts["textures"] == 0
        digests.add(image.tobytes())
    assert len(digests) == 1


def test_lines_that_are_indented_or_continued(tmp_path: Path) -> None:
    text = "  " + CORNERS.replace("\n", "\n\t") + "usemtl\ta\r\n  f 1 \\\n 2 \\\r\n 3 -1\n"
    np.testing.assert_allclose(
        emitted(obj(tmp_path, "newmtl a\nKe 1 1 1\n", "mtllib a.mtl\n" + text)), 1, rtol=1e-5
    )


def test_colours_of_vertices_of_an_obj(tmp_path: Path) -> None:
    text = CORNERS.replace(" 0\n", " 0 0.8 0.4 0.2\n") + "f 1 2 3 4\n"
    path = obj(tmp_path, "", text)
    assert "left out" not in warning_of(path)
    scene = load(path, environment=(1, 1, 1))
    scene.set_camera((0, 0, 2), (0, 0, 0), vertical_fov=1.0)
    color = look(scene, max_depth=2, spp=128)[5:11, 5:11].mean((0, 1))
    np.testing.assert_allclose(color, [0.8, 0.4, 0.2], rtol=0.02)


def test_faces_without_their_vertices(tmp_path: Path) -> None:
    for face in ("f 1 2 9\n", "f -9 1 2\n", "f 1 2 3 9\n", "f 0 1 2\n", "f a b c\n"):
        with pytest.raises(lightcull.Error, match=r"a\.obj: ") as caught:
            load(obj(tmp_path, "", CORNERS + face))
        assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize(
    ("statements", "left", "right"),
    [
        ("d 0.5", 0.5, 0.5),
        ("Tr 0.75", 0.25, 0.25),
        ("map_d mask.png", 0.2, 0.8),
        ("d 0.5\nmap_d mask.png", 0.1, 0.4),
        ("map_d alpha.png", 0.2, 0.8),
    ],
)
def test_opacity_of_materials(tmp_path: Path, statements: str, left: float, right: float) -> None:
    mask = np.zeros((16, 32), np.uint8)
    mask[:, :16], mask[:, 16:] = 51, 204
    Image.fromarray(mask).save(tmp_path / "mask.png")
    Image.fromarray(np.dstack([mask * 0, mask])).save(tmp_path / "alpha.png")
    scene = load(obj(tmp_path, f"newmtl a\nKd 0 0 0\nKe 1 1 1\n{statements}\n"))
    scene.set_camera((0, 0, 2), (0, 0, 0), vertical_fov=1.0)
    image = look(scene, spp=1024)
    # 4096 samples: a standard deviation of 0.008.
    assert image[7:9, 4:6].mean() == pytest.approx(left, abs=0.03)
    assert image[7:9, 10:12].mean() == pytest.approx(right, abs=0.03)


# ---- PLY -----------------------------------------------------------------------------------------

HEADER = """\
ply
format {format} 1.0
comment made by a test
element vertex 5
property float x
property float y
property float z
"""
POINTS = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (0, 0, 1)]
FACES = [(0, 1, 2, 3), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]


def ply(path: Path, form: str, faces: str, rows: list[tuple], code: str, extra: str = "") -> Path:
    """A file of five points; rows: of what `faces` declares, each a list by `code`: the type of its
    length and that of its elements.
    """
    header = HEADER.format(format=form) + extra + faces + "end_header\n"
    if form == "ascii":
        lines = [" ".join(map(str, p)) for p in POINTS]
        lines += [" ".join(map(str, (len(row), *row))) for row in rows]
        path.write_text(header + "\n".join(lines) + "\n")
        return path
    order = "<" if form == "binary_little_endian" else ">"
    data = b"".join(struct.pack(f"{order}3f", *p) for p in POINTS)
    for row in rows:
        data += struct.pack(f"{order}{code[0]}{len(row)}{code[1]}", len(row), *row)
    path.write_bytes(header.encode() + data)
    return path


FORMATS = ("ascii", "binary_little_endian", "binary_big_endian")


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize("names", ["uchar int vertex_indices", "int uint vertex_index"])
def test_ply_of_mixed_polygons(tmp_path: Path, form: str, names: str) -> None:
    code = "Bi" if names.startswith("uchar") else "iI"
    faces = f"element face 5\nproperty list {names}\n"
    scene = load(ply(tmp_path / "a.ply", form, faces, FACES, code))
    assert scene.triangle_count == 6
    np.testing.assert_array_equal(scene.bounds, [[-1, -1, 0], [1, 1, 1]])


@pytest.mark.parametrize("form", FORMATS)
def test_ply_of_strips(tmp_path: Path, form: str) -> None:
    strips = "element tristrips 1\nproperty list int int vertex_indices\n"
    # Two strips, parted by -1; the second goes on over a corner that it repeats.
    row = (0, 1, 3, 2, -1, 0, 1, 4, 4, 2)
    scene = load(ply(tmp_path / "a.ply", form, strips, [row], "ii"))
    assert scene.triangle_count == 3


@pytest.mark.parametrize("form", FORMATS)
def test_ply_that_lacks_or_breaks_faces(tmp_path: Path, form: str) -> None:
    faces = "element face 6\nproperty list uchar int vertex_indices\n"
    with pytest.raises(lightcull.Error, match="promises 6 rows of 'face', and there are fewer"):
        load(ply(tmp_path / "a.ply", form, faces, FACES, "Bi"))
    faces = faces.replace("6", "1")
    for row in ((0, 1, 9), (0, 1, -1)):
        with pytest.raises(lightcull.Error, match="vertex (9|-1)"):
            load(ply(tmp_path / "a.ply", form, faces, [row], "Bi"))


def test_ply_with_colours_normals_and_a_texture(tmp_path: Path) -> None:
    quarters(tmp_path / "quad.png")
    extra = "".join(f"property float {name}\n" for name in ("nx", "ny", "nz", "s", "t"))
    extra += "".join(f"property uchar {name}\n" for name in ("red", "green", "blue", "alpha"))
    header = HEADER.format(format="ascii").replace("vertex 5", "vertex 4")
    header = header.replace("made by a test", "TextureFile quad.png") + extra
    rows = "".join(
        f"{x} {y} 0 0 0 1 {(x + 1) / 2} {(y + 1) / 2} 188 188 188 255\n" for x, y, _ in POINTS[:4]
    )
    face = "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    path = tmp_path / "a.ply"
    path.write_text(header + face + rows + "4 0 1 2 3\n")
    assert "left out" not in warning_of(path)
    scene = load(path, environment=(1, 1, 1))
    scene.set_camera((0, 0, 2), (0, 0, 0), vertical_fov=1.0)
    image = look(scene, max_depth=2, spp=256)
    # 188 of sRGB is 0.503.
    np.testing.assert_allclose(image[4:6, 4:6].mean((0, 1)), [0.503, 0, 0], atol=0.03)
    np.testing.assert_allclose(image[4:6, 10:12].mean((0, 1)), [0, 0.503, 0], atol=0.03)


def test_properties_of_a_ply_that_are_not_read_are_named(tmp_path: Path) -> None:
    header = HEADER.format(format="ascii").replace("vertex 5", "vertex 3")
    path = tmp_path / "a.ply"
    path.write_text(
        header + "property float confidence\nelement face 1\nproperty list uchar int vertex_indices\n"
        "property uchar red\nend_header\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2 255\n"
    )
    said = warning_of(path)
    assert "properties of vertices: confidence (1)" in said
    assert "colours of faces (1)" in said
