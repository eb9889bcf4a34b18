"""Parameters of a scenario that results are differentiated by, and their effect on start states."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from antenna_pin.base.state import State
from antenna_pin.base.units import quantity
from antenna_pin.dynamics import System, Workspace
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.scenario import Scenario, number_of
from antenna_pin.scenario.assemble import initial_angles, initial_state
from antenna_pin.studies.nonlinear.coordinates import configuration_difference

# Tables of computation and output, of which no motion is a differentiable function.
_NOT_OF_THE_MOTION = ("duration", "integrator", "output", "format")


class SensitivityError(AntennaPinError, RuntimeError):
    """A result without a derivative; the message gives the reason."""


class GrazeError(SensitivityError):
    """A contact or event that any perturbation adds or removes: there is no derivative.

    Attributes:
        time: Approximate time of the event; NaN if unknown [s].
    """

    def __init__(self, message: str, time: float = math.nan) -> None:
        super().__init__(message)
        self.time = time


class Parameter(NamedTuple):
    """Number of a scenario that results are differentiated by."""

    key: str  # key in the scenario
    value: float  # value in SI units
    unit: str  # SI unit; "" if it depends on other entries
    scale: float  # scale in the same unit, relative to which changes are small


def parameters_of(
    scenario: Scenario, keys: Sequence[str] | Mapping[str, float | str | None], place: str
) -> tuple[Parameter, ...]:
    """Return the parameters at some keys of a scenario.

    Args:
        scenario: The scenario.
        keys: As in ``--set``, ``mechanism.gravity[2]`` for one number of an array; a mapping gives each its
            scale, a number or text with a unit, or None for the size of its value.
        place: Name of the caller, for messages.

    Raises:
        InvalidParameterError: A key is given twice, none is given, one has no scale, or does not affect
            motions.
        UnknownNameError: The scenario has no such number.
    """
    scales = dict(keys) if isinstance(keys, Mapping) else dict.fromkeys(keys)
    if not scales:
        raise InvalidParameterError(place, "keys", "one key of the scenario or more", said="none")
    if len(scales) < len(keys):
        twice = next(key for key in keys if list(keys).count(key) > 1)
        raise InvalidParameterError(place, "keys", "named once each", said=f"{twice} twice")
    found = []
    for key, scale in scales.items():
        if key.split(".")[0] in _NOT_OF_THE_MOTION:
            rule = f"of the mechanism, its loads or its start, not of {', '.join(_NOT_OF_THE_MOTION)}"
            raise InvalidParameterError(place, "key", rule, said=key)
        number = number_of(scenario, key, place)
        size = abs(number.value) if scale is None else quantity(scale, number.unit or "1", f"{place}: {key}")
        if not 0.0 < size < math.inf:
            rule = (
                f"given with its scale, positive, where its value is 0: {{{key!r}: 0.1}}, or {key}=0.1 "
                "on the command line"
            )
            raise InvalidParameterError(place, key, rule, said="0" if scale is None else f"{scale}")
        found.append(Parameter(key, number.value, number.unit, size))
    return tuple(found)


# --- states that a run continues from -----------------------------------------------------------------------


def is_initial(key: str) -> bool:
    """Return whether a key belongs to the first state."""
    return key.split(".")[0] == "initial"


def check_start_keys(keys: tuple[str, ...], system: System) -> None:
    """Refuse keys of the first state where a run continues under constraints."""
    if system.plan is None:
        return
    for key in keys:
        if is_initial(key):
            rule = "none of initial.* where a run with closed loops or motions continues from a state (start)"
            raise InvalidParameterError("sensitivities", "key", rule, said=key)


def shifted_start(start: State, scenario: Scenario, other: Scenario, system: System) -> State:
    """Return a state shifted by the difference of the starts of two scenarios.

    Differences of a joint's position and rate apply along the joint's axis, of a joint with play in its
    bearing's axes, of the base in the world's axes, and of its velocities in its own.
    """
    here, there = (
        system.state(*initial_state(one, system), initial_angles(one, system)) for one in (scenario, other)
    )
    model, mechanism = system.model, system.mechanism
    nq, nv = model.nq, model.nv
    way, change = configuration_difference(system, here[:nq], there[:nq]), (there - here)[nq : nq + nv]
    free = [(slice(0, 7), slice(0, 6), False)] if mechanism.base == "free" else []
    free += [
        (slot.q, slot.v, True)
        for slot in (mechanism.joint(one.name) for one in system.clearances)
        if slot.kind == "floating"
    ]
    for q, v, play in free:
        turn = _rotation(start.q[q]).T @ _rotation(here[q])
        first = v.start
        way[first : first + 3] = turn @ way[first : first + 3]
        if play:
            change[first : first + 3] = turn @ change[first : first + 3]
            change[first + 3 : first + 6] = turn @ change[first + 3 : first + 6]
    y = start.y
    Workspace(system).retract(y, way)
    y[nq : nq + nv] += change
    system.turn_on(y)
    return dataclasses.replace(start, q=y[:nq].copy(), v=y[nq : nq + nv].copy(), x=y[nq + nv :].copy())


def _rotation(pose: np.ndarray) -> np.ndarray:
    """Return the rotation of a pose, (7,)."""
    return np.asarray(Rotation.from_quat(pose[3:7]).as_matrix())
