"""Checks of single arguments. Each throws TypeError or `lightcull.Error` with one line that begins
with the argument's name.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from numbers import Real
from operator import index
from typing import Any

from ._core import Error

MOST_32_BITS, MOST_64_BITS = 2**32 - 1, 2**64 - 1
MOST_PIXELS = 65535
"""Along an edge of an image."""


def whole_number(name: str, value: Any, least: int = 0, most: int = MOST_32_BITS) -> int:
    """A whole number, least to most."""
    try:
        number = index(value)
    except TypeError:
        number = least - 1
    if number < least:
        raise Error(f"{name}: wanted a whole number from {least} up, got {value!r}")
    if number > most:
        raise Error(f"{name}: wanted at most {most}, got {value!r}")
    return number


def number(name: str, value: Any) -> float:
    """Any real number; whether it makes sense is for others to say."""
    if not isinstance(value, Real):
        raise TypeError(f"{name}: wanted a number, got {value!r}")
    return float(value)


def text(name: str, value: Any) -> str:
    """A string."""
    if not isinstance(value, str):
        raise TypeError(f"{name}: wanted a string, got {value!r}")
    return _encodable(name, value)


def texts(name: str, values: Any) -> dict[str, str]:
    """Strings by names."""
    return {text(f"{name}: name", k): text(f"{name}: {k}", v) for k, v in dict(values).items()}


def path(name: str, value: Any) -> str:
    """The name of a file."""
    try:
        return _encodable(name, os.fsdecode(value))
    except TypeError:
        raise TypeError(f"{name}: wanted a path, got {value!r}") from None


def _encodable(name: str, value: str) -> str:
    try:
        value.encode()
    except UnicodeEncodeError:
        raise Error(f"{name}: {ascii(value)} is not UTF-8") from None
    return value


def size(value: Any) -> tuple[int, int]:
    """Width and height of an image, pixels."""
    pair = tuple(value) if isinstance(value, Iterable) else ()
    if len(pair) != 2:
        raise Error(f"size: wanted (width, height), got {value!r}")
    width, height = pair
    return (
        whole_number("width", width, 1, MOST_PIXELS),
        whole_number("height", height, 1, MOST_PIXELS),
    )
