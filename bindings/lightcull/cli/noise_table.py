"""lightcull selftest --noise."""

from __future__ import annotations

import json
from collections.abc import Sequence

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from .._core import Error
from ..output_files import write_whole_file
from ..selftest.noise import KNOWN_EVEN_MISSES, KNOWN_MISSES, Row, all_situations, measure
from .options import SelftestOptions
from .tables import print_table


def run(options: SelftestOptions, messages: Console) -> bool:
    """Runs the battery, prints its table and writes the JSON. Throws Error if a mean is wrong, or
    the default sampler is noisier where it is not known to be.
    """
    rows: list[Row] = []
    with messages.status("") as status:
        for situation in all_situations():
            status.update(situation.name)
            rows.append(measure(situation))
    print_table(_table(rows), highlight=False)
    if options.json is not None:
        text = json.dumps([_json(row) for row in rows], indent=2, allow_nan=False)
        write_whole_file(options.json, (text + "\n").encode())
    wrong = [row for row in rows if not row.right]
    worse = [row for row in rows if not (row.no_worse and row.no_worse_by_even)]
    known = [row for row in worse if _is_known(row)]
    print(
        f"{len(rows) - len(worse)} no noisier than the best, {len(worse)} noisier "
        f"({len(known)} known), {len(wrong)} wrong"
    )
    if wrong or len(known) < len(worse):
        raise Error("the battery has not passed")
    return True


def _is_known(row: Row) -> bool:
    """True if it is noisier nowhere where it is not known to be."""
    known, by_even = row.situation in KNOWN_MISSES, row.situation in KNOWN_EVEN_MISSES
    return (row.no_worse or known) and (row.no_worse_by_even or by_even)


def _json(row: Row) -> dict[str, object]:
    return {
        "situation": row.situation,
        "kind": row.kind,
        "ratio": row.ratio,
        "worse": not row.no_worse,
        "even_ratio": row.even_ratio,
        "worse_by_even": not row.no_worse_by_even,
        "known": _is_known(row) and not (row.no_worse and row.no_worse_by_even),
        "right": row.right,
        "samplers": [
            {
                "sampler": f.sampler,
                "variance": f.variance,
                "even_variance": f.even_variance,
                "mean": f.mean,
                "z": f.z,
            }
            for f in (row.default, *row.others)
        ],
    }


def _table(rows: Sequence[Row]) -> Table:
    """Variances of one sample over the square of its mean: of independent numbers, then of numbers
    that are even from pass to pass.
    """
    table = Table("situation", box=SIMPLE, padding=(0, 1, 0, 0))
    for numbers in ("", ", even"):
        table.add_column(rows[0].default.sampler + numbers, justify="right")
        table.add_column("best other", justify="right")
        table.add_column("which", overflow="fold")
        table.add_column("ratio", justify="right", no_wrap=True)
    table.add_column("z", justify="right", no_wrap=True)
    table.add_column("result", no_wrap=True)
    kind = ""
    for row in rows:
        if kind not in ("", row.kind):
            table.add_section()
        kind = row.kind
        table.add_row(
            row.situation, f"{row.default.variance:.3g}", f"{row.best.variance:.3g}",
            row.best.sampler, f"{row.ratio:.2f}", f"{row.default.even_variance:.3g}",
            f"{row.best_even.even_variance:.3g}", row.best_even.sampler, f"{row.even_ratio:.2f}",
            f"{row.default.z:+.1f}", _verdict(row),
        )  # fmt: skip
    return table


def _verdict(row: Row) -> str:
    if not row.right:
        return "WRONG"
    if row.no_worse and row.no_worse_by_even:
        return "OK"
    return "worse" if _is_known(row) else "WORSE"
