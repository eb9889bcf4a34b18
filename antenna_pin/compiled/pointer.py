"""Address stored as a number, as a pointer in compiled functions of a user's."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


@intrinsic
def pointer(typing: Any, place: Any) -> Any:
    """Return the pointer to numbers at an address."""

    def lowered(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        number = builder.fptoui(arguments[0], ir.IntType(64))
        return builder.inttoptr(number, context.get_value_type(signature.return_type))

    return types.CPointer(types.float64)(types.float64), lowered
