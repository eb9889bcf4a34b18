"""An end stop that gives way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from antenna_pin.base.parameters import parameter, parameters_of
from antenna_pin.base.readable import GIVEN, readable
from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.contact.kernels import NORMAL_SIZE, elastic_energy, elastic_force, normal_force
from antenna_pin.contact.onset import NO_APPROACH, approach_speed_in_contact
from antenna_pin.contact.registry import SHAPELESS_LAWS
from antenna_pin.elements.element import IMPULSE, LOSS, Integral, packed
from antenna_pin.elements.hook_kernels import Loaded
from antenna_pin.elements.limits import FREE, LOWER, UPPER, Limits, beyond
from antenna_pin.elements.modal import Change, Met, Remembered
from antenna_pin.errors import InvalidParameterError

# Its function that passes zero where the joint turns back, once in a touch.
TURNS = 2

if TYPE_CHECKING:
    StopLaw = str
else:
    StopLaw = Literal[("elastic", *SHAPELESS_LAWS)]
"""Laws of a stop that gives way: those of :mod:`antenna_pin.contact` that are of no certain shape."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EndStop(Limits):
    r"""A compliant end stop: a contact law beyond a limit, without tension.

    .. math:: \tau = \mp f(\delta, \dot\delta), \qquad
              \delta = \phi - \phi_{upper} \text{ or } \phi_{lower} - \phi, \quad
              f_e = K \delta \left(\frac{\delta}{1\,\mathrm{rad}}\right)^{n - 1}

    with f of the named law, whose depth is the angle beyond the limit; touch and release are located.
    ``upper_stiffness``, ``upper_law``, ... apply to the upper side alone. After a start beyond a limit, or
    where a stop is switched on or moved there, only the elastic part of the law acts up to the release, as
    the approach speed is unknown.

    Attributes:
        stiffness: K, torque at a depth of 1 rad over 1 rad, whatever the exponent [N*m/rad] ([N/m]).
        exponent: n, 1 for a linear spring [-].
        law: Dissipation; ``exact-restitution`` delivers its restitution against a free body.
        restitution: Of laws that need one, in [0, 1] [-].
        damping: Of ``kelvin-voigt`` and ``adams-impact`` [N*m*s/rad] ([N*s/m]).
        full_damping_depth: Of ``adams-impact`` [rad] ([m]).
        slope: Of ``marhefka-orin``: loss of restitution over rate [s/rad] ([s/m]).
        inertia: Of ``tsuji`` and ``jankowski``: inertia that strikes the stop [kg*m**2] ([kg]).
        upper_stiffness: K of the upper side; None for the same [N*m/rad] ([N/m]).
        upper_exponent: n of the upper side; None for the same [-].
        upper_law: Law of the upper side, with its own parameters where the law of both sides does not have
            them; None for the same.
        upper_restitution: Of the upper side; None for the same [-].
        upper_damping: Of the upper side; None for the same [N*m*s/rad] ([N*s/m]).
        upper_full_damping_depth: Of the upper side; None for the same [rad] ([m]).
        upper_slope: Of the upper side; None for the same [s/rad] ([s/m]).
        upper_inertia: Of the upper side; None for the same [kg*m**2] ([kg]).
        least_rate: Floor of the approach rate in the law [rad/s] ([m/s]).
        approach: Rate at the onset of the present touch [rad/s] ([m/s]).
        turned: Whether it has turned back in the present touch, 0 or 1.
        lost: Its loss before that [J].
        struck: Its impulse before that, by size [N*m*s] ([N*s]).
    """

    kernels: ClassVar[str] = __name__
    integrals: ClassVar[tuple[Integral, ...]] = (LOSS, IMPULSE)
    remembers: ClassVar[tuple[str, ...]] = ("approach", "turned", "lost", "struck")
    goes_by: ClassVar[Mapping[str, Remembered]] = {"approach": "rate"}
    goes_by_in: ClassVar[tuple[int, ...]] = (LOWER, UPPER)
    change_names: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "touch": ("on",),
        "turn": ("turns",),
        "lift-off": ("off",),
    }

    stiffness: float = parameter("N*m/rad", sliding="N/m", rule="positive")
    exponent: float = parameter("1", rule="1 or more", default=1.0)
    law: StopLaw = "exact-restitution"
    restitution: float | None = parameter("1", rule="zero or more", default=None)
    damping: float | None = parameter("N*m*s/rad", sliding="N*s/m", rule="zero or more", default=None)
    full_damping_depth: float | None = parameter("rad", sliding="m", rule="positive", default=None)
    slope: float | None = parameter("s/rad", sliding="s/m", rule="zero or more", default=None)
    inertia: float | None = parameter("kg*m**2", sliding="kg", rule="positive", default=None)
    upper_stiffness: float | None = parameter("N*m/rad", sliding="N/m", rule="positive", default=None)
    upper_exponent: float | None = parameter("1", rule="1 or more", default=None)
    upper_law: StopLaw | None = None
    upper_restitution: float | None = parameter("1", rule="zero or more", default=None)
    upper_damping: float | None = parameter("N*m*s/rad", sliding="N*s/m", rule="zero or more", default=None)
    upper_full_damping_depth: float | None = parameter("rad", sliding="m", rule="positive", default=None)
    upper_slope: float | None = parameter("s/rad", sliding="s/m", rule="zero or more", default=None)
    upper_inertia: float | None = parameter("kg*m**2", sliding="kg", rule="positive", default=None)
    least_rate: float = parameter("rad/s", sliding="m/s", rule="positive", default=1e-4)
    on: bool = True
    approach: float = field(default=0.0, repr=False)
    turned: float = field(default=0.0, repr=False)
    lost: float = field(default=0.0, repr=False)
    struck: float = field(default=0.0, repr=False)

    def __post_init__(self) -> None:
        """Check limits and laws."""
        Limits.__post_init__(self)
        self.check_upper(_OF_SIDES)
        for side in (LOWER, UPPER) if self.differs(_OF_SIDES) else (LOWER,):
            self._check_law(side)

    def _check_law(self, side: int) -> None:
        """Check that the parameters of a side are those of its law."""
        law, takes = self.of_side("law", side), self._law_parameters(side)
        for own in _OF_LAWS:
            name = self.said_by(own, side)
            given = getattr(self, name) is not None
            if given and own not in takes and not (side == UPPER and name == own):
                told = ", ".join(item for item in takes if item in _OF_LAWS) or "none of its own"
                raise InvalidParameterError(
                    self, name, f"left out: law {law} takes {told}", getattr(self, name)
                )
            if own in takes and not given:
                name = f"upper_{own}" if side == UPPER else own
                raise InvalidParameterError(self, name, f"given; law {law} needs it", said="none")
        try:
            self.contact_law(side)
        except InvalidParameterError as error:
            name = self.said_by(_NAMES.get(error.parameter, error.parameter), side)
            raise InvalidParameterError(self, name, error.rule, getattr(self, name)) from None

    def _law_parameters(self, side: int) -> tuple[str, ...]:
        """Return the names of its own parameters that the law of a side takes."""
        return tuple(_NAMES.get(name, name) for name in parameters_of(_law(self.of_side("law", side))))

    def contact_law(self, side: int) -> Any:
        """Return the contact law of a side, with the angle as its depth."""
        law, takes = _law(self.of_side("law", side)), self._law_parameters(side)
        given = {
            item.name: self.of_side(name, side)
            for item in fields(law)
            for name in [_NAMES.get(item.name, item.name)]
            if name in takes
        }
        return law(**{name: value for name, value in given.items() if value is not None})

    @packed
    def inertias(self) -> tuple[float, float]:
        """Inertia of each side, lower and upper, 0 where its law needs none [kg*m**2] ([kg])."""
        return self.of_side("inertia", LOWER) or 0.0, self.of_side("inertia", UPPER) or 0.0

    def initial_change(self, met: Met) -> Change | None:
        """Return the side that the joint is pressed into at the start, if any."""
        side = self.side_at(met.angle, met.rate)
        return self._pressed_in(side, met) if side != self.mode else None

    def in_another(self, met: Met) -> Change | None:
        """Touch, or come off, where the joint is in or off now."""
        side = self.side_at(met.angle, met.rate)
        if side == self.mode:
            return None
        if side == FREE:
            return Change(FREE, memory={"approach": 0.0, "turned": 0.0})
        return self._pressed_in(side, met)

    def moved(self, key: str, met: Met) -> Change | None:
        """Return the memory of a stop moved to, or off, a joint beyond it."""
        if self.mode != FREE:
            return None
        side = self.side_at(met.angle, met.rate)
        approach = 0.0 if side == FREE else self._approach_in(side, met)  # not that of before it was off
        return Change(FREE, memory={"approach": approach})

    def passed(self, k: int, met: Met) -> Change | None:
        """Touch side k, turn back in it, or come off it."""
        if k == TURNS:
            return Change(self.mode, f"{self.modes[self.mode]}: turns", {"turned": 1.0})
        if self.mode == FREE:
            return self._on(k + 1, met)
        lost, struck = met.integrals
        sign = 1.0 if self.mode == LOWER else -1.0
        return Change(
            FREE,
            f"{self.modes[self.mode]}: off",
            {"approach": 0.0, "turned": 0.0},
            loss=lost - self.lost,
            impulse=sign * (struck - self.struck),
        )

    def _approach_in(self, side: int, met: Met) -> float:
        """Return the approach rate of a joint on a side without onset [rad/s] ([m/s])."""
        sign, limit = (-1.0, self.lowest) if side == LOWER else (1.0, self.highest)
        return approach_speed_in_contact(sign * (met.angle - limit), sign * met.rate, 0.0)

    def _pressed_in(self, side: int, met: Met) -> Change:
        found = self._on(side, met)
        return found._replace(memory={**found.memory, "approach": self._approach_in(side, met)})

    def _on(self, side: int, met: Met) -> Change:
        rate = -met.rate if side == LOWER else met.rate
        lost, struck = met.integrals or (0.0, 0.0)
        approach = NO_APPROACH if self.approach == NO_APPROACH else max(rate, 0.0)
        memory = {"approach": approach, "turned": float(rate <= 0.0)}
        return Change(side, f"{self.modes[side]}: on", {**memory, "lost": lost, "struck": struck})

    def tail(self) -> tuple[float, ...]:
        """Return the laws of the lower and of the upper side in numbers."""
        return tuple(number for side in (LOWER, UPPER) for number in self.contact_law(side).code())

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        told = [f"end stop {self.words_of_limits(slides)}", *self._law_words(LOWER, slides)]
        if self.differs(_OF_SIDES):
            upper = ", ".join(self._law_words(UPPER, slides))
            return f"{', '.join(told)}; above {upper}"
        return ", ".join(told)

    def _law_words(self, side: int, slides: bool) -> list[str]:
        exponent = self.of_side("exponent", side)
        power = "" if exponent == 1.0 else f", exponent {readable(exponent, '1', GIVEN)}"
        own = [
            f"{word} {self.text_of(self.said_by(word, side), slides)}"
            for word in ("restitution", "damping", "slope", "inertia")
            if word in self._law_parameters(side)
        ]
        spring = f"stiffness {self.text_of(self.said_by('stiffness', side), slides)}{power}"
        return [spring, self.of_side("law", side), *own]


# What the sides may differ in; parameters that only some laws have, and their names in the laws where these
# are others.
_OF_LAWS = ("restitution", "damping", "full_damping_depth", "slope", "inertia")
_OF_SIDES = ("stiffness", "exponent", "law", *_OF_LAWS)
_NAMES = {"effective_mass": "inertia"}


def _law(name: str) -> Any:
    from antenna_pin.contact import NORMAL_LAWS

    return NORMAL_LAWS["hertz" if name == "elastic" else name]


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def depth(stop: EndStop, angle: float) -> float:
    """Return the depth of the joint in the side that it touches; else zero."""
    if stop.mode == LOWER:
        return float(stop.lowest - angle)
    if stop.mode == UPPER:
        return float(angle - stop.highest)
    return 0.0


@inlined
def way(stop: EndStop) -> float:
    """Direction into the side that it touches: -1 lower, +1 upper, 0 neither."""
    if stop.mode == LOWER:
        return -1.0
    return 1.0 if stop.mode == UPPER else 0.0


@inlined
def law_at(stop: EndStop) -> int:
    """Return the place of the law of the side that the joint touches."""
    return NORMAL_SIZE if stop.mode == UPPER else 0


@kernel
def effort(stop: EndStop, tail: Floats, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N], out of the stop; never into it."""
    if stop.mode == FREE:
        return 0.0
    first, sign = law_at(stop), way(stop)
    law = tail[first : first + NORMAL_SIZE]
    inertia = stop.inertias[1] if stop.mode == UPPER else stop.inertias[0]
    approach = max(stop.approach, stop.least_rate)
    return float(-sign * normal_force(law, depth(stop, angle), sign * rate, approach, inertia))


@kernel
def write_rates(
    stop: EndStop, tail: Floats, angle: float, rate: float, power: float, rates: Floats, x: int
) -> None:
    """Write the power lost [W], and the size of the torque."""
    rates[x] = rates[x + 1] = 0.0
    if stop.mode != FREE:
        first = law_at(stop)
        law = tail[first : first + NORMAL_SIZE]
        rates[x] = -power - elastic_force(law, depth(stop, angle)) * way(stop) * rate
        rates[x + 1] = abs(effort(stop, tail, 0.0, angle, rate))


@kernel
def stored(stop: EndStop, tail: Floats, angle: float) -> float:
    """Energy stored [J]."""
    if stop.mode == FREE:
        return 0.0
    first = law_at(stop)
    return elastic_energy(tail[first : first + NORMAL_SIZE], depth(stop, angle))


@kernel
def switch(stop: EndStop, k: int, motion: Loaded) -> tuple[float, float]:
    """Return function k: 0, 1 gap or depth with its rate; 2 closing rate."""
    if k == TURNS:
        return (way(stop) * motion[2], 0.0) if stop.mode != FREE and stop.turned == 0.0 else (1.0, 0.0)
    return beyond(stop.lowest, stop.highest, stop.mode, k, motion[1], motion[2])
