"""Set-up of workers on this machine, whom Ctrl-C at a terminal reaches as well."""

from __future__ import annotations

import signal


def dask_setup(worker: object) -> None:
    """Leaves Ctrl-C to whoever started them: Dask calls this in each of them."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
