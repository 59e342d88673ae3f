"""The command `lightcull`."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from rich.console import Console

from .._core import Error
from .commands import COMMANDS
from .options import make_parser
from .texts import one_line

_ERROR, _INTERRUPTED = 1, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line and returns its exit code: 0, 1 error, 2 usage, 130 interrupted."""
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    messages = Console(stderr=True, highlight=False, soft_wrap=True)
    try:
        options = make_parser().parse_args(arguments)
        completed = COMMANDS[options.command](options, arguments, messages)
        return 0 if completed else _INTERRUPTED
    except KeyboardInterrupt as stop:
        reason = one_line(stop) or "interrupted before there was anything to save"
        messages.print(f"lightcull: {reason}", markup=False)
        return _INTERRUPTED
    except MemoryError:
        messages.print("lightcull: error: there is not enough memory", style="red", markup=False)
        return _ERROR
    except (Error, OSError) as error:
        messages.print(f"lightcull: error: {one_line(error)}", style="red", markup=False)
        return _ERROR
