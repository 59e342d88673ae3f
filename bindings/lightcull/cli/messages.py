"""What is said beside the results: in one line each, whatever it is about."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console


def one_line(text: object) -> str:
    """What is said in one line, whatever names of files are in it."""
    return " ".join(str(text).splitlines())


@contextmanager
def warnings_to(messages: Console) -> Iterator[None]:
    """Shows warnings as lines of their own."""
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        warnings.showwarning = lambda message, *_: messages.print(
            f"lightcull: warning: {one_line(message)}", style="yellow", markup=False
        )
        yield
