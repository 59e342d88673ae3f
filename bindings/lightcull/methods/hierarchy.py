"""The lighting grid hierarchy: table 1 and figure 5 of [LY19], and its error."""

from __future__ import annotations

import numpy as np

from .findings import Curve, Plot, Study, Table
from .measure import TIME, Bench, measure, relative_rmse

_DIVISOR = 10
"""vpl_all has a hundredth of the pixels."""


def grid(bench: Bench) -> Study:
    """Build, lights per pixel, error and time of vpl_grid for each number of lights."""
    small = bench.sized(_DIVISOR)
    scale = bench.pixels / small.pixels
    numbers = bench.light_numbers()
    rows, lights, summed, times = [], [], [], []
    for i, number in enumerate(numbers):
        bench.report("lighting grid", i / len(numbers))
        options = f":lights={number}:shadows=none:filter=off"
        gathered = measure(bench, f"vpl_grid{options}")
        scattered = measure(bench, f"vpl_grid{options}:build=scatter")
        every = measure(small, f"vpl_all{options}")
        near = measure(small, f"vpl_grid{options}")
        counts = gathered.counts
        all_seconds = every.seconds * scale
        lights.append(counts.lights)
        summed.append(counts.accepted)
        times.append((gathered.seconds, all_seconds))
        rows.append(
            (round(counts.lights), 1e3 * counts.build_seconds,
             1e3 * scattered.counts.build_seconds, counts.accepted,
             relative_rmse(near.bounced, every.bounced), 1e3 * gathered.seconds,
             all_seconds / gathered.seconds)
        )  # fmt: skip
    per_decade = float(np.polyfit(np.log10(lights), summed, 1)[0])
    return Study(
        key="hierarchy",
        title="Lighting grid hierarchy",
        finding=f"A pixel sums {summed[0]:.0f} lights of {lights[0]:,.0f} and {summed[-1]:.0f} of "
        f"{lights[-1]:,.0f}: {per_decade:.0f} more for each factor of 10. It takes "
        f"1/{rows[-1][6]:.0f} of the time of vpl_all there, at an RMSE of {rows[-1][4]:.1%} of the "
        "mean.",
        note="As table 1 and figure 5 of [LY19]; alpha 2, no shadows. vpl_all has a hundredth of the "
        f"pixels, and its time is multiplied by {scale:.0f}; the error is of those pixels. Build: "
        "of the grids; by scatter alone the virtual lights go into every level, by gather into the "
        f"first one only. {TIME} the build, the tree to find lights by, and shading.",
        table=Table(
            ("lights", "build by gather, ms", "by scatter alone, ms", "lights summed / pixel",
             "RMSE / mean, against vpl_all", "vpl_grid, ms", "vpl_all / vpl_grid, time"),
            tuple(rows),
        ),
        plot=Plot(
            "virtual lights", "processor seconds",
            (Curve("vpl_grid", lights, [t[0] for t in times]),
             Curve("vpl_all", lights, [t[1] for t in times])),
        ),
        figures={"summed_per_decade": per_decade, "last_error": float(rows[-1][4])},
    )  # fmt: skip
