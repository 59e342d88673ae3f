"""Progress bars."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Timer
from types import TracebackType

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, TaskID, TaskProgressColumn, TextColumn
from rich.progress import Progress as RichProgress

from ..rendering.progress import Progress


PATIENCE = 1.0
"""Seconds of work without a word."""


@contextmanager
def reading(name: str) -> Iterator[None]:
    """Says at a terminal that a file is being read, where that takes long."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield
        return
    status = console.status(f"reading {escape(name)}")
    said = Timer(PATIENCE, status.start)
    said.daemon = True
    said.start()
    try:
        yield
    finally:
        said.cancel()
        said.join()
        status.stop()


class Bars:
    """A bar for each stage, and the time left for all. A progress callback."""

    def __init__(self, console: Console) -> None:
        self._bars = RichProgress(
            TextColumn("{task.description}"),
            BarColumn(),
            TaskProgressColumn(),
            TextColumn("{task.fields[spp]:>6} spp"),
            TextColumn("{task.fields[left]} left"),
            console=console,
            refresh_per_second=4,
        )
        self._tasks: dict[str, TaskID] = {}

    def __enter__(self) -> Bars:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._tasks:
            self._bars.stop()

    def __call__(self, progress: Progress) -> None:
        left = _clock(progress.seconds_left)
        self._bars.start()  # not before there is anything to show: errors come alone
        if progress.stage not in self._tasks:
            self._tasks[progress.stage] = self._bars.add_task(
                progress.stage, total=1.0, spp=0, left=left
            )
        self._bars.update(
            self._tasks[progress.stage], completed=progress.fraction, spp=progress.spp
        )
        for task in self._tasks.values():
            self._bars.update(task, left=left)


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02}"
