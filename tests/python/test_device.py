"""Selections on another device than the processor, and what the command line says of devices."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import lightcull
import numpy as np
import pytest
from conftest import Outcome, make_room
from lightcull import _core
from lightcull.bench import bench

Run = Callable[..., Outcome]

rng = np.random.default_rng(9)
LIGHTS = lightcull.point_lights(
    rng.random((400, 3), dtype=np.float32), rng.random(400, dtype=np.float32)
)
POSITIONS = rng.random((3000, 3), dtype=np.float32)
U = rng.random(3000, dtype=np.float32)


def test_a_device_chooses_as_the_processor_does() -> None:
    cpu, gpu = (
        lightcull.LightSampler(LIGHTS, "culled:sets=4", device=device)
        for device in ("cpu", "vulkan")
    )
    for number in (0, 5):
        cpu.begin_pass(number)
        gpu.begin_pass(number)
        expected, chosen = (sampler.select(POSITIONS, None, U) for sampler in (cpu, gpu))
        same = expected["light"] == chosen["light"]
        assert np.mean(~same) <= 1e-4
        np.testing.assert_allclose(chosen["prob"][same], expected["prob"][same], rtol=1e-5)
        probs = gpu.prob(POSITIONS, None, chosen)
        np.testing.assert_allclose(probs, chosen["prob"], rtol=1e-5)


def test_a_device_is_named_by_a_part_of_its_name() -> None:
    (name, problem), *_ = _core.vulkan_devices()
    assert name and not problem
    lightcull.LightSampler(LIGHTS, device=f"vulkan:{name[1:]}")


@pytest.mark.parametrize(
    ("description", "device", "message"),
    [
        ("culled", "cuda", "device 'cuda': unknown; there are cpu, vulkan and vulkan:NAME"),
        ("culled", "vulkan:none such", "Vulkan: no device 'none such'; there are: "),
        ("power", "vulkan", "Vulkan: of the samplers, only culled and paper"),
    ],
)
def test_bad_devices(description: str, device: str, message: str) -> None:
    with pytest.raises(lightcull.Error, match=message):
        lightcull.LightSampler(LIGHTS, description, device=device)


def test_a_device_is_measured_beside_the_processor() -> None:
    rows = list(
        bench(make_room(), ["power", "culled"], size=(16, 12), threads=(1,), device="vulkan")
    )
    of_camera = [(row.sampler, row.device, row.entry) for row in rows if row.points == "camera"]
    assert of_camera == [
        ("power", "cpu", "batch"),
        ("power", "cpu", "single"),
        ("culled", "cpu", "batch"),
        ("culled", "cpu", "single"),
        ("culled", "vulkan", "batch"),
    ]
    assert all(row.ns_per_selection > 0 for row in rows)
    with pytest.raises(lightcull.Error, match="vulkan: none of the samplers is culled or paper"):
        list(bench(make_room(), ["power"], device="vulkan"))


def number(printed: str) -> float:
    """Of a cell of a table: "1,234", "12.3k", "4.56M"."""
    factor = {"k": 1e3, "M": 1e6}.get(printed[-1], 1)
    return factor * float(printed.rstrip("kM").replace(",", ""))


def test_the_command_prints_selections_per_second_side_by_side(
    main_here: Run, tmp_path: Path
) -> None:
    result = main_here(
        "bench", "cornell", "--samplers", "culled", "--size", "32x24", "--threads", "1",
        "--device", "vulkan", "--json", "rows.json",
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    per_second = {
        (row["points"], row["device"]): row["selections_per_second"]
        for row in json.loads((tmp_path / "rows.json").read_text())
        if row["entry"] == "batch"
    }
    assert len(per_second) == 3 * 2
    tables = result.stdout.split("cornell, 2 lights: ")[1:]
    assert len(tables) == 3
    for table in tables:
        printed = {}
        for line in table.splitlines():
            cells = re.match(r" *(culled(?: on vulkan)?) +[\d,.kM]+ +([\d,.kM]+) ", line)
            if cells:
                printed[cells[1]] = number(cells[2])
        points = table.split()[0]
        expected = {
            "culled": per_second[points, "cpu"],
            "culled on vulkan": per_second[points, "vulkan"],
        }
        assert printed == pytest.approx(expected, rel=0.01)


def test_info_names_the_devices(main_here: Run) -> None:
    said = main_here("info", "cornell").stdout
    assert f"cpu: {_core.instruction_set()}" in said
    assert f"vulkan: {_core.vulkan_devices()[0][0]}" in said


# Without a device, or with one that fails. Each in a program of its own, whose environment says so.

GPU_TESTS = Path(__file__).parents[2] / "build/tests/gpu"
FAULTY = {
    "VK_ADD_LAYER_PATH": str(GPU_TESTS / "layer"),
    "VK_INSTANCE_LAYERS": "VK_LAYER_LIGHTCULL_faulty",
}
"""A layer that makes calls of Vulkan fail, by LIGHTCULL_FAULT."""
HOST = """\
import os, sys
import lightcull
import numpy as np

lights = lightcull.point_lights(np.eye(3, dtype=np.float32), np.ones(3, np.float32))
points, u = np.zeros((5000, 3), np.float32), np.full(5000, 0.5, np.float32)

def chosen(sampler):
    return sampler.select(points, None, u)["light"].tolist()

try:
    sampler = lightcull.LightSampler(lights, "culled", device="vulkan")
    os.environ["LIGHTCULL_FAULT"] = sys.argv[1]
    sampler.begin_pass(1)
except lightcull.Error as error:
    print(error)
    if not sys.argv[1]:
        sampler = lightcull.LightSampler(lights, "culled")
        sampler.begin_pass(1)
    cpu = lightcull.LightSampler(lights, "culled")
    cpu.begin_pass(1)
    print("goes on" if chosen(sampler) == chosen(cpu) else "differs")
"""


@pytest.mark.parametrize(
    ("environment", "later_fault", "message"),
    [
        ({"LD_LIBRARY_PATH": str(GPU_TESTS / "no_loader")}, "", "Vulkan: this machine has no loader"),
        ({"VK_DRIVER_FILES": "/nonexistent"}, "", "Vulkan: this machine has no driver for it"),
        (FAULTY | {"LIGHTCULL_FAULT": "compute 0 0"}, "", "no queue for compute"),
        (FAULTY | {"LIGHTCULL_FAULT": "vkAllocateMemory -2 0"}, "", "out of device memory"),
        (FAULTY, "vkQueueSubmit -4 0", "the device was lost"),
        (FAULTY, "hung 0 0", "no answer within 60 s"),
    ],
)  # fmt: skip
def test_a_device_that_fails_is_one_error_and_the_processor_goes_on(
    environment: dict[str, str], later_fault: str, message: str
) -> None:
    result = subprocess.run(
        [sys.executable, "-c", HOST, later_fault],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert result.returncode == 0, result.stderr
    told, after = result.stdout.splitlines()
    assert message in told
    assert after == "goes on"
