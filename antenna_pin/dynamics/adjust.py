"""Elements of a run: all of a system, those that take commands, numbers that change."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.parameters import parameters_of
from antenna_pin.dynamics import kernels
from antenna_pin.dynamics.mode_kernels import is_held
from antenna_pin.dynamics.system import System
from antenna_pin.elements import FAMILIES, Change, Element, ForceElement, Met, Modal, kind_of
from antenna_pin.elements.control import Controller
from antenna_pin.errors import InvalidParameterError, UnknownNameError

# --- elements -----------------------------------------------------------------------------------------------


class Acting(NamedTuple):
    """An element of a system."""

    family: str  # table in a scenario, such as ``drives``
    name: str  # name in that table
    element: ForceElement  # the element
    block: int  # place of its block in a program

    @property
    def label(self) -> str:
        """Name in messages."""
        return f"{FAMILIES[self.family].word} {self.name!r}"

    @property
    def place(self) -> str:
        """Place in a scenario."""
        return f"{self.family}.{self.name}"


def check_begins(system: System, y: NDArray[np.float64]) -> None:
    """Refuse a start [q, v, x] outside the range of an element that is on."""
    for one in acting_in(system):
        if one.element.acts and one.element.acts_at is not None and one.element.ends:
            angle, _, _, _ = kernels.joint_motion(system.program, one.block, y, system.model.nq)
            one.element.check_begin(one.label, float(angle))


def acting_in(system: System) -> Iterator[Acting]:
    """Yield the drives, then the springs of a system, then those of further families."""
    for family, elements in system.families.items():
        for name, element in elements.items():
            yield Acting(family, name, element, system.element_blocks[family][name])


# --- elements that take commands ----------------------------------------------------------------------------


def actuators_of(system: System) -> Mapping[str, str]:
    """Return places that take commands by name: the place, ``drives.motor``, ``motor`` if unique."""
    found: dict[str, str] = {}
    twice = set()
    for one in acting_in(system):
        if one.element.commanded:
            place = f"{one.place}.{one.element.commanded}"
            if one.name in found:
                twice.add(one.name)
            found |= {one.name: place, one.place: place, place: place}
    return {name: place for name, place in found.items() if name not in twice}


def settled(controllers: Mapping[str, Controller], system: System) -> dict[str, Controller]:
    """Return controllers with the joints that they command, and these joints' axes."""
    places = actuators_of(system)
    elements = {one.place: one.element for one in acting_in(system)}
    found: dict[str, Controller] = {}
    for name, one in controllers.items():
        joints = {command: elements[places[command].rpartition(".")[0]].acts_at for command in one.commands}
        axes = {command: _axis_in_base(system, joint) for command, joint in joints.items()}
        found[name] = one.placed(joints, axes)
    return found


def _axis_in_base(system: System, joint: str | None) -> NDArray[np.float64] | None:
    """Return the axis of a joint in a free base's axes, (3,), or None."""
    mechanism = system.mechanism
    if joint is None or mechanism.base != "free":
        return None
    slot = mechanism.joint(joint)
    if mechanism.model.parents[slot.joint_id] != 1:
        return None
    turned = mechanism.model.jointPlacements[slot.joint_id].rotation @ slot.frame_rotation.T
    return np.asarray(turned @ slot.axis)


# --- numbers that change ------------------------------------------------------------------------------------

Array = NDArray[np.float64]

_ON = "on"


class Adjustments:
    """Present elements of a run, in its copy of a program.

    A place is written as in a scenario file: ``drives.motor.value``, ``springs.coil.stiffness``. Besides its
    own numbers an element has ``on``; if off, it does not act. A prescribed motion has no ``on``.

    Args:
        system: The system; not changed.
        program: The run's copy of its program; written.

    Attributes:
        values: Changed values, by place.
        elements: Present elements, by place.
    """

    def __init__(self, system: System, program: Array) -> None:
        """Begin with the system's own numbers."""
        self._program = program
        self.values: dict[str, float] = {}
        self.elements: dict[str, ForceElement] = {one.place: one.element for one in acting_in(system)}
        self._blocks = {one.place: one.block for one in acting_in(system)}

    def set(self, place: str, value: float) -> None:
        """Change one number.

        Args:
            place: Its place.
            value: In SI units; of ``on`` true or false.

        Raises:
            AntennaPinError: There is no such place, or it cannot have this value.
        """
        element, _, key = place.rpartition(".")
        if element not in self._blocks:
            raise UnknownNameError("Set", "element", element or place, self._blocks)
        source = self.elements[element]
        keys = [name for name, parameter in parameters_of(type(source)).items() if not parameter.sizes]
        keys = [key for key in keys if key not in source.at_start]
        if hasattr(source, _ON):
            keys.append(_ON)
        elif key == _ON:
            rule = "left alone: a prescribed motion holds all the time; use a pd drive instead"
            raise InvalidParameterError("Set", place, rule, value)
        keys += source.own_keys()
        block = self._blocks[element]
        if key == _ON:
            if value not in (True, False):
                raise InvalidParameterError("Set", place, "true or false", value)
            self.elements[element] = dataclasses.replace(source, on=bool(value))  # type: ignore[call-arg]
            head = self._program[block : block + kernels.PARAMETERS].view(kernels.ELEMENT)
            head["on"] = float(value)
            if isinstance(source, Modal) and not value:
                self.change(element, Change(0))  # released when switched off
        elif key in keys:
            given = int(value) if key == "mode" else float(value)
            changed = dataclasses.replace(source, **{key: given})
            self._write(element, changed)
        else:
            raise UnknownNameError("Set", f"number of {element}", key, keys)
        self.values[place] = float(value)

    def snapshot(self) -> tuple[Array, dict[str, float], dict[str, ForceElement]]:
        """Return what is needed to go back to these numbers."""
        return self._program.copy(), dict(self.values), dict(self.elements)

    def go_back(self, snapshot: tuple[Array, dict[str, float], dict[str, ForceElement]]) -> None:
        """Restore the numbers of a snapshot."""
        self._program[:] = snapshot[0]
        self.values, self.elements = dict(snapshot[1]), dict(snapshot[2])

    def change(self, element: str, change: Change) -> None:
        """Bring an element, by its place, into another mode."""
        source = self.elements[element]
        values: dict[str, float] = {"mode": change.mode, **change.memory}
        self._write(element, dataclasses.replace(source, **values))
        for key, value in values.items():
            self.values[f"{element}.{key}"] = float(value)

    def _write(self, element: str, changed: ForceElement) -> None:
        words = changed.words_of_kernel()
        if len(words) != len(self.elements[element].words_of_kernel()):
            rule = "left alone: of how many parts an element is cannot change in a run"
            raise InvalidParameterError("Set", f"number of {element}", rule, said="another")
        self.elements[element] = changed
        first = self._blocks[element] + kernels.PARAMETERS
        self._program[first : first + len(words)] = words

    def held_joints(self) -> frozenset[str]:
        """Return the joints that elements hold at present."""
        return frozenset(
            element.joint
            for place, element in self.elements.items()
            if isinstance(element, Element) and self.holds(place)
        )

    def holds(self, place: str) -> bool:
        """Return whether an element, by its place, holds its joint at present."""
        words = self._blocks[place] + int(kernels.PARAMETERS)
        return bool(is_held(kind_of(type(self.elements[place])), self._program, words))


def first_modes(system: System, y: Array, t: float = 0.0) -> tuple[tuple[str, float], ...]:
    """Return the modes of elements in an initial state [q, v, x]: (place, value).

    An element that is switched off holds nothing and refuses no start.
    """
    program = system.program.copy()
    found = Adjustments(system, program)
    for one in acting_in(system):
        if isinstance(one.element, Modal):
            angle, rate, _, _ = kernels.joint_motion(program, one.block, y, system.model.nq)
            met = Met(t, float(angle), float(rate), 0.0)
            change = one.element.initial_change(met) if one.element.acts else one.element.first_off(met)
            if change is not None:
                found.change(one.place, change)
                for other in change.switches_off:  # a latch that holds at the start has captured
                    found.set(f"{other}.on", False)
    return tuple(found.values.items())


def modes_kept(system: System, adjusted: Sequence[tuple[str, float]]) -> tuple[tuple[str, float], ...]:
    """Return the mode-dependent adjustments of another system: (place, value).

    For a latch that holds these include the elements that it has switched off.
    """
    modal = {one.place: one.element for one in acting_in(system) if isinstance(one.element, Modal)}
    others = {f"{place}.on" for one in modal.values() for place in getattr(one, "switches_off", ())}
    found = []
    for key, value in adjusted:
        place, _, name = key.rpartition(".")
        if key in others or (place in modal and name in modal[place].own_keys()):
            found.append((key, value))
    return tuple(found)


def modes_in_another(
    system: System, y: Array, t: float, adjusted: Sequence[tuple[str, float]]
) -> tuple[tuple[str, float], ...]:
    """Return the continued modes of elements in a state of another system: (place, value).

    Args:
        system: The other.
        y: State, which is one of it.
        t: Time [s].
        adjusted: Their modes before (:func:`modes_kept`).

    Raises:
        InvalidParameterError: An element cannot continue there.
    """
    found = Adjustments(system, system.program.copy())
    for place, value in adjusted:
        found.set(place, value)
    nq, nv = system.model.nq, system.model.nv
    for one in acting_in(system):
        element = found.elements[one.place]
        if isinstance(element, Modal) and element.on:  # type: ignore[attr-defined]
            angle, rate, _, _ = kernels.joint_motion(system.program, one.block, y, nq)
            head = system.program[one.block :][: kernels.PARAMETERS].view(kernels.ELEMENT)[0]
            first = nq + nv + int(head["x"])
            own = tuple(float(y[first + k]) for k in range(len(element.integrals)))
            change = element.in_another(Met(t, float(angle), float(rate), 0.0, own))
            if change is not None:
                found.change(one.place, change)
    return tuple(found.values.items())


def joints_held(system: System, adjusted: Sequence[tuple[str, float]]) -> frozenset[str]:
    """Return the joints that elements hold where numbers have been changed: (place, value)."""
    if not system.holds:
        return frozenset()
    found = Adjustments(system, system.program.copy())
    for place, value in adjusted:
        found.set(place, value)
    return found.held_joints()
