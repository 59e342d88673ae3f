"""The wheel for machines without a compiler: what is in it, and that it needs nothing else."""

import re
import subprocess
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BUILD = ROOT / "build"
VENV = BUILD / "venv"
PYPI_LIMIT = 100_000_000
# By soname. All others have to be in the wheel, but those of Mitsuba, which are in its own.
OF_THE_SYSTEM = {
    *("ld-linux-x86-64.so.2", "libc.so.6", "libdl.so.2", "libm.so.6", "libpthread.so.0"),
    *("libexpat.so.1", "libgcc_s.so.1", "libstdc++.so.6", "libz.so.1"),
}
OF_MITSUBA = {f"lib{name}.so" for name in ("mitsuba", "drjit-core", "drjit-extra", "nanothread")}
BUNDLED = ("embree", "OpenImageIO", "OpenColorIO", "tbb", "hwy")


def run(*command, env=None, cwd=None):
    result = subprocess.run(
        [str(part) for part in command],
        env=env,
        cwd=cwd,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


@pytest.fixture(scope="module")
def facts():
    """What wheels.sh says of the wheel that it has built."""
    return run(ROOT / "core/tools/wheels.sh")


@pytest.fixture(scope="module")
def wheel(facts):
    return Path(re.search(r"^(.*\.whl):", facts, re.M)[1])


@pytest.fixture(scope="module")
def bare(wheel, tmp_path_factory):
    """An environment with the wheel, and nothing else of lightcull."""
    folder = tmp_path_factory.mktemp("bare")
    run(VENV / "bin/python", "-m", "venv", "--without-pip", folder)
    pip = (VENV / "bin/python", "-m", "pip", "--python", folder / "bin/python", "install")
    run(*pip, "--no-index", "--no-deps", wheel)
    packages = next(folder.glob("lib/python*/site-packages"))
    # What it depends on is at hand already.
    for package in next(VENV.glob("lib/python*/site-packages")).iterdir():
        if not package.name.startswith(("lightcull", "pip", "__pycache__")):
            (packages / package.name).symlink_to(package)
    return folder


def soname(bundled):
    """Of a library as auditwheel calls it, which puts a hash after its name."""
    return re.sub(r"-[0-9a-f]{8}(?=\.so)", "", bundled)


def needed(library):
    return set(re.findall(r"\(NEEDED\).*\[(.*)\]", run("readelf", "-d", library)))


def test_its_libraries_need_each_other_the_c_library_and_mitsuba(bare):
    (packages,) = bare.glob("lib/python*/site-packages")
    bundled = {path.name for path in packages.glob("lightcull.libs/*")}
    for name in BUNDLED:
        assert any(re.match(rf"lib{name}\d*-", library) for library in bundled), name
    for library in [*packages.glob("lightcull*/**/*.so*")]:
        strangers = needed(library) - bundled - OF_THE_SYSTEM
        is_plugin = library.parent.name == "plugins"
        assert strangers == (OF_MITSUBA if is_plugin else set()), library


def test_it_renders_without_any_other_library(bare, tmp_path):
    program = Path(__file__).with_name("installed_render.py")
    env = {"HOME": str(tmp_path)}  # Dr.Jit keeps a folder there, and has to have one
    command = (bare / "bin/python", "-I", program, tmp_path, "scalar_rgb")
    loaded = run(*command, env=env, cwd=tmp_path).splitlines()
    (packages,) = bare.glob("lib/python*/site-packages")
    ours = {path.name for path in packages.glob("lightcull.libs/*")}
    ours.remove("libatomic.so.1")  # is for systems that have none
    assert ours <= {Path(path).name for path in loaded}
    bundled = {soname(name).split(".so")[0] for name in ours}
    for path in map(Path, loaded):
        if "site-packages" not in path.parts:
            assert path.name.split(".so")[0] not in bundled, path
            assert not re.match("libOpenEXR|libav|libopencv", path.name), path
        elif packages not in path.parents:  # of what it depends on
            assert not any(part.startswith("lightcull") for part in path.parts[-4:]), path


def test_it_has_the_licences_of_what_it_brings_along(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        (list_name,) = (name for name in names if name.endswith("licenses/bundled/LIST"))
        lines = archive.read(list_name).decode().splitlines()
        for line in lines:
            owner = re.split(": |headers of ", line)[-1]
            licence = archive.read(list_name.replace("LIST", f"{owner}.txt")).decode()
            assert re.search("copyright|licen[cs]e", licence, re.I), owner
        listed = {line.split(": ")[0] for line in lines}
        bundled = {Path(name).name for name in names if name.startswith("lightcull.libs/")}
        assert bundled and bundled <= listed


def test_its_size_and_the_time_of_its_import_are_said(wheel, facts):
    assert wheel.stat().st_size < PYPI_LIMIT
    assert f"{wheel.stat().st_size / 1e6:.1f} MB" in facts
    assert re.search(r"import lightcull: \d+\.\d\d s", facts)
    assert re.search(r"import lightcull\.mitsuba: \d+\.\d\d s", facts)


def test_another_mitsuba_is_refused_in_one_line(bare, tmp_path):
    (tmp_path / "mitsuba.py").write_text('__version__ = "3.7.1"\n')
    program = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); import lightcull.mitsuba"
    result = subprocess.run(
        [bare / "bin/python", "-c", program], capture_output=True, text=True, env={}
    )
    assert result.returncode != 0
    assert result.stderr.splitlines()[-1].endswith(
        "mitsuba is 3.7.1, and lightcull_path is for 3.8.0: pip install mitsuba==3.8.0"
    )


def test_a_missing_mitsuba_is_named_in_one_line(bare, tmp_path):
    program = "import sys; sys.modules['mitsuba'] = None; import lightcull.mitsuba"
    result = subprocess.run(
        [bare / "bin/python", "-c", program], capture_output=True, text=True, env={}
    )
    assert result.returncode != 0
    # The plugin is in the wheel: nothing has to be installed again.
    assert result.stderr.splitlines()[-1].endswith("): pip install mitsuba==3.8.0")
