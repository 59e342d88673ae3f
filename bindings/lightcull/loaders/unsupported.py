"""What a file has that cannot be had here."""

from __future__ import annotations

from collections import Counter


class UnsupportedWarning(UserWarning):
    """A file has things that are not supported; they are named, and were left out or shown as
    something near.
    """


class Notes:
    """Collects what loading a file left out or made up, for one warning."""

    def __init__(self) -> None:
        self.has_camera = False
        self.has_light = False
        self._left_out: Counter[str] = Counter()
        self._approximated: Counter[str] = Counter()
        self._remarks: list[str] = []

    def left_out(self, thing: str, count: int = 1) -> None:
        """Notes so many things that are not supported."""
        if count > 0:
            self._left_out[thing] += count

    def approximated(self, thing: str, count: int = 1) -> None:
        """Notes so many things that are shown as something else: "one thing as another"."""
        if count > 0:
            self._approximated[thing] += count

    def remark(self, text: str) -> None:
        """Notes anything else that the user should know of."""
        self._remarks.append(text)

    def left_out_text(self) -> str:
        """What was left out, in one line; nothing if that is nothing."""
        return _listed("not supported and left out: ", self._left_out)

    def message(self) -> str:
        """One line, or nothing if there is nothing to say."""
        parts = [self.left_out_text(), _listed("shown as far as can be: ", self._approximated)]
        return "; ".join([part for part in parts if part] + self._remarks)


def _listed(title: str, things: Counter[str]) -> str:
    if not things:
        return ""
    return title + ", ".join(f"{thing} ({count})" for thing, count in things.items())
