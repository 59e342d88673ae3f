"""What renders take of memory: as foretold, little enough, and no more after a thousand passes."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

import lightcull
from conftest import QUAD, make_room, square

Command = Callable[..., subprocess.CompletedProcess[str]]

PEAK = """
import sys
from lightcull.cli import main
code = main()
from lightcull import memory
print("peak", memory.of_process("VmHWM"))
sys.exit(code)
"""
UNITS = {"KiB": 2**10, "MiB": 2**20, "GiB": 2**30}
FACTOR = 1.15
"""Between what `lightcull info` says and the largest resident size that is measured, either way."""


def foretold(command: Command, *arguments: str) -> dict[str, float]:
    """What `lightcull info` says, in bytes."""
    text = " ".join(command("info", *arguments).stdout.split("memory", 1)[1].split())
    amounts = re.findall(r"([^,;:]*?) ?([0-9.]+) ([KMG]iB)([^,;]*)", text)
    return {(before + after).strip(): float(n) * UNITS[unit] for before, n, unit, after in amounts}


def measured(command: Command, *arguments: str) -> int:
    result = command("render", *arguments, "-o", "a.exr", program=("-c", PEAK))
    assert result.returncode == 0, result.stderr
    return int(result.stdout.split("peak ")[1])


@pytest.mark.parametrize(
    "arguments",
    [
        ("cornell",),
        ("cornell", "--size", "2400x1600", "--max-depth", "4"),
        ("lanterns", "--sampler", "culled:sets=256", "--size", "640x480"),
        ("lanterns", "--sampler", "light_bvh"),
        ("million",),
        ("cornell", "--method", "vpl_all:lights=700000:shadows=none", "--size", "8x8"),
        ("cornell", "--method", "vpl_culled:lights=700000"),
        ("cornell", "--method", "vpl_culled:lights=50000:shadows=maps", "--size", "32x24"),
        ("cornell", "--method", "vpl_grid:lights=200000:shadows=none", "--size", "32x24"),
        ("cornell", "--method", "vpl_culled:lights=1000", "--size", "1600x1200"),
    ],
)
def test_a_render_takes_what_info_says(command: Command, arguments: tuple[str, ...]) -> None:
    said = foretold(command, *arguments)
    peak = next(iter(said.values()))  # comes first
    learned = said.get("what is learned at most", 0.0)
    was = measured(command, *arguments, "--spp", "2")
    assert (peak - learned) / FACTOR < was < peak * FACTOR, (said, was)


MILLION = """
import numpy as np
import lightcull
from lightcull import memory

scene = lightcull.example_scene("million")
random = np.random.default_rng(1)
places = random.uniform((-200, 0, -200), (200, 2, 200), (202_000, 1, 3))
corners = (places + random.uniform(-0.05, 0.05, (202_000, 3, 3))).astype(np.float32)
scene.add_mesh(corners.reshape(-1, 3), np.arange(606_000, dtype=np.uint32).reshape(-1, 3))
result = lightcull.render(scene, spp=2)
assert result.image.any()
print(len(scene.lights()), scene.triangle_count, memory.of_process("VmHWM"))
"""


def test_a_million_lights_among_two_million_triangles_take_less_than_two_gibibytes(
    command: Command,
) -> None:
    result = command(program=("-c", MILLION))
    assert result.returncode == 0, result.stderr
    lights, triangles, peak = map(int, result.stdout.split())
    assert lights > 1_000_000
    assert triangles > 2_000_000
    assert peak < 2 * 2**30


@pytest.mark.parametrize("method", ["vpl_all", "vpl_culled:source=shadow_map", "vpl_grid"])
def test_virtual_lights_for_which_there_is_no_memory(
    monkeypatch: pytest.MonkeyPatch, method: str
) -> None:
    """Found out before anything is rendered."""
    from lightcull import memory

    monkeypatch.setattr(memory, "available", lambda: 2**30)
    scene = lightcull.Scene("room")
    scene.add_mesh(square(4, 0, facing_up=True), QUAD)
    scene.add_spot_light((0, 2, 0), (0, -1, 0), (1, 1, 1), 0.1, 0.5)
    many = f"{method}:lights={2**26}"
    said = f"^{many}: its virtual lights need [0-9.]+ GiB of memory, and 1.0 GiB are free$"
    with pytest.raises(lightcull.Error, match=said):
        lightcull.render(scene, method=many, max_depth=3, spp=1, size=(8, 8))
    with pytest.raises(lightcull.Error, match=said):
        lightcull.compare_methods(scene, ["path", many], seconds=1e9, size=(8, 8))
    with pytest.raises(lightcull.Error, match=f"^{method}: its image needs 1.[0-9] GiB of memory"):
        lightcull.render(scene, method=method, max_depth=3, spp=1, size=(4096, 2048))


def resident() -> int:
    from lightcull import memory

    return memory.of_process("VmRSS")


@pytest.mark.parametrize("sampler", ["culled", "learned", "light_bvh", "paper"])
def test_a_thousand_passes_do_not_grow_the_process(sampler: str, tmp_path: Path) -> None:
    """A leak of 64 bytes per pixel or pass would be seen."""
    sizes: dict[int, int] = {}

    def look(step: lightcull.Progress) -> None:
        if step.spp in (100, 1100):
            sizes[step.spp] = resident()

    lightcull.render(
        make_room(), sampler, spp=1100, size=(40, 30), max_depth=3, progress=look,
        checkpoint=tmp_path / "a", every=0.1,
    )  # fmt: skip
    assert sizes[1100] - sizes[100] < 2**20


def test_renders_one_after_the_other_do_not_grow_the_process() -> None:
    def render() -> None:
        lightcull.render(make_room(), "culled", spp=1, size=(64, 48))

    for _ in range(20):
        render()
    before = resident()
    for _ in range(100):
        render()
    assert resident() - before < 2 * 2**20
