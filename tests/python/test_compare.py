"""lightcull.compare."""

from __future__ import annotations

import json
import signal
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest

import lightcull
from conftest import make_room
from lightcull.comparing import compare as compare_module
from lightcull.rendering import subject as subject_module
from lightcull.report.metrics import relmse, relmse_of_mean

SIZE = (32, 24)
QUICK = {"spp": 4, "size": SIZE}


class FakeJob:
    """Renders nothing, by a clock of its own."""

    setup_seconds = {"slow": 0.2, "middle": 0.05, "fast": 0.0, "huge": 0.0, "big": 0.0}
    pass_seconds = {"slow": 0.09, "middle": 0.031, "fast": 0.002, "huge": 1.0, "big": 0.9}
    turns: list[str] = []

    def __init__(self, scene, sampler, settings) -> None:
        self.sampler = sampler
        self.spp = 0

    def render_pass(self) -> None:
        self.spp += 1
        FakeJob.turns.append(self.sampler)

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
def fake_jobs(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    reference = lightcull.report.Reference(np.ones((24, 32, 3), np.float32), "other", 64, 0.0)
    monkeypatch.setattr(subject_module, "PathJob", FakeJob)
    monkeypatch.setattr(subject_module, "check_description", lambda description: None)
    monkeypatch.setattr(compare_module, "reference_for", lambda order, progress: reference)
    FakeJob.turns = []
    return FakeJob.turns


def test_all_have_the_same_time_in_turns(room: lightcull.Scene, fake_jobs: list[str]) -> None:
    result = lightcull.compare(room, ["slow", "middle", "fast"], seconds=6.0, size=SIZE)
    seconds = [run.seconds for run in result.samplers.values()]
    assert min(seconds) >= 6.0
    assert max(seconds) <= 1.03 * min(seconds)
    assert max(seconds) <= 6.0 + 2 * 0.09
    changes = sum(a != b for a, b in zip(fake_jobs, fake_jobs[1:], strict=False))
    assert changes > 100
    run = result.samplers["middle"]
    assert (run.accepted_per_point, run.nodes_per_point, run.lights_tested_per_point) == (1, 2, 3)
    assert run.setup_seconds == 0.05


def test_a_pass_that_is_too_long_is_said(room: lightcull.Scene, fake_jobs: list[str]) -> None:
    with pytest.warns(UserWarning, match=r"render times differ by \d+%: one pass takes too long"):
        lightcull.compare(room, ["huge", "big"], seconds=0.5, size=SIZE)


def test_error_curve_is_spaced_by_ratio(room: lightcull.Scene, fake_jobs: list[str]) -> None:
    result = lightcull.compare(room, ["fast"], seconds=2.0, size=SIZE)
    moments = [seconds for seconds, _ in result.samplers["fast"].curve]
    assert moments[0] == pytest.approx(0.002)
    assert moments[-1] == result.samplers["fast"].seconds
    ratios = np.divide(moments[1:], moments[:-1])
    assert np.all(ratios[:-1] >= 1.3)
    assert np.all(ratios[8:-1] < 1.4)


def test_ctrl_c_reports_what_there_is(
    room: lightcull.Scene, fake_jobs: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(progress: lightcull.Progress) -> None:
        if progress.stage == "middle":
            raise KeyboardInterrupt

    result = lightcull.compare(room, ["slow", "middle"], seconds=6.0, size=SIZE, progress=stop)
    assert result.interrupted
    assert list(result.samplers) == ["slow", "middle"]
    assert result.samplers["middle"].spp >= 1
    assert result.samplers["middle"].seconds < 6


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
    report = json.loads((tmp_path / "report" / "report.json").read_text())
    assert {"scene", "width", "height", "max_depth", "threads", "reference", "samplers"} <= set(
        report
    )
    assert set(report["reference"]) == {"sampler", "spp", "relmse_of_itself"}
    assert list(report["samplers"]) == ["uniform", "culled"]
    assert {
        "spp", "seconds", "setup_seconds", "ns_per_selection", "rays_per_second",
        "accepted_per_point", "rmse", "relmse", "flip", "relmse_blurred", "efficiency",
        "ratio_to_uniform", "ratio_to_light_bvh", "error_curve",
    } <= set(report["samplers"]["culled"])  # fmt: skip
    assert (report["scene"], report["width"], report["height"]) == ("room", 32, 24)
    assert report["samplers"]["culled"]["spp"] == 4
    assert report["samplers"]["uniform"]["ratio_to_uniform"] == 1
    assert set(stages) == {"reference", "uniform", "culled"}
    assert json.loads(json.dumps(asdict(result.figures))) == report
    last_seconds, last_error = result.samplers["culled"].curve[-1]
    assert last_seconds == result.samplers["culled"].seconds
    assert last_error == relmse(result.samplers["culled"].image, result.reference.image)


def test_what_was_learned_is_reported(room: lightcull.Scene, tmp_path: Path) -> None:
    result = lightcull.compare(room, ["culled", "learned"], folder=tmp_path, **QUICK)
    assert result.samplers["culled"].learned is None
    learned = result.samplers["learned"].learned
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
    visibility = result.samplers["learned"].learned.visibility
    known = visibility[np.isfinite(visibility)]
    assert (known < 0.2).mean() > 0.1 and (known > 0.8).mean() > 0.1


def test_images_are_those_of_render(room: lightcull.Scene) -> None:
    result = lightcull.compare(room, ["culled"], seed=5, **QUICK)
    alone = lightcull.render(make_room(), "culled", seed=5, **QUICK)
    assert np.array_equal(result.samplers["culled"].image, alone.image)


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
    assert first.relmse_of_itself == pytest.approx(relmse_of_mean(*halves))
    np.testing.assert_allclose(first.image, (halves[0] + halves[1]) / 2, rtol=1e-6)

    again = reference(make_room())
    assert not jobs
    assert np.array_equal(again.image, first.image)
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
    middle = npz.index(b"image.npy") + 200
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
