"""Scenes of Mitsuba's from .xml files."""

from __future__ import annotations

import hashlib
import os
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from .._core import Error
from ..loaders.unsupported import Notes, UnsupportedWarning
from .file_integrator import take_integrator
from .host import mitsuba
from .mitsuba_scene import IN_MEDIA, MitsubaScene

DEFAULT_VARIANT = "scalar_rgb"


def load_file(
    path: str | os.PathLike[str],
    variant: str = DEFAULT_VARIANT,
    parameters: Mapping[str, str] | None = None,
) -> MitsubaScene:
    """Loads an .xml scene, and sets Mitsuba's variant.

    parameters: values for the file's `$name`s, in place of its `<default>`s, as by Mitsuba's `-D
    name=value`; one that the file does not use is an Error. max_depth, rr_depth and hide_emitters
    of the file's integrator hold, wherever they stand; what else it asks for is named in one
    `UnsupportedWarning`.
    """
    path, mi = Path(path), mitsuba()
    if not path.is_file():
        raise Error(f"{path}: no such file")
    if variant not in mi.variants():
        raise Error(f"Mitsuba has no variant {variant!r}; it has {', '.join(mi.variants())}")
    notes = Notes()
    try:
        mi.set_variant(variant)
        config = mi.parser.ParserConfig(variant)
        with _files_beside(path):
            state = mi.parser.parse_file(config, str(path), **(parameters or {}))
            mi.parser.transform_upgrade(config, state)
            integrator = take_integrator(state, notes)
            mi.parser.transform_all(config, state)
            scene = mi.parser.instantiate(config, state)
    except Error as error:
        raise Error(f"{path}: {error}") from error
    except Exception as error:  # Mitsuba lets through what its plugins meet
        raise Error(f"{path}: {_reason(error)}") from error
    if not isinstance(scene, mi.Scene):
        raise Error(f"{path}: holds no scene")
    result = MitsubaScene(
        scene, path.stem, _digest(path, state, parameters or {}), integrator=integrator
    )
    if result.wants_media:
        notes.remark(
            f"its media are rendered by lightcull_volpath, the sampler {IN_MEDIA!r}; "
            f"'path' is Mitsuba's {integrator.kind}"
        )
    if message := notes.message():
        warnings.warn(f"{path}: {message}", UnsupportedWarning, stacklevel=2)
    return result


@contextmanager
def _files_beside(path: Path) -> Iterator[None]:
    """What a scene refers to is looked for in its folder."""
    resolver = mitsuba().file_resolver()
    before = list(resolver)
    resolver.prepend(str(path.parent))
    try:
        yield
    finally:
        resolver.clear()
        for folder in before:
            resolver.append(folder)


def _digest(path: Path, state: Any, parameters: Mapping[str, str]) -> str:
    """Of the file, of what it includes and of its parameters."""
    digest = hashlib.blake2b(str(path.resolve()).encode(), digest_size=16)
    for file in state.files:
        digest.update(Path(str(file)).read_bytes())
    digest.update(repr(sorted(parameters.items())).encode())
    return digest.hexdigest()


def _reason(error: Exception) -> str:
    """What Mitsuba says, in one line and without the places in its source."""
    lines = [line.split("] ", 1)[-1] if line.startswith("[") else line for line in _lines(error)]
    return " ".join(lines)


def _lines(error: Exception) -> list[str]:
    return [line.strip() for line in str(error).splitlines() if line.strip()]
