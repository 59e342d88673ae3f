"""Other renderers, of which the same scene is shown: Cycles, and pbrt-v4."""

from __future__ import annotations

import json
import math
import os
import struct
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import QUAD, square

import lightcull
import lightcull.peers.blender
from lightcull.peers.exported import Surface, export
from lightcull.peers.job import PeerJob
from lightcull.peers.pbrt_file import write_pbrt
from lightcull.peers.subject import SubjectWithPeers
from lightcull.rendering.settings import RenderSettings

SIZE = (32, 24)
BLOCK = 8


def has(peer: str) -> bool:
    try:
        SubjectWithPeers(lightcull.Scene()).check_sampler(peer)
    except lightcull.Error:
        return False
    return True


with_cycles = pytest.mark.skipif(
    not has("cycles"), reason="there is no bpy (pip install bpy, or LIGHTCULL_BPY_PYTHON)"
)
with_pbrt = pytest.mark.skipif(not has("pbrt"), reason="there is no program pbrt on the path")


def floor() -> lightcull.Scene:
    scene = lightcull.Scene("floor")
    brown = scene.add_material(base_color=(0.7, 0.5, 0.3))
    scene.add_mesh(square(4, 0, facing_up=True), QUAD, material=brown, name="floor")
    scene.set_camera(origin=(0, 3, 6), target=(0, 0.5, 0))
    return scene


def lamps(scene: lightcull.Scene) -> None:
    """One that shines down, one that shines to both sides and reflects, and one that shines up."""
    white = scene.add_material(base_color=(0.8, 0.8, 0.8))
    down = square(0.3, 2, facing_up=False) + np.float32([1, 0, 0])
    scene.add_light_mesh(down, QUAD, radiance=(4, 5, 3))
    both = square(0.3, 1, facing_up=True) + np.float32([-1, 0, 0])
    scene.add_light_mesh(both, QUAD, radiance=(2, 1, 3), two_sided=True, material=white)
    up = square(0.3, 0.5, facing_up=True) + np.float32([1, 0, 1])
    scene.add_light_mesh(up, QUAD, radiance=(9, 9, 9))


def textured(scene: lightcull.Scene) -> None:
    """A picture on the floor that a picture lights."""
    texels = np.random.default_rng(1).random((4, 6, 3)).astype(np.float32)
    picture = scene.add_texture(texels)
    painted = scene.add_material(base_color=(0.9, 0.5, 0.7), base_color_texture=picture)
    uvs = np.float32([[0, 0], [0, 1], [1.5, 1], [1.5, 0]])
    scene.add_mesh(square(2, 0.1, facing_up=True), QUAD, uvs=uvs, material=painted)
    scene.add_light_mesh(
        square(1, 2, facing_up=False), QUAD, radiance=(3, 2, 1), uvs=uvs, texture=picture
    )


def smooth(scene: lightcull.Scene) -> None:
    """A ridge with shading normals."""
    positions = np.float32([[x, 0.5 * (x == 0), z] for z in (1, -1) for x in (-1, 0, 1)])
    normals = np.float32([[-0.6, 0.8, 0], [0, 1, 0], [0.6, 0.8, 0]] * 2)
    triangles = np.uint32([[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4]])
    scene.add_mesh(positions, triangles, normals=normals)
    scene.add_point_light((0.5, 2, 0.5), (3, 3, 3))


def points(scene: lightcull.Scene) -> None:
    scene.add_point_light((0, 1.5, 0), (3, 2, 1))
    scene.add_point_light((-2, 0.5, 1), (0.2, 0.3, 0.4))


def spots(scene: lightcull.Scene) -> None:
    scene.add_spot_light((0, 2.5, 1), (0.2, -1, -0.3), (9, 8, 7), 0.2, 0.6)
    scene.add_spot_light((1, 1.5, 0), (0, -1, 0), (3, 3, 3), 0.4, 0.4)
    scene.add_spot_light((-2, 1, 0), (1, 0.2, 0), (1, 1, 1), 0.4, 2.5)


def sun(scene: lightcull.Scene) -> None:
    scene.add_directional_light((0.3, -1, 0.2), (1, 2, 3))


def sky(scene: lightcull.Scene) -> None:
    scene.set_environment((0.3, 0.5, 0.7), scale=2)


def sky_map(scene: lightcull.Scene) -> None:
    texels = np.random.default_rng(1).random((8, 16, 3)).astype(np.float32)
    scene.set_environment(texels, scale=(1, 0.5, 2), rotation=0.7)


def lens(scene: lightcull.Scene) -> None:
    lamps(scene)
    scene.set_camera(
        origin=(1, 3, 4), target=(0, 0, 0), up=(0.1, 1, 0), vertical_fov=0.6, aperture_radius=0.2,
        focus_distance=4,
    )  # fmt: skip


KINDS: dict[str, Callable[[lightcull.Scene], None]] = {
    kind.__name__: kind
    for kind in (lamps, textured, smooth, points, spots, sun, sky, sky_map, lens)
}


def block_means(image: np.ndarray) -> np.ndarray:
    height, width, _ = image.shape
    blocks = image.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, 3)
    return blocks.mean(axis=(1, 3), dtype=np.float64)


def many_means(
    subject: SubjectWithPeers, sampler: str, spp: int, part: str, repeats: int = 12
) -> np.ndarray:
    """The means of blocks, of as many independent images: (repeats, rows, columns, 3)."""
    found = []
    for seed in range(repeats):
        job = subject.new_job(sampler, RenderSettings(SIZE, 3, seed, 2, emission_apart=True), spp)
        while job.stats().spp < spp:
            job.render_pass()
        found.append(block_means(getattr(job, part)()))
    return np.stack(found)


def assert_alike(a: np.ndarray, b: np.ndarray) -> None:
    """Blocks of many images are the same in the mean: none differs by more than 6 standard
    deviations of the difference. With t's some 22 degrees of freedom (Welch) that happens with a
    probability of 5e-6, among the 36 means, 2 parts and 9 kinds here once in 300 times.
    """
    count = len(a)
    difference = np.abs(a.mean(axis=0) - b.mean(axis=0))
    deviation = np.sqrt((a.var(axis=0, ddof=1) + b.var(axis=0, ddof=1)) / count)
    rounding = 2e-4 * np.abs(a.mean(axis=0)).max()
    worst = np.max(difference / (deviation + rounding))
    assert worst < 6, worst
    # What is too noisy to tell would pass.
    for images in (a, b):
        means = images.mean(axis=(1, 2, 3))
        assert means.std(ddof=1) / np.sqrt(count) < 0.03 * means.mean()


@with_cycles
@pytest.mark.parametrize("kind", KINDS)
def test_cycles_shows_the_same_scene(kind: str) -> None:
    scene = floor()
    KINDS[kind](scene)
    subject = SubjectWithPeers(scene)
    ours = many_means(subject, "culled", 64, "lit")
    assert_alike(ours, many_means(subject, "cycles", 64, "lit"))
    assert_alike(
        many_means(subject, "culled", 16, "image"), many_means(subject, "cycles", 16, "image")
    )


@with_cycles
@pytest.mark.parametrize("kind", ["lamps", "textured"])
def test_cycles_takes_many_radiances_from_an_attribute(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lightcull.peers.blender, "MOST_MATERIALS", 0)
    scene = floor()
    KINDS[kind](scene)
    subject = SubjectWithPeers(scene)
    ours = many_means(subject, "culled", 64, "lit")
    assert_alike(ours, many_means(subject, "cycles", 64, "lit"))


@with_cycles
def test_cycles_is_compared_in_the_report(tmp_path: Path) -> None:
    """With the light tree and without, for the same time, against our reference."""
    scene = floor()
    lamps(scene)
    samplers = ["learned", "cycles", "cycles:light_tree=off"]
    result = lightcull.compare(
        scene, samplers, seconds=0.5, size=SIZE, threads=1, reference_seconds=2, folder=tmp_path
    )
    report = json.loads((tmp_path / "report.json").read_text())
    assert list(report["samplers"]) == samplers
    assert report["measured"] == "lit"
    assert result.reference.sampler == "learned"
    figures = result.figures.samplers
    assert all(0.5 <= run.seconds < 2 and run.spp > 8 for run in figures.values())
    # Each is unbiased: its error is what noise leaves, and far from that of a wrong scene.
    for name in samplers:
        lit = result.samplers[name][0].lit_image
        assert np.mean(lit) == pytest.approx(np.mean(result.reference.lit_image), rel=0.02)
        assert figures[name].relmse < 0.02


@with_cycles
def test_cycles_names_what_it_cannot_show() -> None:
    scene = floor()
    points(scene)
    with pytest.raises(lightcull.Error, match="direct_light is 'lights': it has its own"):
        lightcull.compare(scene, ["cycles"], spp=1, size=SIZE, direct_light="lights")
    with pytest.raises(lightcull.Error, match="max_depth is 1, wanted 2 at least"):
        lightcull.compare(scene, ["cycles"], spp=1, size=SIZE, max_depth=1)
    shiny = floor()
    points(shiny)
    gloss = shiny.add_material("metallic_roughness", roughness=0.4)
    shiny.add_mesh(square(1, 0.1, facing_up=True), QUAD, material=gloss)
    with pytest.warns(UserWarning, match="1 glossy materials are shown by Blender's"):
        theirs = many_means(SubjectWithPeers(shiny), "cycles", 64, "lit", 4)
    ours = many_means(SubjectWithPeers(shiny), "culled", 64, "lit", 4)
    assert theirs.mean() == pytest.approx(ours.mean(), rel=0.05)


def test_where_there_is_no_blender_a_line_says_so(
    main_here: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LIGHTCULL_BPY_PYTHON", "/no/python")
    done = main_here("compare", "cornell", "--samplers", "culled,cycles", "--spp", "1")
    assert done.returncode != 0
    assert done.stdout == ""
    (line,) = done.stderr.splitlines()
    assert "cycles: /no/python has no module bpy: pip install bpy" in line


def test_a_blender_that_fails_is_said_in_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    python = tmp_path / "python"
    python.write_text('#!/bin/sh\n[ "$1" = -c ] || { echo first >&2; echo no GPU >&2; exit 3; }\n')
    python.chmod(0o755)
    monkeypatch.setenv("LIGHTCULL_BPY_PYTHON", str(python))
    scene = floor()
    points(scene)
    with pytest.raises(lightcull.Error, match="^cycles: Blender failed: no GPU$"):
        lightcull.compare(scene, ["cycles"], spp=1, size=SIZE)


@pytest.mark.parametrize(
    ("description", "message"),
    [
        ("cycles:light_tree=no", "unknown option 'light_tree=no'; there are light_tree=on"),
        ("pbrt:depth=1", "pbrt:depth=1: pbrt has no options"),
    ],
)
def test_options_that_there_are_none_of_are_named(description: str, message: str) -> None:
    with pytest.raises(lightcull.Error, match=message):
        lightcull.compare(floor(), [description], spp=1)


def test_renders_of_ours_beside_others_are_timed_by_the_processors() -> None:
    """Half of what two threads take, and not the time in which nobody works."""
    scene = floor()
    points(scene)
    subject = SubjectWithPeers(scene)
    job = subject.new_job("culled", RenderSettings(SIZE, 2, 0, 2, emission_apart=True))
    before = time.process_time()
    job.render_pass()
    time.sleep(0.2)
    took = time.process_time() - before
    stats = job.stats()
    assert 0 < stats.setup_seconds < stats.seconds
    assert stats.seconds - stats.setup_seconds <= took / 2 < 0.1
    assert stats.spp == 1 and stats.selections > 0
    alone = lightcull.render(scene, "culled", spp=1, size=SIZE, threads=2)
    assert np.array_equal(job.image(), alone.image)


def write_layers(path: Path, layers: dict[str, np.ndarray]) -> None:
    """An OpenEXR file of several layers, float32 (H, W, 3), with what the format asks for."""
    height, width, _ = next(iter(layers.values())).shape
    channels = {
        f"{name}.{color}": np.asarray(image[..., i], "<f4")
        for name, image in layers.items()
        for i, color in enumerate("RGB")
    }
    names = sorted(channels)
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    float32 = struct.pack("<iB3xii", 2, 0, 1, 1)
    attributes = [
        ("channels", "chlist", b"".join(name.encode() + b"\0" + float32 for name in names) + b"\0"),
        ("compression", "compression", b"\0"),
        ("dataWindow", "box2i", window),
        ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", b"\0"),
        ("pixelAspectRatio", "float", struct.pack("<f", 1)),
        ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
        ("screenWindowWidth", "float", struct.pack("<f", 1)),
    ]
    header = struct.pack("<ii", 20000630, 2)
    for name, kind, value in attributes:
        header += f"{name}\0{kind}\0".encode() + struct.pack("<i", len(value)) + value
    header += b"\0"
    rows = [b"".join(channels[name][y].tobytes() for name in names) for y in range(height)]
    size = 8 + len(rows[0])
    begin = len(header) + 8 * height
    offsets = b"".join(struct.pack("<Q", begin + y * size) for y in range(height))
    lines = b"".join(struct.pack("<ii", y, len(row)) + row for y, row in enumerate(rows))
    path.write_bytes(header + offsets + lines)


def test_layers_are_read_by_their_names(tmp_path: Path) -> None:
    random = np.random.default_rng(3)
    layers = {
        name: random.random((3, 5, 3), np.float32)
        for name in ("View.Combined", "View.Emit", "View.NotEmit", "Env")
    }
    file = tmp_path / "layers.exr"
    write_layers(file, layers)
    for name, image in layers.items():
        found = lightcull._core.read_layer(str(file), name.rpartition(".")[2])
        assert np.array_equal(found, image)
    with pytest.raises(lightcull.Error, match="layers.exr: cannot read: there is no layer mit"):
        lightcull._core.read_layer(str(file), "mit")


class CountingPeer:
    """A renderer that shows the number of its first sample, and takes 10 ms for each."""

    description = "counting"

    def __init__(self) -> None:
        self.orders: list[tuple[int, int, int]] = []

    def render(
        self, first: int, samples: int, seed: int
    ) -> tuple[np.ndarray, np.ndarray, float]:
        self.orders.append((first, samples, seed))
        image = np.full((2, 3, 3), first, np.float32)
        return image, image / 4, 0.01 * samples


def test_a_job_is_the_mean_of_passes_that_grow() -> None:
    peer = CountingPeer()
    job = PeerJob(peer, 5, 40)
    while job.stats().spp < 40:
        job.render_pass()
    firsts, samples, seeds = zip(*peer.orders, strict=True)
    assert samples == (1, 2, 4, 8, 16, 9)  # as many as were asked for
    assert firsts == (0, 1, 3, 7, 15, 31)
    assert len(set(seeds)) == 1 and 0 <= seeds[0] < 2**31
    mean = sum(first * count for first, count, _ in peer.orders) / 40
    assert job.image() == pytest.approx(mean)
    assert job.emission() == pytest.approx(mean / 4)
    assert job.lit() == pytest.approx(mean * 3 / 4)
    assert job.stats().seconds == pytest.approx(0.4)
    other = CountingPeer()
    PeerJob(other, 6, None).render_pass()
    assert other.orders[0][2] not in seeds


def test_an_export_has_all_that_was_added_as_it_is_now() -> None:
    scene = floor()
    lamps(scene)
    textured(scene)
    spots(scene)
    sky_map(scene)
    moved = square(0.3, 1.8, facing_up=False)
    scene.set_mesh_positions(1, moved)
    exported = export(scene)
    assert exported.indices.shape == (2 * 6, 3)
    assert np.array_equal(exported.positions[4:8], moved)
    assert np.array_equal(exported.indices[2:4], QUAD + 4)
    of_lamp = exported.surfaces[exported.surface[2]]
    assert (of_lamp.radiance, of_lamp.two_sided) == ((4, 5, 3), False)
    assert exported.materials[of_lamp.material]["base_color"] == (0, 0, 0)
    floor_surface = exported.surfaces[exported.surface[0]]
    assert floor_surface == Surface(0, None, None, False)
    assert exported.surfaces[exported.surface[-1]].emission_texture == 0
    assert not exported.smooth.any()
    assert [spot["inner"] for spot in exported.spots] == pytest.approx([0.2, 0.4, 0.4], rel=1e-5)
    assert [spot["outer"] for spot in exported.spots] == pytest.approx([0.6, 0.4, 2.5], rel=1e-5)
    assert exported.environment is not None
    assert exported.environment["rotation"] == pytest.approx(0.7)
    virtual = floor()
    points(virtual)
    virtual.add_virtual_lights(16)
    with pytest.raises(lightcull.Error, match="virtual lights, which no other renderer knows"):
        export(virtual)


def test_an_export_has_textures_decoded() -> None:
    scene = floor()
    scene.add_texture(np.uint8([[[255, 188, 0]]]))
    scene.add_texture(np.uint16([[65535, 13107]]), linear_data=True)
    colors, numbers = export(scene).textures
    assert colors[0, 0] == pytest.approx([1, 0.5029, 0], abs=1e-4)
    np.testing.assert_allclose(numbers[0], [[1, 1, 1], [0.2, 0.2, 0.2]], rtol=1e-6)


def test_an_export_refuses_what_is_not_handed_on() -> None:
    scene = floor()
    mask = scene.add_texture(np.uint8([[0, 255]]), linear_data=True)
    for material in ({"opacity": 0.5}, {"opacity_texture": mask}):
        cut = floor()
        cut.add_texture(np.uint8([[0, 255]]), linear_data=True)
        uvs = np.zeros((4, 2))
        cut.add_mesh(square(1, 1, facing_up=True), QUAD, uvs=uvs, material=cut.add_material(**material))
        with pytest.raises(lightcull.Error, match="scene: it has cut-outs: other renderers are not"):
            export(cut)
    scene.add_mesh(square(1, 1, facing_up=True), QUAD, colors=np.full((4, 3), 0.5))
    scene.set_camera((0, 3, 6), (0, 0, 0), orthographic_height=2)
    with pytest.raises(lightcull.Error, match="it has colours of vertices, an orthographic camera:"):
        export(scene)


def test_a_pbrt_file_says_what_the_scene_is(tmp_path: Path) -> None:
    scene = floor()
    lamps(scene)
    points(scene)
    spots(scene)
    sun(scene)
    sky(scene)
    text = write_pbrt(tmp_path, export(scene), SIZE, 3).read_text()
    for line in (
        "Scale -1 1 1",
        "LookAt 0 3 6 0 0.5 0 0 1 0",
        f'Camera "perspective" "float fov" [{math.degrees(0.8):.9g}]',
        '"integer xresolution" [32] "integer yresolution" [24]',
        'Integrator "path" "integer maxdepth" [2]',
        'LightSource "point" "rgb I" [3 2 1] "point3 from" [0 1.5 0]',
        'LightSource "infinite" "rgb L" [0.600000024 1 1.39999998]',
        'Material "diffuse" "rgb reflectance" [0.699999988 0.5 0.300000012]',
        'AreaLightSource "diffuse" "rgb L" [2 1 3] "bool twosided" true',
        'AreaLightSource "diffuse" "rgb L" [4 5 3] "bool twosided" false',
    ):
        assert line in text
    files = list(tmp_path.glob("*.ply"))
    assert text.count('"plymesh"') == text.count("AttributeBegin") == len(files)
    ply = (tmp_path / "surface0.ply").read_bytes()
    header, data = ply.split(b"end_header\n")
    assert b"element vertex 4" in header and b"element face 2" in header
    vertices = np.frombuffer(data, "<f4", 20).reshape(4, 5)
    assert np.array_equal(vertices[:, :3], square(4, 0, facing_up=True))
    assert len(data) == 4 * 20 + 2 * 13


def test_a_pbrt_file_cannot_have_maps_that_emit(tmp_path: Path) -> None:
    refused = {"multiplies a texture": textured, "the environment is a map": sky_map}
    for message, kind in refused.items():
        scene = floor()
        kind(scene)
        with pytest.raises(lightcull.Error, match=message):
            write_pbrt(tmp_path, export(scene), SIZE, 3)


def test_pbrt_is_called_where_its_program_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By one that keeps its arguments and shows 1 everywhere, of which a quarter is emission."""
    monkeypatch.setenv("PATH", str(tmp_path) + os.pathsep + os.environ["PATH"])
    program, script = tmp_path / "pbrt", tmp_path / "pbrt.py"
    # The path of a "#!" may hold no blank.
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{script}" "$@"\n')
    script.write_text(
        "import sys, numpy, lightcull\n"
        f"print(*sys.argv[1:], file=open({str(tmp_path / 'calls')!r}, 'a'))\n"
        "path = sys.argv[sys.argv.index('--outfile') + 1]\n"
        "value = 0.25 if 'emission' in path else 1\n"
        "lightcull.write_exr(path, numpy.full((24, 32, 3), value, numpy.float32))\n"
        "sys.exit('a line' if '--seed' not in sys.argv else 0)\n"
    )
    program.chmod(0o755)
    scene = floor()
    points(scene)
    result = lightcull.compare(scene, ["pbrt"], spp=2, size=SIZE, threads=2)
    (run,) = result.samplers["pbrt"]
    assert np.all(run.image == 1) and np.all(run.lit_image == 0.75)
    setup, *calls = (tmp_path / "calls").read_text().splitlines()
    assert "--pixelbounds 0,1,0,1" in setup
    assert len(calls) >= 2 and all("--nthreads 2" in call for call in calls)
    program.write_text("#!/bin/sh\necho reading; echo no scene; exit 1\n")
    with pytest.raises(lightcull.Error, match="^pbrt: it failed: no scene$"):
        lightcull.compare(scene, ["pbrt"], spp=2, size=SIZE)
    monkeypatch.setenv("PATH", "")
    with pytest.raises(lightcull.Error, match="there is no program pbrt on the path"):
        lightcull.compare(scene, ["pbrt"], spp=2, size=SIZE)


@with_pbrt
@pytest.mark.parametrize("kind", ["lamps", "points", "sun", "sky"])
def test_pbrt_shows_the_same_scene(kind: str) -> None:
    """Of grey materials and lights: pbrt computes with spectra."""
    scene = lightcull.Scene("grey")
    scene.add_mesh(square(4, 0, facing_up=True), QUAD)
    scene.set_camera(origin=(0, 3, 6), target=(0, 0.5, 0))
    down = square(0.3, 2, facing_up=False)
    {
        "lamps": lambda: scene.add_light_mesh(down, QUAD, radiance=(4, 4, 4)),
        "points": lambda: scene.add_point_light((0, 1.5, 0), (3, 3, 3)),
        "sun": lambda: scene.add_directional_light((0.3, -1, 0.2), (1, 1, 1)),
        "sky": lambda: scene.set_environment((0.5, 0.5, 0.5)),
    }[kind]()
    subject = SubjectWithPeers(scene)
    ours, theirs = (many_means(subject, name, 64, "lit") for name in ("culled", "pbrt"))
    assert_alike(ours, theirs)
