"""Numbers of a session's present state, by name.

Three kinds of names::

    JOINT.angle  JOINT.rate                                 of a joint that has an axis, whole turns included
    CONTACT.gap  .depth_rate  .force  .touching             of a contact such as elevation.radial+
    TABLE.NAME.KEY                                          a number of an element: drives.motor.value

and any quantity of a result, named as in sections and figures (:mod:`antenna_pin.analysis.quantity`):
``motion_angle[hinge]``, ``joint_force[hinge].x``, ``|joint_force[hinge]|``, ``kinetic_energy``. The first
three take microseconds, the first quantity of a state some milliseconds.
"""

from __future__ import annotations

from collections.abc import Callable
from operator import methodcaller
from typing import Any

import xarray as xr

from antenna_pin.analysis import Quantity, quantities, quantity
from antenna_pin.base.parameters import parameters_of
from antenna_pin.dynamics import acting_in
from antenna_pin.elements import Element
from antenna_pin.errors import AntennaPinError, UnknownNameError
from antenna_pin.run.simulation.events import Moment
from antenna_pin.run.simulation.loop import Run
from antenna_pin.run.simulation.recorder import at_present

_OF_CONTACT = {"gap": "m", "depth_rate": "m/s", "force": "N", "touching": "1"}
_SHOWN = 6  # names that a message offers


def slides(run: Run, joint: str) -> bool:
    """Return whether a joint slides along its axis."""
    return run.system.slides(joint)


class StateNumbers:
    """Numbers of a run's present state, by name.

    Args:
        run: Run; another run of the same system may take its place.
    """

    def __init__(self, run: Run) -> None:
        """Find the names."""
        self._quick: dict[str, Callable[[Moment], Any]] = {}
        #: Units of joints', contacts' and elements' numbers, by name.
        self.units: dict[str, str] = {}
        self.use(run)
        self._find_joints()
        for contact in run.system.contact_names:
            for of, unit in _OF_CONTACT.items():
                self._add(f"{contact}.{of}", unit, methodcaller(of, contact))
        for one in acting_in(run.system):
            joint = one.element.acts_at
            slid = joint is not None and isinstance(one.element, Element) and slides(run, joint)
            for key, parameter in parameters_of(type(one.element)).items():
                if isinstance(getattr(one.element, key), int | float) and not parameter.sizes:
                    unit = one.element.unit(key, slid)
                    self._add(f"{one.place}.{key}", unit, self._of_element(one.place, key))
            if hasattr(one.element, "on"):
                self._add(f"{one.place}.on", "1", self._of_element(one.place, "on"))
        #: Places of the elements' numbers.
        self.settable = [
            name for name in self.units if name.rpartition(".")[0] in run.actions.adjustments.elements
        ]

    def use(self, run: Run) -> None:
        """Read the numbers of a run from now on."""
        self._run = run
        self._moment = Moment(run.workspace)
        self.forget()

    def forget(self) -> None:
        """Discard the numbers of an earlier state."""
        self._set = False
        self._data: xr.Dataset | None = None

    def __getitem__(self, name: str) -> float:
        """Return a number.

        Raises:
            AntennaPinError: The name is unknown.
        """
        quick = self._quick.get(name)
        if quick is None:
            return float(self._quantity(name).values[-1])
        if not self._set:
            self._moment.set(self._run.stepper.t, self._run.here)
            self._set = True
        return float(quick(self._moment))

    @property
    def data(self) -> xr.Dataset:
        """Result of the present state, at its last sample."""
        if self._data is None:
            self._data = at_present(self._run)
        return self._data

    def names(self) -> dict[str, str]:
        """Return all names, each with its unit."""
        return {**self.units, **quantities(self.data)}

    def unit(self, name: str) -> str:
        """Return the unit of a number, "1" for none.

        Raises:
            AntennaPinError: The name is unknown.
        """
        return self.units[name] if name in self.units else self._quantity(name).units

    def _quantity(self, name: str) -> Quantity:
        try:
            return quantity(self.data, name)
        except UnknownNameError as error:
            import difflib

            similar = difflib.get_close_matches(name, self.names(), n=_SHOWN, cutoff=0.0)
            raise UnknownNameError("session", "number", name, similar) from error

    def _add(self, name: str, unit: str, read: Callable[[Moment], Any]) -> None:
        self._quick[name], self.units[name] = read, unit

    def _find_joints(self) -> None:
        """Add the joints with an axis."""
        moment = self._moment.set(self._run.stepper.t, self._run.here)
        for joint in self._run.system.mechanism.joints:
            try:
                moment.angle(joint)
            except AntennaPinError:
                continue
            unit = "m" if slides(self._run, joint) else "rad"
            self._add(f"{joint}.angle", unit, methodcaller("angle", joint))
            self._add(f"{joint}.rate", f"{unit}/s", methodcaller("rate", joint))

    def _of_element(self, place: str, key: str) -> Callable[[Moment], Any]:
        return lambda moment: getattr(self._run.actions.adjustments.elements[place], key)
