"""Hard cases: what the library answers beside what is known to be right, on this machine."""

from .model import Result
from .run import run

__all__ = ["Result", "run"]
