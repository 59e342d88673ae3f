"""The command `lightcull`, from before lightcull is imported: that takes a second, in which Ctrl-C is
to be as quiet as it is later. An exception would not be, for compiled modules make an ImportError
of it.
"""

import os
import signal
import sys
from types import FrameType
from typing import NoReturn


def main() -> int:
    """Runs the command line and returns its exit code."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _stop)
    from lightcull.cli import main as run

    if signal.getsignal(signal.SIGINT) is _stop:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    return run()


def _stop(number: int, frame: FrameType | None) -> NoReturn:
    print("lightcull: interrupted before anything was done", file=sys.stderr, flush=True)
    os._exit(130)
