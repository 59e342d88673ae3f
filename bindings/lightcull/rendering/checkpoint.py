"""Renders that are saved on the way, to go on later as if they had never stopped.

A checkpoint is a line that says what it is, a checksum of the rest, a line of JSON that says of
which render, the sums of its passes (float64 (H, W, 3), little-endian), and what its sampler has
learned.
"""

from __future__ import annotations

import hashlib
import json
import os
import time
import warnings
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from .. import _core, checks
from .._core import Error
from ..output_files import check_output, write_whole_file

_MAGIC = b"lightcull checkpoint 4\n"
_DIGEST_SIZE = 32
_SECONDS_BETWEEN = 60.0


@dataclass(frozen=True)
class RenderKey:
    """What the bits of a render depend on."""

    scene: str
    digest: str
    """Of all that the scene is made of."""
    sampler: str
    size: tuple[int, int]
    max_depth: int
    rr_depth: int
    direct_light: str
    hide_emitters: bool
    seed: int
    chunk: int
    """Passes that are added up before they are added to the others."""
    version: str
    """Of lightcull, down to the build."""

    def check(self, path: str, other: RenderKey) -> None:
        """Throws Error that names the first thing in which the key of a checkpoint is another."""
        for name, ours in asdict(self).items():
            theirs = getattr(other, name)
            if theirs == ours:
                continue
            if name == "digest":
                raise Error(f"{path}: is of another scene {other.scene!r}, or it has changed")
            raise Error(f"{path}: is of {name} {_text(theirs)}, not {_text(ours)}")


@dataclass(frozen=True)
class Checkpoint:
    """What a render has come to after some whole passes."""

    stats: _core.RenderStats
    setup_seconds: float
    sums: np.ndarray
    """float64 (H, W, 3), over the passes."""
    learned: bytes
    """By the sampler; empty if it does not learn."""


_STATS = ("passes", "seconds", "sampler_seconds", "selection_seconds", "selections", "rays")


def write(path: str, key: RenderKey, checkpoint: Checkpoint) -> None:
    """Replaces the file whole or not at all."""
    about = {
        "key": asdict(key),
        "stats": {name: getattr(checkpoint.stats, name) for name in _STATS},
        "setup_seconds": checkpoint.setup_seconds,
    }
    sums = checkpoint.sums.astype("<f8", copy=False)
    rest = json.dumps(about).encode() + b"\n" + sums.tobytes() + checkpoint.learned
    write_whole_file(path, _MAGIC + _checksum(rest) + b"\n" + rest)


def read(path: str) -> tuple[RenderKey, Checkpoint]:
    """Throws Error unless the file is a whole checkpoint."""
    if os.path.exists(path) and not os.path.isfile(path):
        raise Error(f"{path}: cannot read: it is not a file")
    try:
        data = Path(path).read_bytes()
    except (OSError, ValueError) as error:
        raise Error(f"{path}: cannot read: {getattr(error, 'strerror', None) or error}") from error
    if not data.startswith(_MAGIC):
        raise Error(f"{path}: is not a checkpoint, or is one of another version of lightcull")
    checksum, _, rest = data[len(_MAGIC) :].partition(b"\n")
    if checksum != _checksum(rest):
        raise Error(f"{path}: is a checkpoint that has been damaged")
    try:
        return _parse(rest)
    except (KeyError, TypeError, ValueError) as error:
        reason = str(error).partition("\n")[0]
        raise Error(f"{path}: is a checkpoint that makes no sense: {reason}") from error


def _parse(data: bytes) -> tuple[RenderKey, Checkpoint]:
    header, _, sums = data.partition(b"\n")
    about = json.loads(header)
    key = RenderKey(**{**about["key"], "size": checks.size(about["key"]["size"])})
    stats = _core.RenderStats(**{name: about["stats"][name] for name in _STATS})
    width, height = key.size
    size = 8 * 3 * height * width
    image = np.frombuffer(sums[:size], "<f8").astype(np.float64).reshape(height, width, 3)
    return key, Checkpoint(stats, float(about["setup_seconds"]), image, sums[size:])


class Keeper:
    """Saves a render from time to time, if that is wanted, and knows what it goes on from."""

    def __init__(
        self,
        key: RenderKey,
        *,
        checkpoint: str | os.PathLike[str] | None,
        every: float | None,
        resume: str | os.PathLike[str] | None,
    ) -> None:
        """checkpoint, every, resume: as `lightcull.render` has them. Throws Error if it cannot be
        written, would replace a file that is not gone on from, or is another render's.
        """
        source = None if resume is None else checks.path("resume", resume)
        self._target = source if checkpoint is None else checks.path("checkpoint", checkpoint)
        self._key = key
        self._every = _SECONDS_BETWEEN if every is None else _positive("every", every)
        self._last = time.monotonic()
        self.before: Checkpoint | None = None
        """What to go on from."""
        if self._target is not None:
            check_output(self._target)
            if Path(self._target).exists() and not _same(source, self._target):
                raise Error(f"{self._target}: is there already: resume it, or remove it")
        if source is not None:
            found, self.before = read(source)
            key.check(source, found)

    def after_pass(self, checkpoint: Callable[[], Checkpoint]) -> None:
        """Saves what there is if it is time to."""
        if time.monotonic() - self._last >= self._every:
            self.save(checkpoint)

    def save_after(self, checkpoint: Callable[[], Checkpoint]) -> str:
        """Saves what there is of a render that cannot go on, and gives words for that, or none."""
        if self._target is None:
            return ""
        self.save(checkpoint)
        return f"; what there is can be gone on from: --resume {self._target}"

    def save(self, checkpoint: Callable[[], Checkpoint]) -> None:
        """Saves what there is. That this may fail is no reason to give a render up."""
        if self._target is None:
            return
        try:
            write(self._target, self._key, checkpoint())
        except Error as error:
            warnings.warn(f"no checkpoint was written: {error}", stacklevel=4)
        self._last = time.monotonic()


def _same(source: str | None, target: str) -> bool:
    return source is not None and Path(source).resolve() == Path(target).resolve()


def _positive(name: str, value: float) -> float:
    if not 0 < checks.number(name, value) < float("inf"):
        raise Error(f"{name}: wanted a number above 0, got {value}")
    return value


def _checksum(data: bytes) -> bytes:
    return hashlib.blake2b(data, digest_size=_DIGEST_SIZE).hexdigest().encode()


def _text(value: object) -> str:
    return "x".join(map(str, value)) if isinstance(value, tuple) else repr(value)
