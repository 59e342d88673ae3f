"""Renders that are saved, stopped in all ways, and gone on with."""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import lightcull
from conftest import Outcome, make_room
from lightcull.rendering import checkpoint

SIZE = (48, 32)
PLACE = Path(__file__).parent


def render(
    spp: int, sampler: str = "culled", *, seed: int = 3, lamps: int = 3, **options: object
) -> lightcull.RenderResult:
    return lightcull.render(
        make_room(lamps), sampler, **{"size": SIZE, "max_depth": 3, **options}, spp=spp, seed=seed
    )


@pytest.mark.parametrize("sampler", ["culled", "light_bvh", "power", "paper", "culled:sets=256", "learned"])
def test_the_same_bits_as_if_it_had_never_stopped(tmp_path: Path, sampler: str) -> None:
    file = tmp_path / "a"
    first = render(3, sampler, checkpoint=file, threads=1)
    second = render(5, sampler, resume=file, threads=2)
    whole = render(5, sampler)
    assert np.array_equal(second.image, whole.image)
    assert second.stats.spp == 5
    assert second.stats.rays == whole.stats.rays
    assert second.stats.selections == whole.stats.selections
    assert second.stats.seconds > first.stats.seconds
    assert render(5, sampler, resume=file).stats.spp == 5  # nothing is left to do
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_going_on_in_another_file_leaves_the_first(tmp_path: Path) -> None:
    render(2, checkpoint=tmp_path / "a")
    before = (tmp_path / "a").read_bytes()
    render(3, resume=tmp_path / "a", checkpoint=tmp_path / "b")
    assert (tmp_path / "a").read_bytes() == before
    assert checkpoint.read(str(tmp_path / "b"))[1].stats.passes == 3


def test_seconds_count_from_the_first_start(tmp_path: Path) -> None:
    lightcull.render(make_room(), seconds=0.3, size=SIZE, checkpoint=tmp_path / "a")
    again = lightcull.render(make_room(), seconds=0.31, size=SIZE, resume=tmp_path / "a")
    assert again.stats.seconds >= 0.31
    assert again.stats.seconds - again.stats.setup_seconds < 0.6


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"sampler": "power"}, "is of sampler 'culled', not 'power'"),
        ({"seed": 4}, "is of seed 3, not 4"),
        ({"size": (48, 33)}, "is of size 48x32, not 48x33"),
        ({"max_depth": 2}, "is of max_depth 3, not 2"),
        ({"lamps": 4}, "is of another scene 'room', or it has changed"),
        ({"spp": 1}, "has 2 samples per pixel already, and 1 were wanted"),
    ],
)
def test_a_checkpoint_of_another_render_is_refused(
    tmp_path: Path, options: dict[str, object], message: str
) -> None:
    render(2, checkpoint=tmp_path / "a")
    with pytest.raises(lightcull.Error, match=message):
        render(**{"spp": 3, "resume": tmp_path / "a", **options})


def test_a_checkpoint_of_another_scene_or_version_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    render(2, checkpoint=tmp_path / "a")
    other = make_room()
    other.name = "hall"
    with pytest.raises(lightcull.Error, match="is of scene 'room', not 'hall'"):
        lightcull.render(other, spp=3, resume=tmp_path / "a")
    monkeypatch.setattr("lightcull.machine.build_id", lambda: "9.9.9")
    with pytest.raises(lightcull.Error, match=r"is of version '\d+\.\d+\.\d+-.*', not '9\.9\.9'"):
        render(3, resume=tmp_path / "a")


def test_numbers_of_any_kind_are_those_of_the_checkpoint(tmp_path: Path) -> None:
    """Of NumPy's, and a list for a size, none would have been written, or gone on from."""
    whole = render(3)
    render(2, checkpoint=tmp_path / "a", size=list(np.array(SIZE)), max_depth=np.uint8(3))
    resumed = render(3, resume=tmp_path / "a", size=np.array(SIZE), seed=np.uint64(3))
    assert np.array_equal(resumed.image, whole.image)


def test_a_file_that_is_there_is_not_lost(tmp_path: Path) -> None:
    render(1, checkpoint=tmp_path / "a")
    with pytest.raises(lightcull.Error, match="a: is there already: resume it, or remove it"):
        render(1, checkpoint=tmp_path / "a")
    render(2, resume=tmp_path / "a", checkpoint=tmp_path / "." / "a")
    render(1, checkpoint=tmp_path / "b")
    before = (tmp_path / "b").read_bytes()
    with pytest.raises(lightcull.Error, match="b: is there already: resume it, or remove it"):
        render(3, resume=tmp_path / "a", checkpoint=tmp_path / "b")
    assert (tmp_path / "b").read_bytes() == before


def test_it_is_saved_on_the_way(tmp_path: Path) -> None:
    """As often as that was asked for."""
    file = tmp_path / "a"
    saved: list[bool] = []
    render(3, checkpoint=file, every=1e-9, progress=lambda _: saved.append(file.exists()))
    assert saved == [True] * 3
    file.unlink()
    saved.clear()
    render(3, checkpoint=file, every=1e6, progress=lambda _: saved.append(file.exists()))
    assert saved == [False] * 3
    assert file.exists()


@pytest.mark.parametrize("every", [0, -1, float("nan"), float("inf")])
def test_how_often_it_is_saved_is_a_time(tmp_path: Path, every: float) -> None:
    with pytest.raises(lightcull.Error, match="every: wanted a number above 0, got"):
        render(1, checkpoint=tmp_path / "a", every=every)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("method", ["path", "vpl_culled"])
def test_how_often_nothing_is_saved_is_an_error(method: str) -> None:
    with pytest.raises(lightcull.Error, match="^every: only with checkpoint or resume$"):
        render(1, every=5, method=method)


def test_where_it_cannot_be_saved_is_found_first(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    os.mkfifo(tmp_path / "pipe")
    for file in ("/proc/a", tmp_path, tmp_path / "file" / "a", tmp_path / "pipe"):
        with pytest.raises(lightcull.Error, match="cannot write|is a folder"):
            render(1, checkpoint=file, progress=lambda _: pytest.fail("it has been rendered"))


def test_a_damaged_checkpoint_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "a"
    render(1, checkpoint=file)
    whole = file.read_bytes()
    random = np.random.default_rng(1)
    places = [*range(0, 40), *random.integers(0, len(whole), 60)]
    for place in places:
        for damaged in (whole[:place], whole[:place] + b"\0" + whole[place + 1 :]):
            if damaged == whole:
                continue
            file.write_bytes(damaged)
            with pytest.raises(lightcull.Error, match="not a checkpoint|has been damaged"):
                render(2, resume=file)
    file.unlink()
    with pytest.raises(lightcull.Error, match="a: cannot read: No such file"):
        render(2, resume=file)


@pytest.mark.parametrize(
    "change",
    [
        lambda about: about.pop("key"),
        lambda about: about["key"].update(size=[2**31, 2**31]),
        lambda about: about["key"].update(size=[48]),
        lambda about: about["key"].update(more=1),
        lambda about: about["stats"].update(passes=-1),
        lambda about: about["stats"].update(seconds="a"),
        lambda about: about["stats"].update(seconds=-1.0),
        lambda about: about.update(setup_seconds=None),
    ],
)
def test_a_checkpoint_that_makes_no_sense_is_refused(
    tmp_path: Path, change: Callable[[dict], object]
) -> None:
    """One whose checksum is right."""
    file = tmp_path / "a"
    render(1, checkpoint=file)
    magic, _, header, sums = file.read_bytes().split(b"\n", 3)
    about = json.loads(header)
    change(about)
    rest = json.dumps(about).encode() + b"\n" + sums
    file.write_bytes(magic + b"\n" + checkpoint._checksum(rest) + b"\n" + rest)
    with pytest.raises(lightcull.Error) as caught:
        render(2, resume=file)
    assert len(str(caught.value).splitlines()) == 1


# ---- a disk that fills up ------------------------------------------------------------------------


class FullDisk:
    """No file can grow beyond so many bytes."""

    def __init__(self, limit: int) -> None:
        self._limit = limit

    def __enter__(self) -> None:
        self._before = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (self._limit, self._before[1]))

    def __exit__(self, *_: object) -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, self._before)


@pytest.mark.parametrize("limit", [0, 1, 23, 500, 4096, 36_000])
def test_a_disk_that_fills_up_at_any_byte(tmp_path: Path, limit: int) -> None:
    """The old file stays whole, the render goes on, and it is said."""
    file = tmp_path / "a"
    render(1, checkpoint=file)
    before = file.read_bytes()
    assert len(before) > 36_864
    with pytest.warns(UserWarning, match="no checkpoint was written: .*a: cannot write: "):
        with FullDisk(limit):
            result = render(2, resume=file)
    assert result.stats.spp == 2
    assert file.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


# ---- killed and interrupted ----------------------------------------------------------------------

KILLED = """
import os, random, signal, sys, time
from pathlib import Path
from lightcull.rendering import checkpoint
from test_checkpoint import render

def go_on(file):
    where = {"resume": file} if Path(file).exists() else {"checkpoint": file}
    render(10**9, every=1e-9, **where)

def saved():
    return os.stat(file).st_mtime_ns if Path(file).exists() else None

file, kills = sys.argv[1], int(sys.argv[2])
moments = random.Random(5)
passes = 0
for kill in range(kills):
    before = saved()
    child = os.fork()
    if child == 0:
        go_on(file)
    # Some are killed before they have saved anything, and some are not, however slow they are.
    while kill % 2 == 1 and saved() == before:
        time.sleep(0.001)
    time.sleep(moments.uniform(0.0, 0.12))
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    if Path(file).exists():
        now = checkpoint.read(file)[1].stats.passes
        assert now >= passes, (now, passes)
        passes = now
print(passes)
"""


def test_killed_at_fifty_random_moments(tmp_path: Path) -> None:
    """The file is whole after each, and what it ends with has the bits of one render."""
    file = tmp_path / "a"
    result = subprocess.run(
        [sys.executable, "-c", KILLED, str(file), "50"],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(PLACE), *sys.path])},
        capture_output=True, text=True, timeout=300,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    passes = int(result.stdout)
    assert passes > 10
    resumed = render(passes + 2, resume=file)
    assert np.array_equal(resumed.image, render(passes + 2).image)
    assert [path.name for path in tmp_path.iterdir()] == ["a"]  # nor anything half written


@pytest.fixture
def ctrl_c():
    """Ctrl-C as a shell in the foreground has it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield lambda: os.kill(os.getpid(), signal.SIGINT)
    signal.signal(signal.SIGINT, before)


def test_ctrl_c_once_saves(tmp_path: Path, ctrl_c: Callable[[], None]) -> None:
    def stop(step: lightcull.Progress) -> None:
        if step.spp == 2:
            ctrl_c()

    result = render(10_000_000, checkpoint=tmp_path / "a", progress=stop)
    assert result.interrupted
    assert result.stats.spp == 2
    assert checkpoint.read(str(tmp_path / "a"))[1].stats.passes == 2
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_ctrl_c_twice_leaves_the_last_checkpoint(
    tmp_path: Path, ctrl_c: Callable[[], None]
) -> None:
    render(1, checkpoint=tmp_path / "a")
    before = (tmp_path / "a").read_bytes()

    def stop(step: lightcull.Progress) -> None:
        if step.spp == 3:
            ctrl_c()
            ctrl_c()

    with pytest.raises(KeyboardInterrupt):
        render(10_000_000, resume=tmp_path / "a", progress=stop)
    assert (tmp_path / "a").read_bytes() == before


INTERRUPTED = """
import os, signal, sys
from lightcull.cli import main, progress_bars
shown = progress_bars.Bars.__call__
def show(self, progress):
    shown(self, progress)
    if progress.spp == 3:
        for _ in range({times}):
            os.kill(os.getpid(), signal.SIGINT)
progress_bars.Bars.__call__ = show
sys.exit(main())
"""


@pytest.mark.parametrize("times", [1, 2])
def test_ctrl_c_on_the_command_line(
    command: Callable[..., subprocess.CompletedProcess[str]],
    main_here: Callable[..., Outcome],
    tmp_path: Path,
    times: int,
) -> None:
    shared = ("render", "cornell", "--size", "32x24", "-o", "a.exr")
    assert main_here(*shared, "--spp", "1", "--checkpoint", "c").returncode == 0
    (tmp_path / "a.exr").unlink()
    result = command(
        *shared, "--spp", "100000", "--resume", "c", program=("-c", INTERRUPTED.format(times=times))
    )
    assert result.returncode == 130
    passes = checkpoint.read(str(tmp_path / "c"))[1].stats.passes
    if times == 1:
        assert passes == 3
        assert result.stdout.splitlines()[-1].endswith(", interrupted")
    else:
        assert passes == 1
        assert "stopped at once: c is as it was saved last" in result.stderr
    assert (tmp_path / "a.exr").exists() == (times == 1)
    done = main_here(*shared, "--spp", "5", "--resume", "c")
    assert done.returncode == 0, done.stderr
    whole = lightcull.render(lightcull.example_scene("cornell"), spp=5, size=(32, 24))
    assert np.array_equal(lightcull.read_image(tmp_path / "a.exr"), whole.image)
