"""What renders need of memory, and what there is."""

from __future__ import annotations

from pathlib import Path

from ._core import Error

_BYTES_PER_PIXEL = 24 + 12 + 2 * 12
"""Sums of the passes, the pass under way, and the image as it is taken."""


def of_image(size: tuple[int, int]) -> int:
    """Bytes for an image that is being rendered."""
    return size[0] * size[1] * _BYTES_PER_PIXEL


def check_image(size: tuple[int, int]) -> None:
    """Throws Error for an image for which there is not enough memory."""
    needed, there = of_image(size), available()
    if there is not None and needed > there:
        raise Error(
            f"size: an image of {size[0]}x{size[1]} needs {text(needed)} of memory, and "
            f"{text(there)} are free"
        )


def available() -> int | None:
    """Bytes that this machine has free, swap included; None where it does not say."""
    try:
        lines = Path("/proc/meminfo").read_text().splitlines()
    except OSError:
        return None
    kilobytes = {line.split(":")[0]: int(line.split()[1]) for line in lines}
    return 1024 * (kilobytes["MemAvailable"] + kilobytes["SwapFree"])


def text(size: float) -> str:
    """Bytes, for people to read."""
    return f"{size / 2**30:.1f} GiB" if size >= 2**30 else f"{size / 2**20:.0f} MiB"
