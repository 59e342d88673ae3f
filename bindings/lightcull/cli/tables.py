"""Tables on the terminal."""

from __future__ import annotations

from rich.console import Console
from rich.measure import Measurement
from rich.table import Table


def print_table(table: Table, *, highlight: bool = True) -> None:
    """Prints a table in full: where there is no room, as in a pipe, its lines run on."""
    console = Console(highlight=highlight)
    needed = Measurement.get(console, console.options.update(width=10_000), table).maximum
    if needed > console.width:
        table.width = needed
    console.print(table, crop=False)
