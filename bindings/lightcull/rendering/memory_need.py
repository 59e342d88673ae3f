"""What a render takes of memory."""

from __future__ import annotations

from dataclasses import dataclass

from ..memory import BYTES_TAKEN, of_process
from .path_job import PathJob
from .virtual_light_job import VirtualLightJob


@dataclass(frozen=True)
class MemoryNeed:
    """What a render takes of memory, bytes."""

    program: int
    """Python, libraries, and what is left over from making the scene."""
    scene: int
    """Geometry, materials, textures and lights."""
    bvh: int
    """Embree's."""
    sampler: int
    """Its trees, with all sets of ranges."""
    learned: int
    """What the sampler may come to besides by learning, at most."""
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
            self.program, self.scene, self.bvh, self.sampler, self.learned, self.image, self.paths,
            self.virtual_lights,
        )  # fmt: skip
        return max(self.setup, sum(parts))


def memory_need(job: PathJob | VirtualLightJob, size: tuple[int, int]) -> MemoryNeed:
    """What a render that is set up in this process will have needed once it is done."""
    scene, renderer, virtual_lights, kept = job.memory_size()
    there = scene.data + scene.bvh + renderer.sampler + renderer.film + kept
    return MemoryNeed(
        program=max(of_process("VmRSS") - there, 0),
        scene=scene.data,
        bvh=scene.bvh,
        sampler=renderer.sampler,
        learned=renderer.learned,
        image=renderer.film + size[0] * size[1] * BYTES_TAKEN,
        paths=renderer.paths,
        virtual_lights=virtual_lights,
        setup=of_process("VmHWM"),
    )
