"""The battery of `lightcull selftest --noise`, and that it can fail.

Seeds are fixed, so that a run gives the same figures each time. With others, a battery of right
means would be called wrong once in 9,000 runs, and a sampler that is as noisy as the best (of which
a variance is known to 3 %) called worse less than once in a million.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from lightcull.cli import main, noise_table
from lightcull.selftest.noise import (
    KNOWN_EVEN_MISSES,
    KNOWN_MISSES,
    all_situations,
    closed_forms,
    measure,
)
from lightcull.selftest.noise.measure import MOST
from lightcull.selftest.noise.situation import Situation
from lightcull.selftest.noise.stage import Stage, cut_up

SITUATIONS = {situation.name: situation for situation in all_situations()}
BY_EVEN = {*KNOWN_EVEN_MISSES, *list(SITUATIONS)[::4]}
"""Of which even numbers are measured here, for the sake of time: of all by `lightcull selftest
--noise`."""
NO_MORE = 1.15
"""By how much a known miss may grow: four standard deviations of a ratio of variances."""


@pytest.mark.parametrize("situation", SITUATIONS.values(), ids=lambda situation: situation.name)
def test_the_default_is_right_and_no_noisier_than_the_best(situation: Situation) -> None:
    by_even = situation.name in BY_EVEN
    row = measure(situation, by_even=by_even)
    assert row.right, row.default
    ratios = [(row.ratio, KNOWN_MISSES)] + [(row.even_ratio, KNOWN_EVEN_MISSES)] * by_even
    for ratio, misses in ratios:
        if situation.name in misses:
            assert ratio > MOST, "misses no longer: take it out of the known misses"
            assert ratio < NO_MORE * misses[situation.name], row
        else:
            assert ratio <= MOST, row


def test_there_are_enough_situations_and_every_miss_is_one() -> None:
    assert len(SITUATIONS) == len(all_situations()) >= 40
    assert set(KNOWN_MISSES) | set(KNOWN_EVEN_MISSES) <= set(SITUATIONS)


# ---- that it can fail ----------------------------------------------------------------------------


def test_a_biased_sampler_is_found() -> None:
    """clamped leaves out what is far, but for a small error."""
    row = measure(SITUATIONS["1,000 lamps"], "clamped", ["exhaustive"])
    assert not row.right and row.best.right


def test_light_that_is_lacking_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """A 200th of it."""
    mean = Stage.mean
    monkeypatch.setattr(Stage, "mean", lambda self: 1.005 * mean(self))
    row = measure(SITUATIONS["a panel of 512 triangles"], others=["exhaustive"])
    assert not row.right


def test_a_noisy_sampler_is_found() -> None:
    row = measure(SITUATIONS["a panel of 512 triangles"], "culled", ["light_bvh", "exhaustive"])
    assert row.right and not row.no_worse and not row.no_worse_by_even


def test_what_is_wrong_is_not_the_best() -> None:
    """power chooses nothing but the sun: without noise, and half of the light."""
    row = measure(SITUATIONS["a sun and lamps"], others=["power", "exhaustive"])
    power = next(figures for figures in row.others if figures.sampler == "power")
    assert power.variance < row.best.variance and row.best.sampler == "exhaustive"


@pytest.mark.parametrize("misses", [{}, {"one": 9.0}])
def test_the_command_says_how_many_are_worse(
    misses: dict[str, float],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
) -> None:
    panel = SITUATIONS["a panel of 512 triangles"]
    monkeypatch.setattr(noise_table, "KNOWN_MISSES", misses)
    monkeypatch.setattr(noise_table, "KNOWN_EVEN_MISSES", misses)
    monkeypatch.setattr(
        noise_table, "all_situations", lambda: [Situation("one", "panels", panel.make)]
    )
    monkeypatch.setattr(noise_table, "measure", lambda s: measure(s, "culled", ["exhaustive"]))
    file = tmp_path / "noise.json"
    assert main(["selftest", "--noise", "--json", str(file)]) == (0 if misses else 1)
    output = capsys.readouterr().out
    assert output.splitlines()[-1] == (
        f"0 no noisier than the best, 1 noisier ({len(misses)} known), 0 wrong"
    )
    assert ("worse" if misses else "WORSE") in output
    (row,) = json.loads(file.read_text())
    assert row["worse"] and row["right"] and row["known"] == bool(misses)
    assert [s["sampler"] for s in row["samplers"]] == ["culled", "exhaustive"]


# ---- closed forms --------------------------------------------------------------------------------


def test_solid_angles_and_irradiances_of_planes() -> None:
    """Half a sphere of directions, and pi of a sky of radiance 1; a cube's side is a sixth."""
    place = np.array([[0.0, 1.0, 0.0]])
    wide = np.full(2, 1e6)
    assert closed_forms.solid_angle(place, -wide, wide)[0] == pytest.approx(2 * np.pi, rel=1e-5)
    assert closed_forms.solid_angle(place, -wide * 1e-6, wide * 1e-6)[0] == pytest.approx(
        4 * np.pi / 6
    )
    sky = cut_up((0, 1, 0), (1e6, 0, 0), (0, 0, 1e6), 1)
    of_sky = closed_forms.triangle_irradiance(np.zeros((1, 3)), sky)
    assert of_sky.sum() == pytest.approx(np.pi, rel=1e-5)
    assert closed_forms.triangle_irradiance(np.zeros((1, 3)), sky[:, ::-1]).sum() == 0


def test_the_flux_of_a_spot() -> None:
    """Against a sum."""
    inner, outer = 0.4, 0.9
    angle = (np.arange(100_000) + 0.5) * (outer / 100_000)
    falloff = closed_forms.spot_falloff(np.cos(angle), inner, outer)
    by_sum = 2 * np.pi * (falloff * np.sin(angle)).sum() * outer / 100_000
    assert closed_forms.spot_flux(inner, outer) == pytest.approx(by_sum, rel=1e-6)


def test_what_a_plate_hides() -> None:
    plate = np.array([[-1.0, 1, -1], [2, 0, 0], [0, 0, 2]])
    a, b = np.array([[0.0, 0, 0], [5, 0, 0]]), np.array([[0.0, 2, 0], [0, 0.9, 0], [0, 1, 0]])
    assert closed_forms.hidden(a, b, plate).tolist() == [[True, False, False], [False] * 3]
