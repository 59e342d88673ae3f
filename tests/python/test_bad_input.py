"""What makes no sense is one line that names the thing, and leaves nothing behind."""

from __future__ import annotations

import os
import struct
import subprocess
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import lightcull
from conftest import QUAD, Outcome, make_room, square
from gltf_file import GltfFile

Run = Callable[..., Outcome]
NAN, INF = float("nan"), float("inf")
FLOOR = square(1, 0, facing_up=True)
POINT = np.ones((1, 3), np.float32)
ONE = np.ones(1, np.float32)
TINY = ("--size", "8x8", "--spp", "1")


def sampler(description: str = "culled:sets=64") -> lightcull.LightSampler:
    return lightcull.LightSampler(lightcull.point_lights(0 * POINT, ONE), description)


def selection(**fields: float) -> np.ndarray:
    chosen = sampler().select(POINT, None, 0 * ONE)
    for name, value in fields.items():
        chosen[name] = value
    return chosen


def light(**fields: object) -> np.ndarray:
    lights = lightcull.point_lights(0 * POINT, ONE)
    for name, value in fields.items():
        lights[name] = value
    return lights


def mesh(**changes: object) -> None:
    lightcull.Scene().add_mesh(**{"positions": FLOOR, "indices": QUAD, **changes})


def render(**options: object) -> None:
    lightcull.render(make_room(), **{"spp": 1, "size": (8, 8), **options})


def compare(samplers: object) -> None:
    lightcull.compare(make_room(), samplers, spp=1, size=(8, 8))


def moved(value: float) -> np.ndarray:
    positions = FLOOR.copy()
    positions[1, 2] = value
    return positions


BAD_NUMBERS: list[tuple[Callable[[float], object], str]] = [
    (lambda x: mesh(positions=moved(x)), "positions[1]"),
    (lambda x: mesh(normals=moved(x)), "normals[1]"),
    (lambda x: mesh(uvs=np.ascontiguousarray(moved(x)[:, 1:])), "uvs[1]"),
    (lambda x: lightcull.Scene().add_point_light((x, 0, 0), (1, 1, 1)), "position"),
    (lambda x: lightcull.Scene().add_point_light((0, 0, 0), (1, x, 1)), "intensity"),
    (lambda x: lightcull.Scene().add_spot_light((0, x, 0), (0, 1, 0), (1, 1, 1), 0, 1), "position"),
    (lambda x: lightcull.Scene().add_spot_light((0, 0, 0), (0, x, 0), (1, 1, 1), 0, 1), "direction"),
    (lambda x: lightcull.Scene().add_spot_light((0, 0, 0), (0, 1, 0), (1, 1, 1), x, 1), "inner"),
    (lambda x: lightcull.Scene().add_spot_light((0, 0, 0), (0, 1, 0), (1, 1, 1), 0, x), "outer"),
    (lambda x: lightcull.Scene().set_camera((x, 0, 0), (0, 0, 0)), "camera: origin"),
    (lambda x: lightcull.Scene().set_camera((1, 0, 0), (0, 0, x)), "camera: target"),
    (lambda x: lightcull.Scene().set_camera((1, 0, 0), (0, 0, 0), (0, x, 0)), "camera: up"),
    (lambda x: lightcull.Scene().set_camera((1, 0, 0), (0, 0, 0), vertical_fov=x), "vertical_fov"),
    (lambda x: lightcull.Scene().set_camera((1, 0, 0), (0, 0, 0), aperture_radius=x), "aperture"),
    (lambda x: lightcull.Scene().set_camera((1, 0, 0), (0, 0, 0), focus_distance=x), "focus_dist"),
    (lambda x: lightcull.Scene().set_environment((x, 0, 0)), "environment: map"),
    (lambda x: lightcull.Scene().set_environment((1, 1, 1), scale=x), "environment: scale"),
    (lambda x: lightcull.Scene().set_environment((1, 1, 1), rotation=x), "environment: rotation"),
    (lambda x: lightcull.Scene().add_material(base_color=(0, x, 0)), "base_color.y"),
    (lambda x: lightcull.Scene().add_material(metallic=x), "metallic"),
    (lambda x: lightcull.Scene().add_material(roughness=x), "roughness"),
    (lambda x: lightcull.Scene().add_texture(np.full((2, 2, 3), x, np.float32)), "texels[0]"),
    (lambda x: lightcull.Scene().add_light_mesh(FLOOR, QUAD, radiance=(1, x, 1)), "radiance"),
    (lambda x: lightcull.LightSampler(light(center=(x, 0, 0))), "light 0: center"),
    (lambda x: lightcull.LightSampler(light(radius=x)), "light 0: radius"),
    (lambda x: lightcull.LightSampler(light(intensity=x)), "light 0: intensity"),
    (lambda x: lightcull.LightSampler(light(cos_theta_o=x)), "light 0: cos_theta_o"),
    (lambda x: lightcull.LightSampler(light(cos_theta_e=x)), "light 0: cos_theta_e"),
    (lambda x: lightcull.LightSampler(light(cos_theta_o=0, axis=(0, x, 0))), "light 0: axis"),
    (lambda x: sampler().select(x * POINT, None, 0 * ONE), "positions[0]"),
    (lambda x: sampler().select(POINT, x * POINT, 0 * ONE), "normals[0]"),
    (lambda x: sampler().select(POINT, None, x * ONE), "u[0]"),
    (lambda x: sampler().count(x * POINT, None), "positions[0]"),
    (lambda x: sampler().vertex_prob(POINT, None, selection(), x * POINT), "vertices[0]"),
    (lambda x: sampler().prob(POINT, None, selection(weight_sum=x), np.zeros(1, np.uint32)), "sum"),
    (lambda x: sampler(f"culled:accepted={x}"), "accepted"),
    (lambda x: sampler(f"culled:error_bound={x}"), "error_bound"),
    (lambda x: sampler(f"culled:exposure={x}"), "exposure"),
    (lambda x: lightcull.apply_view(np.ones((2, 2, 3), np.float32), exposure=x), "exposure"),
]


@pytest.mark.parametrize("value", [NAN, INF, -INF])
@pytest.mark.parametrize(("call", "name"), BAD_NUMBERS)
def test_what_is_not_finite_is_named(
    call: Callable[[float], object], name: str, value: float
) -> None:
    with pytest.raises(lightcull.Error) as caught:
        call(value)
    assert name in only_line(str(caught.value))


def only_line(text: str) -> str:
    assert len(text.splitlines()) == 1, text
    return text


@pytest.mark.parametrize(
    ("call", "kind", "message"),
    [
        (lambda: light_mesh((-1, 1, 1)), lightcull.Error, "radiance is negative"),
        (
            lambda: lightcull.Scene().add_point_light((0, 0, 0), (-1, 0, 0)),
            lightcull.Error,
            "intensity is negative",
        ),
        (
            lambda: lightcull.Scene().add_point_light((1e16, 0, 0), (1, 0, 0)),
            lightcull.Error,
            "position is above 1e15",
        ),
        (
            lambda: lightcull.Scene().set_camera((1e16, 0, 0), (0, 0, 0)),
            lightcull.Error,
            "camera: origin is above 1e15",
        ),
        (lambda: lightcull.LightSampler(light(intensity=-1)), lightcull.Error, "intensity is -1"),
        (
            lambda: sampler().select(POINT, None, 0 * ONE, np.array([64], np.uint32)),
            lightcull.Error,
            "sets[0]: not below set_count = 64",
        ),
        (
            lambda: sampler().prob(POINT, None, selection(), np.array([1], np.uint32)),
            lightcull.Error,
            "lights[0]: there are 1 lights",
        ),
        (
            lambda: sampler().prob(POINT, None, selection(key=64), np.zeros(1, np.uint32)),
            lightcull.Error,
            "selections[0]: the key",
        ),
        (
            lambda: sampler().prob(POINT, None, selection(light=2**31), np.zeros(1, np.uint32)),
            lightcull.Error,
            "selections[0]: the light",
        ),
        (lambda: sampler().select(POINT, None, ONE), lightcull.Error, "u[0]: not in [0, 1)"),
        (lambda: sampler().begin_pass(-1), lightcull.Error, "number: wanted a whole number"),
        (lambda: sampler().begin_pass(2**64), lightcull.Error, "number: wanted at most 18446744"),
        (lambda: sampler(3), TypeError, "description: wanted a string, got 3"),
        (lambda: mesh(indices=np.uint32([[0, 1, 2**31]])), lightcull.Error, "indices[2] is 2147"),
        (lambda: mesh(material=7), lightcull.Error, "material is 7, but there are 0 materials"),
        (lambda: mesh(material=-1), lightcull.Error, "material: wanted a whole number from 0 up"),
        (lambda: mesh(name=3), TypeError, "name: wanted a string, got 3"),
        (
            lambda: lightcull.Scene().add_material(base_color_texture="wood"),
            lightcull.Error,
            "base_color_texture: wanted a whole number from 0 up, got 'wood'",
        ),
        (
            lambda: lightcull.Scene().add_material(base_color_texture=2**32 - 1),
            lightcull.Error,
            "base_color_texture: wanted at most 4294967294, got 4294967295",
        ),
        (lambda: lightcull.Scene().add_material(roughness="a"), TypeError, "roughness: wanted a nu"),
        (lambda: lightcull.Scene().add_texture(None), TypeError, "texture: wanted a path, got None"),
        (lambda: lightcull.Scene().add_texture(""), lightcull.Error, "'': cannot read: no name of"),
        (
            lambda: lightcull.Scene().set_environment((1e30, 1, 1), scale=1e30),
            lightcull.Error,
            "environment: map times scale is not finite",
        ),
        (
            lambda: lightcull.Scene().set_environment((1e300, 1, 1)),
            lightcull.Error,
            "environment: map: texels[0] is not finite",
        ),
        (lambda: lightcull.open_scene(""), lightcull.Error, "'' is neither a file nor an example"),
        (lambda: lightcull.Scene().add_texture("a\0b"), lightcull.Error, "no name of a file"),
        (lambda: render(size=(8,)), lightcull.Error, "size: wanted (width, height), got (8,)"),
        (lambda: render(size=8), lightcull.Error, "size: wanted (width, height), got 8"),
        (lambda: render(size=(2**31, 1)), lightcull.Error, "width: wanted at most 65535"),
        (lambda: render(size=(65535, 65535)), lightcull.Error, "needs 240.0 GiB of memory, and"),
        (lambda: render(seed=2**64), lightcull.Error, "seed: wanted at most"),
        (lambda: render(max_depth=2**32), lightcull.Error, "max_depth: wanted at most"),
        (lambda: render(threads=2**31), lightcull.Error, "threads is above 65535"),
        (lambda: render(threads=-1), lightcull.Error, "threads: wanted a whole number from 0"),
        (lambda: render(spp=1.5), lightcull.Error, "spp: wanted a whole number from 0 up, got 1.5"),
        (lambda: render(spp=None, seconds="a"), TypeError, "seconds: wanted a number, got 'a'"),
        (lambda: render(sampler=3), TypeError, "sampler: wanted a string, got 3"),
        (lambda: lightcull.render(None, spp=1), TypeError, "scene: wanted a lightcull.Scene"),
        (lambda: lightcull.load("a\0.glb"), lightcull.Error, "no name of a file"),
        (lambda: lightcull.load(None), TypeError, "path: wanted a path, got None"),
        (lambda: lightcull.load(b"\xff.glb"), lightcull.Error, r"path: '\udcff.glb' is not UTF-8"),
        (lambda: lightcull.Scene().add_texture("/dev/zero"), lightcull.Error, "read: not a file"),
        (lambda: render(resume="/dev/zero", checkpoint="a"), lightcull.Error, "it is not a file"),
        (lambda: lightcull.example_scene(3), TypeError, "name: wanted a string, got 3"),
        (lambda: lightcull.compare(None, ["culled"], spp=1), TypeError, "scene: wanted a lightc"),
        (lambda: compare("culled"), TypeError, "samplers: wanted several, got 'culled'"),
        (lambda: compare([3]), TypeError, "sampler: wanted a string, got 3"),
        (lambda: compare([]), lightcull.Error, "samplers: wanted one at least"),
        (
            lambda: lightcull.LightSampler(light(), calibration=POINT),
            TypeError,
            "calibration: wanted positions and normals, got ndarray",
        ),
        (
            lambda: lightcull.render(make_room(), spp=1, size=(8, 8)).save("a.exr", "aces"),
            lightcull.Error,
            "a.exr: a view and exposure are for a .png",
        ),
        (lambda: lightcull.Scene(3), TypeError, "name: wanted a string, got 3"),
        (lambda: lightcull.Scene("\ud800"), lightcull.Error, r"name: '\ud800' is not UTF-8"),
        (lambda: mesh(name="\ud800"), lightcull.Error, r"name: '\ud800' is not UTF-8"),
        (
            lambda: lightcull.write_exr("a.exr", np.ones((1, 1, 3), np.float32), metadata={"a": 1}),
            TypeError,
            "metadata: a: wanted a string, got 1",
        ),
        (
            lambda: lightcull.write_exr("a\0.exr", np.ones((1, 1, 3), np.float32)),
            lightcull.Error,
            "no name of a file",
        ),
        (
            lambda: lightcull.write_exr("a.exr", np.ones((0, 1, 3), np.float32)),
            lightcull.Error,
            "a.exr: cannot write: an image of 1 x 0",
        ),
        (
            lambda: lightcull.apply_view(np.broadcast_to(np.float64(1), (2**16, 2**16, 4))),
            TypeError,
            "wanted an array of shape (N, M, 3)",
        ),
    ],
)
def test_one_exception_of_one_line(
    call: Callable[[], object],
    kind: type[Exception],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(kind) as caught:
        call()
    assert message in only_line(str(caught.value))
    assert not list(tmp_path.iterdir())


def light_mesh(radiance: tuple[float, float, float]) -> None:
    lightcull.Scene().add_light_mesh(FLOOR, QUAD, radiance=radiance)


def test_nothing_is_fine() -> None:
    """Empty arrays are no error: no light is chosen, and there is nothing to choose for."""
    none = lightcull.LightSampler(lightcull.point_lights(POINT[:0], ONE[:0]), "culled")
    assert none.select(POINT, None, 0 * ONE)["prob"] == 0
    assert len(sampler().select(POINT[:0], None, ONE[:0])) == 0
    mesh(positions=FLOOR[:0], indices=QUAD[:0])


def test_more_threads_than_there_are() -> None:
    render(threads=65535)


def test_an_image_that_is_black_says_so() -> None:
    with pytest.warns(UserWarning, match="scene: the image is black: no light is seen"):
        lightcull.render(lightcull.Scene(), spp=1, size=(8, 8))


@pytest.mark.parametrize(
    "arguments",
    [
        ("--threads", "-1"),
        ("--threads", "4294967296"),
        ("--threads", "65536"),
        ("--seconds", "-1"),
        ("--seconds", "nan"),
        ("--size", "65536x1"),
        ("--size", "65535x65535"),
        ("--size", "\u0663x4"),
        ("--seed", "18446744073709551616"),
        ("--max-depth", "4294967296"),
        ("--exposure", "nan"),
        ("--every", "0"),
        ("--every", "5"),
        ("--variant", "scalar_rgb"),
        ("--sampler", ""),
        ("--sampler", "cul\nled"),
        ("--method", "vpl\nall"),
        ("--resume", "no\nfile"),
        ("--view", "sepia", "-o", "a.png"),
        ("-o", ""),
        ("-o", "."),
        ("-o", "/proc/a.exr"),
        ("-o", "/dev/full"),
        ("--checkpoint", "/proc/a"),
        ("--checkpoint", "there"),
        ("--checkpoint", ""),
        ("--checkpoint", "new/"),
        ("--checkpoint", "a.exr", "-o", "a.exr"),
        ("-o", f"{'a' * 240}.exr"),
        ("-o", f"new/{'a' * 300}/a.exr"),
        ("-o", f"{'new/' * 1500}a.exr"),
        ("-o", "\udcff.exr"),
        ("--checkpoint", "a" * 240),
        ("--checkpoint", "\udcff"),
        ("--resume", "missing"),
        ("--resume", "there"),
    ],
)
def test_command_line(main_here: Run, tmp_path: Path, arguments: tuple[str, ...]) -> None:
    (tmp_path / "there").write_text("mine")
    before = () if arguments[0] in ("--size", "--seconds") else ("--size", "8x8", "--seconds", "9")
    result = main_here("render", "cornell", *before, *arguments)
    assert result.returncode in (1, 2)
    assert "error: " in only_line(result.stderr)
    assert not result.stdout
    assert [path.name for path in tmp_path.iterdir()] == ["there"]
    assert (tmp_path / "there").read_text() == "mine"


def test_no_folder_is_made_for_a_render_that_never_was(main_here: Run, tmp_path: Path) -> None:
    assert main_here("render", "cornel", *TINY, "-o", "new/a.exr").returncode == 1
    assert main_here("compare", "cornel", *TINY, "-o", "new").returncode == 1
    assert not list(tmp_path.iterdir())


def test_a_broken_configuration_of_views_is_found_first(
    main_here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OCIO", "missing.ocio")
    result = main_here("render", "cornell", "--seconds", "9", "-o", "a.png")
    assert result.returncode == 1
    assert "$OCIO, missing.ocio" in only_line(result.stderr)
    assert not list(tmp_path.iterdir())


# ---- files ---------------------------------------------------------------------------------------


def whole_gltf() -> GltfFile:
    file = GltfFile()
    noise = np.random.default_rng(1).integers(0, 256, (48, 48, 3), np.uint8)
    texture = file.texture(noise)
    factors = {"baseColorTexture": texture, "metallicRoughnessTexture": texture}
    material = file.add("materials", {"pbrMetallicRoughness": factors, "emissiveTexture": texture})
    file.node(mesh=file.quad(material))
    file.node(extensions=file.light(type="point"))
    file.camera(translation=[0, 0, 5])
    return file


def test_a_glb_cut_anywhere(tmp_path: Path) -> None:
    whole = whole_gltf().write(tmp_path / "whole.glb").read_bytes()
    lightcull.load(tmp_path / "whole.glb")
    cut = tmp_path / "cut.glb"
    for length in [*range(0, 64), *range(64, len(whole), 1024), len(whole) - 1]:
        cut.write_bytes(whole[:length])
        with pytest.raises(lightcull.Error, match=r"cut\.glb: ") as caught:
            lightcull.load(cut)
        only_line(str(caught.value))


def test_a_glb_with_any_byte_of_its_json_changed(tmp_path: Path) -> None:
    whole = whole_gltf().write(tmp_path / "whole.glb").read_bytes()
    (length,) = struct.unpack_from("<I", whole, 12)
    changed = tmp_path / "changed.glb"
    for place in range(20, 20 + length, 3):
        changed.write_bytes(whole[:place] + b"9" + whole[place + 1 :])
        try_to_load(changed)


def try_to_load(path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            lightcull.load(path)
        except lightcull.Error as error:
            only_line(str(error))


@pytest.mark.parametrize("ending", ["glb", "gltf", "obj", "ply"])
def test_files_that_are_something_else(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"a.{ending}"
    random = np.random.default_rng(2)
    for data in (b"", b"\0" * 100, random.bytes(5000), b"{}", b"[" * 100_000, "é".encode("latin-1")):
        path.write_bytes(data)
        with pytest.raises(lightcull.Error, match=rf"a\.{ending}: ") as caught:
            lightcull.load(path)
        only_line(str(caught.value))
    path.unlink()
    os.mkfifo(path)
    with pytest.raises(lightcull.Error, match="is not a file"):
        lightcull.load(path)
    path.unlink()
    path.mkdir()
    with pytest.raises(lightcull.Error, match="is a folder"):
        lightcull.load(path)


@pytest.mark.parametrize("ending", ["png", "exr"])
def test_textures_that_are_missing_cut_or_no_images(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"a.{ending}"
    with pytest.raises(lightcull.Error, match=rf"a\.{ending}: cannot read: "):
        lightcull.Scene().add_texture(path)
    pixels = np.random.default_rng(3).random((64, 64, 3), np.float32)
    (lightcull.write_png if ending == "png" else lightcull.write_exr)(path, pixels)
    whole = path.read_bytes()
    for data in (b"", b"no image", whole[: len(whole) // 2], whole[:10]):
        path.write_bytes(data)
        with pytest.raises(lightcull.Error, match=rf"a\.{ending}: cannot read: ") as caught:
            lightcull.Scene().add_texture(path)
        only_line(str(caught.value))


def test_other_files_that_a_file_names(tmp_path: Path) -> None:
    """They are left out, and named."""
    (tmp_path / "none.png").write_bytes(b"no image")
    os.mkfifo(tmp_path / "pipe.png")
    lightcull.write_png(tmp_path / "cut.png", np.random.default_rng(4).random((64, 64, 3), np.float32))
    whole = (tmp_path / "cut.png").read_bytes()
    (tmp_path / "cut.png").write_bytes(whole[: len(whole) // 2])
    for image, message in (
        ("gone.png", "missing file 'gone.png'"),
        ("none.png", "image 'none.png' that cannot be read"),
        ("pipe.png", "missing file 'pipe.png'"),
        ("../gone.png", "missing file '../gone.png'"),
        ("cut.png", "image 'cut.png' that cannot be read"),
    ):
        for path in (obj_with(tmp_path, image), ply_with(tmp_path, image)):
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                with pytest.raises(lightcull.UnsupportedWarning, match=message):
                    lightcull.load(path)


def obj_with(folder: Path, image: str) -> Path:
    (folder / "a.mtl").write_text(f"newmtl m\nmap_Kd {image}\n")
    faces = "vt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n"
    (folder / "a.obj").write_text(f"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}")
    return folder / "a.obj"


def ply_with(folder: Path, image: str) -> Path:
    corner = "".join(f"property float {name}\n" for name in ("x", "y", "z", "s", "t"))
    (folder / "a.ply").write_text(
        f"ply\nformat ascii 1.0\ncomment TextureFile {image}\nelement vertex 3\n{corner}"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n"
    )
    return folder / "a.ply"


@pytest.mark.parametrize("vertices", [5, 2**31])
@pytest.mark.parametrize("binary", [False, True])
def test_a_ply_that_promises_more_than_it_has(tmp_path: Path, vertices: int, binary: bool) -> None:
    path = tmp_path / "a.ply"
    corners = "".join(f"property float {name}\n" for name in "xyz")
    faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    kind = "binary_little_endian" if binary else "ascii"

    def write(vertices: int) -> None:
        header = f"ply\nformat {kind} 1.0\nelement vertex {vertices}\n{corners}{faces}".encode()
        packed = struct.pack("<9fB3i", 0, 0, 0, 1, 0, 0, 0, 1, 0, 3, 0, 1, 2)
        path.write_bytes(header + (packed if binary else b"0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n\n"))

    write(3)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert lightcull.load(path).triangle_count == 1
    write(vertices)
    said = "promises (5|2147483648) rows of 'vertex', and there are fewer"
    with pytest.raises(lightcull.Error, match=f"a.ply: cannot be read: .*{said}"):
        lightcull.load(path)


def test_what_a_library_says_of_a_file_is_not_printed(
    command: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path
) -> None:
    ply_with(tmp_path, "gone.png")
    result = command("render", "a.ply", *TINY)
    assert result.returncode == 0
    assert "missing file 'gone.png'" in result.stderr.splitlines()[0]
    assert "Traceback" not in result.stderr


# ---- a disk that fills up ------------------------------------------------------------------------

FULL_DISK = """
import resource, sys
from lightcull.cli import main
resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))  # Python ignores SIGXFSZ
sys.exit(main())
"""


@pytest.mark.parametrize("ending", ["exr", "png"])
def test_a_disk_that_fills_up(
    command: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path, ending: str
) -> None:
    output = tmp_path / f"a.{ending}"
    output.write_bytes(b"before")
    result = command(
        "render", "cornell", "--size", "64x48", "--spp", "1", "-o", output.name,
        program=("-c", FULL_DISK.format(limit=1000)),
    )  # fmt: skip
    assert result.returncode == 1
    assert result.stderr.splitlines()[-1] == (
        f"lightcull: error: a.{ending}: cannot write: File too large"
    )
    assert [path.name for path in tmp_path.iterdir()] == [output.name]
    assert output.read_bytes() == b"before"


def test_a_report_on_a_disk_that_fills_up(
    command: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path
) -> None:
    """Every file of it is whole."""
    result = command(
        "compare", "cornell", "--samplers", "uniform", "--size", "64x48", "--spp", "1", "-o", "r",
        program=("-c", FULL_DISK.format(limit=30_000)),
    )  # fmt: skip
    assert result.returncode == 1
    assert result.stderr.splitlines()[-1].endswith("cannot write: File too large")
    assert not (tmp_path / "r" / "index.html").exists()
    for path in (tmp_path / "r").iterdir():
        assert path.suffix in (".png", ".exr")
        lightcull.read_image(path)
