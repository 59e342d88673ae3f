"""lightcull selftest."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from itertools import groupby

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from .. import selftest
from .._core import Error
from ..output_files import write_whole_file
from ..selftest.case import Result, worst
from . import noise_table
from .options import SelftestOptions
from .tables import print_table


def run(options: SelftestOptions, messages: Console) -> bool:
    """Runs the hard cases, prints a table of them and writes the JSON. Throws Error if one fails."""
    if options.noise:
        return noise_table.run(options, messages)
    results: list[Result] = []
    with messages.status("") as status:
        for result in selftest.run(progress=status.update):
            results.append(result)
    print_table(_table(results), highlight=False)
    failed = [result for result in results if not result.passed]
    for result in failed:
        finding = result.finding
        print(
            f"{result.case} ({result.target}): {finding.what}: "
            f"{finding.error:.3g}, allowed {finding.allowed:.3g}"
        )
    print(f"{len(results) - len(failed)} passed, {len(failed)} failed")
    if options.json is not None:
        text = json.dumps([_row(result) for result in results], indent=2, allow_nan=False)
        write_whole_file(options.json, (text + "\n").encode())
    if failed:
        raise Error("the hard cases have not all passed")
    return True


def _row(result: Result) -> dict[str, object]:
    """null for an error that is no number."""
    error = float(result.finding.error)
    return {
        "case": result.case,
        "instruction_set": result.target,
        "of": result.finding.what,
        "error": error if math.isfinite(error) else None,
        "allowed": float(result.finding.allowed),
        "passed": bool(result.passed),
        "note": result.note,
    }


def _table(results: Sequence[Result]) -> Table:
    """A line for each case: what came nearest to failing with any instruction set."""
    table = Table("case", box=SIMPLE, padding=(0, 1, 0, 0))
    for heading in ("error", "allowed"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("result", no_wrap=True)
    table.add_column("of", overflow="fold")
    for case, of_case in groupby(results, key=lambda result: result.case):
        runs = list(of_case)
        finding = worst([result.finding for result in runs])
        passed = sum(result.passed for result in runs)
        verdict = "pass" if passed == len(runs) else "FAIL"
        about = runs[0].note or finding.what
        table.add_row(
            case, f"{finding.error:.2g}", f"{finding.allowed:.2g}",
            f"{verdict} {passed}/{len(runs)}", about,
        )  # fmt: skip
    return table
