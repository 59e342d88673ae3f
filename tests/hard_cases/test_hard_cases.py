"""The cases of `lightcull selftest`, each with every instruction set, and that they can fail."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from lightcull import _core, selftest
from lightcull.cli import main
from lightcull.selftest import edges, lit_points, runner, sampler_checks
from lightcull.selftest.case import Case, Finding, worst
from lightcull.selftest.runner import all_cases


@pytest.fixture(autouse=True)
def _fewer_pairs(monkeypatch: pytest.MonkeyPatch) -> None:
    """A quarter of the command's, to save time."""
    monkeypatch.setattr(edges, "_DIRECTIONS", 4)


@pytest.mark.parametrize("case", all_cases(), ids=lambda case: case.name)
def test_case(case: Case) -> None:
    results = list(selftest.run([case]))
    assert [result.target for result in results] == (
        ["all"] if case.once else _core.instruction_sets()
    )
    assert [result for result in results if not result.passed] == []


# ---- that they can fail --------------------------------------------------------------------------


def failed(findings: object) -> list[str]:
    return [finding.what for finding in findings if not finding.passed]


def test_a_biased_sampler_is_found() -> None:
    setting = lit_points.mixed_setting()
    found = failed(sampler_checks.means(setting, ("clamped",)))
    assert any("samples have none" in what for what in found)


def test_a_sampler_that_leaves_lights_out_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    setting = lit_points.points_setting()
    fewer = setting.lights.copy()
    fewer["intensity"][::2] = 0
    part = lit_points.Setting(fewer, setting.positions, setting.normals)
    whole = lit_points.Setting.sampler
    monkeypatch.setattr(
        lit_points.Setting,
        "sampler",
        lambda self, name: whole(setting if name == "exhaustive" else part, name),
    )
    assert any("never chosen" in what for what in failed(sampler_checks.totals(setting)))


def test_bits_that_differ_are_found() -> None:
    a = np.zeros(3, _core.SELECTION)
    a["prob"] = 0.5
    b = a.copy()
    b["weight_sum"][1] = 1e-30
    assert sampler_checks._differ(a, b) == 1
    assert sampler_checks._differ(a, a) == 0


def test_the_worst_finding_is_shown() -> None:
    good, bad = Finding("good", 0.5, 1.0), Finding("bad", 2.0, 1.0)
    none, exact = Finding("none", float("nan"), 1.0), Finding("exact", 0.0, 0.0)
    assert worst([good, bad, exact]) is bad
    assert worst([good, none, bad]) is none
    assert not none.passed
    assert worst([exact, good]) is good
    assert worst([Finding("a", 1, 0), bad]).what == "a"


def test_results_are_shown_before_their_file_is_written(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """The file may not come to be."""
    folder = tmp_path / "new"

    def find():
        folder.write_text("")
        yield Finding("x", 0.0, 0.0)

    monkeypatch.setattr(runner, "all_cases", lambda: [Case("case", find, once=True)])
    assert main(["selftest", "--json", str(folder / "a.json")]) == 1
    output = capsys.readouterr()
    assert output.out.splitlines()[-1] == "1 passed, 0 failed"
    assert "cannot make this folder" in output.err


def test_the_instruction_set_is_put_back() -> None:
    before = _core.instruction_set()
    used = []

    def find():
        used.append(_core.instruction_set())
        yield Finding("", 0.0, 0.0)

    list(selftest.run([Case("case", find)]))
    assert used == _core.instruction_sets()
    assert _core.instruction_set() == before


@pytest.mark.parametrize("passes", [True, False])
def test_the_command_ends_with_a_count(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    passes: bool,
) -> None:
    cases = [
        Case("good", lambda: iter([Finding("x", 0.0, 0.0)])),
        Case("other", lambda: iter([Finding("y", 0.0 if passes else 1.0, 0.0)]), once=True),
    ]
    monkeypatch.setattr(runner, "all_cases", lambda: cases)
    table = tmp_path / "selftest.json"
    assert main(["selftest", "--json", str(table)]) == (0 if passes else 1)
    count = len(_core.instruction_sets())
    lines = capsys.readouterr().out.splitlines()
    assert lines[-1] == (
        f"{count + 1} passed, 0 failed" if passes else f"{count} passed, 1 failed"
    )
    rows = json.loads(table.read_text())
    assert [row["case"] for row in rows] == ["good"] * count + ["other"]
    assert [row["passed"] for row in rows] == [True] * count + [passes]
    assert rows[-1]["error"] == (0 if passes else 1) and rows[-1]["allowed"] == 0
    assert passes or lines[-2] == "other (all): y: 1, allowed 0"
