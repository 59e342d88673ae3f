"""The files that a file names."""

from __future__ import annotations

from pathlib import Path

from .unsupported import Notes


class Neighbours:
    """Finds files by the names that stand in another, which may come from another system: with
    backslashes, in other cases, or with a folder that is not there.
    """

    def __init__(self, path: Path, notes: Notes) -> None:
        self._folder = path.parent
        self._notes = notes

    def find(self, name: str) -> Path | None:
        """The file, or None with a note."""
        try:
            for candidate in self._candidates(name):
                if candidate.is_file():  # a pipe may never end
                    return candidate
        except (OSError, ValueError):  # no name of a file
            pass
        self._notes.left_out(f"missing file {_short(name)!r}")
        return None

    def read(self, name: str) -> bytes | None:
        """What is in the file, or None with a note."""
        path = self.find(name)
        try:
            return None if path is None else path.read_bytes()
        except OSError:
            self._notes.left_out(f"file {_short(name)!r} that cannot be read")
            return None

    def _candidates(self, name: str) -> list[Path]:
        slashes = name.strip().replace("\\", "/")
        bare = slashes.rsplit("/", 1)[-1]
        return [
            self._folder / name,
            self._folder / slashes,
            *self._in_any_case(slashes),
            *self._in_any_case(bare),
        ]

    def _in_any_case(self, name: str) -> list[Path]:
        *folders, bare = name.split("/")
        folder = self._folder.joinpath(*folders)
        if not bare or not folder.is_dir():
            return []
        return [p for p in sorted(folder.iterdir()) if p.name.lower() == bare.lower()]


def _short(name: str) -> str:
    return name if len(name) <= 100 else f"{name[:100]}..."
