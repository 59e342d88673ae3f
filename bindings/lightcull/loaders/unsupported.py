"""What a file has that cannot be had here."""

from __future__ import annotations

from collections import Counter


class UnsupportedWarning(UserWarning):
    """A file has things that are not supported; they are named and were left out."""


class Notes:
    """Collects what loading a file left out or made up, for one warning."""

    def __init__(self) -> None:
        self.has_camera = False
        self.has_light = False
        self._left_out: Counter[str] = Counter()
        self._remarks: list[str] = []

    def left_out(self, thing: str, count: int = 1) -> None:
        """Notes so many things that are not supported."""
        if count > 0:
            self._left_out[thing] += count

    def remark(self, text: str) -> None:
        """Notes anything else that the user should know of."""
        self._remarks.append(text)

    def message(self) -> str:
        """One line, or nothing if there is nothing to say."""
        parts = []
        if self._left_out:
            things = [f"{thing} ({count})" for thing, count in self._left_out.items()]
            parts.append(f"not supported and left out: {', '.join(things)}")
        return "; ".join(parts + self._remarks)
