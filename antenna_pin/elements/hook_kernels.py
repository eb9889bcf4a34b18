"""Hooks of force elements: kernels of a kind, with arguments and units.

A kind has those that it needs, in its own file, under these names and with these arguments
(``tests/elements/test_hooks.py`` compares them); :mod:`antenna_pin.elements.kernels` calls them by the number
of the kind, and does without those that a kind has not. Units are those of a turning joint, in brackets those
of a sliding one.

The first argument of all is the element as a record, which its class is the type of
(:meth:`antenna_pin.elements.element.ForceElement.layout`). A second one, ``tail``, has the numbers behind
that, if the kernel needs them. An element writes to its record only what is declared to be state, as a mode.
"""

from __future__ import annotations

from typing import Protocol, TypeVar

from antenna_pin.base.records import Floats, Pose
from antenna_pin.elements.desk_kernels import Desk

#: Time [s], the joint's angle [rad] ([m]) and rate [rad/s] ([m/s]).
Motion = tuple[float, float, float]
#: The joint's angle [rad] ([m]) and rate [rad/s] ([m/s]), and the power that the element puts in [W].
Powered = tuple[float, float, float]
#: As ``Motion``; then the load of a hold [N m] ([N]), or the joint's reduced inertia [kg m^2] ([kg]).
Loaded = tuple[float, float, float, float]
#: An array and a place: the numbers that the element integrates begin at ``y[i]``.
Own = tuple[Floats, int]
#: Centre [m] and unit axis of a journal in its bearing's axes.
JournalPlace = tuple[float, float, float, float, float, float]


#: A kind's class, as whose record its kernels see the numbers of an element.
_Record = TypeVar("_Record", contravariant=True)


class Hooks(Protocol[_Record]):
    """The kernels of one kind of element, as a module has them; none needs all."""

    def effort(self, element: _Record, t: float, angle: float, rate: float) -> float:
        """Return the torque on the joint [N m] ([N]); without it there is none.

        Between two joints: along the deflection, which ``angle`` and ``rate`` are then.
        """

    def write_rates(
        self, element: _Record, angle: float, rate: float, power: float, rates: Floats, x: int
    ) -> None:
        """Write the rates of what it integrates (``integrals`` of its class) to ``rates[x:]``.

        Without it these are the work of a drive, or no loss. ``power`` is that which it puts in [W]; an
        integral's rate has its unit per second.
        """

    def stored(self, element: _Record, angle: float) -> float:
        """Return the energy stored [J]; a kind without it stores none."""

    def effort_of(self, element: _Record, motion: Motion, own: Own) -> float:
        """Return the torque [N m] ([N]) of a kind with states; replaces ``effort``."""

    def write_rates_of(self, element: _Record, motion: Powered, own: Own, rates: Floats, x: int) -> None:
        """Write the rates of integrals and states of a kind with states to ``rates[x:]``."""

    def stored_of(self, element: _Record, angle: float, own: Own) -> float:
        """Return the energy stored [J] of a kind with states."""

    def kink(self, element: _Record, t: float, angle: float, rate: float) -> float:
        """Return a function that passes zero where the effort has a kink: steps end there."""

    def kink_of(self, element: _Record, k: int, motion: Motion, own: Own) -> float:
        """Return function k of its ``kinks``, of a kind with states or with several."""

    def reference(self, element: _Record, t: float) -> tuple[float, float]:
        """Return the reference that it follows [rad] ([m]) and its rate [rad/s] ([m/s])."""

    def motion(self, element: _Record, t: float) -> tuple[float, float, float]:
        """Return the motion that it prescribes: position [rad] ([m]), its rate and its acceleration."""

    def switch(self, element: _Record, k: int, motion: Loaded) -> tuple[float, float]:
        """Return function k of its ``switches`` and its rate, 0 where unknown.

        It is positive while the mode stays, and the mode may change where it passes zero (``passed`` of its
        class); of another mode's functions it is 1. A function that is ``weighed`` has the joint's reduced
        inertia for a load.
        """

    def hold(self, element: _Record) -> tuple[bool, float]:
        """Return whether it holds its joint rigidly now, and the angle at which [rad] ([m])."""

    def grip(self, element: _Record) -> float:
        """Return the largest sticking torque at the last evaluation's load [N m] ([N])."""

    def bearing(self, element: _Record) -> tuple[float, float, float, float]:
        """Return the weights of its joint's load and the bearing's middle.

        Torque over radial force, over axial force [m] ([-]) and over moment [-] ([1/m]); the middle along the
        joint's axis [m]. Without it they are the record's ``load_numbers``.
        """

    def rub(self, element: _Record, rate: float, own: Own) -> float:
        """Return the torque of friction over the load, with its sign [-]."""

    def bear(self, element: _Record, burden: float) -> None:
        """Store the load of the present evaluation [N m] ([N])."""

    def between(
        self, element: _Record, angle: float, rate: float, other: float, other_rate: float
    ) -> tuple[float, float, float, float]:
        """Return the deflection between two joints, its rate, and its derivatives over both angles.

        ``angle`` and ``rate`` are of the input, ``other`` and ``other_rate`` of the output.
        """

    def dissipation(self, element: _Record, x: float, rate: float) -> float:
        """Return the power of dampers along a deflection x [rad] ([m]) and its rate [W]."""

    def drag(self, element: _Record, torque: float, rate: float) -> float:
        """Return the friction torque on the input [N m] ([N]), by torque and rate."""

    def press(self, element: _Record, pose: Pose) -> float:
        """Write force, and moment about its centre, into the journal's pose; return loss [W]."""

    def journal_energy(self, element: _Record, place: JournalPlace) -> float:
        """Return the energy stored [J] of a kind that acts on a journal's whole pose."""

    def coordinates(
        self, element: _Record, place: JournalPlace
    ) -> tuple[float, float, float, float, float, float]:
        """Return a journal's displacement [m], tilts about x and y, reference point [m]."""

    def tension(self, element: _Record, length: float, rate: float) -> float:
        """Return the force that draws points together [N], of distance [m] and rate [m/s]."""

    def loss(self, element: _Record, rate: float) -> float:
        """Return the power lost between two points [W]."""

    def act(self, element: _Record, t: float, desk: Desk) -> None:
        """Write forces and torques on links and joints, and rates of states, to the desk.

        The desk has the motions that they follow from, all in world axes
        (:mod:`antenna_pin.elements.desk_kernels`); zero stands there before.
        """
