"""What was done to a scene, step by step, so that it can be done again elsewhere: as bytes, of plain
values and arrays alone.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import wraps
from io import BytesIO
from typing import Any, Concatenate, ParamSpec, Protocol, TypeVar

import numpy as np

_RECORDING: ContextVar[bool] = ContextVar("recording", default=False)

P = ParamSpec("P")
Result = TypeVar("Result")


class SceneRecord:
    """Steps, in their order: names of methods, and what they were given."""

    def __init__(self) -> None:
        self._steps: list[tuple[str, Any, Any]] = []

    def add(self, method: str, arguments: tuple[Any, ...], keywords: dict[str, Any]) -> None:
        """Arrays are copied: whoever gave them may change them."""
        self._steps.append((method, _copied(arguments), _copied(keywords)))

    def to_bytes(self) -> bytes:
        """As `replay` takes them."""
        arrays: list[np.ndarray] = []
        text = json.dumps(_plain(self._steps, arrays))
        named: dict[str, Any] = {f"a{i}": array for i, array in enumerate(arrays)}
        data = BytesIO()
        np.savez(data, steps=np.frombuffer(text.encode(), np.uint8), **named)
        return data.getvalue()


class _Recorded(Protocol):
    _record: SceneRecord | None


Recorded = TypeVar("Recorded", bound=_Recorded)


def recorded(
    method: Callable[Concatenate[Recorded, P], Result],
) -> Callable[Concatenate[Recorded, P], Result]:
    """A step, of a method that changes a scene and calls no other such: noted if it succeeds."""

    @wraps(method)
    def step(scene: Recorded, /, *arguments: P.args, **keywords: P.kwargs) -> Result:
        result = method(scene, *arguments, **keywords)
        if scene._record is not None:
            scene._record.add(method.__name__, arguments, keywords)
        return result

    return step


def new_record(wanted: bool) -> SceneRecord | None:
    """A record for a new scene, if one is wanted, here or by `recording`."""
    return SceneRecord() if wanted or _RECORDING.get() else None


@contextmanager
def recording() -> Iterator[None]:
    """Scenes that are made meanwhile have a record."""
    token = _RECORDING.set(True)
    try:
        yield
    finally:
        _RECORDING.reset(token)


def replay(data: bytes, scene: object) -> None:
    """Does to a new scene what `SceneRecord.to_bytes` holds."""
    with np.load(BytesIO(data), allow_pickle=False) as arrays:
        for method, arguments, keywords in _restored(json.loads(bytes(arrays["steps"])), arrays):
            getattr(scene, method)(*arguments, **keywords)


def _copied(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.copy()
    if isinstance(value, tuple | list):
        return type(value)(map(_copied, value))
    if isinstance(value, dict):
        return {key: _copied(part) for key, part in value.items()}
    return value


def _plain(value: Any, arrays: list[np.ndarray]) -> Any:
    """What JSON can hold; arrays, and numbers of NumPy's, by their place in `arrays`."""
    if isinstance(value, np.ndarray | np.generic):
        arrays.append(np.asarray(value))
        kind = "array" if isinstance(value, np.ndarray) else "number"
        return {kind: len(arrays) - 1}
    if isinstance(value, tuple | list):
        return {type(value).__name__: [_plain(part, arrays) for part in value]}
    if isinstance(value, dict):
        return {"dict": {key: _plain(part, arrays) for key, part in value.items()}}
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise TypeError(f"a scene's record holds no {type(value).__name__}")


def _restored(plain: Any, arrays: Any) -> Any:
    if not isinstance(plain, dict):
        return plain
    ((kind, value),) = plain.items()
    match kind:
        case "array":
            return arrays[f"a{value}"]
        case "number":
            return arrays[f"a{value}"][()]
        case "tuple":
            return tuple(_restored(part, arrays) for part in value)
        case "list":
            return [_restored(part, arrays) for part in value]
        case _:
            return {key: _restored(part, arrays) for key, part in value.items()}
