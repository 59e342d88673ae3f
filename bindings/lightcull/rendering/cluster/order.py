"""What workers are told of a render, in plain values."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from typing import Any

from ... import machine
from ..settings import RenderSettings


@dataclass(frozen=True)
class Order:
    """A render of which workers do chunks."""

    scene: str
    """Its name."""
    digest: str
    """Of all that the scene is made of."""
    sampler: str
    settings: RenderSettings
    learned: str
    """Hash of what the sampler knows."""

    def to_dict(self) -> dict[str, Any]:
        """Strings and numbers alone."""
        return asdict(self)

    @classmethod
    def from_dict(cls, plain: dict[str, Any]) -> Order:
        """What `to_dict` gave."""
        return cls(**{**plain, "settings": RenderSettings(**plain["settings"])})

    def key(self) -> str:
        """By which it is known, down to the bits that come of it: by another build it is another."""
        text = json.dumps([self.to_dict(), machine.build_id()], sort_keys=True)
        return hash_of(text.encode())


def hash_of(data: bytes) -> str:
    """A hash to know bytes by."""
    return hashlib.blake2b(data, digest_size=16).hexdigest()
