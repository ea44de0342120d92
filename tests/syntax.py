"""Syntax trees of sources, and their nodes: made once in a process, however many tests look at them."""

from __future__ import annotations

import ast
from functools import cache


@cache
def parsed(text: str) -> ast.Module:
    """Syntax tree of a source."""
    return ast.parse(text)


@cache
def walked(text: str) -> tuple[ast.AST, ...]:
    """Nodes of a source, those of the first level first."""
    return tuple(ast.walk(parsed(text)))
