"""Renders that are shared out: real schedulers and workers, that come, go and are killed."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("distributed", reason="lightcull[cluster] is not installed")

import dask  # noqa: E402
import distributed  # noqa: E402
import psutil  # noqa: E402

import lightcull  # noqa: E402
from cluster_processes import Processes  # noqa: E402
from conftest import Outcome, make_room  # noqa: E402
from lightcull.rendering import checkpoint  # noqa: E402
from lightcull.rendering.cluster import flow  # noqa: E402
from lightcull.scene_record import recording  # noqa: E402

SIZE = (48, 32)
CHUNK = 4


def scene() -> lightcull.Scene:
    """One over whose lights `learned` learns, that can be sent."""
    with recording():
        return make_room(24)


def render(
    cluster: object = None, spp: int = 24, sampler: str = "learned:rounds=6", **options: object
) -> lightcull.RenderResult:
    chosen = {"scene": scene(), "size": SIZE, "max_depth": 3, "seed": 3, "chunk": CHUNK, **options}
    return lightcull.render(sampler=sampler, spp=spp, cluster=cluster, **chosen)


def same_bits(a: lightcull.RenderResult, b: lightcull.RenderResult) -> bool:
    return a.image.tobytes() == b.image.tobytes() and a.stats.rays == b.stats.rays


@pytest.fixture(scope="module")
def cluster() -> Iterator[Processes]:
    """A scheduler, and workers as tests start them."""
    processes = Processes()
    yield processes
    processes.close()


@pytest.fixture
def workers(cluster: Processes) -> Callable[[int], str]:
    """So many workers of the cluster, and the address of its scheduler."""

    def start(count: int) -> str:
        while len(cluster.workers) < count:
            cluster.start_worker()
        while len(cluster.workers) > count:
            cluster.kill(cluster.workers[-1])
        return cluster.scheduler

    return start


# ---- chunks on one machine -----------------------------------------------------------------------


@pytest.mark.parametrize("sampler", ["learned:rounds=6", "culled", "power"])
def test_chunks_of_one_pass_are_a_plain_render(tmp_path: Path, sampler: str) -> None:
    """And those of more are one but for rounding, on any number of threads."""
    plain = render(sampler=sampler, chunk=None)
    assert same_bits(plain, render(sampler=sampler, chunk=1))
    chunks = render(sampler=sampler, chunk=5)
    assert np.allclose(chunks.image, plain.image, rtol=1e-6)
    assert chunks.stats.rays == plain.stats.rays
    assert chunks.stats.spp == 24  # the last chunk is shorter
    assert same_bits(chunks, render(sampler=sampler, chunk=5, threads=1))


def test_a_resumed_render_in_chunks_has_the_same_bits(tmp_path: Path) -> None:
    """Also where it had ended with a shorter chunk."""
    whole = render(spp=22)
    for first in (3, 8, 18):
        file = tmp_path / str(first)
        render(spp=first, checkpoint=file)
        assert checkpoint.read(str(file))[1].stats.passes == first // CHUNK * CHUNK
        assert same_bits(render(spp=22, resume=file), whole)
    with pytest.raises(lightcull.Error, match="is of chunk 4, not 5"):
        render(spp=22, chunk=5, resume=tmp_path / "8")


# ---- the same bits -------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 2, 5])
@pytest.mark.parametrize("sampler", ["learned:rounds=6", "culled"])
def test_the_same_bits_for_any_number_of_workers(
    workers: Callable[[int], str], count: int, sampler: str
) -> None:
    shared = render(workers(count), spp=26, sampler=sampler)
    assert same_bits(shared, render(spp=26, sampler=sampler))
    assert shared.stats.spp == 26
    assert not shared.interrupted


def test_workers_have_what_was_learned() -> None:
    """The twin of the test above: bits are others where workers begin with an empty sampler."""
    from lightcull.rendering.chunk import Chunk
    from lightcull.rendering.path_job import PathJob
    from lightcull.rendering.settings import RenderSettings

    settings = RenderSettings(SIZE, 3, 3, 1)
    knows, fresh = (PathJob(scene(), "learned:rounds=6", settings) for _ in range(2))
    assert knows.learning
    knows.render_chunk(Chunk(0, 8))
    assert not knows.learning
    sums = knows.render_chunk(Chunk(12, 2)).sums
    assert not np.array_equal(fresh.render_chunk(Chunk(12, 2)).sums, sums)
    fresh.take_learned(knows.learned())
    fresh.render_chunk(Chunk(20, 1))  # the order does not matter
    assert np.array_equal(fresh.render_chunk(Chunk(12, 2)).sums, sums)


def test_a_client_of_ones_own_and_the_default_sampler(workers: Callable[[int], str]) -> None:
    with distributed.Client(workers(2), set_as_default=False) as client:
        opened = lightcull.open_scene("cornell")
        shared = lightcull.render(opened, spp=40, size=SIZE, cluster=client)
        assert shared.sampler == "learned:rounds=32"
        assert client.status == "running"
        while client.futures:  # what was released is so soon
            time.sleep(0.01)
    here = lightcull.render(opened, shared.sampler, spp=40, size=SIZE, chunk=16)
    assert same_bits(shared, here)


# ---- scenes --------------------------------------------------------------------------------------


def everything() -> lightcull.Scene:
    """A scene of all kinds of things, moved since."""
    made = make_room(5)
    texels = np.random.default_rng(1).integers(0, 255, (4, 4, 3)).astype(np.uint8)
    texture = made.add_texture(texels)
    metal = made.add_material("metallic_roughness", np.float32([0.5, 0.4, 0.3]), 1.0, 0.3, texture)
    corners = np.array([[-1, 0.2, 0], [1, 0.2, 0], [0, 1.2, 0.3]])
    made.add_mesh(
        corners, np.array([[0, 1, 2]]), uvs=np.zeros((3, 2)), normals=corners, material=metal
    )
    made.add_point_light([0, 1, 1], (1, 2, 3))
    made.add_spot_light((1, 2, 1), np.array([0, -1, 0.1]), [4, 4, 4], 0.3, 0.7)
    made.add_directional_light((0.1, -1, 0), (0.1, 0.1, 0.1))
    made.set_environment((0.1, 0.2, 0.3), np.float32(0.5), 0.3)
    made.lights()  # closes it
    made.set_light_positions(np.array([[0.3, 1, 1], [1, 2, 1.2]]))
    made.closed()
    made.set_light_directions(np.array([[0, -1, 0.0], [0, -1, 0.2]]))
    return made


def test_a_scene_comes_out_of_its_record_as_it_was() -> None:
    from lightcull.rendering.cluster.scene_transport import bytes_of, from_bytes

    with recording():
        made = everything()
    again = from_bytes(bytes_of(made), made.name, made.digest())
    options = {"size": SIZE, "max_depth": 4, "spp": 2}
    for sampler in ("culled", "learned"):
        images = [lightcull.render(s, sampler, **options).image for s in (made, again)]
        assert np.array_equal(*images)
    assert np.array_equal(made.lights(), again.lights())
    with pytest.raises(lightcull.Error, match="what was sent of it makes another one"):
        from_bytes(bytes_of(made), made.name, "0")


def test_every_step_that_a_digest_knows_is_recorded() -> None:
    """So that what is new in scenes is not forgotten here."""
    from lightcull.scene import Scene

    source = Path(sys.modules[Scene.__module__].__file__ or "").read_text()
    methods = source.split("    def ")
    steps = [before for before, body in zip(methods, methods[1:]) if "self._digest.add(" in body]
    assert len(steps) > 8
    assert all(step.rstrip().endswith("@recorded") for step in steps)


def test_arrays_are_recorded_as_they_were_given() -> None:
    made = lightcull.Scene("a", recorded=True)
    corners = np.zeros((3, 3), np.float32)
    corners[1, 0] = corners[2, 1] = 1
    made.add_mesh(corners, np.array([[0, 1, 2]], np.uint32))
    digest = made.digest()
    corners += 1
    from lightcull.rendering.cluster.scene_transport import bytes_of, from_bytes

    assert from_bytes(bytes_of(made), "a", digest).digest() == digest


def test_a_scene_of_which_nobody_kept_a_record_is_refused(workers: Callable[[int], str]) -> None:
    message = r"scene 'room' cannot be sent: make it by Scene\(recorded=True\), or open it"
    with pytest.raises(lightcull.Error, match=message):
        render(workers(1), scene=make_room())
    changed = lightcull.open_scene("cornell")
    changed.add_point_light((0, 0, 0), (1, 1, 1))
    with pytest.raises(lightcull.Error, match="scene 'cornell' cannot be sent"):
        render(workers(1), scene=changed)


LACKS_FILES = """
import lightcull
from lightcull.loaders import reopen
def lacks(*arguments, **keywords):
    raise lightcull.Error("no such file")
reopen.open_scene = lacks
"""
OTHER_SCENE = """
import lightcull
from lightcull.loaders import reopen
reopen.open_scene = lambda *arguments, **keywords: lightcull.open_scene("lanterns")
"""


@pytest.mark.parametrize("before", [LACKS_FILES, OTHER_SCENE])
def test_a_worker_that_lacks_the_file_is_sent_the_scene(
    workers: Callable[[int], str], cluster: Processes, before: str
) -> None:
    address = workers(0)
    cluster.start_worker(before)
    opened = lightcull.open_scene("cornell")
    shared = render(address, scene=opened, sampler="culled")
    assert same_bits(shared, render(scene=opened, sampler="culled"))
    workers(0)


# ---- workers that come, go and die ---------------------------------------------------------------


def test_workers_are_killed_at_twenty_random_moments() -> None:
    """Nothing is lost or counted twice: bits and rays are those of one machine."""
    moments = random.Random(11)
    processes = Processes()
    for _ in range(3):
        processes.start_worker()
    kills = 0

    def kill_one(step: lightcull.Progress) -> None:
        nonlocal kills
        if kills == 20:
            return
        kills += 1
        time.sleep(moments.uniform(0, 0.15))
        processes.kill(moments.choice(processes.workers))
        processes.start_worker()

    options = {"spp": 24 * CHUNK, "sampler": "culled", "size": (96, 64)}
    shared = render(processes.scheduler, progress=kill_one, **options)
    processes.close()
    assert kills == 20
    assert same_bits(shared, render(**options))


def test_the_only_worker_dies_and_another_comes(
    workers: Callable[[int], str], cluster: Processes
) -> None:
    address = workers(1)

    def replace(step: lightcull.Progress) -> None:
        if step.spp == 2 * CHUNK:
            workers(0)
            workers(1)

    shared = render(address, sampler="culled", progress=replace)
    assert same_bits(shared, render(sampler="culled"))


def test_a_scheduler_that_is_killed_leaves_a_checkpoint(tmp_path: Path) -> None:
    processes = Processes()
    processes.start_worker()
    file = tmp_path / "a"

    def kill(step: lightcull.Progress) -> None:
        if step.spp == 12:
            processes.kill(processes.scheduler)

    with pytest.raises(lightcull.Error) as caught:
        render(processes.scheduler, spp=4000, checkpoint=file, progress=kill)
    processes.close()
    message = f"cluster: the connection to the scheduler is lost; what there is can be gone on from: --resume {file}"
    assert str(caught.value) == message
    passes = checkpoint.read(str(file))[1].stats.passes
    assert passes >= 12
    assert same_bits(render(spp=passes + 6, resume=file), render(spp=passes + 6))


OTHER_BUILD = "from lightcull import machine; machine.build_id = lambda: '9.9.9-other'"


def test_a_worker_of_another_build_is_refused_by_name(
    workers: Callable[[int], str], cluster: Processes
) -> None:
    address = workers(0)
    other = cluster.start_worker(OTHER_BUILD)
    message = rf"worker {other} is left out: it has lightcull 9.9.9-other, not \d.\d.\d-"
    with pytest.warns(UserWarning, match=message), pytest.raises(
        lightcull.Error, match=f"cluster: no worker is left: {other}: it has lightcull 9.9.9-other"
    ):
        render(address, sampler="culled")
    cluster.start_worker()
    with pytest.warns(UserWarning, match=message):
        shared = render(address, sampler="culled")
    assert same_bits(shared, render(sampler="culled"))
    workers(0)


LITTLE_MEMORY = """
import resource
from pathlib import Path
from lightcull import memory
from lightcull.rendering.path_job import PathJob
make = PathJob.__init__
def make_with_little(*arguments):
    size = memory.of_process("VmSize")
    resource.setrlimit(resource.RLIMIT_AS, (size + 2**24, resource.RLIM_INFINITY))
    try:
        make(*arguments)
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        Path({tried!r}).touch()
PathJob.__init__ = make_with_little
"""
LETS_IT_TRY = """
import time
from pathlib import Path
from lightcull.rendering.path_job import PathJob
make = PathJob.__init__
def make_later(*arguments):
    while not Path({tried!r}).exists():
        time.sleep(0.01)
    make(*arguments)
PathJob.__init__ = make_later
"""
DIES = """
import os, signal
from lightcull.rendering.path_job import PathJob
PathJob.render_chunk = lambda *arguments: os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_worker_without_memory_is_left_out(
    workers: Callable[[int], str], cluster: Processes, tmp_path: Path
) -> None:
    """The others do what it could not."""
    address, tried = workers(0), str(tmp_path / "tried")
    cluster.start_worker(LETS_IT_TRY.format(tried=tried))
    small = cluster.start_worker(LITTLE_MEMORY.format(tried=tried))
    options = {"sampler": "uniform", "size": (1600, 1200), "max_depth": 1, "spp": 4, "chunk": 1}
    with pytest.warns(UserWarning, match=f"worker {small} is left out: it has not enough memory"):
        shared = render(address, **options)
    assert shared.stats.spp == 4
    workers(0)


def test_workers_that_all_die_of_a_chunk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As those do that the system kills for want of memory."""
    monkeypatch.setattr(flow, "_TRIES", 1)
    processes = Processes(DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="0")
    dies = processes.start_worker(DIES)
    message = f"cluster: passes 0 to 3: all workers died of them, {dies} last: is there enough memory?"
    with pytest.raises(lightcull.Error) as caught:
        render(processes.scheduler, sampler="culled")
    processes.close()
    assert str(caught.value) == message


def test_nobody_is_there_for_long(
    workers: Callable[[int], str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("lightcull.rendering.cluster.pool._PATIENCE", 0.5)
    with pytest.raises(lightcull.Error, match="cluster: there has been no worker for 0 s"):
        render(workers(0), sampler="culled")


# ---- long renders --------------------------------------------------------------------------------


def tasks_at(dask_scheduler: distributed.Scheduler) -> int:
    """How many the scheduler knows."""
    return len(dask_scheduler.tasks)


def test_a_thousand_chunks_do_not_grow(workers: Callable[[int], str], cluster: Processes) -> None:
    """Of 0.46 MB each: neither here, nor where they are rendered, nor at the scheduler."""
    address = workers(2)
    pids = [os.getpid(), *map(cluster.pid, [address, *cluster.workers])]
    sizes: dict[int, list[int]] = {}
    tasks: list[int] = []

    with distributed.Client(address, set_as_default=False) as client:

        def look(step: lightcull.Progress) -> None:
            if step.spp % 100 == 0:
                tasks.append(client.run_on_scheduler(tasks_at))
            if step.spp in (200, 1000):
                sizes[step.spp] = [psutil.Process(pid).memory_info().rss for pid in pids]

        options = {"sampler": "uniform", "size": (160, 120), "max_depth": 2, "chunk": 1, "spp": 1000}
        shared = render(client, progress=look, **options)
    assert shared.stats.spp == 1000
    # Two for each worker; those that were taken may not be forgotten yet.
    assert max(tasks) <= 8, tasks
    growth = [after - before for before, after in zip(sizes[200], sizes[1000], strict=True)]
    assert max(growth) < 60 * 2**20, growth  # all that was rendered since is 368 MB
    assert same_bits(shared, render(**options))


def test_it_is_saved_and_resumed_here_and_there(
    workers: Callable[[int], str], tmp_path: Path
) -> None:
    """While it learns, and after that."""
    whole = render(spp=24)
    for first in (4, 12, 18):
        file = tmp_path / f"{first}"
        render(workers(2), spp=first, checkpoint=file)
        assert same_bits(render(spp=24, resume=file, checkpoint=tmp_path / f"{first}b"), whole)
        assert same_bits(render(workers(1), spp=24, resume=file), whole)


def test_progress_tells_of_chunks(workers: Callable[[int], str]) -> None:
    steps: list[lightcull.Progress] = []
    render(workers(2), sampler="culled", progress=steps.append)
    assert [step.spp for step in steps] == [4, 8, 12, 16, 20, 24]
    assert [step.fraction for step in steps] == [spp / 24 for spp in range(4, 25, 4)]
    assert steps[-1].seconds_left == 0 < steps[0].seconds_left


def test_seconds_are_those_of_a_clock(workers: Callable[[int], str]) -> None:
    result = render(workers(2), None, sampler="culled", seconds=0.5)
    assert 0.5 <= result.stats.seconds
    assert result.stats.spp % CHUNK == 0 < result.stats.spp


def test_ctrl_c_keeps_what_there_is(workers: Callable[[int], str], tmp_path: Path) -> None:
    address = workers(2)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)

    def stop(step: lightcull.Progress) -> None:
        if step.spp == 12:
            os.kill(os.getpid(), signal.SIGINT)

    try:
        result = render(address, 100_000, checkpoint=tmp_path / "a", progress=stop)
    finally:
        signal.signal(signal.SIGINT, before)
    assert result.interrupted
    assert result.stats.spp == 12
    assert same_bits(render(spp=16, resume=tmp_path / "a"), render(spp=16))


# ---- frames --------------------------------------------------------------------------------------

OBJ = """
mtllib shot.mtl
v -2 0 -2
v 2 0 -2
v 2 0 2
v -2 0 2
v {x} 2 -0.5
v {x} 2 0.5
v 1.5 2 0
usemtl floor
f 1 4 3 2
usemtl lamp
f 5 7 6
"""
MTL = "newmtl floor\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0 0 0\nKe 8 8 8\n"
FRAMES = ("--size", "32x24", "--sampler", "culled", "--spp", "4", "--threads", "1")
CAMERA = ("--camera-from", "0,3,5", "--camera-to", "0,0,0")


@pytest.fixture
def shots(tmp_path: Path) -> Path:
    """A folder with numbered files in which a lamp moves."""
    (tmp_path / "shot.mtl").write_text(MTL)
    for number in (7, 8, 9, 10):
        (tmp_path / f"shot.{number:03}.obj").write_text(OBJ.format(x=-0.1 * number))
    return tmp_path


def image_bytes(folder: Path, *names: str) -> list[bytes]:
    return [lightcull.read_image(folder / name).tobytes() for name in names]


def test_numbered_files_are_frames(
    workers: Callable[[int], str], main_here: Callable[..., Outcome], shots: Path
) -> None:
    """Each is what it is when it is rendered alone, here and there."""
    frames = ("render", "shot.###.obj", *FRAMES, *CAMERA, "--frames", "7:10")
    shared = main_here(*frames, "-o", "out/a##.exr", "--cluster", workers(2))
    assert shared.returncode == 0, shared.stderr
    assert shared.stdout.startswith("out/a##.exr: 4 frames in ")
    assert main_here(*frames, "-o", "b.#.exr").returncode == 0
    images = image_bytes(shots, *(f"out/a{number:02}.exr" for number in (7, 8, 9, 10)))
    assert images == image_bytes(shots, *(f"b.{number}.exr" for number in (7, 8, 9, 10)))
    assert len(set(images)) == 4
    alone = main_here("render", "shot.009.obj", *FRAMES, *CAMERA, "-o", "c.exr")
    assert alone.returncode == 0, alone.stderr
    assert image_bytes(shots, "c.exr") == images[2:3]


def test_a_camera_path_is_frames(
    workers: Callable[[int], str], main_here: Callable[..., Outcome], tmp_path: Path
) -> None:
    cameras = {
        str(number): {"from": [0, 1, 2 + number / 4], "to": [0, 1, 0], "up": [0, 1, 0], "fov": 40}
        for number in range(3)
    }
    (tmp_path / "path.json").write_text(json.dumps(cameras))
    frames = ("render", "cornell", *FRAMES, "--camera-path", "path.json")
    result = main_here(*frames, "--frames", "0:2", "--cluster", workers(2), "-o", "a#.exr")
    assert result.returncode == 0, result.stderr
    view = ("--camera-from", "0,1,2.25", "--camera-to", "0,1,0", "--camera-up", "0,1,0", "--fov", "40")
    assert main_here("render", "cornell", *FRAMES, *view, "-o", "b.exr").returncode == 0
    images = image_bytes(tmp_path, "a0.exr", "a1.exr", "a2.exr", "b.exr")
    assert images[1] == images[3]
    assert len(set(images)) == 3
    missing = main_here(*frames, "--frames", "0:3", "-o", "a#.exr")
    assert "path.json: has no camera for frame 3" in missing.stderr


def test_frames_whose_files_workers_lack_or_have_otherwise(
    workers: Callable[[int], str],
    cluster: Processes,
    main_here: Callable[..., Outcome],
    shots: Path,
) -> None:
    address = workers(0)
    other = cluster.start_worker(
        "from lightcull.rendering.frame_series import FrameSeries\n"
        "FrameSeries.file_hash = lambda *_: ''"
    )
    frames = ("render", "shot.###.obj", *FRAMES, *CAMERA, "--frames", "7:8", "-o", "a#.exr")
    result = main_here(*frames, "--cluster", address)
    assert result.returncode == 1
    assert f"worker {other} is left out: {shots}/shot.007.obj: is not there, or another" in result.stderr
    assert result.stderr.rstrip().endswith("go on with --frames 7:8")
    workers(0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--frames", "1:2", "-o", "a.exr"), "a.exr: wanted signs # in it"),
        (("--frames", "1:2", "--checkpoint", "c"), "--checkpoint: not with --frames"),
        (("--frames", "1:2", "--method", "vpl_all"), "--frames: for paths in scenes of ours only"),
        (("--camera-path", "a.json"), "--camera-path: only with --frames"),
        (("--frames", "1:2", "--camera-path", "a.json"), "a.json: cannot read: No such file"),
        (("--frames", "1:2", "--camera-path", "b.json"), "b.json: is no camera path: 'too' is unknown"),
    ],
)
def test_frames_that_make_no_sense(
    main_here: Callable[..., Outcome], tmp_path: Path, arguments: tuple[str, ...], message: str
) -> None:
    (tmp_path / "b.json").write_text('{"1": {"from": [0, 0, 1], "too": [0, 0, 0]}}')
    result = main_here("render", "cornell", *arguments)
    assert result.returncode == 1
    assert message in result.stderr
    assert main_here("render", "cornell", "--frames", "2:1").returncode == 2


# ---- the command, and what is refused ------------------------------------------------------------


def test_the_command_on_workers_of_this_machine(
    command: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path
) -> None:
    shared = ("render", "cornell", "--sampler", "culled", "--size", "48x32", "--spp", "20")
    chunk = ("--chunk", "8")
    assert command(*shared, *chunk, "-o", "a.exr").returncode == 0
    result = command(*shared, *chunk, "-o", "b.exr", "--cluster", "local:2")
    assert result.returncode == 0, result.stderr
    images = [lightcull.read_image(tmp_path / name).tobytes() for name in ("a.exr", "b.exr")]
    assert images[0] == images[1]


CTRL_C = """
import os, signal, sys, time
from lightcull.rendering.cluster.connection import connected
if __name__ == "__main__":
    os.setsid()
    with connected("local:1") as client:
        before = client.submit(os.getpid, pure=False).result()
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        os.killpg(0, signal.SIGINT)
        client.submit(time.sleep, 0.5).result(timeout=60)
        assert client.submit(os.getpid, pure=False).result(timeout=60) == before
"""


def test_ctrl_c_at_a_terminal_leaves_workers_alone(
    command: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path
) -> None:
    """It reaches them, too, and the client may wait for what they do."""
    (tmp_path / "program.py").write_text(CTRL_C)
    result = command(program=("program.py",))
    assert result.returncode == 0, result.stderr


def test_a_scheduler_that_is_killed_is_one_line_of_the_command(
    main_here: Callable[..., Outcome], monkeypatch: pytest.MonkeyPatch
) -> None:
    from lightcull.cli import progress_bars

    processes = Processes()
    processes.start_worker()
    monkeypatch.setattr(
        progress_bars.Bars, "__call__", lambda bars, step: processes.kill(processes.scheduler)
    )
    result = main_here(
        "render", "cornell", "--sampler", "culled", "--size", "48x32", "--spp", "4096",
        "--cluster", processes.scheduler, "--checkpoint", "c",
    )  # fmt: skip
    processes.close()
    assert result.returncode == 1
    assert result.stderr == (
        "lightcull: error: cluster: the connection to the scheduler is lost; what there is can be "
        "gone on from: --resume c\n"
    )


def test_a_reference_is_shared(workers: Callable[[int], str], tmp_path: Path) -> None:
    """Emission apart, in the same bits as here, and the next comparison has it kept."""
    opened = lightcull.open_scene("cornell")
    options = {"size": SIZE, "spp": 8, "chunk": CHUNK}
    first = lightcull.compare(opened, ["power"], cluster=workers(2), **options)
    assert first.reference.sampler == "learned:rounds=32"
    from lightcull.rendering.chunk_job import ChunkJob, LocalChunks
    from lightcull.rendering.path_job import PathJob
    from lightcull.rendering.settings import RenderSettings

    for half, seed in enumerate((0x52454641, 0x52454642)):
        settings = RenderSettings(SIZE, 2, seed, 0, emission_apart=True)
        job = PathJob(opened, "learned:rounds=32", settings)
        here = ChunkJob("learned:rounds=32", settings, LocalChunks(job), 0.0, CHUNK, 32)
        while here.stats().spp < 32:
            here.render_pass()
        assert np.array_equal(first.reference.halves[half], here.image())
        assert np.array_equal(first.reference.emission[half], here.emission())
        assert np.array_equal(first.reference.lit[half], here.lit())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        again = lightcull.compare(opened, ["power"], cluster=workers(0), **options)
    assert np.array_equal(again.reference.halves, first.reference.halves)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"method": "vpl_culled", "cluster": "local:2"}, "cluster and chunk: not for vpl_culled"),
        ({"method": "vpl_culled", "chunk": 2}, "cluster and chunk: not for vpl_culled"),
        ({"chunk": 0}, "chunk: wanted a whole number from 1 up, got 0"),
        ({"cluster": "tcp://127.0.0.1:9"}, "cluster: tcp://127.0.0.1:9: no scheduler answers"),
        ({"cluster": "nonsense://x"}, "cluster: nonsense://x: no scheduler answers"),
        ({"cluster": "local:0"}, "cluster: local:0: no scheduler answers"),
    ],
)
def test_what_cannot_be_shared(
    monkeypatch: pytest.MonkeyPatch, options: dict[str, object], message: str
) -> None:
    monkeypatch.setattr("lightcull.rendering.cluster.connection._PATIENCE", 0.5)
    with pytest.raises(lightcull.Error, match=message):
        lightcull.render(scene(), "culled", spp=1, size=SIZE, max_depth=3, **options)


def test_no_cluster_at_all(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(TypeError, match="cluster: wanted an address or a distributed.Client, got 4"):
        render(4)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(lightcull.Error, match=r"wants Dask: pip install 'lightcull\[cluster\]'"):
        render("local:2")


TLS_SCHEDULER = """
import asyncio, sys
import distributed
from distributed.security import Security
key, certificate = sys.argv[1:]
security = Security(
    tls_ca_file=certificate, require_encryption=True,
    **{f"tls_{who}_{what}": file for who in ("scheduler", "worker", "client")
       for what, file in (("key", key), ("cert", certificate))},
)
async def main():
    host = {"host": "tls://127.0.0.1", "security": security}
    async with distributed.Scheduler(port=0, dashboard=False, **host) as scheduler:
        async with distributed.Worker(scheduler.address, nthreads=1, dashboard=False, **host):
            print(scheduler.address, flush=True)
            await scheduler.finished()
asyncio.run(main())
"""


@pytest.mark.skipif(shutil.which("openssl") is None, reason="there is no openssl")
def test_certificates_of_dask_s_configuration_are_used(tmp_path: Path) -> None:
    """And a client without them is not let in."""
    key, certificate = str(tmp_path / "key.pem"), str(tmp_path / "certificate.pem")
    make = ("openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes")
    names = ("-subj", "/CN=lightcull", "-keyout", key, "-out", certificate)
    subprocess.run([*make, *names], check=True, capture_output=True)
    scheduler = subprocess.Popen(
        [sys.executable, "-c", TLS_SCHEDULER, key, certificate],
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )  # fmt: skip
    assert scheduler.stdout is not None
    address = scheduler.stdout.readline().strip()
    assert address.startswith("tls://127.0.0.1:")
    settings = {"client.key": key, "client.cert": certificate, "ca-file": certificate}
    config = {f"distributed.comm.tls.{name}": value for name, value in settings.items()}
    with dask.config.set({**config, "distributed.comm.require-encryption": True}):
        shared = render(address, sampler="culled")
    assert same_bits(shared, render(sampler="culled"))
    with pytest.raises(lightcull.Error, match="cluster: tls://.*: no scheduler answers: .*TLS"):
        render(address, sampler="culled")
    scheduler.kill()
    scheduler.wait()


def test_nothing_listens_beyond_loopback() -> None:
    from lightcull.rendering.cluster.connection import connected

    with connected("local:1") as client:
        (worker,) = client.nthreads()
        pids = [os.getpid(), client.submit(os.getpid).result()]
        listening = [
            connection.laddr.ip
            for pid in pids
            for connection in psutil.Process(pid).net_connections(kind="tcp")
            if connection.status == psutil.CONN_LISTEN
        ]
    assert worker.startswith("tcp://127.0.0.1:")
    assert listening and set(listening) <= {"127.0.0.1"}
