"""Measures `lightcull_path` against Mitsuba's `path` in equal time, or on `street`, which is in fog,
`lightcull_volpath` against `volpath`. Not a test: it takes minutes.

    python tests/hosts/equal_time.py lanterns scalar_rgb --seconds 60
    python tests/hosts/equal_time.py lanterns llvm_ad_rgb --seconds 60
    python tests/hosts/equal_time.py cornell scalar_rgb --seconds 60
    python tests/hosts/equal_time.py offices scalar_rgb --integrators learned --seconds 60
    python tests/hosts/equal_time.py street llvm_ad_rgb --max-depth 4 --seconds 60

The integrators take turns; a render's set-up counts. That takes `--seconds` for each of them, and
the reference, which lightcull makes, `--reference`. The bulbs of `street` are not seen directly. In scalar_rgb every triangle of
`lanterns` is an emitter of its own; in llvm_ad_rgb they are one mesh with a texel for each, which
`path` can sample. Efficiency is 1 / (relMSE x seconds).
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import lightcull.mitsuba  # noqa: F401
import mitsuba as mi
import numpy as np
from lightcull.report.metrics import relmse, relmse_of_mean
from mitsuba_export import export
from volume_scenes import street

REFERENCE_SEED = 1 << 20


class Contender:
    """The mean of its renders so far, and the time that they took."""

    def __init__(self, scene: Any, properties: dict[str, Any], spp: int) -> None:
        self._scene, self._spp = scene, spp
        self._sum: Any = 0.0
        self.renders, self.seconds, self.processor_seconds = 0, 0.0, 0.0
        # Compiles kernels, by another integrator: what this one learns takes its time.
        mi.render(scene, integrator=mi.load_dict(properties), spp=spp)
        self._integrator = mi.load_dict(properties)

    def render(self, seed: int) -> None:
        start, processor_start = time.perf_counter(), time.process_time()
        image = mi.render(self._scene, integrator=self._integrator, spp=self._spp, seed=seed)
        self._sum = self._sum + np.array(image)[..., :3].astype(np.float64)
        self.seconds += time.perf_counter() - start
        self.processor_seconds += time.process_time() - processor_start
        self.renders += 1

    @property
    def spp(self) -> int:
        return self.renders * self._spp

    @property
    def image(self) -> np.ndarray:
        return self._sum / self.renders


def load(name: str, variant: str, size: tuple[int, int]) -> Any:
    if name == "cornell":
        scene = mi.cornell_box()
        film = scene["sensor"]["film"] | {"width": size[0], "height": size[0]}
        return mi.load_dict(scene | {"sensor": scene["sensor"] | {"film": film}})
    if name == "street":
        return mi.load_dict(street(size))
    return mi.load_dict(export(name, "triangles" if "scalar" in variant else "texture", size))


def turns(contenders: list[Contender], seconds: float) -> None:
    """Always the one that has had the least."""
    while (least := min(contenders, key=lambda c: c.seconds)).seconds < seconds:
        least.render(1 + least.renders)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", choices=["lanterns", "city", "offices", "cornell", "street"])
    parser.add_argument("variant", choices=["scalar_rgb", "llvm_ad_rgb"])
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--reference", type=float, help="seconds; default: 4 times --seconds")
    parser.add_argument("--size", type=int, nargs=2, default=(320, 240))
    parser.add_argument("--max-depth", type=int, default=2)
    parser.add_argument("--spp", type=int, default=16, help="of a turn")
    parser.add_argument(
        "--integrators", nargs="+", default=["path", "uniform", "light_bvh", "culled", "learned"]
    )
    options = parser.parse_args()
    reference_seconds = options.reference or 4 * options.seconds

    mi.set_variant(options.variant)
    scene = load(options.scene, options.variant, tuple(options.size))
    integrators = {
        "path": {"type": "path"},
        "uniform": {"type": "lightcull_path", "light_sampler": "uniform"},
        "light_bvh": {"type": "lightcull_path", "light_sampler": "light_bvh"},
        "means": {"type": "lightcull_path", "light_sampler": "light_bvh:importance=means"},
        "culled": {"type": "lightcull_path", "light_sampler": "culled"},
        "learned": {
            "type": "lightcull_path",
            "light_sampler": "learned",
            "keep_learned": True,
        },
    }
    by, best, wanted = "path", "culled", {"path", "culled", *options.integrators}
    if "learned" in options.integrators:
        best = "learned"
    more: dict[str, Any] = {"max_depth": options.max_depth}
    if options.scene == "street":
        by, best = "volpath", "lightcull_volpath"
        wanted = {by, best}
        integrators = {name: {"type": name} for name in (by, best)}
        more["hide_emitters"] = True
    contenders = {
        name: Contender(scene, d | more, options.spp)
        for name, d in integrators.items()
        if name in wanted
    }
    total = options.seconds * len(contenders) + reference_seconds
    print(f"{len(contenders)} integrators and the reference: {total:g} s", flush=True)
    turns(list(contenders.values()), options.seconds)
    # By the best one, in two halves with seeds of their own: how they differ tells what the
    # reference itself adds to an error, which is taken off.
    halves = [Contender(scene, integrators[best] | more, options.spp) for _ in range(2)]
    for i, half in enumerate(halves):
        while half.seconds < 0.5 * reference_seconds:
            half.render(REFERENCE_SEED * (i + 1) + half.renders)
    reference = 0.5 * (halves[0].image + halves[1].image)
    own = relmse_of_mean(halves[0].image, halves[1].image)
    path = contenders[by]
    path_error = relmse(path.image, reference) - own
    for name, c in contenders.items():
        error = relmse(c.image, reference) - own
        gain = path_error * path.seconds / (error * c.seconds)
        processor_gain = path_error * path.processor_seconds / (error * c.processor_seconds)
        print(
            f"{name:17} {c.spp:6} spp in {c.seconds:6.1f} s  relMSE {error:8.4g}  "
            f"mean {c.image.mean():.4f}  x {by} {gain:.3g} (by processor time {processor_gain:.3g})"
        )


if __name__ == "__main__":
    main()
