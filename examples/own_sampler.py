"""A light sampler of one's own, compared with ours: python examples/own_sampler.py [FOLDER]"""

import sys

import lightcull
import numpy as np


class RootOfPower:
    """Chooses lights by the square root of their power, wherever the point is."""

    def __init__(self, scene):
        weight = np.sqrt(scene.lights()["intensity"], dtype=np.float64)
        self.share = weight / weight.sum()
        self.below = np.cumsum(self.share)[:-1]

    def begin_pass(self, number):
        pass

    def select(self, positions, normals, u, sets, **surface):
        lights = np.searchsorted(self.below, u, side="right")
        return lights, self.share[lights]

    def prob(self, positions, normals, selections, lights, **surface):
        return self.share[lights]


samplers = {"mine": RootOfPower, "power": "power", "culled": "culled"}
result = lightcull.compare(lightcull.example_scene("lanterns"), samplers, spp=4, repeats=3,
                           size=(80, 60), folder=sys.argv[1] if sys.argv[1:] else None)  # fmt: skip
for name, run in result.figures.samplers.items():
    print(f"{name}: relMSE {run.relmse:.3g}, 95 % of {run.intervals['relmse']}")
