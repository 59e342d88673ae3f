"""How near two workers come to twice the speed of one, and what adding up takes.

    python tests/bench/cluster_efficiency.py [--scene lanterns] [--size 320x240 1920x1080] [--chunks 24 4]

Workers of one thread on this machine, in pairs of renders by one and by two, in turns; the first pair
warms up. Of `ideal`, 1 is twice as fast. `adding` is the share of the time of two workers in which the
client adds sums, `bytes` what comes back for a chunk.
"""

from __future__ import annotations

import argparse
import statistics
import time

import distributed

import lightcull
from lightcull.rendering import chunk_film

CHUNK = 16


class Clock:
    """Time in the adding of chunks."""

    def __init__(self) -> None:
        self.seconds = 0.0
        add = chunk_film.ChunkFilm.add

        def timed(*arguments: object) -> None:
            start = time.perf_counter()
            add(*arguments)  # type: ignore[arg-type]
            self.seconds += time.perf_counter() - start

        chunk_film.ChunkFilm.add = timed  # type: ignore[method-assign]


def seconds_of(client: distributed.Client, scene: str, size: str, chunks: int) -> float:
    width, height = map(int, size.split("x"))
    result = lightcull.render(
        lightcull.open_scene(scene), "culled", spp=CHUNK * chunks,
        size=(width, height), threads=1, chunk=CHUNK, cluster=client,
    )  # fmt: skip
    return result.stats.seconds - result.stats.setup_seconds


def cluster_of(workers: int) -> distributed.LocalCluster:
    return distributed.LocalCluster(
        n_workers=workers, threads_per_worker=1, host="127.0.0.1", dashboard_address="127.0.0.1:0"
    )


def measure(size: str, chunks: int, options: argparse.Namespace, clock: Clock) -> None:
    ratios, shares = [], []
    with (
        cluster_of(1) as small, cluster_of(2) as large,
        distributed.Client(small, set_as_default=False) as one,
        distributed.Client(large, set_as_default=False) as two,
    ):  # fmt: skip
        for _ in range(options.pairs + 1):
            alone = seconds_of(one, options.scene, size, chunks)
            clock.seconds = 0.0
            together = seconds_of(two, options.scene, size, chunks)
            ratios.append(alone / together / 2)
            shares.append(clock.seconds / together)
    width, height = map(int, size.split("x"))
    print(
        f"{size}: {statistics.median(ratios[1:]):.3f} of ideal ({min(ratios[1:]):.3f} to "
        f"{max(ratios[1:]):.3f}), adding {statistics.median(shares[1:]):.2%}, "
        f"{24 * width * height:,} bytes a chunk of {CHUNK} passes"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scene", default="lanterns")
    parser.add_argument("--size", nargs="+", default=["320x240", "1920x1080"])
    parser.add_argument("--chunks", nargs="+", type=int, default=[24, 4], help="of each size")
    parser.add_argument("--pairs", type=int, default=3, help="default: 3")
    options = parser.parse_args()
    clock = Clock()
    for size, chunks in zip(options.size, options.chunks, strict=True):
        measure(size, chunks, options, clock)


if __name__ == "__main__":
    main()
