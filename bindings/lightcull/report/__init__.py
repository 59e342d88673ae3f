"""The report on a comparison of samplers: figures of error, JSON, CSV and a page to look at."""

from . import metrics
from .comparison import Comparison
from .figures import ComparisonFigures, LearnedFigures, ReferenceFigures, SamplerFigures
from .runs import Learned, Reference, SamplerRun
from .write import write

__all__ = [
    "Comparison",
    "ComparisonFigures",
    "Learned",
    "LearnedFigures",
    "Reference",
    "ReferenceFigures",
    "SamplerFigures",
    "SamplerRun",
    "metrics",
    "write",
]
