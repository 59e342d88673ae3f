"""Samplers and renderers of one's own in lightcull.compare."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import lightcull
from conftest import make_room

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "examples/own_sampler.cpp"
EXAMPLE = ROOT / "examples/own_sampler.py"
SIZE = (32, 24)
QUICK = {"spp": 4, "size": SIZE}


class Uniform:
    """As our own `uniform` is."""

    def __init__(self, scene: lightcull.Scene) -> None:
        self.count = len(scene.lights())
        self.passes: list[int] = []
        self.points = 0

    def begin_pass(self, number: int) -> None:
        self.passes.append(number)

    def select(self, positions, normals, u, sets, *, diffuse, lobe):
        count = len(u)
        assert (positions.dtype, positions.shape) == (np.float32, (count, 3))
        assert (normals.dtype, normals.shape) == (np.float32, (count, 3))
        assert (diffuse.dtype, diffuse.shape) == (np.float32, (count,))
        assert (lobe.dtype, lobe.shape) == (lightcull.LOBE, (count,))
        assert (sets.dtype, sets.shape) == (np.uint32, (count,)) and not sets.any()
        assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-3)
        self.points += count
        lights = np.minimum((u * np.float32(self.count)).astype(np.int64), self.count - 1)
        return lights, np.full(count, 1 / self.count)

    def prob(self, positions, normals, selections, lights, *, diffuse, lobe):
        assert selections.dtype == lightcull.SELECTION and lights.dtype == np.uint32
        return np.full(len(lights), 1 / self.count)


@pytest.fixture
def room() -> lightcull.Scene:
    """Whose lamps scattered rays hit, so that prob is asked for."""
    return make_room(8)


def test_a_class_of_arrays_renders_as_ours_does(room: lightcull.Scene) -> None:
    made = []

    def make(scene: lightcull.Scene) -> Uniform:
        made.append(Uniform(scene))
        return made[-1]

    result = lightcull.compare(room, {"mine": make, "theirs": "uniform"}, repeats=2, **QUICK)
    assert list(result.samplers) == ["mine", "theirs"]
    for mine, theirs in zip(*result.samplers.values(), strict=True):
        np.testing.assert_allclose(mine.image, theirs.image, rtol=1e-5, atol=1e-7)
        assert (mine.spp, mine.selections, mine.rays) == (theirs.spp, theirs.selections, theirs.rays)
        assert 0 < mine.own_seconds < mine.seconds
        assert np.isnan(theirs.own_seconds)
    *tried, first, second = made
    # A trial comes before the first pass, by the same ranges.
    assert len(tried) == 1 and len(first.passes) == len(second.passes) == 5
    assert first.passes[0] == first.passes[1] and len(set(first.passes)) == 4
    assert not set(first.passes) & set(second.passes)
    assert 0 < first.points - result.samplers["mine"][0].selections <= 16 * 1024
    figures = result.figures.samplers
    assert figures["mine"].own_seconds > 0 and figures["theirs"].own_seconds is None
    assert figures["mine"].nodes_per_point is None


def test_our_own_sampler_by_way_of_python_is_as_ever_to_the_bit(room: lightcull.Scene) -> None:
    """With receipts, sets and MIS by `prob`, and what is learned left out."""
    for description in ("culled:sets=16", "light_bvh", "exhaustive"):
        samplers = {
            "wrapped": lambda scene, name=description: lightcull.LightSampler(scene, name),
            "ours": description,
        }
        result = lightcull.compare(room, samplers, **QUICK)
        (wrapped,), (ours,) = result.samplers.values()
        assert np.array_equal(wrapped.image, ours.image), description


class Wrong(Uniform):
    """Does one thing wrong, from pass 2 on: the trial before the reference does not see it."""

    def __init__(self, scene: lightcull.Scene, what: str, from_pass: int = 2) -> None:
        super().__init__(scene)
        self.what, self.from_pass = what, from_pass
        if what == "set_count":
            self.set_count = 3

    def select(self, positions, normals, u, sets, *, diffuse, lobe):
        lights, probs = super().select(positions, normals, u, sets, diffuse=diffuse, lobe=lobe)
        if len(self.passes) < self.from_pass:
            return lights, probs
        match self.what:
            case "light":
                lights[1] = self.count
            case "negative":
                lights[1] = -1
            case "prob":
                probs[0] = 1.5
            case "nan":
                probs[0] = np.nan
            case "shape":
                return lights[1:], probs
            case "kind":
                return lights + 0.5, probs
            case "nothing":
                return None
            case "raise":
                raise RuntimeError("something in mine")
        return lights, probs

    def prob(self, *arguments, **surface):
        if self.what == "mis" and len(self.passes) >= self.from_pass:
            return np.full(1, 7.0)
        return super().prob(*arguments, **surface)


@pytest.mark.parametrize(
    ("what", "kind", "message"),
    [
        ("light", lightcull.Error, r"'mine': select gave light 16 at point 1: there are 16 lights"),
        ("negative", lightcull.Error, "'mine': select gave light -1 at point 1"),
        ("prob", lightcull.Error, "'mine': select gave probability 1.5 at point 0, wanted 0 to 1"),
        ("nan", lightcull.Error, "'mine': select gave probability nan at point 0"),
        ("shape", TypeError, "'mine': select gave lights int64 .*wanted whole numbers"),
        ("kind", TypeError, "'mine': select gave lights float64"),
        ("nothing", TypeError, "'mine': select gave NoneType, wanted lights and probabilities"),
        ("raise", RuntimeError, "something in mine"),
        ("mis", lightcull.Error, "'mine': prob gave probability 7 at point 0"),
        ("set_count", lightcull.Error, "'mine': set_count is 3, wanted a power of 4"),
    ],
)
def test_what_a_sampler_does_wrong_is_said(
    room: lightcull.Scene, what: str, kind: type[Exception], message: str
) -> None:
    with pytest.raises(kind, match=message):
        lightcull.compare(room, {"mine": lambda scene: Wrong(scene, what)}, **QUICK)


def test_what_is_wrong_at_once_is_said_before_the_reference(room: lightcull.Scene) -> None:
    stages = []
    for sampler, kind, message in [
        (lambda scene: Wrong(scene, "raise", 0), RuntimeError, "something in mine"),
        (lambda scene: object(), TypeError, "sampler 'mine': .* has no method begin_pass"),
        (3, TypeError, "sampler 'mine': wanted a description, a class or a lightcull.SamplerLi"),
        ("cold", lightcull.Error, "cold"),
    ]:
        with pytest.raises(kind, match=message):
            lightcull.compare(room, {"mine": sampler}, progress=stages.append, **QUICK)
    assert not stages


def test_the_example_is_short_and_runs(tmp_path: Path) -> None:
    assert len([line for line in EXAMPLE.read_text().splitlines() if line.strip()]) <= 30
    run = [sys.executable, str(EXAMPLE), str(tmp_path / "report")]
    result = subprocess.run(run, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    assert re.fullmatch(r"(\w+: relMSE \S+, 95 % of \(.*\)\n){3}", result.stdout)
    report = json.loads((tmp_path / "report/report.json").read_text())
    assert list(report["samplers"]) == ["mine", "power", "culled"]
    assert "in calls of one’s own" in (tmp_path / "report/index.html").read_text()


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_library(tmp_path_factory.mktemp("library"), SOURCE)


def build_library(folder: Path, source: Path) -> Path:
    """The example in C++, as the comment in it says to build it; or another source."""
    path = folder / "libmine.so"
    (line,) = re.findall(r"^/// +(c\+\+ .*)$", SOURCE.read_text(), re.M)
    files = {"libmine.so": str(path), "examples/own_sampler.cpp": str(source)}
    command = [files.get(word, word) for word in line.split()]
    built = subprocess.run(
        [*command, "-Wall", "-Wextra", "-Werror"], cwd=ROOT, capture_output=True, text=True
    )
    assert built.returncode == 0, built.stderr
    return path


def test_a_shared_object_renders_as_ours_does(room: lightcull.Scene, library: Path) -> None:
    samplers = {"mine": lightcull.SamplerLibrary(library), "theirs": "uniform"}
    (mine,), (theirs,) = lightcull.compare(room, samplers, **QUICK).samplers.values()
    np.testing.assert_allclose(mine.image, theirs.image, rtol=1e-5, atol=1e-7)
    assert mine.selections == theirs.selections
    assert mine.rays == theirs.rays


def test_a_shared_object_is_told_which_lights_are_directional(
    room: lightcull.Scene, tmp_path: Path
) -> None:
    """One that takes no others takes a sun, and refuses lamps."""
    takes_suns = (
        SOURCE.read_text()
        .replace("const lightcull_light*, size_t count", "const lightcull_light* lights, size_t count")
        .replace(
            "    *sampler = new",
            "    for (size_t i = 0; i < count; ++i) {\n"
            "        if (lights[i].directional == 0) return LIGHTCULL_OUT_OF_MEMORY;\n"
            "    }\n    *sampler = new",
        )
    )
    assert "directional" in takes_suns
    (tmp_path / "suns.cpp").write_text(takes_suns)
    samplers = {"mine": lightcull.SamplerLibrary(build_library(tmp_path, tmp_path / "suns.cpp"))}
    sunny = lightcull.Scene()
    floor = np.float32([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]])
    sunny.add_mesh(floor, np.uint32([[0, 1, 2], [0, 2, 3]]))
    sunny.add_directional_light((0, -1, 0), (1, 1, 1))
    sunny.set_camera((0, 2, 0), (0, 0, 0), up=(0, 0, -1))
    (mine,) = lightcull.compare(sunny, samplers, **QUICK).samplers["mine"]
    assert mine.image.max() > 0.1
    with pytest.raises(lightcull.Error, match="there is no memory"):
        lightcull.compare(room, samplers, **QUICK)


def test_what_is_no_sampler_library_is_said(room: lightcull.Scene, tmp_path: Path) -> None:
    with pytest.raises(lightcull.Error, match="no.so: no such file"):
        lightcull.SamplerLibrary(tmp_path / "no.so")
    (tmp_path / "text.so").write_text("not one")
    with pytest.raises(lightcull.Error, match="cannot be loaded: .*text.so"):
        lightcull.compare(room, {"mine": lightcull.SamplerLibrary(tmp_path / "text.so")}, **QUICK)
    other = lightcull.SamplerLibrary(lightcull._core.__file__)
    with pytest.raises(lightcull.Error, match=r"_core.*has no function lightcull_\w+"):
        lightcull.compare(room, {"mine": other}, **QUICK)


class ConstantJob(lightcull.SubjectJob):
    """A renderer that shows one number everywhere, off by less and less noise."""

    def __init__(self, sampler: str, noise: float, settings) -> None:
        self.sampler = sampler
        self._noise, self._size = noise, settings.size
        self._chance = np.random.default_rng(settings.seed)
        self._sum, self._spp = 0.0, 0

    def render_pass(self) -> None:
        width, height = self._size
        self._sum = self._sum + 1 + self._noise * self._chance.standard_normal((height, width, 3))
        self._spp += 1

    def image(self) -> np.ndarray:
        return (self._sum / self._spp).astype(np.float32)

    def stats(self) -> lightcull.Stats:
        return lightcull.Stats(spp=self._spp, seconds=0.5 * self._spp)


class ConstantSubject:
    """A renderer whose samplers are called by their noise."""

    name, light_count, best_sampler = "constant", 1, "0.01"

    def digest(self) -> str:
        return "constant"

    def check_sampler(self, description: str) -> None:
        float(description)

    def new_job(self, sampler: str, settings, spp: int | None = None) -> ConstantJob:
        return ConstantJob(sampler, float(sampler), settings)


def test_a_renderer_of_ones_own_is_compared(tmp_path: Path) -> None:
    """By the least that a job has to have. Ratios are those of the variances, to 3 half widths."""
    result = lightcull.compare(
        ConstantSubject(), ["0.1", "0.2"], spp=8, repeats=4, size=SIZE, folder=tmp_path
    )
    assert result.figures.measured == "image"
    quiet, loud = result.figures.samplers.values()
    for figures, noise in ((quiet, 0.1), (loud, 0.2)):
        low, high = figures.intervals["variance"]
        expected = noise**2 / 8 / 1.01
        assert abs(figures.variance - expected) < 3 * (high - low) / 2 < 0.2 * expected
        assert figures.relmse_emission is None and figures.ns_per_selection is None
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["scene"] == "constant"
    with pytest.raises(lightcull.Error, match="of one's own are for scenes of ours"):
        lightcull.compare(ConstantSubject(), {"mine": Uniform}, spp=1, size=SIZE)
