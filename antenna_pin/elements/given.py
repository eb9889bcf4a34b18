"""A torque from a function in Python."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.compiled.calls import call_3
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.element import Drive, packed


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CallableDrive(Drive):
    """A torque from a function of time and motion; slower unless compiled.

    It must answer equal questions equally: a run asks it many times a step, and back in time. An object with
    a memory (an integral, a sample and hold, chance, a clock) ends the run as ``FUNCTION_WITH_MEMORY``; a
    sampled controller is a run for each of its periods with a ``ConstantDrive``, each with
    ``start=run.end`` of the one before.

    Attributes:
        torque: ``(t [s], angle [rad], rate [rad/s]) -> [N m]``; of a clearance joint the motion angle and its
            rate. The angle counts whole turns. A plain function, or compiled by ``numba.njit`` or
            ``numba.cfunc``.
    """

    kernels: ClassVar[str] = __name__

    torque: Callable[[float, float, float], float]

    @property
    def called(self) -> bool:
        """Return whether kernels call the function."""
        from antenna_pin.compiled.given_functions import is_compiled

        return is_compiled(self.torque)

    @property
    def in_python(self) -> bool:  # type: ignore[override]
        """Return whether Python calls the function, before each evaluation."""
        return not self.called

    @property
    def senses(self) -> bool:  # type: ignore[override]
        """Return whether the kernel needs the joint's motion."""
        return self.called

    @packed
    def value(self) -> float:
        """Torque of a plain function, written before each evaluation [N*m] ([N])."""
        return 0.0

    @packed
    def address(self) -> float:
        """Address of a compiled function, else 0."""
        from antenna_pin.compiled.given_functions import address_of

        return address_of(type(self).__name__, "torque", self.torque, 3) if self.called else 0.0

    @property
    def functions(self) -> tuple[tuple[str, Callable[..., float], int], ...]:
        """Its function, of time, angle and rate."""
        return (("torque", self.torque, 3),)

    def record_numbers(
        self, functions: Sequence[Callable[..., float]], t: float, angle: float, rate: float
    ) -> tuple[float, ...]:
        """Return the numbers of its record at time t [s]."""
        return (functions[0](t, angle, rate), 0.0)

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        return "a compiled function" if self.called else "a function in Python"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def effort(drive: CallableDrive, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    return float(drive.value if drive.address == 0.0 else call_3(drive.address, t, angle, rate))
