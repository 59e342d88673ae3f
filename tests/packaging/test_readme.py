"""README.md and the pages of core/docs: their examples run as they stand there, and what they refer
to exists."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BUILD = ROOT / "build"
README = ROOT / "README.md"
HOST = ROOT / "core/docs/host.md"
DESIGN = ROOT / "core/docs/design.md"
PAGES = [README, *sorted((ROOT / "core/docs").glob("*.md"))]
LONGEST = 15
MOST_WORDS = 700
COMMANDS = {"bench", "compare", "info", "render", "selftest"}


def examples(page, language):
    return re.findall(rf"^```{language}\n(.*?)^```$", page.read_text(), re.M | re.S)


def is_program(source):
    return "int main(" in source


def anchors(page):
    """Of the headings of a page, as links name them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(), re.M)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


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


def build(folder, sources, *options, target="add_executable(host"):
    """Builds sources as the project that host.md shows. Returns the folder of what was built."""
    (project,) = examples(HOST, "cmake")
    names = [f"main{i}.cpp" for i in range(len(sources))]
    project, replaced = re.subn(
        r"add_executable\(host main\.cpp", f"{target} {' '.join(names)}", project
    )
    assert replaced == 1
    (folder / "CMakeLists.txt").write_text(project)
    for name, source in zip(names, sources, strict=True):
        (folder / name).write_text(source)
    built = folder / "build"
    found = f"-Dlightcull_DIR={BUILD}"
    run("cmake", "-S", folder, "-B", built, "-G", "Ninja", found, *options, cwd=folder)
    run("cmake", "--build", built, cwd=folder)
    return built


def test_there_are_three_short_ones():
    languages = ("cpp", "python", "console")
    blocks = [block for language in languages for block in examples(README, language)]
    assert len(blocks) == 3
    assert all(len(block.strip().splitlines()) <= LONGEST for block in blocks)


def test_the_readme_is_short():
    assert len(README.read_text().split()) <= MOST_WORDS


def test_host(tmp_path):
    (source,) = examples(README, "cpp")
    built = build(tmp_path, [source])
    assert re.fullmatch(r"light \d+ with probability 0\.\d+\n", run(built / "host", cwd=tmp_path))


def test_first_program_of_the_page_for_hosts(tmp_path):
    (source,) = filter(is_program, examples(HOST, "cpp"))
    built = build(tmp_path, [source])
    assert re.fullmatch(r"(light \d+, prob [01]\.\d+\n){4}", run(built / "host", cwd=tmp_path))


def test_parts_of_a_host_compile(tmp_path):
    """Each by itself. Nothing is linked: what a renderer has is declared in them, not defined."""
    parts = [source for page in PAGES for source in examples(page, "cpp") if not is_program(source)]
    assert len(parts) >= 5
    warnings = "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Wpedantic -Wconversion -Werror"
    build(tmp_path, parts, warnings, target="add_library(host OBJECT")


def test_python(tmp_path):
    (source,) = examples(README, "python")
    (tmp_path / "example.py").write_text(source)
    run(BUILD / "venv/bin/python", "example.py", cwd=tmp_path)
    assert (tmp_path / "lanterns.png").stat().st_size > 10_000


def test_command_line(tmp_path):
    (source,) = examples(README, "console")
    script = f'export PATH="{BUILD}/venv/bin:$PATH"\nset -e\n{source}'
    run("bash", "-c", script, cwd=tmp_path)
    assert (tmp_path / "report/report.json").exists()


def commands():
    """Of all pages, each command with the options that it is shown with."""
    shown = {}
    for page in PAGES:
        text = page.read_text().replace("\\\n", " ")
        lines = re.findall(r"^ {4}lightcull (.*)$", text, re.M)
        lines += re.findall(r"`lightcull\s([^`]*)`", text)
        for block in examples(page, "console"):
            lines += re.findall(r"^lightcull (.*)$", block.replace("\\\n", " "), re.M)
        for line in lines:
            command = line.split()[0]
            if command in COMMANDS:
                shown.setdefault(command, set()).update(re.findall(r"--[a-z-]+", line))
    return shown


@pytest.mark.parametrize("command, options", sorted(commands().items()))
def test_commands_have_the_options_that_are_shown(command, options, tmp_path):
    text = run(BUILD / "venv/bin/lightcull", command, "--help", cwd=tmp_path)
    assert options <= set(re.findall(r"--[a-z-]+", text))


def links():
    for page in PAGES:
        for target in sorted(set(re.findall(r"\]\(([^):]+)\)", page.read_text()))):
            yield pytest.param(page, target, id=f"{page.name}: {target}")


@pytest.mark.parametrize("page, target", list(links()))
def test_links_lead_somewhere(page, target):
    path, _, anchor = target.partition("#")
    other = (page.parent / path).resolve() if path else page
    assert other.exists()
    assert not anchor or anchor in anchors(other)


def test_sections_that_the_code_cites_exist():
    folders = ("core", "plugin", "bindings", "tests", "examples")
    suffixes = {".h", ".cpp", ".glsl", ".comp", ".py"}
    sections = set(re.findall(r"^## (.*)$", DESIGN.read_text(), re.M))
    cited = set()
    for folder in folders:
        for path in (ROOT / folder).rglob("*"):
            if path.suffix not in suffixes or path == Path(__file__):
                continue
            text = re.sub(r"\s*\n\s*(//+|#) ?", " ", path.read_text())
            cited |= set(re.findall(r'design\.md, "([^"]*)"', text))
    assert len(cited) >= 3
    assert cited <= sections
