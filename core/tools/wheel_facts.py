"""Says how large a wheel is and how long its import takes, the shortest of three.

Usage: wheel_facts.py WHEEL    by a Python that has what the package needs
"""

import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path


def shortest(statement: str, folder: str) -> float:
    """Seconds that a new process takes for the statement, with the folder's packages first."""
    program = f"import sys; sys.path.insert(0, {folder!r}); {statement}"
    seconds = []
    for _ in range(3):
        begin = time.perf_counter()
        subprocess.run([sys.executable, "-I", "-c", program], check=True)
        seconds.append(time.perf_counter() - begin)
    return min(seconds)


def main(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive, tempfile.TemporaryDirectory() as folder:
        archive.extractall(folder)
        unpacked = sum(item.file_size for item in archive.infolist())
        times = {
            "Python alone": shortest("pass", folder),
            "import lightcull": shortest("import lightcull", folder),
            "import mitsuba": shortest("import mitsuba", folder),
            "import lightcull.mitsuba": shortest("import lightcull.mitsuba", folder),
        }
    print(f"{wheel}: {wheel.stat().st_size / 1e6:.1f} MB, {unpacked / 1e6:.1f} MB unpacked")
    for statement, seconds in times.items():
        print(f"  {statement}: {seconds:.2f} s")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
