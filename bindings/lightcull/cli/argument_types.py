"""Single arguments of the command line, from text. Each raises ArgumentTypeError with what it wanted."""

from __future__ import annotations

import argparse
import math
import re

from .._core import Error, instruction_sets
from ..checks import MOST_32_BITS, MOST_64_BITS, MOST_PIXELS
from ..peers.subject import is_peer
from ..rendering.method import check_method
from ..report import METRICS
from ..sampler import check_description

MITSUBA_PATH = "path"
"""The sampler that is Mitsuba's own integrator."""


def image_size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"([1-9][0-9]{0,4})x([1-9][0-9]{0,4})", text)
    if match is None:
        raise argparse.ArgumentTypeError(f"wanted WIDTHxHEIGHT such as 640x360, got {text!r}")
    size = int(match[1]), int(match[2])
    if max(size) > MOST_PIXELS:
        raise argparse.ArgumentTypeError(f"wanted at most {MOST_PIXELS} pixels, got {text!r}")
    return size


def positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"wanted a number above 0, got {text!r}")
    return value


def finite(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"wanted a number, got {text!r}")
    return value


def from_one(text: str) -> int:
    return _whole(text, 1, MOST_32_BITS)


def from_zero(text: str) -> int:
    return _whole(text, 0, MOST_32_BITS)


def seed(text: str) -> int:
    return _whole(text, 0, MOST_64_BITS)


def _whole(text: str, least: int, most: int) -> int:
    if not re.fullmatch(r"[0-9]{1,30}", text) or int(text) < least:
        raise argparse.ArgumentTypeError(f"wanted a whole number from {least} up, got {text!r}")
    if int(text) > most:
        raise argparse.ArgumentTypeError(f"wanted at most {most}, got {text!r}")
    return int(text)


def sampler(text: str) -> str:
    if text == MITSUBA_PATH:  # whether there is a Mitsuba is known later
        return text
    try:
        check_description(text)
    except Error as error:
        raise argparse.ArgumentTypeError(str(error)) from error
    return text


def method(text: str) -> str:
    try:
        return check_method(text)
    except Error as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def method_list(text: str) -> list[str]:
    return [method(description) for description in text.split(",")]


def metric_list(text: str) -> list[str]:
    """Names of metrics, between commas."""
    names = text.split(",")
    for name in names:
        if name not in METRICS:
            raise argparse.ArgumentTypeError(
                f"{name!r} is unknown; there are {', '.join(METRICS)}"
            )
    return names


def sampler_list(text: str) -> list[str]:
    """Samplers, and renderers beside ours: whether those are there is known later."""
    return [
        description if is_peer(description) else sampler(description)
        for description in text.split(",")
    ]


def vector(text: str) -> tuple[float, float, float]:
    """Three numbers between commas."""
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        x = y = z = math.nan
    if not all(math.isfinite(value) for value in (x, y, z)):
        raise argparse.ArgumentTypeError(f"wanted three numbers such as 1,2,0.5, got {text!r}")
    return x, y, z


def frame_range(text: str) -> tuple[int, int]:
    """The first frame and the last."""
    match = re.fullmatch(r"([0-9]{1,7}):([0-9]{1,7})", text)
    if match is None or int(match[1]) > int(match[2]):
        raise argparse.ArgumentTypeError(f"wanted FIRST:LAST such as 1:100, got {text!r}")
    return int(match[1]), int(match[2])


def field_of_view(text: str) -> float:
    """Degrees."""
    value = positive(text)
    if value >= 180:
        raise argparse.ArgumentTypeError(f"wanted degrees below 180, got {text!r}")
    return value


def definition(text: str) -> tuple[str, str]:
    """A name and its value."""
    name, equals, value = text.partition("=")
    if not name or not equals:
        raise argparse.ArgumentTypeError(f"wanted NAME=VALUE, got {text!r}")
    return name, value


def thread_counts(text: str) -> list[int]:
    return [from_one(count) for count in text.split(",")]


def instruction_set_list(text: str) -> list[str]:
    available = instruction_sets()
    if text == "all":
        return available
    names = text.split(",")
    for name in names:
        if name not in available:
            raise argparse.ArgumentTypeError(
                f"no instruction set {name!r} here; there are {', '.join(available)} and all"
            )
    return names
