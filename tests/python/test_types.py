"""The type stubs of the compiled module, and the package's own types."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import lightcull

# Classes of pybind11 have a metaclass of its own, and say nothing of their constructors.
EXPECTED_DIFFERENCES = r"""
lightcull\._core\.\w+
lightcull\._core\.\w+\.__init__
"""


def test_stubs_match_the_module(tmp_path: Path) -> None:
    (tmp_path / "allowed").write_text(EXPECTED_DIFFERENCES)
    result = subprocess.run(
        [
            sys.executable, "-m", "mypy.stubtest", "lightcull._core",
            "--allowlist", "allowed", "--ignore-unused-allowlist",
        ],
        cwd=tmp_path,
        env={**os.environ, "MYPY_CACHE_DIR": str(tmp_path / "cache")},
        capture_output=True,
        text=True,
    )  # fmt: skip
    assert result.returncode == 0, result.stdout + result.stderr


def test_the_package_is_marked_as_typed() -> None:
    assert (Path(lightcull.__file__).parent / "py.typed").is_file()
