"""A motor with its circuit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from antenna_pin.base.parameters import parameter
from antenna_pin.base.readable import GIVEN, readable
from antenna_pin.elements.element import GROSS_WORK, WORK, Drive, Integral
from antenna_pin.errors import InvalidParameterError

__all__ = ["Motor"]

_CURRENT = Integral("current", "A")


@dataclass(frozen=True, slots=True, kw_only=True)
class Motor(Drive):
    r"""A motor with brushes, or controlled like one, at a geared joint.

    .. math:: \tau = n (K_t i - T_c \sin(c n \phi + \psi)), \quad L \dot i = U - R i - K_e n \dot\phi

    Without an inductance the current follows at once. The driver puts on the voltage that is commanded,
    within its limit, and none that would bring the current beyond its own: U lies within
    :math:`K_e n \dot\phi \pm R i_{max}`. A current that is commanded takes the voltage
    :math:`R i + K_e n \dot\phi`, which is limited.

    Its work is that on the joint, without the cogging, whose energy is stored,
    :math:`-(T_c / c) \cos(c n \phi + \psi)`. What it takes from its supply, :math:`\int U i`, and the heat
    of the winding, :math:`\int R i^2`, are results of their own: less the heat and :math:`L i^2 / 2` the
    first is the work if both constants are one, as they are in SI units. Switched off it does nothing at the
    joint, and its circuit goes on as if that stood still.

    Attributes:
        value: What is commanded: voltage [V] or current [A], by ``mode``.
        mode: What is commanded.
        torque_constant: K_t [N*m/A].
        back_emf: K_e; that of the torque, if not given [V*s/rad].
        resistance: R [ohm].
        inductance: L; 0 for a current that follows at once [H].
        voltage_limit: Largest voltage either way; none if not given [V].
        current_limit: Largest current either way; none if not given [A].
        cogging: T_c, largest cogging torque, of the motor [N*m].
        cycles: c, cycles of the cogging in a turn of the motor [-].
        cogging_phase: psi [rad].
        ratio: n: turns of the motor per turn of its joint [-] ([rad/m]); below zero it turns the other way.
    """

    kernels: ClassVar[str] = "motor_kernels"
    commanded: ClassVar[str] = "value"
    senses: ClassVar[bool] = True
    integrals: ClassVar[tuple[Integral, ...]] = (
        WORK,
        GROSS_WORK,
        Integral("electric"),
        Integral("heat"),
        _CURRENT,
    )
    states: ClassVar[tuple[Integral, ...]] = (_CURRENT,)

    value: float = parameter(default=0.0)
    mode: Literal["voltage", "current"] = "voltage"
    torque_constant: float = parameter("N*m/A", rule="positive")
    back_emf: float | None = parameter("V*s/rad", rule="zero or more", default=None)
    resistance: float = parameter("ohm", rule="positive")
    inductance: float = parameter("H", rule="zero or more", default=0.0)
    voltage_limit: float | None = parameter("V", rule="positive", default=None)
    current_limit: float | None = parameter("A", rule="positive", default=None)
    cogging: float = parameter("N*m", rule="zero or more", default=0.0)
    cycles: int = parameter(rule="1 or more", default=1)
    cogging_phase: float = parameter("rad", default=0.0)
    ratio: float = parameter("1", sliding="rad/m", default=1.0)

    def __post_init__(self) -> None:
        """Check the parameters together."""
        Drive.__post_init__(self)
        if self.ratio == 0.0:
            raise InvalidParameterError(self, "ratio", "other than zero", self.ratio)
        if self.mode == "current" and self.inductance > 0.0:
            rule = "zero where the current is commanded, which its driver then makes whatever it takes"
            raise InvalidParameterError(self, "inductance", rule, self.inductance)

    @property
    def has_kinks(self) -> bool:
        """Return whether a limit may act."""
        return (self.voltage_limit if self.mode == "current" else self.current_limit) is not None

    def derived(self) -> dict[str, Any]:
        """Return the packed parameters that are no fields of the element."""
        return {
            "by_current": self.mode == "current",
            "back_emf": self.torque_constant if self.back_emf is None else self.back_emf,
            "phase": self.cogging_phase,
        }

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        unit = "V" if self.mode == "voltage" else "A"
        said = {"torque_constant": "K_t", "resistance": "R", "inductance": "L", "cogging": "cogging"}
        given = f"commanded {readable(self.value, unit, GIVEN)}"
        return f"motor, {', '.join([given, *self.said_of(said, slides)])}, ratio {self.ratio:g}"
