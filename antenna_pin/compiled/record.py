"""Numbers in a row read by names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

_Record = TypeVar("_Record", bound=np.generic)

if TYPE_CHECKING:

    class Layout(np.dtype[Any], Generic[_Record]):  # type: ignore[misc]  # final in NumPy's stubs
        """The ``dtype`` of a kind of record, with fields by name for type checkers."""

else:
    Layout = np.dtype


def record(numbers: NDArray[Any], layout: Layout[_Record]) -> _Record:
    """Return flat numbers, shape (n,), as a record of that size: names instead of offsets.

    Compiled code (``intrinsics.py``) reads a field like an entry of the array, and checks nothing; a ``view``
    would cost 2 ns.
    """
    found: _Record = numbers.view(layout)[0]
    return found
