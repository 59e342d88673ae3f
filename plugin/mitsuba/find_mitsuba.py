"""Prints where the Mitsuba wheel is: its version, then the folders of mitsuba, drjit and nanobind,
divided by semicolons; empty for what is not installed. For CMake."""

import importlib.metadata
import importlib.util
import pathlib


def folder(package: str) -> str:
    spec = importlib.util.find_spec(package)
    return str(pathlib.Path(spec.origin).parent) if spec and spec.origin else ""


try:
    version = importlib.metadata.version("mitsuba")
except importlib.metadata.PackageNotFoundError:
    version = ""
print(version, *map(folder, ("mitsuba", "drjit", "nanobind")), sep=";")
