"""Files that are written whole or not at all, and whether they can be, before work is put in."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from . import _core, checks
from ._core import Error

_GROWTH = 32
"""Bytes by which the name of a file is longer while it is written."""


def write_whole_file(path: str | os.PathLike[str], data: bytes) -> None:
    """Writes a file that appears under its name whole or not at all. Makes its folder if need be."""
    name = checks.path("path", path)
    make_folder(Path(name).parent)
    _core.write_whole_file(name, data)


def check_output(path: str | os.PathLike[str]) -> None:
    """Throws Error unless a file of that name can be written, so that no render is lost to it."""
    name = checks.path("path", path)
    if not name or name.endswith("/") or os.path.isdir(name):
        raise Error(f"{name or repr(name)}: is a folder; wanted the name of a file")
    if os.path.exists(name) and not os.path.isfile(name):
        raise Error(f"{name}: cannot write: it is there and is not a file")
    target = Path(os.path.realpath(name))
    _check_place(Path(name).parent, target.with_name(target.name + "_" * _GROWTH))


def check_writable(folder: str | os.PathLike[str]) -> None:
    """Throws Error unless files can be written into a folder, which need not be there yet."""
    name = checks.path("folder", folder)
    _check_place(name, Path(name).absolute() / "report.json")


def _check_place(folder: str | os.PathLike[str], file: Path) -> None:
    """Throws Error with the folder unless the file can be made, and those folders above it that are
    not there.
    """
    there = file.parent
    while not os.path.exists(there) and there != there.parent:
        there = there.parent
    try:
        with tempfile.TemporaryFile(dir=there):
            pass
        most_in_name, most = (os.pathconf(there, name) for name in ("PC_NAME_MAX", "PC_PATH_MAX"))
    except OSError as error:
        raise Error(f"{os.fspath(folder)}: cannot write there: {error.strerror}") from error
    longest = max(len(part.encode()) for part in file.relative_to(there).parts)
    if longest > most_in_name or len(str(file).encode()) >= most:
        raise Error(f"{os.fspath(folder)}: cannot write there: File name too long")


def make_folder(folder: Path) -> None:
    """With those above it, unless it is there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Error(f"{folder}: cannot make this folder: {error.strerror}") from error
