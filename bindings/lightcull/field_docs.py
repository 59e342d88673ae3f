"""Documentation of fields that help() shows: Python keeps what stands below a field of a class nowhere."""

from __future__ import annotations

import ast
import sys
from functools import lru_cache
from inspect import cleandoc
from pathlib import Path
from typing import TypeVar

AnyClass = TypeVar("AnyClass", bound=type)


def with_field_docs(cls: AnyClass) -> AnyClass:
    """Adds to the docstring of a class what stands below its fields and says what they are."""
    if not cls.__doc__:  # Python was told to strip them
        return cls
    lines = [f"{name}: {doc}" for name, doc in _docs_in(cls.__module__).get(cls.__name__, ())]
    cls.__doc__ = "\n\n".join((cleandoc(cls.__doc__), *lines))
    return cls


@lru_cache(maxsize=None)
def _docs_in(module: str) -> dict[str, list[tuple[str, str]]]:
    """By class: its fields, and what stands below each on one line or more. Nothing where the source
    is not there.
    """
    path = getattr(sys.modules[module], "__file__", None)
    if path is None or not Path(path).is_file():
        return {}
    tree = ast.parse(Path(path).read_text(encoding="utf-8"))
    return {node.name: list(_fields(node)) for node in tree.body if isinstance(node, ast.ClassDef)}


def _fields(node: ast.ClassDef) -> list[tuple[str, str]]:
    found = []
    for field, below in zip(node.body, [*node.body[1:], None], strict=True):
        if not (isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name)):
            continue
        if isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant):
            found.append((field.target.id, " ".join(str(below.value.value).split())))
    return found
