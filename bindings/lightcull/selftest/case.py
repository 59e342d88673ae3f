"""What a hard case is, and what it came to."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

ALL_TARGETS = "all"


@dataclass(frozen=True)
class Finding:
    """What one check of a case came to."""

    what: str
    error: float
    """Of ours."""
    allowed: float
    """What rounding in single precision may come to, or for a mean the noise."""

    @property
    def passed(self) -> bool:
        """False for a number that is none, too."""
        return self.error <= self.allowed


@dataclass(frozen=True)
class Result:
    """A case with one instruction set."""

    case: str
    target: str
    """Instruction set, or "all" for what does not depend on it."""
    finding: Finding
    """Of its checks the one that came nearest to failing, or failed most."""
    note: str = ""

    @property
    def passed(self) -> bool:
        return self.finding.passed


@dataclass(frozen=True)
class Case:
    """Findings that are made anew for each instruction set, or once."""

    name: str
    find: Callable[[], Iterator[Finding]]
    once: bool = False
    note: Callable[[], str] = str


Cases: TypeAlias = Iterator[Case]


def worst(findings: list[Finding]) -> Finding:
    """The finding nearest to failing."""

    def badness(finding: Finding) -> float:
        if finding.error != finding.error:
            return float("inf")
        if finding.allowed == 0:
            return float("inf") if finding.error > 0 else 0.0
        return finding.error / finding.allowed

    return max(findings, key=badness)
