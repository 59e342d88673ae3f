"""A scheduler and workers of Dask, each a process of its own that can be killed, on loopback."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys

# One process imports everything, and forks the others, which are there at once.
_FORKS = """
import asyncio, json, os, signal, sys
import distributed, lightcull
import lightcull.rendering.cluster.worker

async def scheduler():
    async with distributed.Scheduler(host="127.0.0.1", port=0, dashboard=False) as scheduler:
        print(scheduler.address, flush=True)
        await scheduler.finished()

async def worker(address):
    async with distributed.Worker(
        address, nthreads=1, host="127.0.0.1", dashboard=False, memory_limit=0, death_timeout=20
    ) as worker:
        print(worker.address, flush=True)
        await worker.finished()

signal.signal(signal.SIGCHLD, signal.SIG_IGN)
for line in sys.stdin:
    order = json.loads(line)
    child = os.fork()
    if child == 0:
        sys.stdin.close()
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        exec(order["before"])
        asyncio.run(worker(order["address"]) if order["address"] else scheduler())
        os._exit(0)
    print(child, flush=True)
"""


class Processes:
    """A cluster that is made one process at a time."""

    def __init__(self, **config: str) -> None:
        """config: of Dask, as environment variables."""
        self._forks = subprocess.Popen(
            [sys.executable, "-c", _FORKS],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
            env={**os.environ, **config, "PYTHONPATH": os.pathsep.join(sys.path)},
        )  # fmt: skip
        self._pids: dict[str, int] = {}
        self.workers: list[str] = []
        """Addresses of those that live."""
        self.scheduler = self._fork("", "")

    def start_worker(self, before: str = "") -> str:
        """Gives its address. before: a program that it runs first."""
        address = self._fork(self.scheduler, before)
        self.workers.append(address)
        return address

    def pid(self, address: str) -> int:
        return self._pids[address]

    def kill(self, address: str) -> None:
        """As `kill -9` does."""
        if address in self.workers:
            self.workers.remove(address)
        try:
            os.kill(self._pids.pop(address), signal.SIGKILL)
        except ProcessLookupError:  # it has died by itself
            pass

    def close(self) -> None:
        for address in list(self._pids):
            self.kill(address)
        self._forks.kill()
        self._forks.wait()

    def _fork(self, address: str, before: str) -> str:
        assert self._forks.stdin is not None and self._forks.stdout is not None
        self._forks.stdin.write(json.dumps({"address": address, "before": before}) + "\n")
        self._forks.stdin.flush()
        lines = [self._forks.stdout.readline().strip() for _ in range(2)]  # in either order
        (pid,) = (line for line in lines if line.isdecimal())
        (found,) = (line for line in lines if not line.isdecimal())
        self._pids[found] = int(pid)
        return found
