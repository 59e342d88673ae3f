"""Mitsuba's .xml scenes are rendered as they are written."""

from __future__ import annotations

import os
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed")

import lightcull  # noqa: E402
from lightcull.camera import View  # noqa: E402
from lightcull.loaders.completion import surround  # noqa: E402
from lightcull.mitsuba import MitsubaScene, import_scene, load_file  # noqa: E402
from lightcull.mitsuba.cameras import camera_of  # noqa: E402

SPP = 64
TOLERANCE = 0.01
"""Of the mean of an image, relative: eight standard errors. The seeds are fixed."""

STAGE = """
<sensor type="perspective" id="front">
  <transform name="to_world"><lookat origin="0, 2, 6" target="0, 0.6, 0" up="0, 1, 0"/></transform>
  <film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="48"/></film>
</sensor>
<emitter type="constant"><rgb name="radiance" value="0.5"/></emitter>
<shape type="rectangle">
  <transform name="to_world"><scale value="4"/><rotate x="1" angle="-90"/></transform>
  <bsdf type="diffuse"><rgb name="reflectance" value="0.8"/></bsdf>
</shape>
<shape type="cube">
  <transform name="to_world"><scale value="0.5"/><translate y="0.5"/></transform>
  <bsdf type="diffuse"><rgb name="reflectance" value="0.8"/></bsdf>
</shape>
<shape type="rectangle">
  <transform name="to_world">
    <scale value="0.3"/><rotate x="1" angle="90"/><translate y="1.8"/>
  </transform>
  <emitter type="area"><rgb name="radiance" value="5"/></emitter>
</shape>
"""
DEPTH_2 = '<integer name="max_depth" value="2"/>'
DEPTH_3 = '<integer name="max_depth" value="3"/>'
PATH_OF_2 = f'<integrator type="path">{DEPTH_2}</integrator>'
PATH_OF_3 = f'<integrator type="path">{DEPTH_3}</integrator>'
HIDDEN = '<boolean name="hide_emitters" value="true"/>'
FOG = """
<shape type="sphere">
  <point name="center" x="1.2" y="0.6" z="1"/><float name="radius" value="0.6"/>
  <bsdf type="null"/>
  <medium type="homogeneous" name="interior">
    <float name="sigma_t" value="5"/><rgb name="albedo" value="0.9"/>
  </medium>
</shape>
"""


def write(folder: Path, integrator: str, stage: str = STAGE, name: str = "scene.xml") -> Path:
    path = folder / name
    path.write_text(f'<scene version="3.0.0">{integrator}{stage}</scene>')
    return path


def loaded(path: Path, **options: object) -> tuple[MitsubaScene, str]:
    """A scene, and what was said of it."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        scene = load_file(path, **options)
    assert len(caught) <= 1
    return scene, "".join(str(warning.message) for warning in caught)


def mean(scene: MitsubaScene | lightcull.Scene) -> float:
    return float(lightcull.render(scene, spp=SPP).image.mean())


def mean_by_mitsuba(path: Path, **parameters: str) -> float:
    mi.set_variant("scalar_rgb")
    scene = mi.load_file(str(path), **parameters)
    return float(np.array(mi.render(scene, spp=SPP, seed=7))[..., :3].mean())


@pytest.mark.parametrize(
    ("integrator", "expected"),
    [
        (PATH_OF_2, 0.4313),
        (f'<integrator type="path">{DEPTH_3}{HIDDEN}</integrator>', 0.239),
        ('<integrator type="path"><integer name="rr_depth" value="2"/></integrator>', 0.4515),
        ('<integrator type="path"/>', 0.4515),
        ("", 0.4515),
        ('<integrator type="direct"/>', 0.4313),
        (f'<integrator type="direct">{HIDDEN}</integrator>', None),
        (f'<integrator type="volpath">{DEPTH_3}{HIDDEN}</integrator>', 0.239),
        (f'<integrator type="volpathmis">{DEPTH_2}</integrator>', 0.4313),
    ],
)
def test_integrators_hold(tmp_path: Path, integrator: str, expected: float | None) -> None:
    path = write(tmp_path, integrator)
    scene, said = loaded(path)
    assert said == ""
    found = mean(scene)
    if integrator:  # Mitsuba renders nothing without one
        assert found == pytest.approx(mean_by_mitsuba(path), rel=TOLERANCE)
    if expected is not None:
        assert found == pytest.approx(expected, rel=0.015)


@pytest.mark.parametrize(
    ("around", "named"),
    [
        ('<integrator type="moment">{}</integrator>', "second moments"),
        (
            '<integrator type="aov"><string name="aovs" value="d:depth"/>{}</integrator>',
            "channels of the integrator 'aov'",
        ),
    ],
)
def test_integrators_within_others_hold(tmp_path: Path, around: str, named: str) -> None:
    inner = f'<integrator type="path">{DEPTH_2}{HIDDEN}</integrator>'
    scene, said = loaded(write(tmp_path, around.format(inner)))
    assert named in said
    assert (scene.integrator.max_depth, scene.integrator.hide_emitters) == (2, True)
    plain, _ = loaded(write(tmp_path, inner))
    assert mean(scene) == pytest.approx(mean(plain), rel=TOLERANCE)


def test_an_integrator_in_an_include_holds(tmp_path: Path) -> None:
    write(tmp_path, PATH_OF_2, "", "part.xml")
    scene, said = loaded(write(tmp_path, '<include filename="part.xml"/>'))
    assert said == ""
    assert mean(scene) == pytest.approx(0.4313, rel=0.015)


@pytest.mark.parametrize(
    ("integrator", "named"),
    [
        ('<integrator type="depth"/>', "'depth' shows no light"),
        (f'<integrator type="ptracer">{DEPTH_2}</integrator>', "'ptracer' is not lightcull's"),
        (f'<integrator type="bdpt">{DEPTH_2}</integrator>', "'bdpt' is not lightcull's"),
        (
            '<integrator type="direct"><integer name="emitter_samples" value="4"/></integrator>',
            "emitter_samples of the integrator 'direct'",
        ),
        (
            '<integrator type="path"><float name="timeout" value="3"/></integrator>',
            "timeout of the integrator 'path'",
        ),
    ],
)
def test_what_does_not_hold_of_an_integrator_is_named(
    tmp_path: Path, integrator: str, named: str
) -> None:
    scene, said = loaded(write(tmp_path, integrator))
    assert named in said and "\n" not in said
    assert scene.integrator.max_depth == (2 if "direct" in integrator or DEPTH_2 in integrator
                                          else 2**31 - 1)  # fmt: skip


def test_integrators_with_derivatives_are_paths_in_any_variant(tmp_path: Path) -> None:
    scene, said = loaded(write(tmp_path, f'<integrator type="prb">{DEPTH_2}</integrator>'))
    assert said == ""
    assert mean(scene) == pytest.approx(0.4313, rel=0.015)


@pytest.mark.parametrize("integrator", ["volpath", "lightcull_volpath"])
def test_media_are_rendered(tmp_path: Path, integrator: str) -> None:
    path = write(tmp_path, f'<integrator type="{integrator}">{DEPTH_2}</integrator>', STAGE + FOG)
    scene, said = loaded(path)
    assert "media" in said and "'path' is Mitsuba's volpath" in said and "\n" not in said
    assert scene.best_sampler == "light_bvh:importance=means"
    assert mean(scene) == pytest.approx(mean_by_mitsuba(path), rel=TOLERANCE)
    by_mitsuba = lightcull.render(scene, "path", spp=SPP).image.mean()
    assert mean(scene) == pytest.approx(by_mitsuba, rel=TOLERANCE)
    with pytest.raises(lightcull.Error, match="not for the media"):
        lightcull.render(scene, "learned", spp=1)


def test_a_camera_in_a_medium_is_not_taken_out_of_it(tmp_path: Path) -> None:
    medium = '<medium type="homogeneous"><float name="sigma_t" value="0.3"/></medium></sensor>'
    stage = STAGE.replace("</sensor>", medium)
    scene, said = loaded(write(tmp_path, f'<integrator type="volpath">{DEPTH_2}</integrator>', stage))
    assert "media" in said
    assert mean(scene) < 0.9 * 0.4313, "fog takes light away"
    scene.use_camera(View(vertical_fov=0.6))
    assert mean(scene) < 0.9 * 0.4313


def test_what_a_call_says_comes_before_the_file(tmp_path: Path) -> None:
    scene, _ = loaded(write(tmp_path, PATH_OF_2))
    result = lightcull.render(scene, spp=1, size=(8, 6), max_depth=1)
    assert result.max_depth == 1 and result.image.shape == (6, 8, 3)


PARAMETER = (
    '<default name="depth" value="3"/>'
    '<integrator type="path"><integer name="max_depth" value="$depth"/></integrator>'
)


def test_parameters_have_defaults_and_can_be_set(tmp_path: Path) -> None:
    path = write(tmp_path, PARAMETER)
    assert loaded(path)[0].integrator.max_depth == 3
    given = loaded(path, parameters={"depth": "2"})[0]
    assert given.integrator.max_depth == 2
    assert given.digest() != loaded(path)[0].digest()
    with pytest.raises(lightcull.Error, match=r"scene\.xml: .*unused parameters: - \$other=1"):
        load_file(path, parameters={"other": "1"})


@pytest.mark.parametrize(
    ("pixel_format", "is_grey"),
    [
        ("luminance", True),
        ("luminance_alpha", True),
        ("rgba", False),
        ("xyz", False),
        ("xyza", False),
    ],
)
def test_films_of_other_pixel_formats(tmp_path: Path, pixel_format: str, is_grey: bool) -> None:
    """A red light: 0.2126 of it is its luminance (ITU-R BT.709)."""
    red = STAGE.replace('value="0.5"/></emitter>', 'value="0.5, 0, 0"/></emitter>').replace(
        'name="radiance" value="5"', 'name="radiance" value="5, 0, 0"'
    )
    film = f'<film type="hdrfilm"><string name="pixel_format" value="{pixel_format}"/>'
    integrator = PATH_OF_2
    scene, _ = loaded(write(tmp_path, integrator, red.replace('<film type="hdrfilm">', film)))
    image = lightcull.render(scene, spp=SPP).image
    expected = 0.4313 * np.array([0.2126] * 3 if is_grey else [1, 0, 0])
    assert image.shape == (48, 64, 3)
    np.testing.assert_allclose(image.mean(axis=(0, 1)), expected, rtol=0.015, atol=1e-3)


@pytest.mark.parametrize(
    ("integrator", "stage", "said"),
    [
        ('<integrator type="path"/>', "", "holds no shapes"),
        ('<integrator type="path"/>', STAGE.replace("hdrfilm", "specfilm"), "specfilm"),
        ('<integrator type="path"/>', STAGE.replace("hdrfilm", "nonesuch"), 'Plugin "nonesuch"'),
        ('<integrator type="path"><integer name="max_depth" value="0"/></integrator>', STAGE,
         "max_depth of 0"),
        ('<integrator type="path"><integer name="rr_depth" value="0"/></integrator>', STAGE,
         "rr_depth of 0"),
        ('<integrator type="path"><integer name="max_depth" value="$x"/></integrator>', STAGE,
         r"undefined parameter: \$x"),
        ('<integrator type="path"/><integrator type="direct"/>', STAGE, "Only one integrator"),
        ("<integrator", "", "Parsing of XML"),
    ],
)  # fmt: skip
def test_what_cannot_be_rendered_is_one_line(
    tmp_path: Path, integrator: str, stage: str, said: str
) -> None:
    path = write(tmp_path, integrator, stage)
    with pytest.raises(lightcull.Error, match=said) as caught:
        lightcull.render(load_file(path), spp=1)
    assert "\n" not in str(caught.value)


def test_an_imported_scene_agrees_with_its_host(tmp_path: Path) -> None:
    """Size and depths, too, which are the file's in both."""
    for integrator in (PATH_OF_3, '<integrator type="direct"/>'):
        host, _ = loaded(write(tmp_path, integrator))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            ours = import_scene(host)
        assert ours.name == "scene"
        image = lightcull.render(ours, spp=SPP).image
        assert image.shape == (48, 64, 3)
        assert image.mean() == pytest.approx(mean(host), rel=TOLERANCE)
        of_object = import_scene(host.scene)
        assert of_object.file_settings == ours.file_settings


MIRROR = """
<shape type="rectangle">
  <transform name="to_world"><scale value="1.5"/><translate y="0.8" z="-2"/></transform>
  <bsdf type="principled">
    <rgb name="base_color" value="0.9"/><float name="metallic" value="1"/>
    <float name="roughness" value="0.1"/>
  </bsdf>
</shape>
<shape type="rectangle">
  <transform name="to_world"><scale value="0.4"/><translate x="-0.8" y="1" z="1.5"/></transform>
  <emitter type="area"><rgb name="radiance" value="2"/></emitter>
</shape>
"""


def blocks(image: np.ndarray) -> np.ndarray:
    """The means of squares of 8 x 8 pixels."""
    height, width = image.shape[:2]
    return image[..., :3].reshape(height // 8, 8, width // 8, 8, 3).mean(axis=(1, 3))


def test_hidden_emitters_are_hidden_in_every_renderer(tmp_path: Path) -> None:
    # Lamps before the floor and the sky, one of them seen from behind, and all in a mirror.
    path = write(tmp_path, f'<integrator type="path">{DEPTH_3}{HIDDEN}</integrator>', STAGE + MIRROR)
    host, _ = loaded(path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ours = import_scene(host)
    assert ours.file_settings.hide_emitters is True
    assert import_scene(host.scene).file_settings == ours.file_settings
    expected = blocks(np.array(mi.render(mi.load_file(str(path)), spp=1024, seed=7)))
    assert expected[0, 0].max() == 0  # the sky
    # Some 6 standard errors of a block.
    wanted = {"rtol": 0.06, "atol": 0.01}
    np.testing.assert_allclose(blocks(lightcull.render(ours, spp=256).image), expected, **wanted)
    np.testing.assert_allclose(blocks(lightcull.render(host, spp=256).image), expected, **wanted)
    shown = blocks(lightcull.render(ours, spp=16, hide_emitters=False).image)
    assert shown[0, 0] == pytest.approx(0.5)
    assert np.abs(shown[1:] - expected[1:]).max() > 0.3  # the lamps


RELIEF = """
<bsdf type="normalmap" id="relief">
  <texture name="normalmap" type="bitmap">
    <string name="filename" value="relief.exr"/><boolean name="raw" value="true"/>
  </texture>
  {}
</bsdf>
<sensor type="perspective">
  <transform name="to_world"><lookat origin="0, 3, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
  <film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="48"/></film>
</sensor>
<emitter type="directional">
  <vector name="direction" x="-1" y="-1.2" z="0.4"/><rgb name="irradiance" value="2"/>
</emitter>
<emitter type="constant"><rgb name="radiance" value="0.2"/></emitter>
<shape type="sphere">
  <transform name="to_world"><scale value="0.8"/><translate y="0.9"/></transform>
  <ref id="relief"/>
</shape>
<shape type="rectangle">
  <transform name="to_world"><scale value="2.5"/><rotate x="1" angle="-90"/></transform>
  <ref id="relief"/>
</shape>
"""


@pytest.mark.parametrize(
    "inside",
    [
        '<bsdf type="diffuse"><rgb name="reflectance" value="0.7"/></bsdf>',
        '<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>',
    ],
)
def test_normal_maps_are_those_of_mitsuba(tmp_path: Path, inside: str) -> None:
    # Waves that lean to all sides, by so little that hardly any turn away from the camera:
    # those are black in Mitsuba.
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 32, False), np.linspace(0, 2 * np.pi, 32, False))
    normals = np.stack([0.2 * np.sin(2 * u), 0.2 * np.cos(v), np.ones_like(u)], axis=2)
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    lightcull.write_exr(tmp_path / "relief.exr", np.float32(0.5 + 0.5 * normals))
    path = write(tmp_path, PATH_OF_2, RELIEF.format(inside))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", "scene: round shapes are made of triangles$")
        ours = import_scene(load_file(path))
    expected = blocks(np.array(mi.render(mi.load_file(str(path)), spp=256, seed=7)))
    found = blocks(lightcull.render(ours, spp=256).image)
    np.testing.assert_allclose(found, expected, rtol=0.05, atol=0.01)
    assert found.mean() == pytest.approx(expected.mean(), rel=TOLERANCE)
    flat = path.read_text().replace('<ref id="relief"/>', inside)
    path.write_text(flat)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        without = blocks(lightcull.render(import_scene(load_file(path)), spp=16).image)
    assert np.abs(without - found).max() > 0.04


GROUP = """
<shape type="shapegroup" id="pair">
  <shape type="cube">
    <transform name="to_world"><scale value="0.3"/><translate y="0.3"/></transform>
    <bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.2, 0.1"/></bsdf>
  </shape>
  <shape type="sphere"><point name="center" x="0" y="0.9" z="0"/><float name="radius" value="0.3"/></shape>
</shape>
""" + "".join(
    f"""<shape type="instance"><ref id="pair"/><transform name="to_world">
    <scale x="{-1 if x > 0 else 1}" y="{1 + 0.2 * x}"/><rotate y="1" angle="{40 * x}"/>
    <translate x="{1.5 * x}" z="1"/></transform></shape>"""
    for x in (-1, 0, 1)
)


def test_instances_stay_instances(tmp_path: Path) -> None:
    path = write(tmp_path, PATH_OF_3, STAGE + GROUP)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", "scene: round shapes are made of triangles$")
        ours = import_scene(load_file(path))
    assert ours.counts["instances"] == 6
    expected = blocks(np.array(mi.render(mi.load_file(str(path)), spp=256, seed=7)))
    found = blocks(lightcull.render(ours, spp=256, seed=1).image)
    np.testing.assert_allclose(found, expected, rtol=0.05, atol=0.01)
    assert found.mean() == pytest.approx(expected.mean(), rel=TOLERANCE)


def test_a_textured_shape_without_texture_coordinates_is_named(tmp_path: Path) -> None:
    lightcull.write_exr(tmp_path / "relief.exr", np.full((2, 2, 3), 0.5, np.float32))
    (tmp_path / "triangle.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    texture = """<bsdf type="diffuse"><texture name="reflectance" type="bitmap">
      <string name="filename" value="relief.exr"/></texture></bsdf>"""
    shape = f'<shape type="obj"><string name="filename" value="triangle.obj"/>{texture}</shape>'
    host = load_file(write(tmp_path, PATH_OF_2, STAGE + shape))
    with pytest.warns(lightcull.UnsupportedWarning, match="shapes without texture coordinates"):
        import_scene(host).closed()


def command(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "lightcull", *arguments],
        cwd=folder,
        env={**os.environ, "COLUMNS": "100"},
        capture_output=True,
        text=True,
        timeout=300,
    )


def test_commands_take_parameters_and_tell_what_holds(tmp_path: Path) -> None:
    write(tmp_path, PARAMETER)
    told = command(tmp_path, "info", "scene.xml", "-D", "depth=4")
    assert told.returncode == 0, told.stderr
    for word in ("max_depth 4", "16 triangles", "ConstantBackgroundEmitter", "'front'", "64x48"):
        assert word in told.stdout
    done = command(
        tmp_path, "render", "scene.xml", "--define", "depth=2", "--spp", "16", "-o", "a.exr"
    )
    assert done.returncode == 0, done.stderr
    image = lightcull.read_image(tmp_path / "a.exr")
    assert image.mean() == pytest.approx(0.4313, rel=0.03)
    wrong = command(tmp_path, "render", "scene.xml", "-D", "depth", "--spp", "1")
    assert wrong.returncode == 2 and "NAME=VALUE" in wrong.stderr
    ours = command(tmp_path, "info", "cornell", "-D", "a=b")
    assert ours.returncode == 1 and "--define is for an .xml" in ours.stderr
    write(tmp_path, "", "", "empty.xml")
    empty = command(tmp_path, "info", "empty.xml")
    assert empty.returncode == 0 and "none" in empty.stdout


SENSORS = STAGE + """
<sensor type="orthographic" id="above">
  <transform name="to_world">
    <scale x="3" y="3"/><lookat origin="0, 5, 0" target="0, 0, 0" up="0, 0, -1"/>
  </transform>
  <film type="hdrfilm"><integer name="width" value="40"/><integer name="height" value="30"/></film>
</sensor>
<sensor type="thinlens" id="lens">
  <float name="aperture_radius" value="0.2"/><float name="focus_distance" value="5"/>
  <float name="fov" value="30"/>
  <transform name="to_world"><lookat origin="3, 2, 4" target="0, 0.6, 0" up="0, 1, 0"/></transform>
  <film type="hdrfilm"><integer name="width" value="40"/><integer name="height" value="30"/></film>
</sensor>
"""


@pytest.mark.parametrize(("which", "number"), [("front", 0), ("above", 1), (1, 1), ("lens", 2)])
def test_sensors_are_chosen_by_name_or_number_in_both_renderers(
    tmp_path: Path, which: str | int, number: int
) -> None:
    host, _ = loaded(write(tmp_path, PATH_OF_2, SENSORS))
    host.use_camera(which)
    image = lightcull.render(host, spp=4 * SPP).image
    expected = np.array(mi.render(host.scene, sensor=number, spp=4 * SPP, seed=7))[..., :3]
    assert image.shape == expected.shape
    assert image.mean() == pytest.approx(expected.mean(), rel=TOLERANCE)
    ours = import_scene(host)
    assert [camera.name for camera in ours.cameras] == ["front", "above", "lens"]
    shown = lightcull.render(ours, spp=4 * SPP).image
    assert shown.shape == expected.shape
    assert abs(shown - expected).mean() < 0.05 * expected.mean()


@pytest.mark.parametrize(
    "camera",
    [
        lightcull.Camera((3, 2, 4), (0, 0.5, 0), vertical_fov=0.6),
        lightcull.Camera((0, 3, 4), (0, 0, 0), orthographic_height=4.0),
        View(origin=(3, 3, 4)),
        View("lens", vertical_fov=0.9),
    ],
)
def test_other_cameras_show_the_same_in_both_renderers(
    tmp_path: Path, camera: lightcull.Camera | View
) -> None:
    path = write(tmp_path, PATH_OF_2, SENSORS)
    host, _ = loaded(path)
    before = host.digest()
    host.use_camera(camera)
    assert host.digest() != before
    image = lightcull.render(host, spp=4 * SPP).image
    shown = lightcull.render(import_scene(host), spp=4 * SPP).image
    assert shown.shape == image.shape
    assert abs(shown - image).mean() < 0.06 * image.mean()


def test_a_camera_makes_up_for_a_sensor_that_is_missing(tmp_path: Path) -> None:
    bare = STAGE[STAGE.index("<emitter") :]
    host, _ = loaded(write(tmp_path, PATH_OF_2, bare))
    host.use_camera(View(origin=(0, 2, 6), target=(0, 0.6, 0)))
    assert lightcull.render(host, spp=4).image.shape == (240, 320, 3)


PLACED = """
import mitsuba as mi
from lightcull.mitsuba import MitsubaScene
from lightcull.mitsuba.cameras import camera_of
mi.set_variant("llvm_ad_rgb")
things = {"thing": {"type": "cube"}, "sky": {"type": "constant"}}
host = MitsubaScene(mi.load_dict({"type": "scene", **things}))
print(*camera_of(host.sensor).origin)
"""


def test_where_there_is_no_sensor_one_is_placed() -> None:
    things = {"thing": {"type": "cube"}, "sky": {"type": "constant"}}
    host = MitsubaScene(mi.load_dict({"type": "scene", **things}))
    with pytest.warns(lightcull.UnsupportedWarning, match="no camera: one is placed"):
        placed = camera_of(host.sensor)
    assert placed is not None
    # From the front, a little from the right and from above; the cube is all that it sees.
    away = np.array(placed.origin)
    assert away / np.linalg.norm(away) == pytest.approx(np.array([0.42, 0.34, 0.84]), abs=0.1)
    image = lightcull.render(host, spp=16, max_depth=2).image[..., 0]
    cube = abs(image - 1) > 0.05
    rows, columns = cube.any(axis=1), cube.any(axis=0)
    assert not (rows[[0, -1]].any() or columns[[0, -1]].any())
    assert rows.mean() > 0.85
    # Mitsuba cannot change to this variant in a process that has rendered by another.
    command = [sys.executable, "-W", "ignore", "-c", PLACED]
    told = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    assert [float(number) for number in told.split()] == pytest.approx(placed.origin, rel=1e-3)
    assert import_scene(host).camera.origin == pytest.approx(placed.origin, rel=1e-3)


@pytest.mark.parametrize("given", ["0.2,0.4,0.8", "sky.exr", "studio", "none"])
def test_other_surroundings_show_the_same_in_both_renderers(
    tmp_path: Path, given: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    texels = np.random.default_rng(1).uniform(0, 2, (8, 16, 3)).astype(np.float32)
    texels[:, :4] *= 5  # one side is brighter
    lightcull.write_exr(tmp_path / "sky.exr", texels)
    host, _ = loaded(write(tmp_path, PATH_OF_2))
    before = host.digest()
    host.surround(given, 0.5)
    assert host.digest() != before
    image = lightcull.render(host, spp=SPP).image
    ours = import_scene(host)
    assert ours.has_environment == (given != "none")
    shown = lightcull.render(ours, spp=SPP).image
    assert shown.mean() == pytest.approx(image.mean(), rel=0.02)
    assert abs(shown - image).mean() < 0.1 * image.mean()
    expected, _ = loaded(write(tmp_path, PATH_OF_2))
    same = import_scene(expected)
    surround(same, given, 0.5)
    assert lightcull.render(same, spp=SPP).image.mean() == pytest.approx(shown.mean(), rel=0.02)


def test_commands_take_cameras_and_surroundings_of_mitsuba_too(tmp_path: Path) -> None:
    write(tmp_path, PATH_OF_2, SENSORS)
    common = ("render", "scene.xml", "--spp", "2", "-o", "a.exr")
    done = command(tmp_path, *common, "--camera", "above")
    assert done.returncode == 0 and "40x30" in done.stdout
    white = ("--environment", "3", "--camera-from", "0,2,6", "--camera-to", "0,9,6", "--camera-up")
    done = command(tmp_path, *common, *white, "0,0,1")
    assert done.returncode == 0, done.stderr
    assert np.allclose(lightcull.read_image(tmp_path / "a.exr"), 3, rtol=1e-4)
    wrong = command(tmp_path, *common, "--camera", "top")
    assert wrong.returncode == 1
    assert "no camera 'top'; there are 0 'front', 1 'above', 2 'lens'" in wrong.stderr


ROUND = """
<shape type="sphere">
  <point name="center" x="-1.2" y="0.6" z="0"/><float name="radius" value="0.5"/>
  <bsdf type="diffuse"><rgb name="reflectance" value="0.7, 0.2, 0.1"/></bsdf>
</shape>
<shape type="sphere">
  <point name="center" x="1.2" y="3.6" z="0.5"/><float name="radius" value="0.25"/>
  <emitter type="area"><rgb name="radiance" value="30, 0, 0"/></emitter>
</shape>
<shape type="cylinder">
  <point name="p0" x="-2" y="3.5" z="0"/><point name="p1" x="-0.4" y="3.9" z="0"/>
  <float name="radius" value="0.05"/>
  <emitter type="area"><rgb name="radiance" value="0, 0, 60"/></emitter>
</shape>
<shape type="disk">
  <transform name="to_world">
    <scale value="0.4"/><rotate x="1" angle="90"/><translate x="1.5" y="3.5" z="1"/>
  </transform>
  <emitter type="area"><rgb name="radiance" value="0, 20, 0"/></emitter>
</shape>
<shape type="sphere">
  <float name="radius" value="9"/><boolean name="flip_normals" value="true"/>
  <emitter type="area"><rgb name="radiance" value="0.05"/></emitter>
</shape>
"""
"""The lamps are above the picture."""


def test_round_shapes_are_imported_as_triangles(tmp_path: Path) -> None:
    dark = STAGE[: STAGE.index("<emitter")] + STAGE[STAGE.index("<shape") :].replace(
        'name="radiance" value="5"', 'name="radiance" value="0"'
    )
    host, _ = loaded(write(tmp_path, PATH_OF_3, dark + ROUND))
    with pytest.warns(lightcull.UnsupportedWarning) as caught:
        ours = import_scene(host)
    assert str(caught[0].message) == "scene: round shapes are made of triangles"
    image = lightcull.render(host, spp=4 * SPP).image
    shown = lightcull.render(ours, spp=4 * SPP).image
    np.testing.assert_allclose(shown.mean(axis=(0, 1)), image.mean(axis=(0, 1)), rtol=0.02)
    blocks = (shown - image).reshape(6, 8, 8, 8, 3).mean(axis=(1, 3))
    assert abs(blocks).mean() < 0.03 * image.mean()


def test_an_environment_that_is_turned_is_imported_so(tmp_path: Path) -> None:
    texels = np.random.default_rng(1).uniform(0, 1, (8, 16, 3)).astype(np.float32)
    texels[3, 2] = (60, 0, 0)
    lightcull.write_exr(tmp_path / "sky.exr", texels)
    turned = (
        '<emitter type="envmap"><string name="filename" value="sky.exr"/>'
        '<transform name="to_world"><rotate y="1" angle="70"/></transform></emitter>'
    )
    start, end = STAGE.index("<emitter"), STAGE.index("</emitter>") + len("</emitter>")
    host, _ = loaded(write(tmp_path, PATH_OF_2, STAGE[:start] + turned + STAGE[end:]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ours = import_scene(host)
    image = lightcull.render(host, spp=4 * SPP).image
    shown = lightcull.render(ours, spp=4 * SPP).image
    assert abs(shown - image).mean() < 0.08 * image.mean()


def test_media_of_a_scene_that_is_no_file_are_not_left_out_silently(tmp_path: Path) -> None:
    path = write(tmp_path, f'<integrator type="volpath">{DEPTH_2}</integrator>', STAGE + FOG)
    mi.set_variant("scalar_rgb")
    scene = MitsubaScene(mi.load_file(str(path)))
    means = "light_bvh:importance=means"
    assert (scene.integrator.kind, scene.best_sampler) == ("volpath", means)
