"""A hash to know a scene by."""

from __future__ import annotations

import hashlib
from typing import Any

import numpy as np


def _as_kept(array: np.ndarray) -> np.ndarray:
    """What a scene keeps of an array: numbers and indices of 32 bits."""
    return array.astype(np.float32 if array.dtype.kind == "f" else np.uint32, copy=False)


class SceneDigest:
    """Hashes all that is added to a scene, in its order."""

    def __init__(self) -> None:
        self._hash = hashlib.blake2b(digest_size=16)

    def add(self, kind: str, *parameters: Any) -> None:
        """Works in something of a kind, and what was said of it."""
        self._hash.update(kind.encode())
        for parameter in parameters:
            if isinstance(parameter, np.ndarray):
                self._hash.update(repr(parameter.shape).encode())
                self._hash.update(np.ascontiguousarray(_as_kept(parameter)).data)
            elif isinstance(parameter, memoryview):
                self._hash.update(parameter)
            else:
                self._hash.update(repr(parameter).encode())
            self._hash.update(b";")

    def hexdigest(self) -> str:
        """The hash so far."""
        return self._hash.hexdigest()
