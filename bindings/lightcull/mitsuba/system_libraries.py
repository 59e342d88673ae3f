"""What Mitsuba's wheels take from the system, for systems that lack it."""

from __future__ import annotations

import ctypes
import os
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

_LIBATOMIC = Path(__file__).parents[2] / "lightcull.libs" / "libatomic.so.1"
"""In wheels of lightcull."""

_LLVM_PACKAGE = "karellen-llvm-core"
"""Of the extra `llvm`."""


def provide() -> None:
    """Lets Dr.Jit find libatomic and LLVM. It looks for them while it is imported."""
    _load_libatomic()
    _name_llvm()


def _load_libatomic() -> None:
    """A library that is loaded is not looked for."""
    try:
        ctypes.CDLL(_LIBATOMIC.name)
    except OSError:
        if _LIBATOMIC.is_file():
            ctypes.CDLL(str(_LIBATOMIC))


def _name_llvm() -> None:
    """Whoever has installed the extra wants that LLVM, unless the environment names one."""
    try:
        installed = files(_LLVM_PACKAGE) or []
    except PackageNotFoundError:
        return
    for file in installed:
        if file.name.startswith("libLLVM.so."):
            os.environ.setdefault("DRJIT_LIBLLVM_PATH", str(Path(str(file.locate())).resolve()))
