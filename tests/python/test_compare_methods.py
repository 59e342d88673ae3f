"""lightcull compare --methods."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import lightcull
from conftest import Outcome, make_room
from lightcull.methods import measure, volumes
from lightcull.rendering.settings import RenderSettings

STUDIES = ["equal_time", "scaling", "volumes", "splatting", "shadow_maps", "hierarchy"]


def bench(scene: lightcull.Scene, size: tuple[int, int]) -> measure.Bench:
    return measure.Bench(scene, RenderSettings(size, 3, 0, 0), 4096, 0.1, lambda *_: None)


def test_the_report_has_every_study(main_here: Callable[..., Outcome], tmp_path: Path) -> None:
    methods = "path,vpl_culled:lights=500,vpl_clamped:lights=500:accepted=0.3"
    options = ("--size", "32x24", "--seconds", "0.2", "--most-lights", "1024", "-o", "r")
    outcome = main_here("compare", "cornell", "--methods", methods, *options)
    assert outcome.returncode == 0, outcome.stderr
    report = json.loads((tmp_path / "r" / "report.json").read_text())
    assert list(report["studies"]) == STUDIES
    page = (tmp_path / "r" / "index.html").read_text()
    for study in report["studies"].values():
        assert study["finding"] in outcome.stdout
        assert study["title"] in page
        assert all(len(row) == len(study["columns"]) for row in study["rows"])
    for key, study in report["studies"].items():
        with (tmp_path / "r" / f"{key}.csv").open(newline="") as stream:
            columns, *rows = csv.reader(stream)
        assert columns == study["columns"]
        assert rows == [["" if cell is None else str(cell) for cell in row] for row in study["rows"]]
    brightness = report["studies"]["equal_time"]["figures"]
    assert brightness["brightness_vpl_clamped:lights=500:accepted=0.3"] < 0.8
    assert (tmp_path / "r" / "reference.png").is_file()
    assert (tmp_path / "r" / "vpl_culled_lights-500.exr").is_file()
    assert (tmp_path / "r" / "alpha-0.02-spheroid.png").is_file()


def test_bounced_light_is_what_a_method_adds() -> None:
    own = bench(lightcull.example_scene("cornell"), (32, 24))
    found = measure.measure(own, "vpl_all:lights=50:shadows=none", 2)
    assert found.bounced.min() > -1e-6
    assert found.bounced.max() > 0
    assert found.counts.listed == pytest.approx(found.counts.lights, rel=1e-3)
    assert 0 < found.counts.accepted < found.counts.listed  # not those that face away


def test_a_spheroid_lists_fewer_lights_than_spheres_the_more_so_the_glossier() -> None:
    study = volumes.spheroids(bench(make_room(), (160, 120)))
    for row in study.table.rows:
        accepted, spheroid, around, at_light = row[1:5]
        assert accepted < spheroid < around < at_light
    removed = list(study.figures.values())
    assert removed[0] > 0.9
    assert np.all(np.diff(removed) < 0)


def test_constant_ranges_accept_in_proportion_to_the_lights() -> None:
    own = bench(lightcull.example_scene("cornell"), (64, 48))
    lights, accepted = [], {"vpl_culled": [], "vpl_clamped": []}
    for number in (1024, 16384):
        for method, counts in accepted.items():
            found = measure.measure(
                own, f"{method}:lights={number}:error_bound=0.3:shadows=none:interleave=1"
            ).counts
            counts.append(found.accepted)
        lights.append(found.lights)
    assert measure.exponent(lights, accepted["vpl_clamped"]) == pytest.approx(1.0, abs=0.1)
    assert measure.exponent(lights, accepted["vpl_culled"]) < 0.6


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--methods", "vpl"), "unknown; there are path"),
        (("--methods", "path", "--spp", "3"), "--spp: methods are compared in equal time"),
        (("--methods", "path", "--most-lights", "0"), "wanted a whole number from 1 up"),
        (("--methods", "path", "--samplers", "power"), "--samplers: not with --methods"),
        (("--methods", "path", "--reference-seconds", "1"), "--reference-seconds: not with --meth"),
        (("--most-lights", "2048"), "--most-lights: only with --methods"),
        (("--methods", "vpl_all", "--max-depth", "6"), "max_depth is 6, wanted 3 to 5"),
        (
            ("--methods", "path,vpl_culled:source=shadow_map"),
            "only spots, directional lights and the environment can have one",
        ),
        (("--methods", "path", "--max-depth", "2"), "max_depth is 2: virtual lights give"),
    ],
)
def test_what_cannot_be_compared_is_refused(
    main_here: Callable[..., Outcome], tmp_path: Path, options: tuple[str, ...], says: str
) -> None:
    """At once: nobody would wait for a reference of 480 seconds."""
    outcome = main_here("compare", "cornell", *options, "-o", "r")
    assert outcome.returncode != 0
    assert says in outcome.stderr
    assert len(outcome.stderr.splitlines()) == 1
    assert not (tmp_path / "r").exists()


@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        ({"methods": "path"}, TypeError, "methods: wanted several, got 'path'"),
        ({"methods": []}, lightcull.Error, "methods: wanted one at least"),
        ({"methods": [3]}, TypeError, "method: wanted a string, got 3"),
        ({"scene": None}, TypeError, "scene: wanted a lightcull.Scene, got None"),
        ({"seconds": float("nan")}, lightcull.Error, "seconds: wanted more than 0, got nan"),
        ({"seconds": "a"}, TypeError, "seconds: wanted a number, got 'a'"),
        ({"most_lights": 2**31}, lightcull.Error, "most_lights: wanted at most 67108864"),
        ({"most_lights": 0}, lightcull.Error, "most_lights: wanted a whole number from 1 up"),
        ({"threads": 65536}, lightcull.Error, "threads is above 65535"),
        ({"folder": "/proc/r"}, lightcull.Error, "/proc/r: cannot write there"),
    ],
)
def test_arguments_that_make_no_sense_are_named(
    options: dict[str, object], kind: type[Exception], message: str
) -> None:
    with pytest.raises(kind, match=message):
        lightcull.compare_methods(**{"scene": make_room(), "methods": ["path"], **options})


def test_a_heat_map_is_blue_where_all_lights_count_and_red_where_none_does() -> None:
    lights = np.array([[[7.0, 7.0], [7.0, 0.0], [0.0, 0.0], [1.0, 0.5]]])
    blue, red, none, half = volumes.heat_map(lights, 7.0)[0]
    assert blue == pytest.approx([0, 0, 1])
    assert red == pytest.approx([1, 0, 0])
    assert none == pytest.approx([0, 0, 0])
    assert half == pytest.approx([0, 1 / 3, 0], abs=1e-6)


def test_errors_are_relative_to_the_mean_of_the_reference() -> None:
    reference = np.array([1.0, 7.0])
    assert measure.relative_rmse(reference + [2.0, -2.0], reference) == pytest.approx(0.5)
