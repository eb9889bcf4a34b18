"""A prescribed motion by functions of time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.records import Triple
from antenna_pin.compiled.calls import call_1
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.element import packed
from antenna_pin.elements.prescribed import Motion


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CallableMotion(Motion):
    """A joint's position from functions of time; slower than the others unless all are compiled.

    They must answer equal questions equally, as a :class:`CallableDrive` must.

    Attributes:
        position: ``t [s] -> [rad]`` ([m]).
        velocity: Its exact first derivative [rad/s] ([m/s]).
        acceleration: Its exact second derivative [rad/s^2] ([m/s^2]).
    """

    kernels: ClassVar[str] = __name__

    position: Callable[[float], float]
    velocity: Callable[[float], float]
    acceleration: Callable[[float], float]

    @property
    def called(self) -> bool:
        """Return whether kernels call the functions."""
        from antenna_pin.compiled.given_functions import is_compiled

        return is_compiled(self.position, self.velocity, self.acceleration)

    @property
    def in_python(self) -> bool:  # type: ignore[override]
        """Return whether Python calls the functions, before each evaluation."""
        return not self.called

    @packed
    def present(self) -> Triple:
        """Position, rate and acceleration by plain functions, written before each evaluation."""
        return 0.0, 0.0, 0.0

    @packed
    def addresses(self) -> Triple:
        """Addresses of compiled functions, else 0."""
        if not self.called:
            return 0.0, 0.0, 0.0
        from antenna_pin.compiled.given_functions import address_of

        place = type(self).__name__
        x, v, a = (address_of(place, name, function, 1) for name, function, _ in self.functions)
        return x, v, a

    @property
    def functions(self) -> tuple[tuple[str, Callable[..., float], int], ...]:
        """Its three functions, of time."""
        return tuple((name, getattr(self, name), 1) for name in ("position", "velocity", "acceleration"))

    def record_numbers(
        self, functions: Sequence[Callable[..., float]], t: float, angle: float, rate: float
    ) -> tuple[float, ...]:
        """Return the numbers of its record at time t [s]."""
        return (*(function(t) for function in functions), 0.0, 0.0, 0.0)

    def profile(self) -> Callable[[float], tuple[float, float, float]]:
        """Return position, rate and acceleration as a function of time."""
        position, velocity, acceleration = self.callbacks(f"motion of joint {self.joint!r}", False)
        return lambda t: (position(t), velocity(t), acceleration(t))

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        return "motion: compiled functions" if self.called else "motion: functions in Python"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def motion(m: CallableMotion, t: float) -> tuple[float, float, float]:
    """Position, its rate and its acceleration."""
    if m.addresses[0] != 0.0:
        return call_1(m.addresses[0], t), call_1(m.addresses[1], t), call_1(m.addresses[2], t)
    return m.present[0], m.present[1], m.present[2]
