"""lightcull.compare."""

from __future__ import annotations

import json
import pydoc
import re
import signal
from dataclasses import asdict, fields
from pathlib import Path

import numpy as np
import pytest

import lightcull
from lightcull import methods, report
from conftest import QUAD, make_room, square
from lightcull.comparing import compare as compare_module
from lightcull.rendering import subject as subject_module
from lightcull.rendering.job import SubjectJob
from lightcull.rendering.settings import RenderSettings
from lightcull.report.metrics import relative_squared_error, relmse, relmse_of_mean

SIZE = (32, 24)
QUICK = {"spp": 4, "size": SIZE}


class FakeJob(SubjectJob):
    """Renders nothing, by a clock of its own."""

    setup_seconds = {"slow": 0.2, "middle": 0.05, "fast": 0.0, "huge": 0.0, "big": 0.0}
    pass_seconds = {"slow": 0.09, "middle": 0.031, "fast": 0.002, "huge": 1.0, "big": 0.9}
    turns: list[tuple[str, int]] = []

    def __init__(self, scene, sampler, settings) -> None:
        self.sampler = sampler
        self.seed = settings.seed
        self.spp = 0

    def render_pass(self) -> None:
        self.spp += 1
        FakeJob.turns.append((self.sampler, self.seed))

    def image(self) -> np.ndarray:
        return np.ones((24, 32, 3), np.float32)

    def mean_counts(self):
        return type("Counts", (), {"accepted": 1.0, "nodes_visited": 2.0, "lights_tested": 3.0})

    def learned_view(self) -> None:
        return None

    def stats(self) -> lightcull.Stats:
        setup = self.setup_seconds[self.sampler]
        seconds = setup + self.spp * self.pass_seconds[self.sampler]
        return lightcull.Stats(self.spp, seconds, setup, seconds / 2, self.spp, 2 * self.spp, seconds / 4)


@pytest.fixture
def fake_jobs(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, int]]:
    reference = lightcull.report.Reference(np.ones((2, 24, 32, 3), np.float32), "other", 64)
    monkeypatch.setattr(subject_module, "PathJob", FakeJob)
    monkeypatch.setattr(subject_module, "check_description", lambda description: None)
    monkeypatch.setattr(compare_module, "reference_for", lambda order, progress: reference)
    FakeJob.turns = []
    return FakeJob.turns


def test_all_have_the_same_time_in_turns(room: lightcull.Scene, fake_jobs: list[tuple[str, int]]) -> None:
    result = lightcull.compare(room, ["slow", "middle", "fast"], seconds=6.0, size=SIZE)
    seconds = [run.seconds for (run,) in result.samplers.values()]
    assert min(seconds) >= 6.0
    assert max(seconds) <= 1.03 * min(seconds)
    assert max(seconds) <= 6.0 + 2 * 0.09
    changes = sum(a != b for a, b in zip(fake_jobs, fake_jobs[1:], strict=False))
    assert changes > 100
    (run,) = result.samplers["middle"]
    assert (run.accepted_per_point, run.nodes_per_point, run.lights_tested_per_point) == (1, 2, 3)
    assert run.setup_seconds == 0.05


def test_a_pass_that_is_too_long_is_said(room: lightcull.Scene, fake_jobs: list[tuple[str, int]]) -> None:
    with pytest.warns(UserWarning, match=r"render times differ by \d+%: one pass takes too long"):
        lightcull.compare(room, ["huge", "big"], seconds=0.5, size=SIZE)


def test_seeds_run_side_by_side_in_turns(
    room: lightcull.Scene, fake_jobs: list[tuple[str, int]]
) -> None:
    names = ["slow", "middle", "fast"]
    result = lightcull.compare(room, names, seconds=2.0, repeats=3, seed=7, size=SIZE)
    assert {turn for turn in fake_jobs} == {(name, 7 + i) for name in names for i in range(3)}
    for name in names:
        assert len(result.samplers[name]) == 3
        turns = [seed for sampler, seed in fake_jobs if sampler == name]
        changes = sum(a != b for a, b in zip(turns, turns[1:], strict=False))
        assert changes > 20
    seconds = [run.seconds for runs in result.samplers.values() for run in runs]
    assert min(seconds) >= 2.0 and max(seconds) <= 1.03 * min(seconds)
    half = len(fake_jobs) // 2  # after half of all passes each has had about half of them
    for turn in set(fake_jobs):
        assert fake_jobs[:half].count(turn) == pytest.approx(fake_jobs.count(turn) / 2, rel=0.3)


def test_error_curve_is_spaced_by_ratio_of_samples(
    room: lightcull.Scene, fake_jobs: list[tuple[str, int]]
) -> None:
    result = lightcull.compare(room, ["fast"], seconds=2.0, size=SIZE)
    ((run,),) = result.samplers.values()
    moments = [moment.spp for moment in run.curve]
    assert moments[:6] == [1, 2, 3, 4, 6, 8]
    assert moments[-1] == run.spp and run.curve[-1].seconds == run.seconds
    ratios = np.divide(moments[1:], moments[:-1])
    assert np.all(ratios[:-1] >= 1.3)
    assert np.all(ratios[8:-1] < 1.4)


def test_ctrl_c_reports_what_there_is(
    room: lightcull.Scene, fake_jobs: list[tuple[str, int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(progress: lightcull.Progress) -> None:
        if progress.stage == "middle":
            raise KeyboardInterrupt

    result = lightcull.compare(room, ["slow", "middle"], seconds=6.0, size=SIZE, progress=stop)
    assert result.interrupted
    assert list(result.samplers) == ["slow", "middle"]
    assert result.samplers["middle"][0].spp >= 1
    assert result.samplers["middle"][0].seconds < 6


def test_report(room: lightcull.Scene, tmp_path: Path) -> None:
    stages = []
    result = lightcull.compare(
        room,
        ["uniform", "culled"],
        folder=tmp_path / "report",
        progress=lambda progress: stages.append(progress.stage),
        **QUICK,
    )
    assert (tmp_path / "report" / "index.html").is_file()
    assert (tmp_path / "report" / "report.csv").is_file()
    content = json.loads((tmp_path / "report" / "report.json").read_text())
    assert {"scene", "width", "height", "max_depth", "threads", "reference", "samplers"} <= set(
        content
    )
    assert set(content["reference"]) == {"sampler", "spp", "relmse_of_itself"}
    assert list(content["samplers"]) == ["uniform", "culled"]
    assert {
        "spp", "seconds", "setup_seconds", "ns_per_selection", "rays_per_second",
        "accepted_per_point", "rmse", "relmse", "flip", "relmse_blurred", "efficiency",
        "ratio_to_uniform", "ratio_to_light_bvh", "error_curve",
    } <= set(content["samplers"]["culled"])  # fmt: skip
    assert (content["scene"], content["width"], content["height"]) == ("room", 32, 24)
    assert content["samplers"]["culled"]["spp"] == 4
    assert content["samplers"]["uniform"]["ratio_to_uniform"] == 1
    assert set(stages) == {"reference", "uniform", "culled"}
    assert json.loads(json.dumps(asdict(result.figures))) == content
    (culled,) = result.samplers["culled"]
    assert culled.curve[-1].seconds == culled.seconds
    assert culled.curve[-1].relmse == result.figures.samplers["culled"].relmse
    measured = relmse(culled.lit, result.reference.lit_image)
    assert content["samplers"]["culled"]["relmse_measured"] == pytest.approx(measured)


def test_what_was_learned_is_reported(room: lightcull.Scene, tmp_path: Path) -> None:
    result = lightcull.compare(room, ["culled", "learned"], folder=tmp_path, **QUICK)
    assert result.samplers["culled"][0].learned is None
    learned = result.samplers["learned"][0].learned
    assert learned.cells.shape == learned.visibility.shape == (SIZE[1], SIZE[0])
    seen = learned.cells >= 0
    assert np.linalg.norm(learned.normals[seen], axis=-1) == pytest.approx(1, abs=1e-3)
    assert seen.mean() > 0.5 and learned.cells.max() < learned.cell_count
    assert learned.memory_size > 1000 * learned.cell_count
    known = np.isfinite(learned.visibility)
    assert known.any() and not known[~seen].any()
    assert 0 <= learned.visibility[known].min() and learned.visibility[known].max() <= 1
    light = room.lights()[learned.light]
    assert learned.light_position == tuple(light["center"])
    assert light["intensity"] > 0
    report = json.loads((tmp_path / "report.json").read_text())["samplers"]
    assert report["learned"]["learned"]["cells"] == learned.cell_count
    assert report["culled"]["learned"] is None
    for what in ("cells", "visibility"):
        assert [path.name for path in tmp_path.glob(f"*_{what}.png")] == [f"learned_{what}.png"]


def test_the_light_shown_is_hidden_from_some_and_not_from_others() -> None:
    """From one of the offices, that is a lamp beyond the door."""
    result = lightcull.compare(
        lightcull.example_scene("offices"), ["learned"], spp=12, size=SIZE, reference_seconds=0.1
    )
    visibility = result.samplers["learned"][0].learned.visibility
    known = visibility[np.isfinite(visibility)]
    assert (known < 0.2).mean() > 0.1 and (known > 0.8).mean() > 0.1


def test_images_are_those_of_render(room: lightcull.Scene) -> None:
    result = lightcull.compare(room, ["culled"], seed=5, repeats=2, **QUICK)
    for seed, run in enumerate(result.samplers["culled"], 5):
        alone = lightcull.render(make_room(), "culled", seed=seed, **QUICK)
        assert np.array_equal(run.image, alone.image)


def test_emission_that_the_camera_sees_is_kept_apart() -> None:
    """It is what paths of one edge find, and the rest is the light that falls on surfaces."""
    room = make_room()
    room.set_camera(origin=(0, 0.5, 6), target=(0, 1, 0))
    (run,) = lightcull.compare(room, ["culled"], seed=5, **QUICK).samplers["culled"]
    assert run.emission is not None and run.lit is not None
    emission = lightcull.render(room, "culled", seed=5, max_depth=1, **QUICK).image
    assert emission.any()
    assert np.array_equal(run.emission, emission)
    np.testing.assert_allclose(run.lit + run.emission, run.image, rtol=1e-6)
    assert run.lit[emission.max(axis=2) == 0].any()


def test_the_error_of_lamps_is_shown_beside_and_not_measured() -> None:
    """In a hall of many small lamps that the camera sees, most of the error is their antialiasing."""
    figures = lightcull.compare(make_hall(), ["culled"], spp=16, size=(64, 48)).figures
    run = figures.samplers["culled"]
    assert figures.measured == "lit"
    assert run.relmse_emission > 0.6 * run.relmse_image
    rest = run.relmse_image - run.relmse_emission
    assert 0 < rest < 0.4 * run.relmse_image
    assert run.relmse > 0


def make_hall() -> lightcull.Scene:
    """A floor under 3,000 lamps of 6 cm, seen along the hall."""
    rng = np.random.default_rng(19)
    scene = lightcull.Scene("hall")
    floor = np.float32([[-10, 0, 30], [10, 0, 30], [10, 0, -30], [-10, 0, -30]])
    scene.add_mesh(floor, QUAD, name="floor")
    place = rng.uniform((-10, 3, -30), (10, 5, 30), (1500, 3)).astype(np.float32)
    lamps = (square(0.03, 0, facing_up=False) + place[:, None]).reshape(-1, 3)
    faces = (QUAD + 4 * np.arange(1500, dtype=np.uint32)[:, None, None]).reshape(-1, 3)
    scene.add_light_mesh(lamps, faces, radiance=(90, 80, 60), name="lamps")
    scene.set_camera(origin=(0, 2, 29), target=(0, 3, 0))
    return scene


def test_intervals_of_a_few_seeds_hold_the_truth() -> None:
    """Five figures of the hall, of which 95 % intervals hold at least four in 98 of a hundred cases.
    The truth is of 16 other seeds.
    """
    options = {"samplers": ["uniform", "culled"], "spp": 4, "size": (48, 36)}
    few = lightcull.compare(make_hall(), seed=100, repeats=5, **options).figures.samplers
    many = lightcull.compare(make_hall(), seed=1000, repeats=16, **options)
    for name, runs in many.samplers.items():
        lit = [run.lit for run in runs]
        errors = [relative_squared_error(one, many.reference.lit_image).mean(axis=2) for one in lit]
        truth = {
            "relmse": np.mean([many.measure.relmse(one) for one in lit]),
            "relmse_measured": np.mean(errors),
            "relmse_median": np.median(errors, axis=(1, 2)).mean(),
            "variance": many.measure.variance(lit),
            "bias": many.measure.bias(lit),
        }
        intervals = few[name].intervals
        held = [intervals[key][0] <= value <= intervals[key][1] for key, value in truth.items()]
        assert sum(held) >= 4, (name, truth, intervals)
        assert few[name].relmse == pytest.approx(few[name].bias + few[name].variance, rel=1e-6)


def test_errors_are_of_the_pixels_of_a_mask(room: lightcull.Scene) -> None:
    mask = np.zeros((SIZE[1], SIZE[0]), bool)
    mask[12:, 4:20] = True
    result = lightcull.compare(room, ["culled"], mask=mask, **QUICK)
    assert result.figures.pixels == mask.sum()
    (run,) = result.samplers["culled"]
    errors = relative_squared_error(run.lit, result.reference.lit_image).mean(axis=2)
    figures = result.figures.samplers["culled"]
    assert figures.relmse_measured == pytest.approx(errors[mask].mean())
    assert figures.relmse_median == pytest.approx(np.median(errors[mask]))
    for wrong, kind, message in [
        (np.zeros((2, 2), bool), TypeError, r"mask: wanted a bool array of shape \(24, 32\)"),
        (np.zeros((24, 32)), TypeError, "mask: wanted a bool array .*got float64"),
        (np.zeros((24, 32), bool), lightcull.Error, "mask: has no pixel that counts"),
    ]:
        with pytest.raises(kind, match=message):
            lightcull.compare(room, ["culled"], mask=wrong, **QUICK)


def test_all_samplers_of_renown_are_compared_unless_told(room: lightcull.Scene) -> None:
    result = lightcull.compare(room, **QUICK)
    assert set(result.samplers) == {"uniform", "power", "light_bvh", "culled", "learned"}
    assert result.reference.sampler == "learned"


def test_the_reference_is_kept(
    room: lightcull.Scene, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    jobs = []

    class CountedJob(subject_module.PathJob):
        def __init__(self, *arguments) -> None:
            super().__init__(*arguments)
            if arguments[1] != "uniform":  # which is under test
                jobs.append(self)

    monkeypatch.setattr(subject_module, "PathJob", CountedJob)

    def reference(scene: lightcull.Scene, **changes: object) -> lightcull.report.Reference:
        jobs.clear()
        return lightcull.compare(scene, ["uniform"], **{**QUICK, **changes}).reference

    first = reference(room)
    assert len(jobs) == 2
    halves = [job.image() for job in jobs]
    assert not np.array_equal(*halves)
    assert first.spp == 32
    assert first.relmse_of_itself == pytest.approx(relmse_of_mean(*(job.lit() for job in jobs)))
    np.testing.assert_allclose(first.image, (halves[0] + halves[1]) / 2, rtol=1e-6)
    assert np.array_equal(first.halves, halves)

    again = reference(make_room())
    assert not jobs
    for part in ("halves", "lit", "emission"):
        assert np.array_equal(getattr(again, part), getattr(first, part))
    assert (again.spp, again.sampler) == (first.spp, first.sampler)
    for change in ({"spp": 5}, {"size": (24, 32)}, {"max_depth": 3}):
        reference(make_room(), **change)
        assert len(jobs) == 2, change
    reference(make_room(lamps=2))
    assert len(jobs) == 2

    folder = tmp_path / "lightcull" / "references"
    files = {file: file.read_bytes() for file in folder.iterdir()}
    for broken in (b"broken", b"", b"PK\3\4", lambda whole: whole[: len(whole) // 2], _spoiled):
        for file, whole in files.items():
            file.write_bytes(broken(whole) if callable(broken) else broken)
        with pytest.warns(UserWarning, match="broken, rendered anew"):
            renewed = reference(make_room())
        assert np.array_equal(renewed.image, first.image)
    assert set(folder.iterdir()) == set(files)


def _spoiled(npz: bytes) -> bytes:
    middle = npz.index(b"halves.npy") + 200
    return npz[:middle] + bytes([npz[middle] ^ 1]) + npz[middle + 1 :]


def test_a_reference_that_cannot_be_kept_is_said(
    room: lightcull.Scene, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "lightcull").write_text("in the way")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    with pytest.warns(UserWarning, match="the reference is not kept: .*cannot make this folder"):
        lightcull.compare(room, ["uniform"], **QUICK)


def test_noise_of_the_reference_is_said(room: lightcull.Scene) -> None:
    with pytest.warns(UserWarning, match="the noise of the reference .* is a good part"):
        lightcull.compare(room, ["uniform"], reference_seconds=1e-6, spp=512, size=SIZE)


def test_what_makes_no_sense_is_said_before_anything_is_rendered(
    room: lightcull.Scene, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("")
    for options, message in [
        ({"samplers": ["culled", "cold"]}, "cold"),
        ({"samplers": []}, "samplers: wanted one at least"),
        ({"folder": tmp_path / "file" / "report"}, "cannot write there"),
        ({"spp": None}, "give either seconds=... or spp=..."),
        ({"repeats": 0}, "repeats: wanted a whole number from 1 up"),
    ]:
        with pytest.raises(lightcull.Error, match=message):
            lightcull.compare(room, **{**QUICK, **options})


def test_ctrl_c_while_the_reference_is_rendered(room: lightcull.Scene) -> None:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            lightcull.compare(
                room,
                ["power"],
                progress=lambda progress: signal.raise_signal(signal.SIGINT),
                **QUICK,
            )
    finally:
        signal.signal(signal.SIGINT, before)


def signed(image: np.ndarray, reference: np.ndarray) -> np.ndarray:
    return (image - reference).mean(axis=2)


def brightness(image: np.ndarray, reference: np.ndarray) -> float:
    return float(image.mean() / reference.mean())


def test_metrics_by_name_and_function(room: lightcull.Scene, tmp_path: Path) -> None:
    names = ["mape", "smape", "flip", "signed", "brightness"]
    metrics = ["mape", "smape", "flip", signed, brightness]
    mask = np.arange(SIZE[0] * SIZE[1]).reshape(SIZE[::-1]) % 3 == 0
    options = {"metrics": metrics, "repeats": 2, "mask": mask, "folder": tmp_path, **QUICK}
    result = lightcull.compare(room, ["culled"], **options)
    found = result.figures.samplers["culled"].metrics
    assert list(found) == names
    runs, reference = result.samplers["culled"], result.reference.lit_image
    expected = np.mean([(run.lit - reference)[mask].mean() for run in runs])
    assert found["signed"].value == pytest.approx(expected, rel=1e-4)
    ratios = [run.lit.mean() / reference.mean() for run in runs]
    assert found["brightness"].value == pytest.approx(np.mean(ratios), rel=1e-5)
    assert found["brightness"].low < found["brightness"].value < found["brightness"].high
    assert found["flip"].value == pytest.approx(result.figures.samplers["culled"].flip)

    error = result.error_map("culled", signed)
    np.testing.assert_allclose(error, np.mean([run.lit for run in runs], axis=0).mean(axis=2)
                               - reference.mean(axis=2), atol=1e-5)  # fmt: skip
    kept = lightcull.read_image(tmp_path / "culled_metric_signed.exr")
    assert np.array_equal(kept[..., 0], error)
    default = lightcull.read_image(tmp_path / "culled_error.exr")[..., 1]
    np.testing.assert_allclose(default, result.error_map("culled"), rtol=1e-6)
    header = (tmp_path / "report.csv").read_text().splitlines()[0].split(",")
    assert {"metric_mape", "metric_mape_low", "metric_signed_high", "relmse_low"} <= set(header)
    assert len(set(header)) == len(header)
    for wrong, kind, message in [
        (["rsme"], lightcull.Error, "metrics: 'rsme' is unknown; there are relmse, mape, smape"),
        ([3], TypeError, "metrics: wanted names and functions, got 3"),
        (["mape", "mape"], lightcull.Error, "metrics: there are two of the name 'mape'"),
        ([lambda image, reference: image[0]], lightcull.Error, r"<lambda> gave an array of shape"),
    ]:
        with pytest.raises(kind, match=message):
            lightcull.compare(room, ["culled"], metrics=wrong, **QUICK)


def test_mape_and_smape_are_what_they_say() -> None:
    """Reference 1 and 3, mean 2: denominators 1.02 and 3.02, and 1.5 + 1.02 and 2 + 3.02."""
    reference = np.repeat(np.float32([[1.0], [3.0]])[..., None], 3, axis=2)
    image = np.repeat(np.float32([[1.5], [2.0]])[..., None], 3, axis=2)
    mape, smape = (lightcull.report.METRICS[name](image, reference) for name in ("mape", "smape"))
    np.testing.assert_allclose(mape[:, 0, 0], [0.5 / 1.02, 1 / 3.02])
    np.testing.assert_allclose(smape[:, 0, 0], [2 * 0.5 / 2.52, 2 / 5.02])


def test_curves_are_arrays(room: lightcull.Scene) -> None:
    result = lightcull.compare(room, ["culled"], repeats=2, **QUICK)
    curve = result.curve("culled")
    assert curve.dtype.names == ("spp", "seconds", "relmse", "low", "high")
    assert curve["spp"].tolist() == [1, 2, 3, 4]
    assert curve["relmse"][-1] == pytest.approx(result.figures.samplers["culled"].relmse)
    assert np.all(curve["low"] < curve["relmse"]) and np.all(curve["relmse"] < curve["high"])
    alone = lightcull.compare(room, ["culled"], **QUICK).curve("culled")
    assert np.isnan(alone["low"]).all()
    for call in (result.curve, result.error_map):
        with pytest.raises(lightcull.Error, match="sampler 'cold': there are culled"):
            call("cold")


def test_slices_are_the_samples_of_parts(room: lightcull.Scene, tmp_path: Path) -> None:
    """Their mean is the image, and each is of its passes alone."""
    options = {"spp": 6, "size": SIZE, "repeats": 2, "folder": tmp_path}
    result = lightcull.compare(room, ["culled"], slices=3, **options)
    for number, run in enumerate(result.samplers["culled"], 1):
        assert [part.spp for part in run.slices] == [2, 2, 2]
        mean = np.mean([part.image for part in run.slices], axis=0)
        np.testing.assert_allclose(mean, run.image, atol=1e-5)
        first = lightcull.render(make_room(), "culled", spp=2, size=SIZE, seed=number - 1).image
        np.testing.assert_allclose(run.slices[0].image, first, atol=1e-6)
        assert not np.allclose(run.slices[1].image, first)
        assert run.slices[-1].seconds == run.seconds
        kept = lightcull.read_image(tmp_path / f"culled_run{number}_slice2.exr")
        assert np.array_equal(kept, run.slices[1].image)
    uneven = lightcull.compare(room, ["culled"], slices=4, **options).samplers["culled"][0]
    assert sum(part.spp for part in uneven.slices) == 6
    assert not lightcull.compare(room, ["culled"], **QUICK).samplers["culled"][0].slices


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["reference"], "sampler 'reference': its files would be those of the reference"),
        (["a/b", "a b"], "sampler 'a b': its files would be those of sampler 'a/b'"),
        (["a", "a_error"], "sampler 'a_error': its files would be those of sampler 'a'"),
        (["a_run2_slice1", "a"], "sampler 'a_run2_slice1': its files would be those of sampler 'a'"),
        ([""], "sampler '': files cannot be called so"),
        (["x" * 121], "files cannot be called so"),
    ],
)
def test_names_that_files_cannot_have_are_refused(
    room: lightcull.Scene, names: list[str], message: str
) -> None:
    with pytest.raises(lightcull.Error, match=message):
        lightcull.compare(room, dict.fromkeys(names, "culled"), **QUICK)


@pytest.mark.parametrize(
    "record",
    [
        lightcull.Stats, lightcull.RenderResult, lightcull.Comparison, lightcull.MethodReport,
        lightcull.Progress, methods.Study, methods.Table, methods.Picture,
        report.ComparisonFigures, report.SamplerFigures, report.ReferenceFigures,
        report.LearnedFigures, report.CurvePoint, report.MetricFigures, report.Reference,
        report.SamplerRun, report.Learned, report.Moment, report.Slice, report.Measure,
        RenderSettings,
    ],
)  # fmt: skip
def test_help_documents_every_field(record: type) -> None:
    text = pydoc.render_doc(record, renderer=pydoc.plaintext)
    for field in fields(record):
        if not field.name.startswith("_"):
            assert re.search(rf"^ \|  {field.name}: \S.{{3,}}", text, re.M), field.name
