"""How large a mechanism may be: what Pinocchio asks memory for grows with the cube of its freedoms."""

from __future__ import annotations

import os

from antenna_pin.errors import MechanismError
from antenna_pin.readable import number

__all__ = ["check_size"]

# Bytes of a `pinocchio.Data` over the cube of freedoms: four tensors of second derivatives.
_BYTES = 32
_SHARE = 4  # of the machine's memory it may take one in so many: several are made


def memory() -> int:
    """Return the memory of this machine [bytes]."""
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")


def check_size(where: str, freedoms: int, way_out: str = "take fewer joints") -> None:
    """Refuse a mechanism that would not fit into memory.

    Args:
        where: Place, for the message.
        freedoms: How many it has, or at least has.
        way_out: What is to be done.

    Raises:
        MechanismError: It does not fit.
    """
    most = int((memory() / (_SHARE * _BYTES)) ** (1.0 / 3.0))
    if freedoms > most:
        raise MechanismError(
            f"{where}: must have at most {most} freedoms on this machine, got {freedoms}: Pinocchio's data, "
            f"which grow with the cube, take {number(_BYTES * freedoms**3 / 1e9, 2)} GB a copy; {way_out}"
        )
