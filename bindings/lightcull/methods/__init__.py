"""The comparison of methods: how virtual lights scale, what culls them best, and who errs least."""

from .findings import MethodReport, Picture, Study, Table
from .studies import compare_methods

__all__ = ["MethodReport", "Picture", "Study", "Table", "compare_methods"]
