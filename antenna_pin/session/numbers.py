"""Numbers of a session's present state, by name.

Three kinds of names::

    JOINT.angle  JOINT.rate                                 of a joint that has an axis, whole turns included
    CONTACT.gap  .depth_rate  .force  .touching             of a contact such as elevation.radial+
    TABLE.NAME.KEY                                          a number of an element: drives.motor.value

and any quantity of a result, as sections and figures name it (:mod:`antenna_pin.analysis.quantity`):
``motion_angle[hinge]``, ``joint_force[hinge].x``, ``|joint_force[hinge]|``, ``kinetic_energy``. Those of the
first kinds take microseconds, a quantity some milliseconds for the first of a state.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import xarray as xr

from antenna_pin.analysis import Quantity, quantities, quantity
from antenna_pin.base.parameters import parameters_of
from antenna_pin.dynamics import acting_in
from antenna_pin.elements import Element
from antenna_pin.errors import AntennaPinError, UnknownNameError
from antenna_pin.simulation.events import Moment
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.recorder import at_present

__all__ = ["Numbers", "slides"]

_OF_CONTACT = {"gap": "m", "depth_rate": "m/s", "force": "N", "touching": "1"}
_SHOWN = 6  # names that a message offers


def slides(run: Run, joint: str) -> bool:
    """Return whether a joint slides along its axis."""
    return run.system.mechanism.joint(joint).kind == "prismatic"


class Numbers:
    """The numbers of a run's present state, by name.

    Args:
        run: The run; another one of the same system may take its place.
    """

    def __init__(self, run: Run) -> None:
        """Find what there is."""
        self._quick: dict[str, Callable[[Moment], float]] = {}
        #: Of those of the first kinds, by name.
        self.units: dict[str, str] = {}
        #: Those that are an element's, which may be set.
        self.settable: list[str] = []
        self.use(run)
        self._find_joints()
        for contact in run.system.contact_names:
            for of, unit in _OF_CONTACT.items():
                self._add(f"{contact}.{of}", unit, _of_contact(of, contact))
        for one in acting_in(run.system):
            joint = one.element.acts_at
            slid = joint is not None and isinstance(one.element, Element) and slides(run, joint)
            for key, parameter in parameters_of(type(one.element)).items():
                if isinstance(getattr(one.element, key), int | float) and not parameter.sizes:
                    unit = one.element.unit(key, slid)
                    self._add(f"{one.place}.{key}", unit, self._of_element(one.place, key))
            if hasattr(one.element, "on"):
                self._add(f"{one.place}.on", "1", self._of_element(one.place, "on"))
        self.settable = [
            name for name in self.units if name.rpartition(".")[0] in run.actions.adjustments.elements
        ]

    def use(self, run: Run) -> None:
        """Have the numbers of a run; what was known of another is forgotten."""
        self._run = run
        self._moment = Moment(run.workspace)
        self.forget()

    def forget(self) -> None:
        """Forget what is known of a state that was the present one."""
        self._set = False
        self._data: xr.Dataset | None = None

    def __getitem__(self, name: str) -> float:
        """Return a number.

        Raises:
            AntennaPinError: There is none of that name.
        """
        quick = self._quick.get(name)
        if quick is None:
            return self._quantity(name)
        if not self._set:
            self._moment.set(self._run.stepper.t, self._run.here)
            self._set = True
        return quick(self._moment)

    @property
    def data(self) -> xr.Dataset:
        """All that a result has of the present state, at its last sample."""
        if self._data is None:
            self._data = at_present(self._run)
        return self._data

    def names(self) -> dict[str, str]:
        """Return all names, each with its unit."""
        return {**self.units, **quantities(self.data)}

    def unit(self, name: str) -> str:
        """Return the unit of a number; "1" of one that has none.

        Raises:
            AntennaPinError: There is none of that name.
        """
        return self.units[name] if name in self.units else self._found(name).units

    def _quantity(self, name: str) -> float:
        return float(self._found(name).values[-1])

    def _found(self, name: str) -> Quantity:
        try:
            return quantity(self.data, name)
        except UnknownNameError as error:
            raise UnknownNameError("session", "number", name, self._near(name)) from error

    def _near(self, name: str) -> list[str]:
        import difflib

        return difflib.get_close_matches(name, self.names(), n=_SHOWN, cutoff=0.0)

    def _add(self, name: str, unit: str, read: Callable[[Moment], float]) -> None:
        self._quick[name], self.units[name] = read, unit

    def _find_joints(self) -> None:
        """Find the joints that have an axis."""
        moment = self._moment.set(self._run.stepper.t, self._run.here)
        for joint in self._run.system.mechanism.joints:
            try:
                moment.angle(joint)
            except AntennaPinError:
                continue
            unit = "m" if slides(self._run, joint) else "rad"
            self._add(f"{joint}.angle", unit, _angle(joint))
            self._add(f"{joint}.rate", f"{unit}/s", _rate(joint))

    def _of_element(self, place: str, key: str) -> Callable[[Moment], float]:
        def read(moment: Moment) -> float:
            return float(getattr(self._run.actions.adjustments.elements[place], key))

        return read


def _angle(joint: str) -> Callable[[Moment], float]:
    return lambda moment: moment.angle(joint)


def _rate(joint: str) -> Callable[[Moment], float]:
    return lambda moment: moment.rate(joint)


def _of_contact(of: str, contact: str) -> Callable[[Moment], float]:
    def read(moment: Moment) -> float:
        found: Any = getattr(moment, of)(contact)
        return float(found)

    return read
