"""lightcull bench: what it measures and writes. Never a time."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import lightcull
import numpy as np
import pytest
from conftest import Outcome, make_room
from lightcull import _core, scenes
from lightcull.bench import Row, bench
from lightcull.cli import bench_command, bench_scenes
from lightcull.scenes.random_numbers import Chance

Run = Callable[..., Outcome]
SIZE = (32, 24)
KEYS = {
    "scene": str, "lights": int, "points": str, "sampler": str, "device": str, "entry": str,
    "target": str, "threads": int, "ns_per_selection": float, "selections_per_second": float,
    "shadow_ray_ns": float, "rays_arrived": float, "nodes_per_point": float, "lights_tested_per_point": float,
    "refit_ns_per_light": float, "build_seconds": float, "bytes_per_light": float,
    "cells": int, "publish_seconds": float,
}  # fmt: skip
"""What scripts read."""


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    samplers = ["light_bvh", "culled:sets=16", "exhaustive"]
    return list(bench(make_room(), samplers, size=SIZE, threads=(1, 2)))


def one_light_scene() -> lightcull.Scene:
    """A square with nothing beside it: what scatters from it leaves."""
    scene = make_room(lamps=0)
    scene.add_point_light((0, 2, 0), (1, 1, 1))
    return scene


def test_there_is_a_row_for_every_setting(rows: list[Row]) -> None:
    settings = [(row.threads, row.points, row.target, row.sampler, row.entry) for row in rows]
    assert settings == [
        (threads, points, _core.instruction_sets()[0], sampler, entry)
        for threads in (1, 2)
        for points in ("camera", "scattered", "uniform")
        for sampler in ("light_bvh", "culled:sets=16", "exhaustive")
        for entry in ("batch", "single")
    ]
    assert {(row.scene, row.lights) for row in rows} == {("room", 6)}
    for row in rows:
        assert row.ns_per_selection > 0
        assert row.selections_per_second == pytest.approx(1e9 / row.ns_per_selection)
        assert row.shadow_ray_ns is not None and row.shadow_ray_ns > 0
        assert row.build_seconds > 0
        assert row.bytes_per_light > 0


def test_work_is_counted(rows: list[Row]) -> None:
    for row in rows:
        if row.sampler == "exhaustive":
            assert (row.nodes_per_point, row.lights_tested_per_point) == (0, 6)
        else:
            assert 1 <= row.nodes_per_point
            assert row.lights_tested_per_point <= 6
    by_threads = [
        [(row.nodes_per_point, row.lights_tested_per_point) for row in rows if row.threads == count]
        for count in (1, 2)
    ]
    assert by_threads[0] == by_threads[1]


def test_a_sampler_that_learns_does_so_before_it_is_measured() -> None:
    rows = list(bench(make_room(), ["learned", "culled"], size=SIZE, threads=(1,)))
    culled = [row for row in rows if row.sampler == "culled"]
    assert all(row.cells == 0 and row.publish_seconds == 0 for row in culled)
    for row in rows:
        assert row.rays_arrived is not None and 0 < row.rays_arrived <= 1
        if row.sampler == "learned":
            assert row.cells > 0 and row.publish_seconds > 0


def test_points_are_those_of_the_renderer() -> None:
    timed = _core.TimedSampler(make_room().closed(), "culled:sets=16", *SIZE, 4, 1)
    camera, bounce = timed.path_points(1), timed.path_points(2)
    # Some pixels see past the floor; some paths leave the room or end on it.
    assert 0 < len(bounce) < len(camera) < SIZE[0] * SIZE[1]
    assert timed.set_count() == 16
    stats = lightcull.render(make_room(), "culled:sets=16", spp=1, size=SIZE, max_depth=4).stats
    assert stats.selections == sum(len(timed.path_points(depth)) for depth in (1, 2, 3))
    with pytest.raises(lightcull.Error, match="depth is not in"):
        timed.path_points(0)


def test_points_are_thinned_evenly() -> None:
    timed = _core.TimedSampler(make_room().closed(), "uniform", 320, 240, 2, 1)
    chance = Chance(1)
    positions, normals = (chance.directions(10_000).astype(np.float32) for _ in range(2))
    points = timed.points(positions, normals)
    assert len(points) == 10_000
    assert 900 < len(points.thinned(1_000)) < 1_100
    assert len(points.thinned(10**9)) == 10_000
    assert len(points.thinned(1)) == 64


def test_shadow_rays_go_where_a_light_was_chosen() -> None:
    timed = _core.TimedSampler(one_light_scene().closed(), "exhaustive", *SIZE, 2, 1)
    position = np.float32([[0, 1, 0], [1, 1, 0]])
    # Only the first faces the light.
    points = timed.points(position, np.float32([[0, 1, 0], [0, -1, 0]]))
    assert timed.trace_shadow_rays(points)[1] == 0
    timed.select_batch(points)
    assert timed.trace_shadow_rays(points)[1] == 1


def test_every_instruction_set_is_measured() -> None:
    available = _core.instruction_sets()
    measured = list(bench(make_room(), ["culled"], size=SIZE, threads=[1], targets=available))
    assert list(dict.fromkeys(row.target for row in measured)) == available
    counts = {(row.points, row.nodes_per_point, row.lights_tested_per_point) for row in measured}
    assert len(counts) == 3


def test_points_that_there_are_not_are_said() -> None:
    with pytest.warns(UserWarning, match="room: there are no scattered points"):
        measured = list(bench(one_light_scene(), ["uniform"], size=SIZE, threads=[1]))
    assert {row.points for row in measured} == {"camera", "uniform"}


def test_what_makes_no_sense_is_said_first(room: lightcull.Scene) -> None:
    for scene, options, message in [
        (room, {"samplers": ["cold"]}, "cold"),
        (room, {"threads": [0]}, "threads: wanted numbers from 1 up"),
        (make_room(lamps=0), {}, "room: there are no surfaces or no lights"),
        (room, {"targets": ["MMX"]}, "MMX"),
    ]:
        with pytest.raises(lightcull.Error, match=message):
            next(bench(scene, **{"samplers": ["uniform"], "size": SIZE, **options}))


# The command


def test_the_command_prints_tables_and_writes_rows(main_here: Run, tmp_path: Path) -> None:
    result = main_here(
        "bench", "cornell", "--samplers", "light_bvh,culled", "--size", "32x24", "--threads", "2",
        "--json", "new/rows.json",
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    assert not result.stderr
    best = _core.instruction_sets()[0]
    for text in (f"cornell, 2 lights: scattered points, 2 threads, {best}", "light_bvh", "per s", "B/light"):
        assert text in result.stdout
    written = json.loads((tmp_path / "new" / "rows.json").read_text())
    assert len(written) == 3 * 2 * 2
    for row in written:
        assert {key: type(value) for key, value in row.items()} == KEYS
        assert all(math.isfinite(row[key]) for key, kind in KEYS.items() if kind is float)


def test_bad_input_is_one_line(main_here: Run, tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    for arguments, code, message in [
        (("lantern",), 1, "'lantern' is neither a file nor an example scene: did you mean"),
        (("cornell", "zzz.glb"), 1, "zzz.glb: no such file"),
        (("cornell", "--json", "folder"), 1, "folder: is a folder"),
        (("cornell", "--targets", "MMX"), 2, "no instruction set 'MMX' here; there are "),
        (("cornell", "--threads", "1,none"), 2, "wanted a whole number from 1 up, got 'none'"),
        (("cornell", "--samplers", "cold"), 2, "argument --samplers: "),
        (("cornell", "--size", "32"), 2, "wanted WIDTHxHEIGHT"),
    ]:
        result = main_here("bench", *arguments)
        assert result.returncode == code, arguments
        (line,) = result.stderr.splitlines()
        assert message in line
        assert not result.stdout


def test_ctrl_c_keeps_what_was_measured(
    main_here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*arguments, **options):
        yield from [*bench(*arguments, **options)][:2]
        raise KeyboardInterrupt

    monkeypatch.setattr(bench_command, "bench", interrupted)
    result = main_here(
        "bench", "cornell", "--samplers", "uniform", "--size", "32x24", "--json", "rows.json"
    )
    assert result.returncode == 130
    assert "cornell, 2 lights: camera points" in result.stdout
    assert len(json.loads((tmp_path / "rows.json").read_text())) == 2


def test_scenes_by_default_are_the_examples_and_the_series(
    main_here: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = []
    monkeypatch.setattr(bench_scenes, "open_scene", lambda name, **_: made.append((name, None)))
    monkeypatch.setattr(scenes, "build", lambda name, lights: made.append((name, lights)))
    monkeypatch.setattr(bench_command, "_bench", lambda *arguments: None)
    assert main_here("bench").returncode == 0
    series = [("lanterns", lights) for lights in bench_scenes.SERIES_LIGHTS]
    assert sorted(map(str, made)) == sorted(
        map(str, [(name, None) for name in scenes.NAMES if name != "lanterns"] + series)
    )


# The series


def test_series_has_constant_power() -> None:
    powers = {}
    for lights in (1_000, 10_000, 54_720, 60_000):
        scene = scenes.build("lanterns", lights=lights)
        assert len(scene.lights()) == lights
        powers[lights] = scene.lights()["intensity"].sum(dtype=np.float64)
    for power in powers.values():
        # The default's power is known to six digits; float32 radiances add a few of the last.
        assert power == pytest.approx(powers[54_720], rel=1e-4)


def test_more_lanterns_are_smaller_and_spread_over_the_same_ground() -> None:
    few, default, many = (
        scenes.build("lanterns", lights=lights).lights() for lights in (10_000, 54_720, 120_000)
    )
    assert few["radius"].mean() == pytest.approx(default["radius"].mean(), rel=0.05)
    assert many["radius"].mean() == pytest.approx(default["radius"].mean() / 3**0.5, rel=0.05)
    for lights in (few, many):
        middle, reach = (
            [how(v["center"][:, [0, 2]], axis=0) for v in (lights, default)]
            for how in (np.mean, np.std)
        )
        # 500 lanterns over 120 m have their mean within 1.6 m; the seed is fixed.
        np.testing.assert_allclose(*middle, atol=2.0)
        np.testing.assert_allclose(*reach, rtol=0.1)


@pytest.mark.parametrize("lights", [0, -20, 1_001])
def test_lights_of_lanterns_come_in_twenties(lights: int) -> None:
    with pytest.raises(lightcull.Error, match="lights must be a multiple of 20"):
        scenes.build("lanterns", lights=lights)
