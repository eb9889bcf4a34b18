r"""Factors of motorization: sets by name, each factor a parameter with its clause.

.. math:: T_{min} = m \left(\sum_i f_i R_i\right) + f_D T_D + T_L, \qquad
          \text{margin} = \frac{\sum_j a_j A_j}{T_{min}} - 1

R are resistances by class, A actuating torques. Customers tailor factors: compliance is not claimed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, Literal, get_args

from antenna_pin.base.arguments import check_number, takes
from antenna_pin.base.readable import brief
from antenna_pin.errors import InvalidParameterError, UnknownNameError

Resistance = Literal["I", "S", "H_M", "F_R", "H_Y", "H_A", "H_D"]
"""Class of a resistance: inertia of what moves with its body, springs, magnetic losses, friction, hysteresis,
harness and others, adhesion."""

WORDS_OF_RESISTANCE: Mapping[str, str] = MappingProxyType(
    {
        "I": "inertia and weight",
        "S": "springs",
        "H_M": "magnetic losses",
        "F_R": "friction",
        "H_Y": "hysteresis",
        "H_A": "harness and others",
        "H_D": "adhesion",
    }
)
"""Classes of resistance in words, by symbol."""

Pairs = Mapping[str, tuple[float, float]]


@takes()
@dataclass(frozen=True, slots=True, kw_only=True)
class FactorSet:
    """Factors of a motorization margin.

    Attributes:
        name: Name of the set.
        source: Document and edition.
        clause: Clause of the formula and of its factors.
        factors: Factors of each class of resistance, for theoretical and for measured values [-].
        motorization: m, on the sum of factored resistances [-].
        commanded: f_D, on the torque of the required acceleration, T_D [-].
        spring: a of a driving spring [-].
        inertia: a of driving weight or inertia [-].
        motor: a of a motor, and of any other drive, in its worst case [-].
        required: Least margin [-].
    """

    __repr__ = brief

    name: str
    source: str
    clause: str
    factors: Pairs = field(default_factory=dict)
    motorization: float
    commanded: float
    spring: float
    inertia: float
    motor: float = 1.0
    required: float = 0.0

    def __post_init__(self) -> None:
        """Check that each class has two positive factors."""
        for symbol in get_args(Resistance):
            pair = self.factors.get(symbol)
            if pair is None or len(pair) != 2 or not all(0.0 < one < float("inf") for one in pair):
                rule = "two positive factors, of a theoretical and of a measured value"
                raise InvalidParameterError(f"factors {self.name!r}", symbol, rule, said=str(pair))
        for name in ("motorization", "commanded", "spring", "inertia", "motor"):
            check_number(f"factors {self.name!r}", name, getattr(self, name), "positive")

    def factor(self, symbol: str, by_measurement: bool) -> float:
        """Return the factor of a resistance of a class, theoretical or measured [-]."""
        return float(self.factors[symbol][1 if by_measurement else 0])


_THREE = (3.0, 1.5)

FACTOR_SETS: Mapping[str, FactorSet] = MappingProxyType(
    {
        "ecss-e-st-33-01c": FactorSet(
            name="ecss-e-st-33-01c",
            source="ECSS-E-ST-33-01C, 6 March 2009",
            clause="4.7.5.3",
            factors={
                "I": (1.1, 1.1),
                "S": (1.2, 1.2),
                "H_M": (1.5, 1.2),
                "F_R": _THREE,
                "H_Y": _THREE,
                "H_A": _THREE,
                "H_D": (3.0, 3.0),
            },
            motorization=2.0,
            commanded=1.25,
            spring=0.8,
            inertia=0.9,
        ),
        "aiaa-s-114": FactorSet(
            name="aiaa-s-114",
            source="AIAA S-114, 100 % static and 25 % dynamic margin; source checked at second hand",
            clause="static and dynamic torque margin",
            factors=dict.fromkeys(get_args(Resistance), (1.0, 1.0)),
            motorization=2.0,
            commanded=1.25,
            spring=1.0,
            inertia=1.0,
        ),
    }
)
"""Sets of factors by name."""

_NUMBERS = ("motorization", "commanded", "spring", "inertia", "motor", "required")


def factor_set(wanted: str | FactorSet | Mapping[str, Any]) -> FactorSet:
    """Return a set of factors by name, or a tailored one.

    Args:
        wanted: A name, a set, or a mapping of changes to a set: ``{"base": "ecss-e-st-33-01c", "F_R":
            2.0, "S": (1.3, 1.2), "motorization": 1.5}``. The base is ``ecss-e-st-33-01c`` by
            default; a single number is the factor of theoretical and measured values.

    Raises:
        UnknownNameError: The set or factor is unknown.
        InvalidParameterError: A factor is not positive.
    """
    if isinstance(wanted, FactorSet):
        return wanted
    if isinstance(wanted, str):
        if wanted not in FACTOR_SETS:
            raise UnknownNameError("margin", "set of factors", wanted, FACTOR_SETS)
        return FACTOR_SETS[wanted]
    changes = dict(wanted)
    base = factor_set(str(changes.pop("base", "ecss-e-st-33-01c")))
    factors = dict(base.factors)
    numbers: dict[str, Any] = {}
    for name, value in changes.items():
        if name in factors:
            pair = value if isinstance(value, tuple | list) else (value, value)
            factors[name] = tuple(float(one) for one in pair)  # type: ignore[assignment]
        elif name in _NUMBERS:
            numbers[name] = float(value)
        else:
            raise UnknownNameError("margin: factors", "factor", name, ("base", *factors, *_NUMBERS))
    source = f"{base.source}, tailored: {', '.join(changes)}" if changes else base.source
    return replace(base, name=f"{base.name}, tailored", source=source, factors=factors, **numbers)
