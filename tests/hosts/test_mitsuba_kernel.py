"""Where lights are chosen within Dr.Jit's kernel, `lightcull_path` is to LLVM variants what `path`
is: one kernel for a pass, and as much memory.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed")

import drjit as dr  # noqa: E402
import lightcull.mitsuba  # noqa: E402, F401
import mitsuba_scenes as scenes  # noqa: E402

MEANS = "light_bvh:importance=means"
SPP = 16
PASS = 4
FEW_OPERATIONS = 200
"""More than the kernels have that ask emitters for their light, fewer than one that traces rays."""


@pytest.fixture(autouse=True)
def _llvm() -> None:
    mi.set_variant("llvm_ad_rgb")


def render(scene: Any, kind: str = "lightcull_path", spp: int = PASS, **options: Any) -> np.ndarray:
    integrator = mi.load_dict({"type": kind, "max_depth": 4, **options})
    return np.array(mi.render(scene, integrator=integrator, spp=spp))


def large_kernels(scene: Any, **options: Any) -> list[dict[str, Any]]:
    """Those that trace paths, of one render: what looks at emitters has other numbers of lanes."""
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        render(scene, **options)
        history = dr.kernel_history([dr.KernelType.JIT])
    pixels = scenes.SIZE[0] * scenes.SIZE[1]
    sizes = [pixels * samples for samples in range(1, PASS + 1)]
    return [
        kernel
        for kernel in history
        if kernel["operation_count"] > FEW_OPERATIONS and kernel["size"] in sizes
    ]


@pytest.mark.parametrize(
    ("make", "sampler"),
    [
        (scenes.many_lamps, MEANS),
        (scenes.suns_and_lamps, MEANS),
        (scenes.panels, "learned"),
        (lambda: scenes.stage() | scenes.lamps(64), "culled"),
        (scenes.cornell, "learned"),
        (scenes.sky_only, "uniform"),
        (scenes.stage, "learned"),
    ],
)
def test_a_pass_is_one_kernel(make: Any, sampler: str) -> None:
    assert len(large_kernels(mi.load_dict(make()), light_sampler=sampler)) == 1


@pytest.mark.parametrize(
    ("sampler", "lamps"),
    [("culled", 65), ("learned", 65), ("light_bvh", 8), ("culled:error_bound=0.1", 8), ("culled:accepted=1", 8)],
)
def test_what_the_kernel_cannot_choose_by_is_chosen_between_kernels(
    sampler: str, lamps: int
) -> None:
    scene = mi.load_dict(scenes.stage() | scenes.lamps(lamps))
    assert len(large_kernels(scene, light_sampler=sampler)) > 1


@pytest.mark.parametrize("make", [scenes.cornell, scenes.sky_only])
def test_without_a_choice_it_is_path(make: Any) -> None:
    """The same random numbers have the same use, so that images are equal."""
    scene = mi.load_dict(make())
    np.testing.assert_allclose(render(scene), render(scene, "path"), rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"])
@pytest.mark.parametrize("count", [1, 2, 70])
def test_no_path_of_depth_0_has_light(variant: str, count: int) -> None:
    mi.set_variant(variant)
    shown = scenes.lamps_in_view() | scenes.lamps(count)
    scene = mi.load_dict(shown)
    assert render(scene, max_depth=1).any()
    assert not render(scene, max_depth=0).any()


MEMORY = """
import sys
import lightcull.mitsuba, mitsuba as mi
from lightcull import memory
import mitsuba_scenes as scenes
mi.set_variant("llvm_ad_rgb")
film = {"width": 320, "height": 240}
scene = scenes.many_lamps()
scene["sensor"]["film"] |= film
loaded = mi.load_dict(scene)
integrator = mi.load_dict({"type": sys.argv[1], "max_depth": 3,
                           **({"light_sampler": sys.argv[2]} if sys.argv[2:] else {})})
# What Mitsuba and LLVM take, whatever is rendered, is not counted. (ru_maxrss would begin with
# the peak of the process that started this one.)
mi.render(loaded, integrator=integrator, spp=4)
before = memory.of_process("VmHWM")
mi.render(loaded, integrator=integrator, spp=SPP)
print(memory.of_process("VmHWM") - before)
"""


def bytes_per_path(*arguments: str) -> float:
    """That a render takes more than one of a quarter of the paths, in a process of its own."""
    output = subprocess.run(
        [sys.executable, "-c", MEMORY.replace("SPP", str(SPP)), *arguments],
        check=True,
        capture_output=True,
        text=True,
        cwd=Path(__file__).parent,
    ).stdout
    return int(output.splitlines()[-1]) / (320 * 240 * SPP)


def test_nothing_is_kept_of_a_path() -> None:
    """As with `path`; what is counted are the pages of the process."""
    assert bytes_per_path("path") < 8
    assert bytes_per_path("lightcull_path", MEANS) < 8
    assert bytes_per_path("lightcull_path", "culled") > 100, "the test could not see it"
