"""Dry friction that sticks: Coulomb's, static, Stribeck's, viscous, under load."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.element import packed
from antenna_pin.elements.hook_kernels import Loaded, Own
from antenna_pin.elements.modal import Change, Met, ModalElement, Remembered
from antenna_pin.elements.own_load import (
    LABELS_OF_LOAD,
    NUMBERS_OF_LOAD,
    check_load,
    check_unloaded,
    numbers_of_load,
)
from antenna_pin.errors import InvalidParameterError

# Slipping one way or the other; sticking; at rest and held by others, with all its friction pushing as if it
# slipped forward, or backward.
_MODES = ("undecided", "forward", "backward", "sticks", "pushed", "pulled")
UNDECIDED, FORWARD, BACKWARD, STUCK, PUSHED, PULLED = range(6)
#: Rate up to which a joint stands whose rate is prescribed: above the round-off of rates that rows hold
#: [rad/s] ([m/s]).
STANDSTILL_RATE = 1e-10
# A joint is at rest for friction where its rate is round-off of one.
_AT_REST = 1e-11


@dataclass(frozen=True, slots=True, kw_only=True)
class StickingFriction(ModalElement):
    r"""Dry friction of a turning (sliding) joint without play.

    While it slips

    .. math::

        \tau = -\mathrm{sign}(\dot\phi)\, (T_c + (T_s - T_c)\, g) - b\, \dot\phi, \qquad
        g = e^{-(|\dot\phi| / \omega_s)^n}

    and while it sticks it is held by a constraint, up to :math:`T_s`. It sticks where its rate passes zero
    and no more than that is needed; without a Stribeck rate g is zero as soon as it slips. Joints that rest
    together are decided together. At a joint whose rate motions prescribe it slips by the sign of that rate;
    while such a joint stands no equation tells its torque, and it stays that of the way it came (none before
    it has moved).

    Under load :math:`T_c = T_{c0} + \mu N` and :math:`T_s = T_{s0} + \mu_s N`, with N of the force F and the
    moment M that the joint carries now, in the middle of its bearing, friction included:
    :math:`N = r (|F_\perp| + |M_\perp| / a) + r_a |F_\parallel|` of a turning joint,
    :math:`N = |F_\perp| + |M| / a` of a sliding one. Where friction changes that load the equation is solved
    in each evaluation, by Newton's method from no friction; where it has no solution (a joint that jams as in
    Painleve's problem) a run ends.

    Attributes:
        coulomb: T_c0, of slipping, whatever the load [N*m] ([N]).
        static: T_s0, up to which it holds, whatever the load; T_c0 if left out [N*m] ([N]).
        viscous: b [N*m*s/rad] ([N*s/m]).
        stribeck_rate: omega_s, over which friction falls from that at rest; if left out it falls at once
            [rad/s] ([m/s]).
        exponent: n of the Stribeck curve [-].
        coefficient: mu, of slipping under load [-].
        static_coefficient: mu_s, up to which it holds under load; mu if left out [-].
        radius: r, at which a turning joint slips under radial load [m].
        axial_radius: r_a, at which a turning joint slips under axial load [m].
        bending_arm: a: a moment M presses like a force M / a [m]; None for moments that do not press.
        middle: Place of the bearing's middle along the axis, from the joint's origin [m].

    References:
        Names of the load as those of joint friction in Adams and MotionSolve: F radial and axial, a bending
        arm, a preload torque (here ``coulomb``).
    """

    kernels: ClassVar[str] = __name__
    modes: ClassVar[tuple[str, ...]] = _MODES
    change_names: ClassVar[Mapping[str, tuple[str, ...]]] = {"stick": ("sticks",), "slip": ("slips",)}
    switches: ClassVar[int] = 2
    loaded: ClassVar[tuple[int, ...]] = (1,)
    remembers: ClassVar[tuple[str, ...]] = ("where", "prescribed")
    goes_by: ClassVar[Mapping[str, Remembered]] = {"where": "way"}
    goes_by_in: ClassVar[tuple[int, ...]] = (STUCK,)
    holds: ClassVar[bool] = True
    together: ClassVar[bool] = True
    one_above_zero: ClassVar[tuple[str, ...]] = ("coulomb", "viscous", "coefficient")
    labels: ClassVar[Mapping[str, str]] = {
        "coulomb": "Coulomb friction",
        "static": "holds up to",
        "viscous": "viscous",
        "stribeck_rate": "Stribeck rate",
        "coefficient": "under load",
        "static_coefficient": "holds under load by",
        **LABELS_OF_LOAD,
    }

    coulomb: float = parameter("N*m", sliding="N", rule="zero or more", default=0.0)
    static: float | None = parameter("N*m", sliding="N", rule="zero or more", default=None)
    viscous: float = parameter("N*m*s/rad", sliding="N*s/m", rule="zero or more", default=0.0)
    stribeck_rate: float | None = parameter("rad/s", sliding="m/s", rule="positive", default=None)
    exponent: float = parameter(rule="positive", default=2.0)
    coefficient: float = parameter(rule="zero or more", default=0.0)
    static_coefficient: float | None = parameter(rule="zero or more", default=None)
    radius: float | None = parameter("m", rule="positive", default=None)
    axial_radius: float | None = parameter("m", rule="zero or more", default=None)
    bending_arm: float | None = parameter("m", rule="positive", default=None)
    middle: float | None = parameter("m", default=None)
    on: bool = True
    where: float = field(default=0.0, repr=False)
    prescribed: float = field(default=0.0, repr=False)

    def __post_init__(self) -> None:
        """Check the parameters together."""
        ModalElement.__post_init__(self)
        for low, high in (("coulomb", "static"), ("coefficient", "static_coefficient")):
            least, most = getattr(self, low), getattr(self, high)
            if most is not None and not most >= least:
                raise InvalidParameterError(self, high, f"at least {low} = {least:g}, or left out", most)
        if not self.under_load:
            check_unloaded(self, "static_coefficient", *NUMBERS_OF_LOAD)

    def check_joint(self, place: str, slides: bool) -> None:
        """Refuse what a joint of this kind has not, or lacks."""
        check_load(self, place, slides)

    @property
    def under_load(self) -> bool:
        """Return whether the friction is of a load."""
        return self.coefficient > 0.0 or bool(self.static_coefficient)

    @packed
    def holding(self) -> float:
        """Torque up to which it holds, whatever the load, T_s0 [N*m] ([N])."""
        return self.coulomb if self.static is None else self.static

    @packed
    def holding_coefficient(self) -> float:
        """Coefficient up to which it holds under load, mu_s [-]."""
        return self.coefficient if self.static_coefficient is None else self.static_coefficient

    @packed
    def falling_rate(self) -> float:
        """Stribeck rate, 0 where friction falls at once [rad/s] ([m/s])."""
        return self.stribeck_rate or 0.0

    @packed
    def load_numbers(self) -> tuple[float, float, float, float]:
        """Weights of the joint's load and the bearing's middle, of hook ``bearing``."""
        return numbers_of_load(self)

    @packed
    def burden(self) -> float:
        """Load at the last evaluation, which kernels write [N*m] ([N])."""
        return 0.0

    def initial_change(self, met: Met) -> Change:
        """Slip if the joint moves, else stick: whether that holds is found next."""
        return self.sticks(met) if abs(met.rate) <= _AT_REST else self.slips(math.copysign(1.0, met.rate))

    def passed(self, k: int, met: Met) -> Change:
        """Stick where the rate passes zero; let go where holding takes too much."""
        return self.sticks(met) if k == 0 else self.slips(-math.copysign(1.0, met.load))

    def sticks(self, met: Met) -> Change:
        """Return the change by which it holds the joint at its position."""
        return Change(STUCK, memory={"where": self.where if self.mode == STUCK else met.angle})

    def slips(self, direction: float) -> Change:
        """Return the change by which it slips one way."""
        return Change(FORWARD if direction > 0.0 else BACKWARD)

    def follows(self, met: Met) -> Change:
        """Return the change at a joint of prescribed rate; at rest the last direction persists."""
        if abs(met.rate) > 0.5 * STANDSTILL_RATE:  # its functions pass at STANDSTILL_RATE, by round-off less
            mode = self.slips(met.rate).mode
        else:
            mode = self.mode if self.mode in (FORWARD, BACKWARD) else UNDECIDED
        return Change(mode, memory={"prescribed": 1.0})

    def is_free(self) -> Change:
        """Return the change once the joint's rate is prescribed no more."""
        return Change(self.mode, memory={"prescribed": 0.0})

    def change_said(self, before: int) -> str:
        """Return what is recorded: that it sticks, or slips, having done something else."""
        moves = self.mode in (FORWARD, BACKWARD)
        if before == self.mode or not (moves or before in (FORWARD, BACKWARD, UNDECIDED)):
            return ""
        return f"slips {self.modes[self.mode]}" if moves else "sticks"

    @property
    def bears(self) -> tuple[float, float]:
        """Friction is finite: it bears no impulse."""
        return 0.0, 0.0


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def _direction(mode_now: int) -> float:
    """Way along which it slips, or would; 0 where it does neither."""
    if mode_now == FORWARD or mode_now == PUSHED:
        return 1.0
    return -1.0 if mode_now == BACKWARD or mode_now == PULLED else 0.0


@inlined
def _fade(law: StickingFriction, rate: float) -> float:
    """Return the remaining share of the excess of static friction at a rate."""
    if law.mode == PUSHED or law.mode == PULLED:
        return 1.0
    if law.falling_rate == 0.0:
        return 0.0
    return math.exp(-((abs(rate) / law.falling_rate) ** law.exponent))


@inlined
def effort(law: StickingFriction, t: float, angle: float, rate: float) -> float:
    """Return the torque without load [N m] ([N]); zero in sticking, by a row."""
    dry = law.coulomb + (law.holding - law.coulomb) * _fade(law, rate)
    return float(-_direction(law.mode) * dry - law.viscous * rate)


@inlined
def write_rates(
    law: StickingFriction, angle: float, rate: float, power: float, rates: Floats, x: int
) -> None:
    """Power that it takes, whatever the load [W]."""
    rates[x] = -power


@inlined
def hold(law: StickingFriction) -> tuple[bool, float]:
    """Return whether the joint sticks, and the position."""
    return law.mode == STUCK, float(law.where)


@inlined
def grip(law: StickingFriction) -> float:
    """Return the largest sticking torque at the last evaluation's load [N m] ([N])."""
    return float(law.holding + law.holding_coefficient * law.burden)


@inlined
def switch(law: StickingFriction, k: int, motion: Loaded) -> tuple[float, float]:
    """Rate in the direction of slipping; what is left of the grip while it sticks.

    Where the rate is prescribed the function passes zero once the joint moves the other way: round-off of a
    joint that stands changes nothing.
    """
    _, _, rate, load = motion
    if k == 0:
        if law.prescribed != 0.0:
            if law.mode == UNDECIDED:
                return float(STANDSTILL_RATE - abs(rate)), 0.0
            return float(_direction(law.mode) * rate + STANDSTILL_RATE), 0.0
        if law.mode == FORWARD:
            return float(rate), 0.0
        if law.mode == UNDECIDED:
            return -1.0, 0.0
        return (float(-rate), 0.0) if law.mode == BACKWARD else (1.0, 0.0)
    return (grip(law) - abs(load), 0.0) if law.mode == STUCK else (1.0, 0.0)


@inlined
def rub(law: StickingFriction, rate: float, own: Own) -> float:
    """Torque by load, with its sign [-]."""
    level = law.coefficient + (law.holding_coefficient - law.coefficient) * _fade(law, rate)
    return float(-_direction(law.mode) * level)


@inlined
def bear(law: StickingFriction, burden: float) -> None:
    """Take notice of the load [N m] ([N])."""
    law.burden = burden  # type: ignore[misc]  # of the record
