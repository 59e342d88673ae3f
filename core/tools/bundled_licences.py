"""Puts the licences of all that a wheel brings along into it, and a list of what that is.

Usage: bundled_licences.py UNPACKED_WHEEL LICENCES_OF_OPENIMAGEIO
"""

import re
import subprocess
import sys
from importlib.metadata import distribution
from pathlib import Path

COMPILED_IN_DEBIAN = ("libfmt-dev", "libhwy-dev", "libimath-dev", "libtinyobjloader-dev")
"""Packages whose headers are compiled into our libraries."""

COMPILED_IN_PYTHON = ("drjit", "mitsuba", "nanobind", "pybind11")


def soname(bundled: str) -> str:
    """Of a library as auditwheel calls it, which puts a hash after its name."""
    return re.sub(r"-[0-9a-f]{8}(?=\.so)", "", bundled)


def debian_package(library: str) -> str:
    """The package that has the file."""
    owners = subprocess.run(
        ["dpkg-query", "--search", f"*/{library}"], text=True, capture_output=True, check=True
    ).stdout
    return owners.split(":")[0]


def debian_licence(package: str) -> str:
    """What the package says of its licences, with the texts that it refers to."""
    text = Path("/usr/share/doc", package, "copyright").read_text()
    for path in sorted(set(re.findall(r"/usr/share/common-licenses/[\w.+-]*\w", text))):
        text += f"\n{'-' * 78}\n{path}\n\n{Path(path).read_text()}"
    return text


def python_licence(name: str) -> str:
    files = distribution(name).files or []
    texts = [
        file.read_text()
        for file in files
        if ".dist-info" in str(file) and re.match("licen[cs]e|copying", file.name, re.I)
    ]
    if not texts:
        raise SystemExit(f"the Python package {name} comes without a licence")
    return "\n".join(texts)


def main(wheel: Path, openimageio: Path) -> None:
    (info,) = wheel.glob("*.dist-info")
    licences = {name: debian_licence(name) for name in COMPILED_IN_DEBIAN}
    licences |= {name: python_licence(name) for name in COMPILED_IN_PYTHON}
    licences["openimageio"] = "\n".join(file.read_text() for file in sorted(openimageio.iterdir()))
    lines = [f"headers of {name}" for name in (*COMPILED_IN_DEBIAN, *COMPILED_IN_PYTHON)]
    for library in sorted(path.name for path in wheel.glob("*.libs/*")):
        name = soname(library)
        package = "openimageio" if "OpenImageIO" in name else debian_package(name)
        if package not in licences:
            licences[package] = debian_licence(package)
        lines.append(f"{library}: {package}")
    folder = info / "licenses" / "bundled"
    folder.mkdir(parents=True)
    for name, text in licences.items():
        (folder / f"{name}.txt").write_text(text)
    (folder / "LIST").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
