"""How large a mechanism may be: what Pinocchio asks memory for grows with the cube of its freedoms."""

from __future__ import annotations

from antenna_pin.base.arguments import takes
from antenna_pin.base.capacity import check_fits

__all__ = ["check_size"]

# What a run needs over the cube of the degrees of freedom [bytes]: Pinocchio's Data has four tensors of that
# size (second derivatives, which nobody asks for), and there are up to three of it at a time.
_PINOCCHIO = 3 * 4 * 8


@takes()
def check_size(where: str, freedoms: int, way_out: str = "leave joints out or lock some") -> None:
    """Refuse a mechanism that would not fit into memory.

    Args:
        where: Place, for the message.
        freedoms: How many it has, or at least has.
        way_out: What is to be done.

    Raises:
        TooLargeError: It does not fit.
    """
    more = "as Pinocchio's buffers grow with the cube of that number"
    check_fits(where, f"{freedoms} degrees of freedom", _PINOCCHIO * freedoms**3, f"{way_out}, {more}")
