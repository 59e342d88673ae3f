"""The command line."""

from __future__ import annotations

import io
import json
import time
from collections.abc import Callable
from dataclasses import FrozenInstanceError
from importlib.metadata import entry_points
from pathlib import Path
from subprocess import CompletedProcess

import numpy as np
import pytest
from rich.console import Console
from rich.table import Table

import lightcull
from conftest import Outcome
from gltf_file import GltfFile
from lightcull.cli import options, progress_bars
from lightcull.cli.parser import make_parser
from lightcull.cli.tables import print_table
from lightcull.scenes import NAMES

Run = Callable[..., CompletedProcess[str] | Outcome]
TINY = ("--size", "32x24", "--spp", "2")

INTERRUPTED_IN_TURN = """
import os, signal, sys
from lightcull.cli import main, progress_bars
shown = progress_bars.Bars.__call__
def show(self, progress):
    shown(self, progress)
    if progress.stage == "{stage}":
        os.kill(os.getpid(), signal.SIGINT)
progress_bars.Bars.__call__ = show
sys.exit(main())
"""


BEGIN = "from lightcull_command import main; sys.exit(main())"
INTERRUPTED_IMPORT = (
    """
import signal, sys
class CtrlC:
    @staticmethod
    def find_spec(name, *_):
        if name == "{module}":
            signal.raise_signal(signal.SIGINT)
sys.meta_path.insert(0, CtrlC)
"""
    + BEGIN
)


def only_line(text: str) -> str:
    lines = text.splitlines()
    assert len(lines) == 1, text
    return lines[0]


def test_a_table_is_printed_whole_where_there_is_no_room(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    table = Table("sampler", "figures")
    table.add_column("last", no_wrap=True)
    table.add_row("light_bvh:importance=means", "0.123456789", "0.987654321")
    print_table(table)
    shown = capsys.readouterr().out
    assert "light_bvh:importance=means" in shown
    assert "0.987654321" in shown
    assert "last" in shown


@pytest.mark.parametrize("patience", [0.0, 1e6])
def test_a_file_that_takes_long_is_said_to_be_read(
    monkeypatch: pytest.MonkeyPatch, patience: float
) -> None:
    terminal = io.StringIO()
    shown = Console(file=terminal, force_terminal=True)
    monkeypatch.setattr(progress_bars, "Console", lambda **_: shown)
    monkeypatch.setattr(progress_bars, "PATIENCE", patience)
    with progress_bars.reading("a[b].ply"):
        while patience == 0 and "reading a[b].ply" not in terminal.getvalue():
            time.sleep(0.01)
    assert ("reading" in terminal.getvalue()) == (patience == 0)


def test_help_teaches(main_here: Run) -> None:
    overview = main_here("--help")
    assert overview.returncode == 0
    words = ("render", "compare", "info", "bench", "examples:", "130")
    for word in (*NAMES, *lightcull.SAMPLERS, *words):
        assert word in overview.stdout
    for name in ("render", "compare", "info", "bench"):
        text = main_here(name, "--help").stdout
        assert f"lightcull {name} " in text.split("examples:")[1]
    shared = ("--size WxH", "--max-depth N", "--seconds S", "--spp N", "--threads N", "--seed N")
    for name in ("render", "compare"):
        text = main_here(name, "--help").stdout
        assert all(option in text for option in (*shared, "-o PATH"))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "required: COMMAND"),
        (("paint",), "invalid choice: 'paint'"),
        (("render",), "required: SCENE"),
        (("render", "cornell", "--size", "32"), "wanted WIDTHxHEIGHT such as 640x360, got '32'"),
        (("render", "cornell", "--seconds", "0"), "wanted a number above 0, got '0'"),
        (("render", "cornell", "--spp", "many"), "wanted a whole number from 1 up, got 'many'"),
        (("render", "cornell", "--spp", "1", "--seconds", "1"), "not allowed with argument"),
        (("render", "cornell", "--sampler", "cold"), "argument --sampler: "),
        (("compare", "cornell", "--samplers", "culled,cold"), "argument --samplers: "),
        (("compare", "cornell", "--samplers", "culled:sets=3"), "argument --samplers: "),
        (("info", "cornell", "--loud"), "unrecognized arguments: --loud"),
    ],
)
def test_wrong_usage_is_two(main_here: Run, arguments: tuple[str, ...], message: str) -> None:
    result = main_here(*arguments)
    assert result.returncode == 2
    line = only_line(result.stderr)
    assert message in line
    assert line.startswith("lightcull")
    assert line.endswith("--help)")
    assert not result.stdout


def test_errors_are_one_line_and_one(main_here: Run, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "folder.exr").mkdir()
    (tmp_path / "broken.glb").write_text("no")
    for arguments, message in [
        (("info", "lantern"), "did you mean 'lanterns'?; there are lanterns, city"),
        (("info", "zzz"), "'zzz' is neither a file nor an example scene; there are"),
        (("info", "zzz.glb"), "zzz.glb: no such file"),
        (("info", "broken.glb"), "broken.glb: is not a binary glTF file"),
        (("render", "cornell", "-o", "a.jpg"), "a.jpg: the name must end in .exr or .png"),
        (("render", "cornell", "-o", "file/a.exr"), "file: cannot write there"),
        (("render", "cornell", "-o", "folder.exr"), "folder.exr: is a folder"),
        (("render", "cornell", "-o", "a.png", "--view", "sepia"), "no view 'sepia'; there are"),
        (("render", "cornell", "-o", "a.exr", "--view", "srgb"), "an .exr stays linear"),
        (("compare", "cornell", "-o", "file"), "file: cannot write there"),
    ]:
        result = main_here(*arguments)
        assert result.returncode == 1, arguments
        line = only_line(result.stderr)
        assert line.startswith("lightcull: error: ")
        assert message in line
        assert not result.stdout


def resolved(*arguments: str) -> options.Options:
    return options.resolve(make_parser().parse_args(arguments), arguments)


def test_options_are_resolved_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    render = resolved("render", "cornell")
    assert isinstance(render, options.RenderOptions)
    assert (render.scene.name, render.output) == ("cornell", Path("cornell.exr"))
    assert (render.seconds, render.spp) == (10.0, None)
    assert (render.size, render.max_depth, render.exposure) == ((320, 240), 2, 0.0)
    with pytest.raises(FrozenInstanceError):
        render.spp = 4  # type: ignore[misc]
    assert render.hide_emitters is False
    assert resolved("render", "cornell", "--hide-emitters").hide_emitters is True
    bounced = resolved("render", "cornell", "--method", "vpl_culled", "--spp", "4")
    assert (bounced.seconds, bounced.spp, bounced.max_depth) == (None, 4, 3)
    compare = resolved("compare", "cornell", "--size", "8x6")
    assert isinstance(compare, options.CompareOptions)
    assert (compare.samplers, render.sampler) == (None, None)
    assert (compare.seconds, compare.size, compare.folder) == (30.0, (8, 6), Path("report"))
    assert compare.command == "lightcull compare cornell --size 8x6"
    methods = resolved("compare", "cornell", "--methods", "path,vpl_grid")
    assert isinstance(methods, options.CompareMethodsOptions)
    assert (methods.methods, methods.max_depth) == (("path", "vpl_grid"), 3)
    info = resolved("info", "cornell", "--max-depth", "5")
    assert (info.settings.size, info.settings.max_depth) == ((320, 240), 5)


def test_render_writes_an_image_and_what_made_it(command: Run, tmp_path: Path) -> None:
    arguments = ("render", "cornell", "--sampler", "power", "--seed", "7", *TINY)
    result = command(*arguments, "-o", "new/folder/a.exr")
    assert result.returncode == 0, result.stderr
    line = only_line(result.stdout)
    assert line.startswith("new/folder/a.exr: 32x24, 2 samples per pixel in ")
    image = lightcull.read_image(tmp_path / "new/folder/a.exr")
    expected = lightcull.render(
        lightcull.example_scene("cornell"), "power", spp=2, size=(32, 24), seed=7
    ).image
    assert np.array_equal(image, expected)
    header = (tmp_path / "new/folder/a.exr").read_bytes()[:4096]
    for text in (b"scene", b"cornell", b"sampler", b"power", b"seed", b"samples", b"seconds"):
        assert text in header


def test_render_of_a_picture(main_here: Run, tmp_path: Path) -> None:
    for name, exposure in (("a.png", "0"), ("b.png", "2")):
        result = main_here("render", "cornell", *TINY, "-o", name, "--exposure", exposure)
        assert result.returncode == 0, result.stderr
    dark, bright = (lightcull.read_image(tmp_path / name) for name in ("a.png", "b.png"))
    assert bright.mean() > dark.mean()


def test_compare_writes_the_report(command: Run, tmp_path: Path) -> None:
    result = command(
        "compare", "cornell", "--samplers", "uniform,culled:sets=16", *TINY, "-o", "r",
        "--threads", "1", "--max-depth", "3", "--reference-seconds", "0.5",
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    report = json.loads((tmp_path / "r" / "report.json").read_text())
    assert list(report["samplers"]) == ["uniform", "culled:sets=16"]
    assert (report["threads"], report["max_depth"]) == (1, 3)
    assert report["command"].startswith("lightcull compare cornell --samplers uniform,culled:")
    assert "culled:sets=16" in result.stdout
    assert result.stdout.splitlines()[-1] == "r/index.html"


def test_compare_with_repeats_and_a_mask(main_here: Run, tmp_path: Path) -> None:
    mask = np.zeros((24, 32, 3), np.float32)
    mask[10:, :16] = 0.1
    lightcull.write_exr(tmp_path / "mask.exr", mask)
    options = ("--samplers", "uniform,culled", *TINY, "--reference-seconds", "0.1", "-o", "r")
    more = ("--repeats", "3", "--mask", "mask.exr", "--metrics", "mape,flip", "--slices", "2")
    result = main_here("compare", "cornell", *options, *more)
    assert result.returncode == 0, result.stderr
    report = json.loads((tmp_path / "r" / "report.json").read_text())
    assert report["pixels"] == 14 * 16
    for run in report["samplers"].values():
        assert run["repeats"] == 3
        assert list(run["metrics"]) == ["mape", "flip"]
        low, high = run["intervals"]["relmse"]
        assert low < run["relmse"] < high
    assert "±" in result.stdout
    assert len(list((tmp_path / "r").glob("*_run3_slice2.exr"))) == 2
    wrong = [
        (("--size", "16x16", "--mask", "mask.exr"), "a mask of 32x24 for an image of 16x16"),
        (("--mask", "no.exr"), "no.exr: "),
        (("--metrics", "mape,mad"), "'mad' is unknown; there are relmse, mape, smape, flip"),
        (("--methods", "path", "--slices", "2"), "--slices: not with --methods"),
        (("--repeats", "0"), "wanted a whole number from 1 up"),
        (("--methods", "path", "--mask", "mask.exr"), "--mask: not with --methods"),
        (("--methods", "path", "--repeats", "2"), "--repeats: not with --methods"),
    ]
    for more, message in wrong:
        result = main_here("compare", "cornell", "--size", "32x24", *more, "-o", "wrong")
        assert result.returncode != 0
        assert message in only_line(result.stderr)


def test_info(main_here: Run, tmp_path: Path) -> None:
    result = main_here("info", "cornell")
    assert result.returncode == 0
    assert not result.stderr
    for text in ("36 in 6 meshes", "2: 2 triangles, 0 points, 0 spots", "39 degrees high"):
        assert text in result.stdout

    file = GltfFile()
    file.node(mesh=file.quad())
    file.node(extensions=file.light(type="directional", intensity=683 * 4))
    file.node(extensions=file.light(type="sun"))
    file.write(tmp_path / "sun.glb")
    result = main_here("info", "sun.glb", "--gltf-lights", "candela")
    assert result.returncode == 0
    line = only_line(result.stderr)
    assert line.startswith("lightcull: warning: sun.glb: not supported and left out: sun lights")
    assert "1: 0 triangles, 0 points, 0 spots, 1 directional lights" in result.stdout
    assert "4 to 4 W/m^2 of directional lights" in result.stdout
    assert "W/sr" not in result.stdout
    refused = main_here("info", "cornell", "--gltf-lights", "watts")
    assert refused.returncode == 1
    assert "is for a .glb or .gltf" in only_line(refused.stderr)


def test_ctrl_c_saves_the_image(command: Run, tmp_path: Path) -> None:
    program = ("-c", INTERRUPTED_IN_TURN.format(stage="learned"))
    result = command(
        "render", "cornell", "--size", "32x24", "--seconds", "10000", "-o", "a.exr",
        program=program,
    )  # fmt: skip
    assert result.returncode == 130, result.stderr
    assert only_line(result.stdout).endswith(", interrupted")
    assert lightcull.read_image(tmp_path / "a.exr").any()


def test_ctrl_c_saves_the_report(command: Run, tmp_path: Path) -> None:
    program = ("-c", INTERRUPTED_IN_TURN.format(stage="culled"))
    result = command(
        "compare", "cornell", "--samplers", "uniform,culled", "--size", "32x24",
        "--seconds", "10000", "--reference-seconds", "0.2", "-o", "r", program=program,
    )  # fmt: skip
    assert result.returncode == 130, result.stderr
    assert result.stdout.splitlines()[-1] == "r/index.html: interrupted"
    report = json.loads((tmp_path / "r" / "report.json").read_text())
    assert all(run["spp"] >= 1 for run in report["samplers"].values())


@pytest.mark.parametrize("module", ["lightcull", "numpy", "lightcull._core", "lightcull.cli.options"])
def test_ctrl_c_while_python_still_imports(command: Run, module: str) -> None:
    program = ("-c", INTERRUPTED_IMPORT.format(module=module))
    result = command("info", "cornell", program=program)
    assert result.returncode == 130
    assert only_line(result.stderr) == "lightcull: interrupted before anything was done"
    assert not result.stdout


def test_the_command_begins_before_the_package(command: Run) -> None:
    (script,) = entry_points(group="console_scripts", name="lightcull")
    assert script.value == "lightcull_command:main"
    result = command("info", "cornel", program=("-c", "import sys; " + BEGIN))
    assert result.returncode == 1
    assert "did you mean 'cornell'?" in only_line(result.stderr)


def test_ctrl_c_before_there_is_anything(command: Run, tmp_path: Path) -> None:
    program = ("-c", INTERRUPTED_IN_TURN.format(stage="reference"))
    result = command("compare", "cornell", *TINY, "-o", "r", program=program)
    assert result.returncode == 130
    assert "interrupted before there was anything to save" in result.stderr
    assert not (tmp_path / "r" / "report.json").exists()
