"""Runs the hard cases."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from .. import _core
from . import edges, furnace, lights, places
from .case import ALL_TARGETS, Case, Result, worst


def all_cases() -> list[Case]:
    """Every case, in the order in which they are shown."""
    return [*places.cases(), *lights.cases(), *edges.cases(), *furnace.cases()]


def run(
    cases: Sequence[Case] | None = None, progress: Callable[[str], None] = lambda _: None
) -> Iterator[Result]:
    """Runs cases (None: all) with each instruction set that this machine has, one after the other.

    progress: called with the name of the case that is next.
    """
    best = _core.instruction_sets()[0]
    try:
        for case in all_cases() if cases is None else cases:
            progress(case.name)
            for target in [best] if case.once else _core.instruction_sets():
                _core.use_instruction_set(target)
                finding = worst(list(case.find()))
                shown = ALL_TARGETS if case.once else target
                yield Result(case.name, shown, finding, case.note())
    finally:
        _core.use_instruction_set(best)
