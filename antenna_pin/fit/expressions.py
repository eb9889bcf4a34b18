"""Arithmetic of a fit's parameters, as text: ``coulomb + excess``."""

from __future__ import annotations

import ast
import functools
import math
import operator
from collections.abc import Callable, Mapping
from typing import Any

__all__ = ["evaluate", "names_in"]

_OPERATORS: Mapping[type, Callable[..., float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}
_FUNCTIONS: Mapping[str, Callable[..., float]] = {
    "sqrt": math.sqrt,
    "exp": math.exp,
    "log": math.log,
    "min": min,
    "max": max,
}
_RULE = f"must be made of parameters, numbers, + - * / ** and {', '.join(_FUNCTIONS)}"


@functools.lru_cache(maxsize=256)
def _tree(text: str) -> ast.expr:
    try:
        return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ValueError(f"{_RULE}, got {text!r}") from None


def names_in(text: str) -> tuple[str, ...]:
    """Return the names of the parameters in an expression, in alphabetical order.

    Raises:
        ValueError: It is no expression, or has more in it than arithmetic; the message is a rule.
    """
    found: set[str] = set()

    def look(node: ast.expr) -> None:
        if isinstance(node, ast.Name):
            found.add(node.id)
        elif isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            look(node.left)
            look(node.right)
        elif isinstance(node, ast.UnaryOp) and type(node.op) in _OPERATORS:
            look(node.operand)
        elif _is_call(node):
            for one in node.args:  # type: ignore[attr-defined]
                look(one)
        elif not (isinstance(node, ast.Constant) and type(node.value) in (int, float)):
            raise ValueError(f"{_RULE}, got {ast.unparse(node)!r}")

    look(_tree(text))
    return tuple(sorted(found))


def evaluate(text: str, values: Mapping[str, float]) -> float:
    """Return the value of an expression that :func:`names_in` accepts.

    Args:
        text: The expression.
        values: Of the parameters in it [SI].

    Raises:
        ValueError: It has no finite real value there.
    """

    def value(node: Any) -> Any:
        if isinstance(node, ast.Constant):
            return float(node.value)  # type: ignore[arg-type]
        if isinstance(node, ast.Name):
            return values[node.id]
        if isinstance(node, ast.UnaryOp):
            return _OPERATORS[type(node.op)](value(node.operand))
        if isinstance(node, ast.BinOp):
            return _OPERATORS[type(node.op)](value(node.left), value(node.right))
        return _FUNCTIONS[node.func.id](*map(value, node.args))

    try:
        found = value(_tree(text))
    except (ArithmeticError, ValueError, TypeError):
        found = math.nan
    if isinstance(found, complex) or not math.isfinite(found):
        at = ", ".join(f"{name} = {values[name]:g}" for name in names_in(text))
        raise ValueError(f"{text} must be finite, got none for {at}")
    return float(found)


def _is_call(node: ast.expr) -> bool:
    return (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id in _FUNCTIONS
        and bool(node.args)
        and not node.keywords
    )
