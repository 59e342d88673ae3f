"""Hard cases: what the library answers beside what is known to be right, on this machine."""

from .case import Result
from .runner import run

__all__ = ["Result", "run"]
