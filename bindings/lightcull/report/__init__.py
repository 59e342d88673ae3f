"""The report on a comparison of samplers: figures of error, JSON, CSV and a page to look at."""

from . import metrics
from .model import Comparison, Reference, SamplerRun
from .write import write

__all__ = ["Comparison", "Reference", "SamplerRun", "metrics", "write"]
