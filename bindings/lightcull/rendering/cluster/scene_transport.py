"""A scene on its way to a worker: by its name where the worker has it, else as bytes."""

from __future__ import annotations

from typing import Any

from ..._core import Error
from ...loaders.reopen import reopen
from ...scene import Scene
from ...scene_record import recording, replay
from ...scene_source import SceneSource


def source_of(scene: Scene) -> dict[str, Any] | None:
    """Where workers may have it from by themselves, in plain values; None: nowhere."""
    source = scene.source
    return source.to_dict() if source is not None and source.digest == scene.digest() else None


def check_can_be_sent(scene: Scene) -> None:
    """Throws Error for a scene of which nobody keeps what was done to it."""
    if scene.record is None and source_of(scene) is None:
        raise Error(
            f"cluster: scene {scene.name!r} cannot be sent: make it by Scene(recorded=True), or open "
            "it by open_scene()"
        )


def bytes_of(scene: Scene) -> bytes:
    """All that was done to a scene, as `from_bytes` takes it."""
    check_can_be_sent(scene)
    if scene.record is not None:
        return scene.record.to_bytes()
    assert scene.source is not None
    with recording():
        again = reopen(scene.source)
    if again.record is None or again.digest() != scene.digest():
        raise Error(f"cluster: {scene.source.name}: has changed since it was opened")
    return again.record.to_bytes()


def from_bytes(data: bytes, name: str, digest: str) -> Scene:
    """The scene of `bytes_of`. Throws Error if it is not the one that is meant."""
    scene = Scene(name)
    replay(data, scene)
    if scene.digest() != digest:
        raise Error(f"scene {name!r}: what was sent of it makes another one")
    return scene


def from_source(source: dict[str, Any], name: str, digest: str) -> Scene:
    """The scene of `source_of`. Throws Error if it is not there, or is another one here."""
    scene = reopen(SceneSource.from_dict(source))
    if scene.digest() != digest:
        raise Error(f"{source['name']}: is another scene here")
    scene.name = name
    return scene
