"""Errors of kernels compiled at their first call (``slots.py``), for the caller of machine code.

Machine code that calls such a kernel cannot pass on what Python raises while compiling it.
"""

from __future__ import annotations

#: Slots of a row of kinds; the last is that of numbers that are no kind's.
KINDS = 128

#: What compilation raised under machine code; its callers return an error at once.
failures: list[BaseException] = []


def raise_failure() -> None:
    """Raise what compilation under machine code has raised, if anything."""
    if failures:
        found = failures[0]
        failures.clear()
        raise found
