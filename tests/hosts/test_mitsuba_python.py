"""What goes with the plugin: merging emitters, the import of scenes, the command line."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed")

import lightcull  # noqa: E402
import lightcull.mitsuba  # noqa: E402
import mitsuba_scenes as scenes  # noqa: E402
from lightcull.loaders.unsupported import UnsupportedWarning  # noqa: E402
from lightcull.rendering.settings import RenderSettings  # noqa: E402

ROOT = Path(__file__).parents[2]

SCENE_XML = """
<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="2"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="45"/>
    <transform name="to_world">
      <lookat origin="0, 2.5, 7" target="0, 0.8, 0" up="0, 1, 0"/>
    </transform>
    <film type="hdrfilm">
      <integer name="width" value="32"/><integer name="height" value="24"/>
    </film>
  </sensor>
  <shape type="rectangle">
    <transform name="to_world"><rotate x="1" angle="-90"/><scale value="5"/></transform>
  </shape>
  <shape type="rectangle">
    <transform name="to_world">
      <scale value="0.3"/><rotate x="1" angle="90"/><translate y="3"/>
    </transform>
    <emitter type="area"><rgb name="radiance" value="9, 8, 7"/></emitter>
  </shape>
</scene>
"""


def render(scene: Any, spp: int = 512, **options: Any) -> np.ndarray:
    integrator = mi.load_dict({"type": "lightcull_path", "max_depth": 3, **options})
    return np.array(mi.render(mi.load_dict(scene), integrator=integrator, spp=spp))[..., :3]


def bulbs(colors: int) -> scenes.SceneDict:
    """Small emitters of all shapes that can be merged, some of them mirrored or flipped."""
    random = np.random.default_rng(2)
    palette = random.uniform(5, 40, (colors, 3)).tolist()
    scene = scenes.stage()
    for i in range(120):
        place = [float(x) for x in random.uniform((-2, 0.5, -2), (2, 3, 2))]
        size = [-0.06, 0.08, 0.06] if i % 2 else [0.06, 0.08, 0.06]
        turn = scenes.transform().translate(place).rotate([1, 0.5, 0], 40 * i).scale(size)
        scene[f"bulb{i}"] = {
            "type": ("rectangle", "cube")[i // 2 % 2],
            "to_world": turn,
            "flip_normals": i % 5 == 0,
            "emitter": scenes.area(*palette[i % colors]),
        }
    return scene


@pytest.mark.parametrize(("colors", "most_shapes"), [(5, 13), (40, 5)])
def test_merged_emitters_give_the_same_light(colors: int, most_shapes: int) -> None:
    mi.set_variant("scalar_rgb")
    scene = bulbs(colors)
    merged = lightcull.mitsuba.merge_emitters(scene)
    shapes = len(mi.load_dict(merged).shapes())
    assert shapes - 3 <= most_shapes
    apart, together = render(scene), render(merged)
    assert np.allclose(apart.mean(axis=(0, 1)), together.mean(axis=(0, 1)), rtol=0.02)
    assert np.abs(apart - together).mean() < 0.1 * apart.mean()


def test_what_cannot_be_merged_stays() -> None:
    mi.set_variant("scalar_rgb")
    scene = scenes.round_lamps() | scenes.textured_lamps()
    with pytest.warns(UnsupportedWarning) as said:
        merged = lightcull.mitsuba.merge_emitters(scene)
    (text,) = (str(warning.message) for warning in said)
    for reason in ("sphere: no mesh", "disk: no mesh", "cylinder: no mesh", "no constant radiance"):
        assert f"1 ({reason})" in text
    assert merged["globe"] is scene["globe"]
    assert merged["screen"] is scene["screen"]
    assert "cube" not in merged


def test_nothing_is_said_where_all_is_merged(recwarn: pytest.WarningsRecorder) -> None:
    mi.set_variant("scalar_rgb")
    lightcull.mitsuba.merge_emitters(scenes.stage() | scenes.lamps(3))
    assert not recwarn.list


@pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"])
def test_path_is_refused_where_radiances_are_an_attribute(variant: str) -> None:
    mi.set_variant(variant)
    loaded = mi.load_dict(lightcull.mitsuba.merge_emitters(bulbs(40)))
    scene = lightcull.mitsuba.MitsubaScene(loaded)
    with pytest.raises(lightcull.Error, match="'merged_emitters_0.*before merge_emitters"):
        scene.check_sampler("path")
    scene.check_sampler("learned")
    lightcull.mitsuba.MitsubaScene(mi.load_dict(bulbs(5))).check_sampler("path")


def test_many_spectral_radiances_stay_exact() -> None:
    """One mesh for each, where no attribute can hold them."""
    mi.set_variant("scalar_spectral")
    scene = bulbs(20)
    merged = lightcull.mitsuba.merge_emitters(scene)
    assert 20 <= len(mi.load_dict(merged).emitters()) <= 40
    apart, together = render(scene), render(merged)
    assert np.allclose(apart.mean(axis=(0, 1)), together.mean(axis=(0, 1)), rtol=0.02)


def test_a_crop_window_is_scaled_with_its_film() -> None:
    mi.set_variant("scalar_rgb")
    scene = lightcull.mitsuba.MitsubaScene(mi.load_dict(scenes.film_options()))
    assert scene.size == (32, 24)

    def picture(width: int, height: int) -> np.ndarray:
        settings = RenderSettings((width, height), max_depth=2, seed=1, threads=0)
        job = scene.new_job("culled", settings, spp=256)
        job.render_pass()
        while job.stats().spp < 256:
            job.render_pass()
        return job.image()

    small, large = picture(32, 24), picture(64, 48)
    assert large.shape == (48, 64, 3)
    halved = large.reshape(24, 2, 32, 2, 3).mean(axis=(1, 3))
    assert np.abs(halved - small).mean() < 0.1 * small.mean()


@pytest.mark.parametrize(
    ("make", "depth"),
    [
        (scenes.cornell, 4),
        (scenes.attribute_lamps, 3),
        (scenes.textured_lamps, 3),
        (scenes.environment, 3),
        (scenes.round_lamps, 3),
        (scenes.suns_and_lamps, 3),
    ],
)
def test_an_imported_scene_looks_the_same(make: Any, depth: int) -> None:
    mi.set_variant("scalar_rgb")
    scene = make()
    scene.pop("ball", None)
    ours = lightcull.mitsuba.import_scene(mi.load_dict(scene))
    image = lightcull.render(ours, spp=256, size=scenes.SIZE, max_depth=depth).image
    expected = render(scene, spp=256, max_depth=depth)
    assert np.allclose(image.mean(axis=(0, 1)), expected.mean(axis=(0, 1)), rtol=0.03)
    assert np.abs(image - expected).mean() < 0.15 * expected.mean()


def test_an_import_names_what_it_leaves_out() -> None:
    mi.set_variant("scalar_rgb")
    with pytest.warns(lightcull.UnsupportedWarning) as record:
        lightcull.mitsuba.import_scene(mi.load_dict(scenes.round_lamps() | scenes.glass()))
    message = str(record[0].message)
    for thing in ("ThinDielectric", "round shapes are made of triangles"):
        assert thing in message
    assert record[0].filename == __file__


def test_an_import_names_what_it_leaves_out_of_things_it_knows() -> None:
    mi.set_variant("scalar_rgb")
    scene = scenes.film_options()
    scene["floor"]["bsdf"] = {"type": "principled", "clearcoat": 0.5, "spec_trans": 0.2}
    scene["wall"]["bsdf"] = {
        "type": "twosided",
        "front": scenes.diffuse(0.5),
        "back": scenes.diffuse(0.1),
    }
    scene["wall"]["interior"] = {"type": "homogeneous"}
    scene["second"] = scene["sensor"]
    with pytest.warns(lightcull.UnsupportedWarning) as record:
        lightcull.mitsuba.import_scene(mi.load_dict(scene))
    message = str(record[0].message)
    for thing in ("clearcoat", "spec_trans", "other material on the back", "medium"):
        assert thing in message
    assert "crop window" in message


def command(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "lightcull", *arguments],
        cwd=folder,
        env={**os.environ, "XDG_CACHE_HOME": str(folder / "cache")},
        capture_output=True,
        text=True,
        timeout=300,
    )


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "scene.xml").write_text(SCENE_XML)
    return tmp_path


def test_command_render(folder: Path) -> None:
    done = command(folder, "render", "scene.xml", "--spp", "11", "-o", "scene.exr")
    assert done.returncode == 0, done.stderr
    assert "32x24, 11 samples per pixel" in done.stdout
    image = lightcull.read_image(folder / "scene.exr")
    assert image.shape == (24, 32, 3) and image.mean() > 0.01


def test_command_compare(folder: Path) -> None:
    done = command(
        folder, "compare", "--host", "mitsuba", "scene.xml", "--samplers", "path,culled",
        "--spp", "16", "-o", "report",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    samplers = json.loads((folder / "report/report.json").read_text())["samplers"]
    assert list(samplers) == ["path", "culled"]
    assert all(figures["relmse"] < 1 for figures in samplers.values())


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("render", "missing.xml"), "no such file"),
        (("render", "scene.xml", "--variant", "scalar_foo"), "no variant 'scalar_foo'"),
        (("compare", "--host", "mitsuba", "cornell"), "for an .xml scene"),
        (("render", "cornell", "--sampler", "path"), "sampler 'path'"),
    ],
)
def test_command_errors(folder: Path, arguments: tuple[str, ...], said: str) -> None:
    done = command(folder, *arguments)
    assert done.returncode == 1
    assert said in done.stderr
    assert "Traceback" not in done.stderr


def test_example_of_fairy_lights(tmp_path: Path) -> None:
    program = ROOT / "examples/mitsuba_fairy_lights.py"
    done = subprocess.run(
        [sys.executable, program, "--seconds", "1", "--size", "48", "36", "-o", tmp_path],
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    for name in ("path", "lightcull_path"):
        assert (tmp_path / f"fairy_lights_{name}.png").stat().st_size > 1000


def test_cmake_says_what_to_install_and_builds_the_rest(tmp_path: Path) -> None:
    """With a Python that has no Mitsuba, as one in a new environment."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", tmp_path / "venv"], check=True)
    pybind = importlib.util.find_spec("pybind11")
    assert pybind is not None and pybind.origin is not None
    options = {
        "Python_EXECUTABLE": tmp_path / "venv/bin/python",
        "pybind11_DIR": Path(pybind.origin).parent / "share/cmake/pybind11",
        "lightcull_DIR": ROOT / "build",
        "SKBUILD_PROJECT_VERSION": "0",
    }
    done = subprocess.run(
        ["cmake", "-G", "Ninja", "-S", ROOT / "bindings", "-B", tmp_path / "build"]
        + [f"-D{key}={value}" for key, value in options.items()],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    said = " ".join(done.stdout.split())
    assert "The Mitsuba plugin is not built: mitsuba is not installed" in said
    assert "pip install mitsuba==3.8.0" in said
    rules = (tmp_path / "build/build.ninja").read_text()
    assert "build _core" in rules and "lightcull_path" not in rules


def test_import_says_what_is_missing() -> None:
    program = "import sys; sys.modules['mitsuba'] = None; import lightcull.mitsuba"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert "pip install mitsuba==3.8.0" in done.stderr
