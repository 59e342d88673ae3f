"""How time grows with the number of lights: figures 6 and 7 of [TH16]."""

from __future__ import annotations

from .measure import Bench, Measured, exponent, measure
from .model import Curve, Plot, Study, Table

_METHODS = ("vpl_culled", "vpl_clamped")


def tiled_lighting(bench: Bench) -> Study:
    """vpl_culled and vpl_clamped with one error bound for all numbers of lights."""
    numbers = bench.light_numbers()
    middle = numbers[len(numbers) // 2]
    plain = ":shadows=none:filter=off:interleave=4"
    bound = measure(bench, f"vpl_culled:lights={middle}{plain}").counts.error_bound
    options = f"{plain}:error_bound={bound:.6e}"
    rows: dict[str, list[Measured]] = {name: [] for name in _METHODS}
    for i, number in enumerate(numbers):
        for name in _METHODS:
            bench.report("lights and time", i / len(numbers))
            rows[name].append(measure(bench, f"{name}:lights={number}{options}"))
    culled, clamped = rows["vpl_culled"], rows["vpl_clamped"]
    lights = [m.counts.lights for m in culled]
    accepted = {n: exponent(lights, [m.counts.accepted for m in rows[n]]) for n in _METHODS}
    seconds = {n: exponent(lights, [m.seconds for m in rows[n]]) for n in _METHODS}
    return Study(
        key="scaling",
        title="Time against the number of lights",
        finding=f"The lights that a pixel accepts grow with the number of lights to the power of "
        f"{accepted['vpl_culled']:.2f} for vpl_culled and {accepted['vpl_clamped']:.2f} for "
        f"vpl_clamped; time, with the linear cost of culling in it, to "
        f"{seconds['vpl_culled']:.2f} and {seconds['vpl_clamped']:.2f}.",
        note=f"As figure 6 of [TH16]: an error bound of {bound:.3g} for all, no shadows, no filter, "
        "4 x 4 interleaved sampling; the ranges of vpl_clamped are those of appendix A for the same "
        "bound. Time is that of ranges, culling and shading, one pass.",
        table=Table(
            ("lights", "vpl_culled: lights / pixel", "ms", "vpl_clamped: lights / pixel", "ms",
             "clamped / culled, time"),
            tuple(
                (round(a.counts.lights), a.counts.accepted, 1e3 * a.seconds, b.counts.accepted,
                 1e3 * b.seconds, b.seconds / a.seconds)
                for a, b in zip(culled, clamped, strict=True)
            ),
        ),
        plot=Plot(
            "virtual lights", "seconds",
            tuple(Curve(n, lights, [m.seconds for m in rows[n]]) for n in _METHODS),
        ),
        figures={
            **{f"{n}_accepted_exponent": e for n, e in accepted.items()},
            **{f"{n}_time_exponent": e for n, e in seconds.items()},
        },
    )  # fmt: skip


def shadow_maps(bench: Bench) -> Study:
    """Imperfect shadow maps with and without culling of points by range."""
    numbers = [n for n in bench.light_numbers() if n <= 16384]
    bound = measure(
        bench, f"vpl_culled:lights={numbers[-1]}:shadows=none:filter=off"
    ).counts.error_bound
    options = f":shadows=maps:points=2048:filter=off:error_bound={bound:.6e}"
    rows = []
    for i, number in enumerate(numbers):
        bench.report("shadow maps", i / len(numbers))
        pair = [
            measure(bench, f"vpl_culled:lights={number}{options}:map_culling={culling}").counts
            for culling in ("on", "off")
        ]
        rows.append(pair)
    lights = [on.lights for on, _ in rows]
    points = [
        exponent(lights, [c.map_points * c.lights for c in column])
        for column in zip(*rows, strict=True)
    ]
    return Study(
        key="shadow_maps",
        title="Imperfect shadow maps",
        finding=f"Points splatted grow with the number of lights to the power of {points[0]:.2f} "
        f"with culling by range and {points[1]:.2f} without.",
        note="As figure 7 of [TH16], with 2,048 points and 32 x 32 texels a map. Points that face "
        "the light or lie below its surface are culled in both: they must be. Every point of a map "
        "is tested, which is linear.",
        table=Table(
            ("lights", "culled: points / light", "ms", "not culled: points / light", "ms",
             "not culled / culled, time"),
            tuple(
                (round(a.lights), a.map_points, 1e3 * a.build_seconds, b.map_points,
                 1e3 * b.build_seconds, b.build_seconds / a.build_seconds)
                for a, b in rows
            ),
        ),
        figures={"culled_exponent": points[0], "not_culled_exponent": points[1]},
    )  # fmt: skip
