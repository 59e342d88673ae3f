"""The command `lightcull`."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from rich.console import Console

from .._core import Error
from . import (
    bench_command,
    compare_command,
    frames_command,
    info_command,
    render_command,
    selftest_command,
)
from .messages import one_line, warnings_to
from .options import (
    BenchOptions,
    CompareMethodsOptions,
    CompareOptions,
    FramesOptions,
    InfoOptions,
    Options,
    RenderOptions,
    SelftestOptions,
    resolve,
)
from .parser import make_parser

_ERROR, _INTERRUPTED = 1, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line and returns its exit code: 0, 1 error, 2 usage, 130 interrupted."""
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    messages = Console(stderr=True, highlight=False, soft_wrap=True)
    try:
        parsed = make_parser().parse_args(arguments)
        with warnings_to(messages):
            completed = _run(resolve(parsed, arguments), messages)
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


def _run(options: Options, messages: Console) -> bool:
    """Does what is asked. False if Ctrl-C ended it early."""
    match options:
        case RenderOptions():
            return render_command.run(options, messages)
        case FramesOptions():
            return frames_command.run(options, messages)
        case CompareOptions():
            return compare_command.run(options, messages)
        case CompareMethodsOptions():
            return compare_command.run_methods(options, messages)
        case InfoOptions():
            return info_command.run(options, messages)
        case BenchOptions():
            return bench_command.run(options, messages)
        case SelftestOptions():
            return selftest_command.run(options, messages)
