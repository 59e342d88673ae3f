"""What memory there is, and what this process has of it."""

from __future__ import annotations

from pathlib import Path

from ._core import Error

BYTES_TAKEN = 2 * 12
"""Per pixel, of the image as it is taken."""
_BYTES_PER_PIXEL = 24 + 12 + BYTES_TAKEN
"""Sums of the passes, the pass under way, and the image as it is taken."""


def of_process(field: str) -> int:
    """Bytes of this process, by a name of /proc/self/status: "VmRSS" now, "VmHWM" at most so far."""
    return _bytes_by_name("/proc/self/status")[field]


def of_image(size: tuple[int, int]) -> int:
    """Bytes for an image that is being rendered."""
    return size[0] * size[1] * _BYTES_PER_PIXEL


def check_image(size: tuple[int, int]) -> None:
    """Throws Error for an image for which there is not enough memory."""
    check(f"size: an image of {size[0]}x{size[1]} needs", of_image(size))


def check(what_needs: str, needed: int) -> None:
    """Throws Error that begins like this unless so many bytes are free."""
    there = available()
    if there is not None and needed > there:
        raise Error(f"{what_needs} {text(needed)} of memory, and {text(there)} are free")


def available() -> int | None:
    """Bytes that this machine has free, swap included; None where it does not say."""
    try:
        free = _bytes_by_name("/proc/meminfo")
    except OSError:
        return None
    return free["MemAvailable"] + free["SwapFree"]


def _bytes_by_name(path: str) -> dict[str, int]:
    """What a file of the system gives in kB."""
    lines = (line.split() for line in Path(path).read_text().splitlines())
    return {words[0].rstrip(":"): 1024 * int(words[1]) for words in lines if words[2:] == ["kB"]}


def text(size: float) -> str:
    """Bytes, for people to read."""
    if size >= 2**30:
        return f"{size / 2**30:.1f} GiB"
    return f"{size / 2**20:.0f} MiB" if size >= 10 * 2**20 else f"{size / 2**20:.1f} MiB"
