"""What ran it, for people to read."""

from __future__ import annotations

import hashlib
import os
import platform
from functools import cache
from pathlib import Path

import numpy as np

from . import _core


def describe() -> dict[str, str]:
    """The machine and the build."""
    return {
        "processor": _processor(),
        "cores": str(core_count()),
        "system": f"{platform.system()} {platform.release()}",
        "lightcull": _core.VERSION,
        "build": _core.BUILD,
        "python": platform.python_version(),
        "numpy": np.__version__,
    }


@cache
def build_id() -> str:
    """The version, down to the build of the compiled part."""
    code = Path(_core.__file__).read_bytes()
    return f"{_core.VERSION}-{hashlib.blake2b(code, digest_size=16).hexdigest()}"


def core_count() -> int:
    """Those that this process may use."""
    return len(os.sched_getaffinity(0))


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.machine()
