"""Samplers that are not ours: classes of Python, and shared objects that speak the C interface."""

from __future__ import annotations

import math
import os
import threading
import time
from collections.abc import Callable
from typing import Any, Protocol, TypeAlias

import numpy as np

from .. import _core, checks
from .._core import Error
from ..scene import Scene


class OwnSampler(Protocol):
    """A sampler of one's own, as a class of calls on arrays: `LightSampler` has them, too.

    It is made by calling what was given to `compare` with the `Scene`, whose `lights()` are those to
    choose among, and used by the path tracer for direct light: slowly, since each call goes through
    Python. The time that passes inside its calls is told apart (`own_seconds`).

    Points are told by positions, float32 (N, 3), metres; normals, float32 (N, 3), unit length;
    diffuse, float32 (N,), and lobe, (N,) of dtype `lightcull.LOBE`, as `LightSelector` has them.
    Calls come from any thread, one at a time. An error that one of them raises ends the render.

    Two attributes may be there: set_count, the number of sets of random numbers that the sampler
    tells apart, a power of 4 (1 unless said); and needs_receipt, False if `prob` does not look at
    the receipts (True unless said).
    """

    def begin_pass(self, number: int) -> None:
        """Begins a sample of the whole image; equal numbers are to give equal passes."""

    def select(
        self,
        positions: np.ndarray,
        normals: np.ndarray,
        u: np.ndarray,
        sets: np.ndarray,
        *,
        diffuse: np.ndarray,
        lobe: np.ndarray,
    ) -> np.ndarray | tuple[np.ndarray, np.ndarray]:
        """Chooses a light for each point by a random number of its own, u: float32 (N,), in [0, 1).

        sets: uint32 (N,), below set_count. Returns lights, whole numbers (N,), and their
        probabilities (N,), in (0, 1], or 0 where none was chosen; or, for a sampler whose `prob`
        needs receipts, both in an array of dtype `lightcull.SELECTION`.
        """

    def prob(
        self,
        positions: np.ndarray,
        normals: np.ndarray,
        selections: np.ndarray,
        lights: np.ndarray,
        *,
        diffuse: np.ndarray,
        lobe: np.ndarray,
    ) -> np.ndarray:
        """The probability with which `select` would have chosen these lights, for the MIS weights of
        rays that hit them: (N,), in [0, 1].

        lights: uint32 (N,). selections: (N,) of dtype `lightcull.SELECTION`, of which only the
        receipts (weight_sum and key) are those of `select`.
        """


class SamplerLibrary:
    """A sampler of a shared object (.so) that speaks the C interface.

    It defines functions of `lightcull/lightcull.h` in its own way: lightcull_sampler_create,
    _destroy, _begin_pass and _current_pass, lightcull_set_count, lightcull_needs_receipt,
    lightcull_select_many, lightcull_prob and lightcull_last_error; and, if it learns,
    lightcull_wants_reports and lightcull_report.

    path: of the file. description: what its lightcull_sampler_create is given.
    """

    def __init__(self, path: str | os.PathLike[str], description: str = "") -> None:
        self.path = os.path.abspath(checks.path("path", path))
        self.description = checks.text("description", description)
        if not os.path.isfile(self.path):
            raise Error(f"{self.path}: no such file")

    def __repr__(self) -> str:
        return f"lightcull.SamplerLibrary({self.path!r}, {self.description!r})"


SamplerChoice: TypeAlias = "str | SamplerLibrary | Callable[[Scene], OwnSampler]"
"""What `compare` takes for a sampler: a description, a shared object, or what makes an `OwnSampler`."""


def check_choice(name: str, choice: Any) -> None:
    """TypeError unless it can be what makes a sampler."""
    if not (isinstance(choice, str | SamplerLibrary) or callable(choice)):
        raise TypeError(
            f"sampler {name!r}: wanted a description, a class or a lightcull.SamplerLibrary, "
            f"got {choice!r}"
        )


class GuardedSampler:
    """A sampler of one's own as the compiled renderer calls it: nothing that it does wrong gets
    there. It throws nothing, but keeps the first error.
    """

    def __init__(self, name: str, make: Callable[[Scene], OwnSampler], scene: Scene) -> None:
        self._name = name
        self._light_count = len(scene.lights())
        self._lock = threading.Lock()
        self._error: Exception | None = None
        start = time.perf_counter()
        self._sampler = make(scene)
        self.setup_seconds = time.perf_counter() - start
        self.seconds = self.setup_seconds
        """Time inside its calls, its making included."""
        for method in ("begin_pass", "select", "prob"):
            if not callable(getattr(self._sampler, method, None)):
                raise TypeError(f"sampler {name!r}: {self._sampler!r} has no method {method}")
        self.set_count = checks.whole_number("set_count", getattr(self._sampler, "set_count", 1), 1)
        if 4 ** round(math.log(self.set_count, 4)) != self.set_count:
            raise Error(f"sampler {name!r}: set_count is {self.set_count}, wanted a power of 4")
        self.needs_receipt = bool(getattr(self._sampler, "needs_receipt", True))

    def begin_pass(self, number: int) -> None:
        self._call(lambda: self._sampler.begin_pass(number), lambda result: None, None)

    def select(
        self,
        positions: np.ndarray,
        normals: np.ndarray,
        u: np.ndarray,
        sets: np.ndarray,
        diffuse: np.ndarray,
        lobe: np.ndarray,
    ) -> np.ndarray:
        return self._call(
            lambda: self._sampler.select(positions, normals, u, sets, diffuse=diffuse, lobe=lobe),
            lambda chosen: self._selections(chosen, len(u)),
            np.zeros(len(u), _core.SELECTION),
        )

    def prob(
        self,
        positions: np.ndarray,
        normals: np.ndarray,
        selections: np.ndarray,
        lights: np.ndarray,
        diffuse: np.ndarray,
        lobe: np.ndarray,
    ) -> float:
        return self._call(
            lambda: self._sampler.prob(
                positions, normals, selections, lights, diffuse=diffuse, lobe=lobe
            ),
            lambda probs: float(self._probabilities("prob", probs, len(lights))[0]),
            0.0,
        )

    def raise_error(self) -> None:
        """Raises what one of its calls raised."""
        if self._error is not None:
            raise self._error

    def _call(self, call: Callable[[], Any], check: Callable[[Any], Any], otherwise: Any) -> Any:
        with self._lock:
            if self._error is not None:
                return otherwise
            start = time.perf_counter()
            try:
                result = call()
                self.seconds += time.perf_counter() - start
                return check(result)
            except Exception as error:
                self._error = error
                return otherwise

    def _selections(self, chosen: Any, count: int) -> np.ndarray:
        if isinstance(chosen, tuple):
            lights, probs = chosen
            selections = np.zeros(count, _core.SELECTION)
            probs = self._probabilities("select", probs, count)
            selections["prob"] = selections["mis_prob"] = probs
            selections["light"] = self._lights(lights, probs, count)
            return selections
        if getattr(chosen, "dtype", None) != _core.SELECTION or chosen.shape != (count,):
            raise TypeError(
                f"sampler {self._name!r}: select gave {_kind(chosen)}, wanted lights and "
                f"probabilities, or an array of lightcull.SELECTION, of {count} points"
            )
        for key in ("prob", "mis_prob"):
            self._probabilities("select", chosen[key], count)
        self._lights(chosen["light"], chosen["prob"], count)
        return np.ascontiguousarray(chosen)

    def _probabilities(self, method: str, probs: Any, count: int) -> np.ndarray:
        values = np.asarray(probs, np.float32)
        if values.shape != (count,):
            raise TypeError(
                f"sampler {self._name!r}: {method} gave probabilities of shape {values.shape}, "
                f"wanted ({count},)"
            )
        wrong = np.flatnonzero(~((values >= 0) & (values <= 1.0001)))
        if wrong.size:
            raise Error(
                f"sampler {self._name!r}: {method} gave probability {values[wrong[0]]:g} at point "
                f"{wrong[0]}, wanted 0 to 1"
            )
        return values

    def _lights(self, lights: Any, probs: np.ndarray, count: int) -> np.ndarray:
        ids = np.asarray(lights)
        if ids.shape != (count,) or ids.dtype.kind not in "iu":
            raise TypeError(
                f"sampler {self._name!r}: select gave lights {_kind(lights)}, wanted whole numbers "
                f"of shape ({count},)"
            )
        wrong = np.flatnonzero((probs > 0) & ~((ids >= 0) & (ids < self._light_count)))
        if wrong.size:
            raise Error(
                f"sampler {self._name!r}: select gave light {ids[wrong[0]]} at point {wrong[0]}: "
                f"there are {self._light_count} lights"
            )
        return np.where(probs > 0, ids, 0)


def _kind(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"{value.dtype} {value.shape}"
    return type(value).__name__
