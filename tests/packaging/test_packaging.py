"""lightcull as others get it: installed, from the build tree, and from its sources."""

import itertools
import re
import shlex
import shutil
import subprocess
import tomllib
from array import array
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BUILD = ROOT / "build"
WORK = BUILD / "packaging"
CONSUMER = ROOT / "tests/packaging/consumer"
INCLUDE = ROOT / "core/include"
HEADERS = sorted(path.relative_to(INCLUDE) for path in INCLUDE.rglob("*.h"))
LIGHTS_HEADERS = [path for path in HEADERS if len(path.parts) == 2]
HOST = ROOT / "tests/packaging/host"
VERSION = re.search(r'VERSION_STRING "(.*)"', (INCLUDE / "lightcull/version.h").read_text())[1]
# What the path tracer and the image library are built with; PkgConfig finds most of it.
RENDER_PACKAGES = ["embree", "PkgConfig", "OpenImageIO", "OpenColorIO", "Imath"]


def attempt(*command, cwd=None):
    return subprocess.run(
        [str(part) for part in command],
        cwd=cwd,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )


def run(*command, cwd=None):
    result = attempt(*command, cwd=cwd)
    assert result.returncode == 0, result.stdout
    return result.stdout


def compiler():
    cache = (BUILD / "CMakeCache.txt").read_text()
    return re.search(r"^CMAKE_CXX_COMPILER:\w+=(.*)$", cache, re.M)[1]


def configure_any(source, build, *options):
    shutil.rmtree(build, ignore_errors=True)
    return attempt(
        *("cmake", "-S", source, "-B", build, "-G", "Ninja"),
        *(f"-DCMAKE_CXX_COMPILER={compiler()}", *options),
    )


def configure(source, build, package, *options):
    """Configures a project that finds lightcull in the folder `package`."""
    found = f"-Dlightcull_DIR={package}"
    return configure_any(source, build, "-DCMAKE_BUILD_TYPE=Release", found, *options)


def without(packages):
    """Options that hide packages from find_package()."""
    return [f"-DCMAKE_DISABLE_FIND_PACKAGE_{package}=ON" for package in packages]


def one_line(text):
    return " ".join(text.split())


def check_host(program):
    """Runs tests/packaging/host. Returns what it said of samplers for Vulkan, if it said that."""
    version, unknown, chosen, *rest = run(program).splitlines()
    assert version == f"headers {VERSION}, library {VERSION}"
    assert re.match("unknown: .*no_such", unknown)
    assert chosen == "chosen: 1"
    return rest


def install(build, name):
    """Installs what was built. Returns the install tree, which is moved to a path with a space."""
    first, moved = WORK / "installed", WORK / f"moved {name}"
    for folder in (first, moved):
        shutil.rmtree(folder, ignore_errors=True)
    run("cmake", "--install", build, "--prefix", first)
    return first.rename(moved)


def package_folder(prefix):
    return next(prefix.rglob("lightcullConfig.cmake")).parent


@pytest.fixture(scope="session")
def prefix():
    """An install tree of static libraries, with all components."""
    return install(BUILD, "prefix")


@pytest.fixture(params=["install tree", "build tree"])
def package(request):
    """The folder of lightcullConfig.cmake."""
    if request.param == "build tree":
        return BUILD
    return package_folder(request.getfixturevalue("prefix"))


def test_all_public_headers_and_no_others_are_installed(prefix):
    include = prefix / "include"
    installed = [path.relative_to(include) for path in include.rglob("*") if path.is_file()]
    assert sorted(installed) == HEADERS


def test_the_install_tree_knows_nothing_of_the_source_tree(prefix):
    for path in [*prefix.rglob("*.cmake"), *prefix.rglob("*.pc")]:
        assert str(ROOT) not in path.read_text(), path


@pytest.mark.parametrize("header", HEADERS, ids=str)
def test_a_header_compiles_alone(prefix, header):
    warnings = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]
    source = WORK / "alone.cpp"
    source.write_text(f"#include <{header}>\n#include <{header}>\n")
    run(compiler(), "-std=c++17", "-fsyntax-only", *warnings, "-I", prefix / "include", source)


@pytest.mark.parametrize("header", LIGHTS_HEADERS, ids=str)
def test_a_header_of_lights_includes_the_standard_library_and_its_like_only(prefix, header):
    text = (prefix / "include" / header).read_text()
    for name in re.findall(r"^\s*#\s*include\s*(.*)$", text, re.M):
        standard = re.fullmatch(r"<([a-z_0-9]+|stddef\.h|stdint\.h)>", name)
        assert standard or name[1:-1] in map(str, LIGHTS_HEADERS)


def test_a_host_builds_with_lights_alone_and_gains_by_it(package, prefix):
    build = WORK / "host"
    result = configure(ROOT / "examples/minimal_host", build, package)
    assert result.returncode == 0, result.stdout
    # A host that wants lights alone needs nothing of what the path tracer needs.
    assert not re.search(r"embree|OpenImageIO|OpenColorIO", (build / "build.ninja").read_text())
    run("cmake", "--build", build)
    line = run(build / "minimal_host", cwd=build)
    error = {name: float(value) for name, value in re.findall(r"(\w+) (\d+\.\d+)", line)}
    assert error["culled"] < error["uniform"] / 10
    assert error["culled"] < 2 * error["exhaustive"]
    assert (build / "minimal_host.pgm").stat().st_size > 128 * 96


def build_path_host(prefix, build_type):
    build = WORK / f"path_host {build_type}"
    package = next(prefix.rglob("lightcullConfig.cmake")).parent
    warnings = "-Wall -Wextra -Wpedantic -Wconversion -Werror"
    options = (f"-DCMAKE_BUILD_TYPE={build_type}", f"-DCMAKE_CXX_FLAGS={warnings}")
    result = configure(ROOT / "examples/path_host", build, package, *options)
    assert result.returncode == 0, result.stdout
    run("cmake", "--build", build)
    return build / "path_host"


def render_all_orders(host, folder, *options):
    """Mean and image of each order of work of path_host, by the name of its file."""
    folder.mkdir()
    said = run(host, *options, cwd=folder)
    means = {name: float(mean) for mean, name in re.findall(r"mean (\S+) -> (\S+)", said)}
    assert len(means) == 4, said
    return means, {name: (folder / name).read_bytes() for name in means}


def pixels_of(pfm):
    pixels = array("f")
    pixels.frombytes(pfm[pfm.index(b"-1.0\n") + len(b"-1.0\n") :])
    return pixels


def difference(a, b):
    """Mean of the squared difference of two images over the square of what they show."""
    pairs = list(zip(pixels_of(a), pixels_of(b), strict=True))
    return sum((p - q) ** 2 / (p * q + 1e-4) for p, q in pairs) / len(pairs)


# Luminance of path_host's image by BSDF sampling alone, without lightcull; it is off by 0.1 % or so.
PATH_HOST_MEAN = 0.3601


def test_a_path_tracer_renders_alike_in_every_order_of_work(prefix):
    host = build_path_host(prefix, "Release")
    size = ("--width", 48, "--samples", 64)
    means, images = render_all_orders(host, host.parent / "one", *size, "--threads", 1)
    # Seeds are fixed. From seed to seed the means vary by 0.9 %, most of it the edges of lanterns,
    # which all of them have in common: among one another they vary by 0.1 %.
    for name, mean in means.items():
        assert mean == pytest.approx(PATH_HOST_MEAN, rel=0.02), name
        assert mean == pytest.approx(means["whole_passes.pfm"], rel=0.004), name
        # They differ by 0.012 and 0.014. With the same set for all samples of a pass it would be
        # 0.039 and 0.0195.
        assert difference(images[name], images["whole_passes.pfm"]) < 0.018, name
    assert len(set(images.values())) == 4  # or they were one order of work
    threads = ("--threads", 3)
    assert (means, images) == render_all_orders(host, host.parent / "three", *size, *threads)


def test_a_path_tracer_tells_lightcull_nothing_that_makes_no_sense(prefix):
    host = build_path_host(prefix, "Debug")  # with the checked sampler, which aborts
    render_all_orders(host, host.parent / "image", "--width", 24, "--samples", 20)


@pytest.mark.parametrize("components", ["", "lights;render;image"])
def test_every_component_links_and_runs(package, prefix, components):
    build = WORK / "consumer"
    result = configure(CONSUMER, build, package, f"-DCOMPONENTS={components}")
    assert result.returncode == 0, result.stdout
    run("cmake", "--build", build)
    assert run(build / "consumer") == "white: 1\n"


def test_a_component_that_is_not_there_is_named(package, prefix):
    result = configure(CONSUMER, WORK / "consumer", package, "-DCOMPONENTS=lights;gpus")
    assert result.returncode != 0
    said = " ".join(result.stdout.split())
    assert "no component 'gpus' here; there are: base, lights, image, render" in said


@pytest.mark.parametrize(
    "component, package", [("lights", "hwy"), ("lights", "TBB"), ("render", "embree")]
)
def test_what_a_component_needs_is_named(prefix, component, package):
    """Both where lightcull is built and where it is found."""
    said = f"lightcull::{component} needs {package}, which was not found (Debian: lib"
    build = configure_any(ROOT, WORK / "without", *without([package]))
    assert build.returncode != 0
    assert said in one_line(build.stdout)
    host = configure(CONSUMER, WORK / "consumer", package_folder(prefix), *without([package]))
    assert host.returncode != 0
    assert said in one_line(host.stdout)


def test_the_version_is_one():
    header = (INCLUDE / "lightcull/version.h").read_text()
    parts = [re.search(rf"_{part} (\d+)\n", header)[1] for part in ("MAJOR", "MINOR", "PATCH")]
    assert ".".join(parts) == VERSION
    project = tomllib.loads((ROOT / "bindings/pyproject.toml").read_text())["project"]
    assert project["version"] == VERSION
    package = (BUILD / "lightcullConfigVersion.cmake").read_text()
    assert f'set(PACKAGE_VERSION "{VERSION}")' in package


@pytest.fixture(scope="session")
def static_subproject():
    """A host with lightcull as a subdirectory, lights alone; what CMake said, and where it is."""
    build = WORK / "subproject"
    absent = without([*RENDER_PACKAGES, "Vulkan"])
    options = ["-DWAY=add_subdirectory", f"-DLIGHTCULL_SOURCE={ROOT}", "-DLIGHTCULL_RENDER=OFF"]
    result = configure_any(HOST, build, "-DCMAKE_BUILD_TYPE=Debug", *options, *absent)
    assert result.returncode == 0, result.stdout
    run("cmake", "--build", build)
    return build, result.stdout


def test_lights_alone_looks_for_nothing_but_highway_and_tbb(static_subproject):
    build, said = static_subproject
    assert check_host(build / "host") == []
    # CMake lists the options that nobody asked for: nothing tried to find these packages.
    unused = said.split("Manually-specified variables were not used by the project:")[1]
    for package in [*RENDER_PACKAGES, "Vulkan"]:
        assert f"CMAKE_DISABLE_FIND_PACKAGE_{package}\n" in unused
    found = re.findall(r"^(\w+)_DIR:PATH=", (build / "CMakeCache.txt").read_text(), re.M)
    assert sorted(found) == ["TBB", "hwy"]


def test_a_subproject_installs_nothing_and_does_not_stop_at_warnings(static_subproject):
    build, _ = static_subproject
    run("cmake", "--install", build, "--prefix", WORK / "subproject installed")
    assert not (WORK / "subproject installed").exists()
    assert "-Werror" not in (build / "build.ninja").read_text()
    assert "-Werror" in (BUILD / "build.ninja").read_text()


@pytest.fixture(scope="session")
def shared_prefix():
    """An install tree of shared libraries, moved, that a host got by FetchContent and installed."""
    build = WORK / "shared"
    result = configure_any(
        *(HOST, build, "-DCMAKE_BUILD_TYPE=Debug", "-DBUILD_SHARED_LIBS=ON"),
        *("-DWAY=FetchContent", f"-DLIGHTCULL_SOURCE={ROOT}", "-DLIGHTCULL_INSTALL=ON"),
        *("-DLIGHTCULL_RENDER=OFF", "-DLIGHTCULL_VULKAN=ON", *without(RENDER_PACKAGES)),
    )
    assert result.returncode == 0, result.stdout
    run("cmake", "--build", build)
    check_host(build / "host")
    return install(build, "shared prefix")


def test_errors_and_casts_pass_between_shared_libraries(shared_prefix):
    build, package = WORK / "host", package_folder(shared_prefix)
    # A host of shared libraries needs no package that they are made with.
    absent = without([*RENDER_PACKAGES, "hwy", "TBB", "Vulkan"])
    result = configure(HOST, build, package, "-DWAY=find_package", *absent)
    assert result.returncode == 0, result.stdout
    run("cmake", "--build", build)
    said = check_host(build / "host")
    if said:  # where the Vulkan back end is built
        uniform, culled = said
        refusal = "Vulkan: of the samplers, only culled and paper"
        assert uniform.startswith(f"uniform: {refusal}")
        assert culled.startswith("culled: Vulkan: ") and refusal not in culled


def test_a_component_that_was_not_built_is_named(shared_prefix):
    folder = package_folder(shared_prefix)
    result = configure(CONSUMER, WORK / "consumer", folder, "-DCOMPONENTS=render")
    assert result.returncode != 0
    assert "no component 'render' here; there are: base, lights" in one_line(result.stdout)


def test_shared_libraries_have_their_version_in_their_name(shared_prefix):
    names = {path.name for path in shared_prefix.rglob("liblightcull_lights.so*")}
    minor = VERSION.rsplit(".", 1)[0]
    assert names == {f"liblightcull_lights.so{end}" for end in ("", f".{minor}", f".{VERSION}")}
    (library,) = shared_prefix.rglob(f"liblightcull_lights.so.{VERSION}")
    assert f"Library soname: [liblightcull_lights.so.{minor}]" in run("readelf", "-d", library)


def symbols(option, library):
    """The names in a library by `nm`, without their arguments."""
    text = run("nm", "-C", option, library)
    return set(re.findall(r" [A-Za-z] (?:(?:vtable|typeinfo)(?: name)? for )?([^ (\[\n]+)", text))


def marked(*folders):
    """The functions and classes that headers export."""
    text = "".join(path.read_text() for folder in folders for path in folder.rglob("*.h"))
    classes = re.findall(r"^(?:class|struct) LIGHTCULL_\w*EXPORT (\w+)", text, re.M)
    functions = re.findall(r"^LIGHTCULL_\w*EXPORT [^;{(]*?(\w+)\(", text, re.M)
    return {*classes, *functions}


def inside(names):
    """The functions and classes of lightcull among names; of a member, its class."""
    return {name.split("::")[1] for name in names if name.startswith("lightcull::")}


def test_shared_libraries_export_what_headers_mark_and_no_more(shared_prefix):
    (library,) = shared_prefix.rglob(f"liblightcull_lights.so.{VERSION}")
    exported = inside(symbols("-D", library))
    lights = marked(ROOT / "core/lights") | marked(INCLUDE)
    assert exported <= lights
    assert {"Error", "LightSampler", "make_sampler", "version"} <= exported


def test_what_one_library_uses_of_another_is_marked():
    """Of all libraries, without linking shared ones: by the symbols of the static ones."""
    archives = sorted(BUILD.glob("core/*/liblightcull_*.a"))
    assert len(archives) >= 4
    marks = marked(ROOT / "core")
    wanted = {archive.stem: symbols("-u", archive) for archive in archives}
    made = {archive.stem: symbols("--defined-only", archive) for archive in archives}
    for user, maker in itertools.permutations(wanted, 2):
        used = inside(wanted[user] & made[maker])
        assert used <= marks, f"{user} of {maker}"


def pkg_config(prefix, *options):
    (file,) = prefix.rglob("lightcull-lights.pc")
    command = ["env", f"PKG_CONFIG_PATH={file.parent}", "pkg-config", "lightcull-lights"]
    assert run(*command, "--modversion").strip() == VERSION
    return shlex.split(run(*command, *options))


def test_a_host_builds_by_pkg_config_with_static_libraries(prefix):
    flags = pkg_config(prefix, "--static", "--cflags", "--libs")
    run(compiler(), "-std=c++17", HOST / "main.cpp", "-o", WORK / "static_host", *flags)
    assert check_host(WORK / "static_host") == []


def test_a_host_builds_by_pkg_config_with_shared_libraries(shared_prefix):
    flags = pkg_config(shared_prefix, "--cflags", "--libs")
    assert not any("hwy" in flag or "tbb" in flag for flag in flags)
    (folder,) = pkg_config(shared_prefix, "--variable=libdir")
    rpath = f"-Wl,-rpath,{folder}"
    run(compiler(), "-std=c++17", HOST / "main.cpp", "-o", WORK / "shared_host", *flags, rpath)
    assert check_host(WORK / "shared_host") == []


def test_a_library_of_a_host_does_not_export_the_static_one_in_it(prefix):
    library = WORK / "libhost.so"
    flags = pkg_config(prefix, "--static", "--cflags", "--libs")
    options = ["-std=c++17", "-shared", "-fPIC"]
    run(compiler(), *options, HOST / "main.cpp", "-o", library, *flags)
    assert "main" in symbols("-D", library)
    assert not inside(symbols("-D", library)) & marked(INCLUDE) - {"Error"}
