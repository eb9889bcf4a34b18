"""Dry friction that sticks: Coulomb's, static, Stribeck's, viscous, under load."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.elements.modal import Change, Met, ModalElement, Remembered
from antenna_pin.elements.own_load import (
    LABELS_OF_LOAD,
    NUMBERS_OF_LOAD,
    check_load,
    check_unloaded,
    numbers_of_load,
)
from antenna_pin.elements.sticking_friction_kernels import STANDSTILL_RATE
from antenna_pin.errors import InvalidParameterError

__all__ = ["StickingFriction"]

# In the order of their numbers in the kernels.
_MODES = ("undecided", "forward", "backward", "sticks", "pushed", "pulled")
_UNDECIDED, _FORWARD, _BACKWARD, _STUCK = range(4)
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
        middle: Where the bearing's middle is, from the joint's origin along its axis [m].

    References:
        Names of the load as those of joint friction in Adams and MotionSolve: F radial and axial, a bending
        arm, a preload torque (here ``coulomb``).
    """

    kernels: ClassVar[str] = "sticking_friction_kernels"
    modes: ClassVar[tuple[str, ...]] = _MODES
    change_names: ClassVar[Mapping[str, tuple[str, ...]]] = {"stick": ("sticks",), "slip": ("slips",)}
    switches: ClassVar[int] = 2
    loaded: ClassVar[tuple[int, ...]] = (1,)
    remembers: ClassVar[tuple[str, ...]] = ("where", "prescribed")
    goes_by: ClassVar[Mapping[str, Remembered]] = {"where": "way"}
    goes_by_in: ClassVar[tuple[int, ...]] = (_STUCK,)
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

    def derived(self) -> dict[str, Any]:
        """Return the packed parameters that are no fields of the element."""
        on_load = self.coefficient if self.static_coefficient is None else self.static_coefficient
        return {
            "static": self.coulomb if self.static is None else self.static,
            "stribeck_rate": self.stribeck_rate or 0.0,
            "static_coefficient": on_load,
            **numbers_of_load(self),
            "burden": 0.0,
        }

    def initial_change(self, met: Met) -> Change:
        """Slip if the joint moves, else stick: whether that holds is found next."""
        return self.sticks(met) if abs(met.rate) <= _AT_REST else self.slips(math.copysign(1.0, met.rate))

    def passed(self, k: int, met: Met) -> Change:
        """Stick where the rate passes zero; let go where holding takes too much."""
        return self.sticks(met) if k == 0 else self.slips(-math.copysign(1.0, met.load))

    def sticks(self, met: Met) -> Change:
        """Return the change by which it holds the joint at its position."""
        return Change(_STUCK, memory={"where": self.where if self.mode == _STUCK else met.angle})

    def slips(self, direction: float) -> Change:
        """Return the change by which it slips one way."""
        return Change(_FORWARD if direction > 0.0 else _BACKWARD)

    def follows(self, met: Met) -> Change:
        """Return the change at a joint of prescribed rate; at rest the last direction persists."""
        if abs(met.rate) > 0.5 * STANDSTILL_RATE:  # its functions pass at STANDSTILL_RATE, by round-off less
            mode = self.slips(met.rate).mode
        else:
            mode = self.mode if self.mode in (_FORWARD, _BACKWARD) else _UNDECIDED
        return Change(mode, memory={"prescribed": 1.0})

    def is_free(self) -> Change:
        """Return the change once the joint's rate is prescribed no more."""
        return Change(self.mode, memory={"prescribed": 0.0})

    def change_said(self, before: int) -> str:
        """Return what is recorded: that it sticks, or slips, having done something else."""
        moves = self.mode in (_FORWARD, _BACKWARD)
        if before == self.mode or not (moves or before in (_FORWARD, _BACKWARD, _UNDECIDED)):
            return ""
        return f"slips {self.modes[self.mode]}" if moves else "sticks"

    @property
    def bears(self) -> tuple[float, float]:
        """Friction is finite: it bears no impulse."""
        return 0.0, 0.0
