"""What `import lightcull` and the command wait for: counts of modules, no times."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

HEAVY = {"PIL", "flip_evaluator", "jinja2", "matplotlib", "mitsuba", "pxr", "scipy", "trimesh"}
"""Packages for reports and for some files."""


def imported_by(code: str) -> set[str]:
    """The top-level packages that a new Python has imported after `code`."""
    tell = "import sys; print('\\n'.join({name.partition('.')[0] for name in sys.modules}))"
    process = subprocess.run(
        [sys.executable, "-c", f"{code}\n{tell}"], capture_output=True, text=True, check=True
    )
    return set(process.stdout.split())


def test_the_package_imports_numpy_and_nothing_that_is_large() -> None:
    modules = imported_by("import lightcull")
    assert "numpy" in modules
    assert not modules & (HEAVY | {"rich"})


def test_a_render_by_the_command_imports_nothing_for_reports(tmp_path: Path) -> None:
    arguments = ["render", "cornell", "--spp", "1", "--size", "16x16", "-o", f"{tmp_path}/image.exr"]
    modules = imported_by(f"from lightcull.cli import main\nassert main({arguments!r}) == 0")
    assert "lightcull" in modules
    assert not modules & HEAVY
