"""Mitsuba itself: whether it is there, and that it knows the plugins."""

from __future__ import annotations

import hashlib
import importlib
from functools import cache
from pathlib import Path
from typing import Any

from .._core import Error
from . import system_libraries

WANTED_VERSION = "3.8.0"
"""The plugins are compiled against it: others differ in their classes."""

_FOLDER = Path(__file__).parent
_PLUGINS = tuple(
    _FOLDER / "plugins" / f"{name}.so" for name in ("lightcull_path", "lightcull_volpath")
)


@cache
def mitsuba() -> Any:
    """The module `mitsuba`, with `lightcull_path` and `lightcull_volpath` among its plugins.

    Raises Error if it, or a plugin, is missing.
    """
    system_libraries.provide()
    try:
        module = importlib.import_module("mitsuba")
    except ImportError as error:
        there = all(plugin.is_file() for plugin in _PLUGINS)
        again = "" if there else ", then install lightcull again"
        raise Error(
            f"mitsuba: cannot be imported ({error}): pip install mitsuba=={WANTED_VERSION}{again}"
        ) from error
    if module.__version__ != WANTED_VERSION:
        raise Error(
            f"mitsuba is {module.__version__}, and lightcull_path is for {WANTED_VERSION}: "
            f"pip install mitsuba=={WANTED_VERSION}"
        )
    missing = [plugin for plugin in _PLUGINS if not plugin.is_file()]
    if missing:
        raise Error(
            f"{missing[0]}: missing; lightcull was installed where there was no mitsuba: install it "
            "again, now that there is"
        )
    module.file_resolver().append(str(_FOLDER))
    return module


@cache
def build_digest() -> str:
    """A hash of the plugins."""
    digest = hashlib.blake2b(digest_size=16)
    for plugin in _PLUGINS:
        digest.update(plugin.read_bytes())
    return digest.hexdigest()
