"""How time grows with the number of lights: figures 6 and 7 of [TH16]."""

from __future__ import annotations

from .findings import Curve, Plot, Study, Table
from .measure import TIME, Bench, Measured, exponent, measure

_METHODS = ("vpl_culled", "vpl_culled:tile=4", "vpl_clamped")
_TYPICAL = 65536
"""Light paths, for which the error bound is that which accepts as many lights as by default."""
_DIVISOR = 2
"""vpl_clamped has a quarter of the pixels where there are more light paths."""


def tiled_lighting(bench: Bench) -> Study:
    """vpl_culled and vpl_clamped with one error bound for all numbers of lights."""
    plain = ":shadows=none:filter=off:interleave=4"
    typical = min(bench.most_lights, _TYPICAL)
    bound = measure(bench, f"vpl_culled:lights={typical}{plain}").counts.error_bound
    rows: dict[str, list[tuple[Measured, float]]] = {name: [] for name in _METHODS}
    numbers = bench.light_numbers()
    for i, number in enumerate(numbers):
        for name in _METHODS:
            bench.report("lights and time", i / len(numbers))
            is_dear = name == "vpl_clamped" and number > _TYPICAL
            own = bench.sized(_DIVISOR) if is_dear else bench
            found = measure(own, f"{name}:lights={number}{plain}:error_bound={bound:.6e}")
            rows[name].append((found, found.seconds * bench.pixels / own.pixels))
    culled, small_tiles, clamped = rows.values()
    lights = [m.counts.lights for m, _ in culled]
    accepted = {n: exponent(lights, [m.counts.accepted for m, _ in rows[n]]) for n in _METHODS}
    seconds = {n: exponent(lights, [t for _, t in rows[n]]) for n in _METHODS}
    return Study(
        key="scaling",
        title="Time against the number of lights",
        finding=f"From {lights[0]:,.0f} to {lights[-1]:,.0f} virtual lights time grows with their "
        f"number to the power of {seconds[_METHODS[0]]:.2f} for vpl_culled "
        f"({seconds[_METHODS[1]]:.2f} with tiles of 4 x 4 pixels) and "
        f"{seconds['vpl_clamped']:.2f} for vpl_clamped; the lights that a pixel accepts, to the "
        f"power of {accepted['vpl_culled']:.2f} and {accepted['vpl_clamped']:.2f}.",
        note=f"As figure 6 of [TH16]: an error bound of {bound:.3g} for all, no shadows, no filter, "
        "4 x 4 interleaved sampling; the ranges of vpl_clamped are those of appendix A for the same "
        f"bound. {TIME} ranges, culling and shading, one pass. vpl_clamped has a quarter of the "
        f"pixels above {_TYPICAL:,} light paths, and its time is multiplied. Exponents are "
        "fitted to all numbers of lights.",
        table=Table(
            ("lights", "vpl_culled: accepted / pixel", "listed", "ms", "tile=4: listed", "ms",
             "vpl_clamped: accepted / pixel", "ms", "clamped / culled, time"),
            tuple(
                (round(a.counts.lights), a.counts.accepted, a.counts.listed, 1e3 * a_time,
                 b.counts.listed, 1e3 * b_time, c.counts.accepted, 1e3 * c_time, c_time / a_time)
                for (a, a_time), (b, b_time), (c, c_time) in zip(
                    culled, small_tiles, clamped, strict=True
                )
            ),
        ),
        plot=Plot(
            "virtual lights", "processor seconds",
            tuple(Curve(n, lights, [t for _, t in rows[n]]) for n in _METHODS),
        ),
        figures={
            **{f"{n}_accepted_exponent": e for n, e in accepted.items()},
            **{f"{n}_time_exponent": e for n, e in seconds.items()},
        },
    )  # fmt: skip


def shadow_maps(bench: Bench) -> Study:
    """Imperfect shadow maps with and without culling of points by range."""
    numbers = [n for n in bench.light_numbers() if n <= _TYPICAL]
    bound = measure(
        bench, f"vpl_culled:lights={numbers[-1]}:shadows=none:filter=off"
    ).counts.error_bound
    options = f":shadows=maps:filter=off:error_bound={bound:.6e}"
    rows = []
    for i, number in enumerate(numbers):
        bench.report("shadow maps", i / len(numbers))
        pair = [
            measure(bench, f"vpl_culled:lights={number}{options}:map_culling={culling}").counts
            for culling in ("on", "off")
        ]
        rows.append(pair)
    lights = [on.lights for on, _ in rows]
    columns = list(zip(*rows, strict=True))
    points = [exponent(lights, [c.map_points * c.lights for c in column]) for column in columns]
    seconds = [exponent(lights, [c.build_seconds for c in column]) for column in columns]
    return Study(
        key="shadow_maps",
        title="Imperfect shadow maps",
        finding=f"Points splatted grow with the number of lights to the power of {points[0]:.2f} "
        f"with culling by range and {points[1]:.2f} without, time to {seconds[0]:.2f} and "
        f"{seconds[1]:.2f}.",
        note="As figure 7 of [TH16], with 8,192 points and 32 x 32 texels a map. Points that face "
        "the light or lie below its surface are culled in both: they must be. Every map is "
        f"cleared, which is linear. {TIME} maps.",
        table=Table(
            ("lights", "culled: points / light", "ms", "not culled: points / light", "ms",
             "not culled / culled, time"),
            tuple(
                (round(a.lights), a.map_points, 1e3 * a.build_seconds, b.map_points,
                 1e3 * b.build_seconds, b.build_seconds / a.build_seconds)
                for a, b in rows
            ),
        ),
        plot=Plot(
            "virtual lights", "processor seconds",
            (Curve("culled", lights, [a.build_seconds for a, _ in rows]),
             Curve("not culled", lights, [b.build_seconds for _, b in rows])),
        ),
        figures={
            "culled_exponent": points[0], "not_culled_exponent": points[1],
            "culled_time_exponent": seconds[0], "not_culled_time_exponent": seconds[1],
        },
    )  # fmt: skip
