"""What renders need of memory, and what there is."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ._core import Error

if TYPE_CHECKING:
    from .render import RenderJob
    from .virtual_lights import VirtualLightJob

_BYTES_TAKEN = 2 * 12
"""Per pixel, of the image as it is taken."""
_BYTES_PER_PIXEL = 24 + 12 + _BYTES_TAKEN
"""Sums of the passes, the pass under way, and the image as it is taken."""


@dataclass(frozen=True)
class Need:
    """What a render takes of memory, bytes."""

    program: int
    """Python, libraries, and what is left over from making the scene."""
    scene: int
    """Geometry, materials, textures and lights."""
    bvh: int
    """Embree's."""
    sampler: int
    """Its trees, with all sets of ranges."""
    image: int
    """Sums of the passes, the pass under way, and the image as it is taken."""
    paths: int
    """Those that are traced at a time."""
    virtual_lights: int
    """Those of a pass, and what pixels show; 0 where paths find what bounces."""
    setup: int
    """What all of the process came to at most until the first pass."""

    @property
    def peak(self) -> int:
        """The most at any time, set-up included."""
        parts = (
            self.program, self.scene, self.bvh, self.sampler, self.image, self.paths,
            self.virtual_lights,
        )  # fmt: skip
        return max(self.setup, sum(parts))


def of_render(job: RenderJob | VirtualLightJob, size: tuple[int, int]) -> Need:
    """What a render that is set up in this process will have needed once it is done."""
    scene, renderer, virtual_lights = job.memory_size()
    there = scene.data + scene.bvh + renderer.sampler + renderer.film
    return Need(
        program=max(_of_process("VmRSS") - there, 0),
        scene=scene.data,
        bvh=scene.bvh,
        sampler=renderer.sampler,
        image=renderer.film + size[0] * size[1] * _BYTES_TAKEN,
        paths=renderer.paths,
        virtual_lights=virtual_lights,
        setup=_of_process("VmHWM"),
    )


def _of_process(field: str) -> int:
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
