"""The report: figures of error against values worked out by hand, JSON, CSV, and the page."""

from __future__ import annotations

import base64
import csv
import io
import json
import math
import re
from dataclasses import asdict
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from lightcull import report
from lightcull.report import intervals, metrics, page, pictures, plots, tables
from lightcull.report.write import file_stem
from PIL import Image

TOP_KEYS = ["scene", "width", "height", "max_depth", "threads", "seconds", "command", "machine",
            "measured", "pixels", "reference", "samplers"]  # fmt: skip
SAMPLER_KEYS = {
    "spp", "seconds", "setup_seconds", "ns_per_selection", "rays_per_second", "accepted_per_point",
    "nodes_per_point", "lights_tested_per_point", "rmse", "relmse", "flip", "relmse_blurred",
    "efficiency", "ratio_to_uniform", "ratio_to_light_bvh", "error_curve", "relmse_blurred31",
    "selection_share", "ratio_to_uniform_blurred", "ratio_to_light_bvh_blurred", "learned",
    "repeats", "relmse_measured", "relmse_median", "relmse_trimmed", "variance", "bias",
    "relmse_image", "relmse_emission", "metrics", "intervals", "own_seconds",
}  # fmt: skip
"""What scripts read."""

HEIGHT, WIDTH = 24, 32


def flat(value: float, height: int = 8, width: int = 8) -> np.ndarray:
    return np.full((height, width, 3), value, np.float32)


def reference_image() -> np.ndarray:
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    ramp = 0.1 + 0.9 * (x + y) / (HEIGHT + WIDTH)
    return np.stack((ramp, 0.8 * ramp, 0.5 * ramp), axis=-1).astype(np.float32)


def make_run(error: float, seconds: float = 10.0, **changes) -> report.SamplerRun:
    """A run whose image is `error` above the reference, alternately more and less."""
    checker = (np.indices((HEIGHT, WIDTH)).sum(axis=0) % 2 * 2 - 1)[..., None]
    values = dict(
        image=(reference_image() * (1 + error * checker)).astype(np.float32),
        spp=64,
        seconds=seconds,
        setup_seconds=2.0,
        selection_seconds=3.0,
        sampler_seconds=1.0,
        selections=1_000_000,
        rays=4_000_000,
        accepted_per_point=16.5,
        nodes_per_point=30.0,
        lights_tested_per_point=40.0,
        curve=[report.Moment(6, 1.0, 0.4), report.Moment(64, 10.0, 0.04)],
    )
    return report.SamplerRun(**{**values, **changes})


def make_learned() -> report.Learned:
    """Two cells side by side and pixels that show nothing; a light that is hidden from one of them."""
    cells = np.repeat([[0, 7, -1, -1]], HEIGHT, axis=0).repeat(WIDTH // 4, axis=1).astype(np.int32)
    visibility = np.select([cells == 0, cells == 7], [0.25, 1.0], np.nan).astype(np.float32)
    normals = np.where((cells >= 0)[..., None], np.float32((0, 0, 1)), 0)
    return report.Learned(cells, visibility, normals, 12_345, (1.5, -2.25, 3.0), 4_321, 5 << 20)


def make_runs(errors: list[float], **changes) -> tuple[report.SamplerRun, ...]:
    """Runs with these errors."""
    return tuple(make_run(error, **changes) for error in errors)


def make_comparison(
    **samplers: report.SamplerRun | tuple[report.SamplerRun, ...],
) -> report.Comparison:
    """Against a reference whose noise is relMSE_of_itself 0: both halves are the same."""
    samplers = samplers or {
        "uniform": make_run(0.4),
        "light_bvh": make_run(0.2),
        "culled:sets=16": make_run(0.1, seconds=5.0),
    }
    return report.Comparison(
        scene="a <scene> & more",
        width=WIDTH,
        height=HEIGHT,
        max_depth=2,
        threads=2,
        seconds=10.0,
        machine={"processor": "of <some> kind", "build": "g++"},
        reference=report.Reference(np.stack([reference_image()] * 2), "exhaustive", 4096),
        samplers={
            name: runs if isinstance(runs, tuple) else (runs,) for name, runs in samplers.items()
        },
        command="lightcull compare x --seconds 10",
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("report") / "made" / "for it"
    assert report.write(make_comparison(), target) == target / "index.html"
    return target


# Metrics


def test_rmse() -> None:
    image = flat(2.0)
    image[0, 0] = (5.0, 2.0, 2.0)
    assert metrics.rmse(image, flat(2.0)) == pytest.approx(3 / math.sqrt(8 * 8 * 3))


def test_relmse() -> None:
    # Reference 1 and 3, mean 2: denominators 1 + 0.04 and 9 + 0.04.
    reference = np.concatenate((flat(1.0), flat(3.0)), axis=1)
    image = np.concatenate((flat(1.5), flat(2.0)), axis=1)
    expected = 0.5 * (0.25 / 1.04 + 1.0 / 9.04)
    assert metrics.relmse(image, reference) == pytest.approx(expected)


def test_relmse_does_not_depend_on_the_unit() -> None:
    run = make_run(0.3)
    once = metrics.relmse(run.image, reference_image())
    assert metrics.relmse(1e4 * run.image, 1e4 * reference_image()) == pytest.approx(once, rel=1e-5)


def test_error_against_a_black_reference() -> None:
    assert metrics.relmse(flat(0.0), flat(0.0)) == 0
    assert metrics.relmse(flat(0.1), flat(0.0)) == math.inf
    with pytest.raises(ValueError, match="black"):
        metrics.flip(flat(0.1), flat(0.0))


def test_box_blur_is_the_mean_of_the_neighbours() -> None:
    values = np.random.default_rng(1).random((11, 13, 3))
    blurred = metrics.box_blur(values)
    assert blurred[5, 6] == pytest.approx(values[2:9, 3:10].mean(axis=(0, 1)))
    assert blurred[0, 0] == pytest.approx(values[:4, :4].mean(axis=(0, 1)))
    assert blurred[10, 5] == pytest.approx(values[7:, 2:9].mean(axis=(0, 1)))
    with pytest.raises(ValueError, match="odd"):
        metrics.box_blur(values, 6)


def test_blur_tells_shared_error_from_independent_error() -> None:
    chance = np.random.default_rng(2)
    reference = flat(1.0, 140, 140)
    independent = reference + 0.1 * chance.standard_normal((140, 140, 1))
    shared = reference + np.kron(0.1 * chance.standard_normal((10, 10, 1)), np.ones((14, 14, 1)))
    ratio = {}
    for name, image in (("independent", independent), ("shared", shared)):
        before = metrics.relmse(image, reference)
        ratio[name] = metrics.relmse_blurred(image, reference) / before
    # 1/49, a little more where a border cuts the window; 20 000 pixels give it within 10 %.
    assert ratio["independent"] == pytest.approx(1 / 49, rel=0.15)
    assert ratio["shared"] > 0.5


def test_wide_blur_leaves_what_is_shared_far_and_wide() -> None:
    chance = np.random.default_rng(4)
    reference = flat(1.0, 248, 248)
    blobs = np.kron(0.1 * chance.standard_normal((31, 31, 1)), np.ones((8, 8, 1)))
    bands = np.kron(0.1 * chance.standard_normal((4, 1, 1)), np.ones((62, 248, 1)))
    narrow, wide = (
        [metrics.relmse_blurred(reference + shared, reference, size) for shared in (blobs, bands)]
        for size in (metrics.BLUR_SIZE, metrics.WIDE_BLUR_SIZE)
    )
    # Blobs are larger than 7 x 7 pixels and much smaller than 31 x 31; bands are larger than both.
    assert wide[0] < 0.2 * narrow[0]
    assert wide[1] > 0.5 * narrow[1]


def test_relmse_of_mean_is_the_variance_of_the_mean() -> None:
    chance = np.random.default_rng(3)
    truth = flat(1.0, 200, 200)
    half_a, half_b = (truth + 0.1 * chance.standard_normal(truth.shape) for _ in range(2))
    actual = metrics.relmse(0.5 * (half_a + half_b), truth)
    assert metrics.relmse_of_mean(half_a, half_b) == pytest.approx(actual, rel=0.05)
    assert metrics.relmse_of_mean(truth, truth) == 0


def test_flip() -> None:
    reference = reference_image()
    assert metrics.flip(reference, reference) == 0
    near, far = (metrics.flip(make_run(error).image, reference) for error in (0.05, 0.5))
    assert 0 < near < far < 1
    # HDR-FLIP takes its exposures from the reference.
    brighter = metrics.flip(64 * make_run(0.5).image, 64 * reference)
    assert brighter == pytest.approx(far, rel=1e-3)
    errors = metrics.flip_map(make_run(0.5).image, reference)
    assert errors.shape == (HEIGHT, WIDTH)
    assert np.mean(errors) == pytest.approx(far, rel=1e-6)


def test_efficiency() -> None:
    assert metrics.efficiency(0.01, 10.0) == pytest.approx(10.0)
    assert metrics.efficiency(0.0, 10.0) == math.inf


@pytest.mark.parametrize("shape", [(8, 8), (8, 8, 4), (7, 8, 3)])
def test_images_must_match(shape: tuple) -> None:
    with pytest.raises(ValueError, match="of one size"):
        metrics.relmse(np.zeros(shape, np.float32), flat(1.0))


# How sure figures are


def noisy_reference(noise: float) -> report.Reference:
    chance = np.random.default_rng(11)
    truth = reference_image()
    halves = truth * (1 + noise * chance.standard_normal((2, *truth.shape)))
    return report.Reference(halves.astype(np.float32), "exhaustive", 4096)


def test_t_quantiles() -> None:
    """Of published tables."""
    for freedom, quantile in [(1, 12.706), (4, 2.776), (20, 2.086), (30, 2.042), (120, 1.980)]:
        assert intervals.t_quantile(freedom) == pytest.approx(quantile, abs=1e-3)


def test_intervals_of_means_hold_the_truth_in_95_of_100() -> None:
    """Of 4,000 means of 5 numbers each; 4 standard errors about that share are 1.4 %."""
    values = np.random.default_rng(5).normal(3.0, 2.0, (4000, 5))
    held = [low <= 3.0 <= high for low, high in map(intervals.of_mean, values)]
    assert np.mean(held) == pytest.approx(0.95, abs=0.014)
    assert intervals.of_mean([1.0]) is None


def test_what_two_share_cancels_in_their_ratio() -> None:
    shared = np.random.default_rng(6).normal(1.0, 0.1, 8)
    below, above = list(shared), list(3 * shared)
    assert intervals.of_product(3.0, [(above, 1), (below, -1)]) == pytest.approx((3.0, 3.0))
    low, high = intervals.of_product(3.0, [(above, 1), (below[::-1], -1)])
    assert low < 2.9 and high > 3.1
    assert intervals.of_product(3.0, [(above[:1], 1), (below, -1)]) is None


def test_ratios_have_intervals_that_hold_the_truth() -> None:
    """Of efficiencies, 500 times: errors and times that vary by a tenth from seed to seed. 4
    standard errors about 95 % are 3.9 %.
    """
    chance = np.random.default_rng(8)
    held = []
    for _ in range(500):
        factors = [(list(chance.normal(mean, 0.1 * mean, 5)), power)
                   for mean, power in ((0.2, 1), (10, 1), (0.1, -1), (10, -1))]  # fmt: skip
        ratio = math.prod(np.mean(values) ** power for values, power in factors)
        low, high = intervals.of_product(ratio, factors)
        held.append(low <= 2.0 <= high)
    assert np.mean(held) == pytest.approx(0.95, abs=0.039)


def test_the_jackknife_of_a_mean_is_the_interval_of_a_mean() -> None:
    values = [1.0, 4.0, 2.0, 8.0]
    jackknife = intervals.by_jackknife(4, lambda some: float(np.mean([values[i] for i in some])))
    assert jackknife == pytest.approx(intervals.of_mean(values))
    assert intervals.by_jackknife(2, lambda some: 0.0) is None


def test_the_noise_of_the_reference_is_taken_off() -> None:
    """In the mean over 40 references, to 4 standard errors."""
    truth = reference_image()
    chance = np.random.default_rng(12)
    image = truth * (1 + 0.2 * chance.standard_normal(truth.shape))
    exact = float(np.mean((image - truth) ** 2 / metrics.scale_of(truth)))
    found, measured = [], []
    for _ in range(40):
        halves = truth * (1 + 0.2 * chance.standard_normal((2, *truth.shape)))
        squared = metrics.squared_error(image, halves)
        found.append(np.mean(squared / metrics.scale_of(truth)))
        raw = (image - halves.mean(axis=0)) ** 2
        measured.append(np.mean(raw / metrics.scale_of(truth)))
    error = np.std(found, ddof=1) / math.sqrt(len(found))
    assert abs(np.mean(found) - exact) < 4 * error < 0.05 * exact
    assert np.mean(measured) == pytest.approx(1.5 * exact, rel=0.05)  # half of the variance is added


def test_bias_is_told_from_variance() -> None:
    """Images that are a tenth too dark, with noise: bias 0.01 and variance 0.04, over r^2 + ..."""
    truth = reference_image()
    chance = np.random.default_rng(13)
    images = [0.9 * truth + 0.2 * truth * chance.standard_normal(truth.shape) for _ in range(8)]
    runs = tuple(make_run(0, image=image.astype(np.float32)) for image in images)
    result = make_comparison(culled=runs)
    result.reference = noisy_reference(0.02)
    figures = result.figures.samplers["culled"]
    share = float(np.mean(truth**2 / metrics.scale_of(truth)))
    assert figures.variance == pytest.approx(0.04 * share, rel=0.05)
    assert figures.bias == pytest.approx(0.01 * share, rel=0.1)
    assert figures.relmse == pytest.approx(figures.bias + figures.variance, rel=1e-6)
    assert figures.intervals["bias"][0] > 0
    right = [image + 0.1 * truth for image in images]
    result = make_comparison(
        culled=tuple(make_run(0, image=image.astype(np.float32)) for image in right)
    )
    result.reference = noisy_reference(0.02)
    low, high = result.figures.samplers["culled"].intervals["bias"]
    assert low < 0 < high < 0.001


def test_the_worst_pixels_are_left_out_of_the_trimmed_mean() -> None:
    image = reference_image()
    image[3, 4] += 100  # the worst of 768: 0.1 % of them is a pixel
    figures = make_comparison(culled=make_run(0, image=image)).figures.samplers["culled"]
    assert figures.relmse_trimmed == 0 and figures.relmse_median == 0
    assert figures.relmse > 1


def test_lit_light_is_measured_and_emission_beside() -> None:
    """An error of what the camera sees of lamps is in the whole image's, and in the floor."""
    truth = reference_image()
    emission = np.zeros_like(truth)
    emission[:2] = 5
    run = make_run(0, image=truth + emission * np.float32(1.1), lit=truth * np.float32(1.2),
                   emission=emission * np.float32(1.1))  # fmt: skip
    run.image = run.lit + run.emission
    result = make_comparison(culled=make_run(0))
    result.samplers = {"culled": (run,)}
    result.reference = report.Reference(
        np.stack([truth + emission] * 2), "x", 1, np.stack([truth] * 2), np.stack([emission] * 2)
    )
    figures = result.figures.samplers["culled"]
    assert result.figures.measured == "lit"
    assert figures.relmse == pytest.approx(metrics.relmse(run.lit, truth), rel=1e-4)
    assert figures.relmse_image == pytest.approx(
        metrics.relmse(run.image, truth + emission), rel=1e-4
    )
    floor = np.mean((0.1 * emission) ** 2 / metrics.scale_of(truth + emission))
    assert figures.relmse_emission == pytest.approx(floor, rel=1e-4)


# Comparison


def test_comparison_names_the_image_at_fault() -> None:
    with pytest.raises(ValueError, match="sampler 'power'.*expected"):
        make_comparison(power=make_run(0.1, image=flat(1.0)))
    spoilt = reference_image()
    spoilt[3, 4] = np.nan
    with pytest.raises(ValueError, match="sampler 'power'.*not finite"):
        make_comparison(power=make_run(0.1, image=spoilt))


# Figures


def test_figures_of_a_sampler() -> None:
    result = make_comparison().figures
    uniform, culled = result.samplers["uniform"], result.samplers["culled:sets=16"]
    reference, image = reference_image(), make_run(0.4).image
    assert uniform.relmse == pytest.approx(metrics.relmse(image, reference))
    assert uniform.relmse_measured == pytest.approx(metrics.relmse(image, reference))
    assert uniform.relmse_image == pytest.approx(metrics.relmse(image, reference))
    assert uniform.relmse_emission is None and result.measured == "image"
    assert uniform.relmse_blurred == pytest.approx(metrics.relmse_blurred(image, reference))
    assert uniform.relmse_blurred31 == pytest.approx(metrics.relmse_blurred(image, reference, 31))
    assert uniform.rmse == pytest.approx(metrics.rmse(image, reference))
    assert (uniform.repeats, uniform.intervals) == (1, {})
    assert uniform.variance is None and uniform.bias is None
    assert uniform.selection_share == pytest.approx(1 / 8)
    assert uniform.ns_per_selection == pytest.approx(3000.0)
    assert uniform.rays_per_second == pytest.approx(4e6 / 8.0)
    assert uniform.efficiency == pytest.approx(1 / (uniform.relmse * 10.0))
    assert [(p.spp, p.seconds, p.relmse, p.low) for p in uniform.error_curve] == [
        (6, 1.0, 0.4, None), (64, 10.0, 0.04, None)
    ]  # fmt: skip
    assert uniform.ratio_to_uniform == 1
    # A quarter of the error, 16 times less relMSE, in half the time.
    assert culled.ratio_to_uniform == pytest.approx(32, rel=1e-3)
    assert culled.ratio_to_light_bvh == pytest.approx(8, rel=1e-3)


def test_ratios_after_the_blur_are_of_the_blurred_error() -> None:
    shared = make_run(0.0, image=(1.1 * reference_image()).astype(np.float32))
    result = make_comparison(uniform=make_run(0.2), light_bvh=shared).figures.samplers
    assert result["uniform"].ratio_to_uniform_blurred == 1
    # Half of the error, but the blur leaves it; that of uniform it takes away.
    assert result["light_bvh"].ratio_to_uniform == pytest.approx(4, rel=1e-3)
    expected = result["uniform"].relmse_blurred / result["light_bvh"].relmse_blurred
    assert expected < 0.1
    assert result["light_bvh"].ratio_to_uniform_blurred == pytest.approx(expected)
    assert result["uniform"].ratio_to_light_bvh_blurred == pytest.approx(1 / expected)


def test_ratios_are_null_without_their_baseline() -> None:
    only = make_comparison(culled=make_run(0.1)).figures.samplers["culled"]
    for key in ("ratio_to_uniform", "ratio_to_light_bvh"):
        assert getattr(only, key) is None and getattr(only, f"{key}_blurred") is None


def test_figures_that_do_not_exist_are_null() -> None:
    perfect = make_run(0.0, selections=0)
    result = make_comparison(uniform=perfect, culled=make_run(0.1)).figures.samplers
    assert result["uniform"].ns_per_selection is None
    assert result["uniform"].efficiency is None
    assert result["culled"].ratio_to_uniform is None
    json.dumps([asdict(run) for run in result.values()], allow_nan=False)


# Files


def test_json_has_exactly_these_keys(folder: Path) -> None:
    content = json.loads((folder / "report.json").read_text())
    assert list(content) == TOP_KEYS
    assert set(content["reference"]) == {"sampler", "spp", "relmse_of_itself"}
    assert list(content["samplers"]) == ["uniform", "light_bvh", "culled:sets=16"]
    for run in content["samplers"].values():
        assert set(run) == SAMPLER_KEYS
    assert content["scene"] == "a <scene> & more"
    assert (content["width"], content["height"], content["max_depth"]) == (WIDTH, HEIGHT, 2)
    assert content["reference"] == {"sampler": "exhaustive", "spp": 4096, "relmse_of_itself": 0}


def test_csv_says_what_json_says(folder: Path) -> None:
    content = json.loads((folder / "report.json").read_text())
    with (folder / "report.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["sampler"] for row in rows] == list(content["samplers"])
    for row in rows:
        assert row["scene"] == content["scene"]
        for key in tables.RUN_COLUMNS:
            figure = content["samplers"][row["sampler"]][key]
            assert row[key] == "" if figure is None else float(row[key]) == figure
    assert set(tables.RUN_COLUMNS) == SAMPLER_KEYS - {"error_curve", "learned", "metrics", "intervals"}
    with (folder / "error_curves.csv").open(newline="") as stream:
        points = [(row["sampler"], float(row["seconds"])) for row in csv.DictReader(stream)]
    assert points == [(name, at) for name in content["samplers"] for at in (1.0, 10.0)]


def test_csv_leaves_a_missing_figure_empty(tmp_path: Path) -> None:
    result = make_comparison(culled=make_run(0.1)).figures
    tables.write_csv(result, tmp_path / "report.csv")
    with (tmp_path / "report.csv").open(newline="") as stream:
        (row,) = csv.DictReader(stream)
    assert row["ratio_to_uniform"] == ""


def test_images_are_written(folder: Path) -> None:
    import lightcull

    for name in ("reference", "uniform", "light_bvh", "culled_sets-16"):
        with Image.open(folder / f"{name}.png") as picture:
            assert picture.size == (WIDTH, HEIGHT)
    kept = lightcull.read_image(folder / "uniform.exr")
    assert np.array_equal(kept, make_run(0.4).image)
    assert file_stem("paper:list=0:error_bound=0.1") == "paper_list-0_error_bound-0.1"


# Pictures


def test_pictures_have_the_exposure_of_the_reference() -> None:
    for factor in (0.25, 1.0, 4.0):
        stops = pictures.exposure_for(flat(pictures.BRIGHTNESS * factor))
        assert stops == pytest.approx(-math.log2(factor), abs=0.051)
    assert pictures.exposure_for(flat(0.0)) == 0
    assert pictures.exposure_for(flat(1e-6)) == 3
    # What is near black does not count: a black sky is to stay so.
    half_black = np.concatenate((flat(pictures.BRIGHTNESS), flat(0.0)), axis=1)
    assert pictures.exposure_for(half_black) == 0


def test_error_maps_share_a_scale() -> None:
    scale = pictures.ERROR_MAPS[0]
    values = np.array([[0.0, scale.low, math.sqrt(scale.low * scale.high), scale.high, 1e9]])
    assert pictures.to_palette(scale, values).tolist() == [[0, 0, 128, 255, 255]]
    with Image.open(io.BytesIO(pictures.encode_png(np.uint8([[0, 255]])))) as picture:
        colors = np.asarray(picture.convert("RGB"))
    assert np.array_equal(colors[0], pictures.palette()[[0, 255]])


def test_error_maps_average_to_the_figures() -> None:
    result = make_comparison(culled=make_runs([0.2, 0.3]))
    for kind in pictures.ERROR_MAPS:
        values = pictures.error_values(kind, result.samplers["culled"], result.measure)
        figure = getattr(result.figures.samplers["culled"], kind.figure_key)
        assert np.mean(values) == pytest.approx(figure, rel=1e-5)


# What was learned


@pytest.fixture(scope="module")
def learned_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("learned")
    learned = make_run(0.1, learned=make_learned())
    report.write(make_comparison(**{"culled": make_run(0.2), "learned:rounds=9": learned}), target)
    return target


def test_cells_differ_in_color_and_are_shaded() -> None:
    cells = np.arange(300, dtype=np.int32).reshape(15, 20)
    side = np.float32(pictures.SHADE_DIRECTION)
    assert np.linalg.norm(side) == pytest.approx(1)
    towards, away = (np.full((15, 20, 3), normal, np.float32) for normal in (side, -side))
    bright, dark = (pictures.cell_picture(cells, normals) for normals in (towards, away))
    assert len(np.unique(bright.reshape(-1, 3), axis=0)) > 290
    # One after the other: as far apart in hue as the golden ratio puts them.
    steps = np.abs(np.diff(bright.astype(int), axis=1)).max(axis=2)
    assert steps.min() > 60
    assert np.all(bright.max(axis=2) == 255)
    assert np.all(dark.max(axis=2) == 102)
    assert not pictures.cell_picture(np.full((2, 2), -1, np.int32), towards[:2, :2]).any()


def test_visibility_has_the_colors_of_its_scale() -> None:
    values = np.array([[0.0, 0.5, 1.0, np.nan]], np.float32)
    expected = [*pictures.palette()[[0, 128, 255]].tolist(), list(pictures.UNKNOWN)]
    assert pictures.visibility_picture(values)[0].tolist() == expected
    assert pictures.UNKNOWN not in {tuple(color) for color in pictures.palette().tolist()}


def test_pictures_of_what_was_learned_are_written(learned_folder: Path) -> None:
    assert sorted(path.name for path in learned_folder.glob("*_*.png")) == [
        "error_curves.png", "learned_rounds-9.png", "learned_rounds-9_cells.png",
        "learned_rounds-9_visibility.png",
    ]  # fmt: skip
    with Image.open(learned_folder / "learned_rounds-9_cells.png") as picture:
        cells = np.asarray(picture.convert("RGB"))
    assert cells.shape == (HEIGHT, WIDTH, 3)
    assert not cells[:, WIDTH // 2 :].any() and cells[:, : WIDTH // 2].any(axis=2).all()
    with Image.open(learned_folder / "learned_rounds-9_visibility.png") as picture:
        seen = np.asarray(picture.convert("RGB"))
    quarters = [pictures.palette()[64], pictures.palette()[255], pictures.UNKNOWN, pictures.UNKNOWN]
    assert np.array_equal(seen[0, WIDTH // 8 :: WIDTH // 4], quarters)


def test_json_and_page_say_what_was_learned(learned_folder: Path) -> None:
    samplers = json.loads((learned_folder / "report.json").read_text())["samplers"]
    assert samplers["culled"]["learned"] is None
    assert samplers["learned:rounds=9"]["learned"] == {
        "cells": 4321, "bytes": 5 << 20, "light": 12345, "light_position": [1.5, -2.25, 3.0],
    }  # fmt: skip
    text = (learned_folder / "index.html").read_text(encoding="utf-8")
    said = re.sub(r"[ \n]+", " ", " ".join(Page(text).text))
    for words in ("What was learned", "4\u202f321 in all", "5.00 MiB", "light 12\u202f345",
                  "(1.5, -2.25, 3.0) m"):  # fmt: skip
        assert words in said
    for what in ("cells", "visibility"):
        png = (learned_folder / f"learned_rounds-9_{what}.png").read_bytes()
        assert base64.b64encode(png).decode("ascii") in text


def test_a_sun_whose_visibility_is_shown_has_no_place(tmp_path: Path) -> None:
    learned = make_learned()
    learned.light_position = None
    report.write(make_comparison(learned=make_run(0.1, learned=learned)), tmp_path)
    samplers = json.loads((tmp_path / "report.json").read_text())["samplers"]
    assert samplers["learned"]["learned"]["light_position"] is None
    assert "infinitely far" in (tmp_path / "index.html").read_text(encoding="utf-8")


def test_page_is_silent_where_nothing_was_learned(page_text: str) -> None:
    assert "What was learned" not in page_text


def test_comparison_names_what_was_learned_of_another_size() -> None:
    learned = make_learned()
    learned.cells = learned.cells[1:]
    with pytest.raises(ValueError, match="cells of sampler 'learned'.*expected"):
        make_comparison(learned=make_run(0.1, learned=learned))


# The page


class Page(HTMLParser):
    """Collects what a page loads, and its text."""

    LOADING = {"src", "href", "xlink:href", "srcset", "data", "poster", "action"}

    def __init__(self, text: str) -> None:
        super().__init__()
        self.loaded: list[str] = []
        self.text: list[str] = []
        self.elements: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list) -> None:
        self.elements.append(tag)
        self.loaded += [value for key, value in attrs if key in self.LOADING and value]

    def handle_data(self, data: str) -> None:
        self.text.append(data)


@pytest.fixture(scope="module")
def page_text(folder: Path) -> str:
    return (folder / "index.html").read_text(encoding="utf-8")


def test_page_loads_nothing(page_text: str) -> None:
    page = Page(page_text)
    assert all(address.startswith(("#", "data:")) for address in page.loaded)
    assert not {"link", "iframe", "object", "embed", "base"} & set(page.elements)
    without_images = re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "", page_text)
    assert not re.search(r"\w+://|@import|\bfetch\(|XMLHttpRequest|import\(", without_images)
    assert all(target.startswith("#") for target in re.findall(r"url\(([^)]*)\)", without_images))


def script_data(page_text: str) -> dict:
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page_text, re.S)
    assert found is not None
    return json.loads(found[1])


def test_page_holds_every_image(page_text: str, folder: Path) -> None:
    data = script_data(page_text)
    samplers = ["uniform", "light_bvh", "culled:sets=16"]
    assert data["samplers"] == samplers
    assert set(data["images"]["image"]) == {"reference", *samplers}
    for kind in pictures.ERROR_MAPS:
        assert set(data["images"][kind.key]) == set(samplers)
    for layer in data["images"].values():
        for address in layer.values():
            png = base64.b64decode(address.removeprefix("data:image/png;base64,"), validate=True)
            with Image.open(io.BytesIO(png)) as picture:
                assert picture.size == (WIDTH, HEIGHT)
    shown = data["images"]["image"]["uniform"].removeprefix("data:image/png;base64,")
    assert base64.b64decode(shown) == (folder / "uniform.png").read_bytes()


def test_page_shows_the_worst_against_the_best_first(page_text: str) -> None:
    data = script_data(page_text)
    assert (data["left"], data["right"]) == ("uniform", "culled:sets=16")


def test_page_says_what_was_done(page_text: str) -> None:
    text = " ".join(Page(page_text).text)
    for said in ("a <scene> & more", "of <some> kind", "lightcull compare x --seconds 10",
                 "32 times uniform and 8.0 times light_bvh in efficiency, by one run each", "direct light only",
                 "nothing is known of how sure"):  # fmt: skip
        assert said in text
    assert "<scene>" not in page_text and "<some>" not in page_text


def page_of(result: report.Comparison) -> str:
    images = {"image": {}, **{kind.key: {} for kind in pictures.ERROR_MAPS}}
    return page.render(result.figures, images, {}, "aces")


def cells_of(text: str, sampler: str) -> dict[str, tuple[bool, str]]:
    """By column: whether the value is marked as the best, and its text."""
    rows = [row for row in text.split("<tr>") if f'name">{sampler}' in row]
    cells = {}
    costs = [column for column in page.COST_COLUMNS if column.key != "own_seconds"]
    for row, columns in zip(rows, (page.ERROR_COLUMNS, page.DETAIL_COLUMNS, costs), strict=True):
        found = re.findall(r'<td( class="best")?>(.*?)</td>', row)[1:]
        for column, (best, cell) in zip(columns, found, strict=True):
            cells[column.key] = bool(best), cell
    return cells


def test_page_has_every_figure(page_text: str) -> None:
    cells = cells_of(page_text, "culled:sets=16")
    assert set(cells) == set(tables.RUN_COLUMNS) - {"repeats", "own_seconds"}
    assert cells["selection_share"][1] == page.significant(100 / 3, 2)


def test_page_marks_the_best_only_where_intervals_part() -> None:
    """Of a single run nothing is the best."""
    errors = {"uniform": [0.3, 0.31, 0.29], "a": [0.1, 0.12, 0.11], "b": [0.1, 0.13, 0.11]}
    apart = page_of(make_comparison(a=make_runs(errors["a"]), uniform=make_runs(errors["uniform"])))
    cells = cells_of(apart, "a")
    for key in ("relmse", "relmse_blurred31", "efficiency", "ratio_to_uniform", "flip"):
        assert cells[key][0], key
    assert not cells["accepted_per_point"][0] and not cells["seconds"][0]
    assert "±" in cells["relmse"][1] and "a is 7.4 times (" in apart
    together = page_of(make_comparison(**{name: make_runs(of) for name, of in errors.items()}))
    for name in errors:
        assert not any(cells_of(together, name)[key][0] for key in ("relmse", "efficiency"))
    assert "a and b do not differ in efficiency beyond chance" in together
    single = page_of(make_comparison(a=make_run(0.1), uniform=make_run(0.3)))
    assert not any(best for best, _ in cells_of(single, "a").values())


def test_page_warns_of_a_noisy_reference() -> None:
    clean, noisy = make_comparison(), make_comparison()
    noisy.reference = noisy_reference(0.3)
    assert ["†" in page_of(made) for made in (clean, noisy)] == [False, True]


@pytest.mark.parametrize(
    ("value", "interval", "text"),
    [
        (12.3456, (11.9, 12.8), "12.3 ±\u20090.5"),
        (12.3456, (12.3316, 12.3596), "12.346 ±\u20090.014"),
        (0.045, (0.036, 0.054), "0.045 ±\u20090.009"),
        (0.0001, (-0.02, 0.02), "0.00 ±\u20090.02"),
        (100.4, (77.0, 131.0), "100 ±\u200930"),
        (54321.0, (54021.0, 54621.0), "54\u202f300 ±\u2009300"),
        (3.21e-7, (3.0e-7, 3.42e-7), "3.2\u2009×\u200910⁻⁷ ±\u20090.2\u2009×\u200910⁻⁷"),
        (8.0, (8.0, 8.0), "8"),
        (0.0123456, None, "0.012"),
        (1142.0, None, "1\u202f100"),
        (None, None, "–"),
    ],
)
def test_as_many_digits_as_are_known(
    value: float | None, interval: tuple[float, float] | None, text: str
) -> None:
    assert " ".join(page.known(value, interval)).strip() == text


def test_bands_are_drawn_where_intervals_are_known() -> None:
    """And not for single runs."""
    runs = make_runs([0.3, 0.4])
    runs[1].curve = [report.Moment(6, 1.2, 0.5), report.Moment(64, 11.0, 0.05)]
    several, single = (make_comparison(culled=of).figures for of in (runs, runs[:1]))
    bands = [
        len(plots.error_against_time(figures).axes[0].collections) for figures in (several, single)
    ]
    assert bands == [1, 0]
    first, last = several.samplers["culled"].error_curve
    assert (first.spp, first.seconds) == (6, pytest.approx(1.1))
    assert first.low < 0.4 and first.high > 0.5 and first.relmse == pytest.approx(0.45)


def test_plot_has_a_curve_for_each_sampler() -> None:
    result = make_comparison().figures
    svg = plots.to_svg(plots.error_against_time(result))
    assert svg.startswith("<svg")
    for text in ("uniform", "light_bvh", "culled:sets=16", "1/t", "relMSE", "seconds"):
        assert f">{text}<" in svg
    for color in plots.sampler_colors(list(result.samplers)).values():
        assert color in svg


def test_long_names_leave_room_for_the_curves() -> None:
    name = "learned:rounds=96:memory=64:accepted=32"
    assert plots.shortened(name) == "learned:roun…:accepted=32"
    assert plots.shortened("light_bvh:importance=mean") == "light_bvh:importance=mean"
    figures = make_comparison(**{name: make_run(0.1)}).figures
    svg = plots.to_svg(plots.error_against_time(figures))
    assert ">learned:roun…:accepted=32<" in svg and name not in svg


def test_a_headline_names_few_rivals() -> None:
    runs = {name: make_runs([0.1, 0.12, 0.11]) for name in "abcd"}
    assert " and 3 others do not differ in efficiency beyond chance" in page_of(make_comparison(**runs))


def test_metrics_that_were_asked_for_have_columns() -> None:
    """Less is the best of those that are known; of functions nothing is."""
    def darker(image: np.ndarray, reference: np.ndarray) -> np.ndarray:
        return reference - image

    result = make_comparison(a=make_runs([0.1, 0.12, 0.11]), b=make_runs([0.3, 0.31, 0.29]))
    result.metrics = {"mape": report.METRICS["mape"], "darker": darker}
    text = page_of(result)
    (row,) = [row for row in text.split("<tr>") if 'name">a<' in row and "FLIP" not in row][1:2]
    *_, mape, other = re.findall(r'<td( class="best")?>', row)
    assert mape and not other
    assert "<th>mape</th><th>darker</th>" in text


def test_sampler_colors_differ() -> None:
    names = ["culled", "culled:sets=16", "culled:sets=4", "paper", "uniform"]
    assert len(set(plots.sampler_colors(names).values())) == len(names)
    assert plots.sampler_colors(names)["culled"] == plots.sampler_colors(["culled"])["culled"]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "–"), (0.0, "0"), (0.012345, "0.0123"), (1.0, "1.00"), (123.4, "123"),
        (54720.0, "54\u202f720"), (2.5e9, "2.50\u2009×\u200910⁹"), (1.5e-6, "1.50\u2009×\u200910⁻⁶"),
    ],
)  # fmt: skip
def test_numbers_for_people(value: float | None, text: str) -> None:
    assert page.significant(value) == text
