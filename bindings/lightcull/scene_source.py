"""Where a scene can be had from again: a file or an example, by its name."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from .camera import Camera, View


@dataclass(frozen=True)
class SceneSource:
    """What `open_scene` was told, in plain values, and what came of it."""

    digest: str
    """`Scene.digest()` then: if that is another now, something was added since."""
    name: str
    """An example, or the absolute path of a file."""
    gltf_lights: str | None
    environment: str
    environment_scale: float
    camera: str | int | Camera | View | None
    virtual_lights: int | None = None
    """That were added to it."""

    def to_dict(self) -> dict[str, Any]:
        """Strings, numbers, lists and dictionaries alone."""
        camera = self.camera
        plain = asdict(self)
        if isinstance(camera, Camera | View):
            plain["camera"] = {"kind": type(camera).__name__, **asdict(camera)}
        return plain

    @classmethod
    def from_dict(cls, plain: dict[str, Any]) -> SceneSource:
        """What `to_dict` gave."""
        camera = plain["camera"]
        if isinstance(camera, dict):
            kind = {"Camera": Camera, "View": View}[camera["kind"]]
            values = {name: _tuple(value) for name, value in camera.items() if name != "kind"}
            camera = kind(**values)
        return cls(**{**plain, "camera": camera})


def _tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value
