"""Mitsuba itself: whether it is there, and that it knows the plugin."""

from __future__ import annotations

import hashlib
import importlib
from functools import cache
from pathlib import Path
from typing import Any

from .._core import Error
from . import system_libraries

WANTED_VERSION = "3.8.0"
"""The plugin is compiled against it: others differ in their classes."""

_FOLDER = Path(__file__).parent
_PLUGIN = _FOLDER / "plugins" / "lightcull_path.so"


@cache
def mitsuba() -> Any:
    """The module `mitsuba`, with `lightcull_path` among its plugins.

    Raises Error if it, or the plugin, is missing.
    """
    system_libraries.provide()
    try:
        module = importlib.import_module("mitsuba")
    except ImportError as error:
        again = "" if _PLUGIN.is_file() else ", then install lightcull again"
        raise Error(
            f"mitsuba: cannot be imported ({error}): pip install mitsuba=={WANTED_VERSION}{again}"
        ) from error
    if module.__version__ != WANTED_VERSION:
        raise Error(
            f"mitsuba is {module.__version__}, and lightcull_path is for {WANTED_VERSION}: "
            f"pip install mitsuba=={WANTED_VERSION}"
        )
    if not _PLUGIN.is_file():
        raise Error(
            f"{_PLUGIN}: missing; lightcull was installed where there was no mitsuba: install it "
            "again, now that there is"
        )
    module.file_resolver().append(str(_FOLDER))
    return module


@cache
def build_digest() -> str:
    """A hash of the plugin."""
    return hashlib.blake2b(_PLUGIN.read_bytes(), digest_size=16).hexdigest()
