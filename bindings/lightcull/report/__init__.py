"""The report on a comparison of samplers: figures of error, JSON, CSV and a page to look at."""

from . import metrics
from .comparison import Comparison
from .errors import METRICS, Measure, Metric
from .figures import (
    ComparisonFigures,
    CurvePoint,
    LearnedFigures,
    MetricFigures,
    ReferenceFigures,
    SamplerFigures,
)
from .runs import Learned, Moment, Reference, SamplerRun, Slice
from .write import write

__all__ = [
    "METRICS",
    "Comparison",
    "ComparisonFigures",
    "CurvePoint",
    "Learned",
    "LearnedFigures",
    "Measure",
    "Metric",
    "MetricFigures",
    "Moment",
    "Reference",
    "ReferenceFigures",
    "SamplerFigures",
    "SamplerRun",
    "Slice",
    "metrics",
    "write",
]
