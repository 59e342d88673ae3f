"""A hash to know a scene by."""

from __future__ import annotations

import hashlib
from typing import Any

import numpy as np


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
                self._hash.update(np.ascontiguousarray(parameter).tobytes())
            else:
                self._hash.update(repr(parameter).encode())
            self._hash.update(b";")

    def hexdigest(self) -> str:
        """The hash so far."""
        return self._hash.hexdigest()
