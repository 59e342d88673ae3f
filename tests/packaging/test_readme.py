"""The examples of README.md, run as they stand there."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BUILD = ROOT / "build"
README = (ROOT / "README.md").read_text()
LONGEST = 15


def examples(language):
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.M | re.S)


def run(*command, cwd):
    result = subprocess.run(
        [str(part) for part in command],
        cwd=cwd,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )
    assert result.returncode == 0, result.stdout
    return result.stdout


def test_there_are_three_short_ones():
    blocks = [block for language in ("cpp", "python", "console") for block in examples(language)]
    assert len(blocks) == 3
    assert all(len(block.strip().splitlines()) <= LONGEST for block in blocks)


def test_host(tmp_path):
    (source,) = examples("cpp")
    (tmp_path / "main.cpp").write_text(source)
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.22)\n"
        "project(host LANGUAGES CXX)\n"
        "find_package(lightcull REQUIRED COMPONENTS lights)\n"
        "add_executable(host main.cpp)\n"
        "target_link_libraries(host PRIVATE lightcull::lights)\n"
    )
    build = tmp_path / "build"
    run("cmake", "-S", tmp_path, "-B", build, "-G", "Ninja", f"-Dlightcull_DIR={BUILD}", cwd=tmp_path)
    run("cmake", "--build", build, cwd=tmp_path)
    assert re.fullmatch(r"light \d+ with probability 0\.\d+\n", run(build / "host", cwd=tmp_path))


def test_python(tmp_path):
    (source,) = examples("python")
    (tmp_path / "example.py").write_text(source)
    run(BUILD / "venv/bin/python", "example.py", cwd=tmp_path)
    assert (tmp_path / "lanterns.png").stat().st_size > 10_000


def test_command_line(tmp_path):
    (source,) = examples("console")
    script = f'export PATH="{BUILD}/venv/bin:$PATH"\nset -e\n{source}'
    run("bash", "-c", script, cwd=tmp_path)
    assert (tmp_path / "report/report.json").exists()


@pytest.mark.parametrize("path", sorted(set(re.findall(r"\]\(([^)#:]+)\)", README))))
def test_links_lead_somewhere(path):
    assert (ROOT / path).exists()
