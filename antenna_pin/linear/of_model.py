"""The modes of a scenario, of a system, or of a run where it ended."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.assemble import build_system, initial_angles, initial_state
from antenna_pin.base.arguments import takes
from antenna_pin.base.interruption import uninterrupted
from antenna_pin.base.state import State
from antenna_pin.dynamics import System, check_closed, first_modes
from antenna_pin.errors import FileFormatError, InvalidParameterError
from antenna_pin.linear.play import Play, prepared
from antenna_pin.linear.result import Modes, modes_at
from antenna_pin.scenario import Scenario, scenario_named
from antenna_pin.simulation import simulate
from antenna_pin.simulation.inputs import check_sizes
from antenna_pin.trajectory import Trajectory, is_lean

__all__ = ["modes"]

Array = NDArray[np.float64]


@takes(at="s", approach_speed="m/s")
def modes(
    model: Scenario | System | Trajectory | str | os.PathLike[str],
    *,
    at: float | State | Trajectory | None = None,
    q: ArrayLike | None = None,
    v: ArrayLike | None = None,
    play: Play | Mapping[str, Play] | None = None,
    load: ArrayLike | Mapping[str, ArrayLike] | None = None,
    approach_speed: float | None = None,
    hold: Sequence[str] = (),
    moving: bool = False,
) -> Modes:
    """Return natural frequencies, damping ratios and shapes of small motions about a state.

    Args:
        model: A scenario, or its name or path, or a system; or a run, which means the state that it ended in.
        at: A time to which a scenario is run first [s], a run for the state that it ended in, or a state; the
            start if not given.
        q: Configuration instead, (nq,).
        v: Velocity beside q, (nv,); zero if not given.
        play: What joints with play are taken as: ``ideal``, ``free`` in their play, or in ``contact`` as they
            touch in the state; one for all or by name. Those that are not named are ideal, but in contact if
            they have a load.
        load: Force that presses the journal into the bearing, in bearing axes, (3,) [N]; by joint if several
            have play. The journal rests where its contacts balance it; it is held up by nothing else.
        approach_speed: That contacts under a load remember [m/s], on which the damping of many laws depends;
            their joint's floor if not given.
        hold: Names of joints that do not move; ``base`` is a free base.
        moving: Whether the state's velocities and accelerations count. If not, it is taken at rest, and what
            would set it moving is held in balance.

    Raises:
        AntennaPinError: What is asked makes no sense; one line that says why.
    """
    model = scenario_named(model)
    if isinstance(model, Trajectory):
        for name, given in (("at", at), ("q", q), ("v", v)):
            if given is not None:
                raise InvalidParameterError("modes", name, "left out for a run, which has its end", given)
        if model.scenario is None:
            raise FileFormatError(
                "modes: a run must carry its scenario to be linearised, got one of a system built in Python; "
                "give the system, and at = run"
            )
        at, model = model, model.scenario
    if at is not None and (q is not None or v is not None):
        raise InvalidParameterError("modes", "q" if q is not None else "v", "left out beside at", "both")
    scenario = model if isinstance(model, Scenario) else None
    if not isinstance(model, Scenario | System):
        raise InvalidParameterError(
            "modes", "model", "a Scenario, System or Trajectory", type(model).__name__
        )
    if isinstance(at, int | float):
        at = _reached(model, float(at))
    system = build_system(model) if isinstance(model, Scenario) else model
    more: dict[str, Any] = {}
    if isinstance(at, Trajectory):
        end = _end(at)
        y = _last(system, at, end)
        touching = at.data["touching"].values[-1] if "touching" in at.data else end.memory[:, 0]
        # What changed between the state that a run leaves and its end forgets how it came about.
        known = np.array_equal(np.asarray(touching, dtype=float), end.memory[:, 0])
        more = {"time": end.reached, "memory": end.memory if known else None, "adjusted": end.adjusted}
    elif isinstance(at, State):
        check_sizes(system, at, "modes", "at")
        y = at.y
        more = {"time": at.time, "memory": at.memory, "adjusted": at.adjusted}
    else:
        y = _start(model, system, q, v)
        more = {"adjusted": first_modes(system, y)}
    found = prepared(
        system,
        y,
        play=play,
        load=load,
        approach_speed=approach_speed,
        hold=hold,
        moving=moving,
        **more,
    )
    return modes_at(found, scenario)


def _end(run: Trajectory) -> State:
    if run.end is None:
        raise FileFormatError("modes: a run must have its end to be linearised there, got none; run it again")
    return run.end


def _reached(model: Scenario | System, time: float) -> Trajectory | None:
    """Return a run up to a time; None for the start."""
    if not 0.0 <= time < np.inf:
        raise InvalidParameterError("modes", "at", "a time of zero or more [s]", time)
    if time == 0.0:
        return None
    run = uninterrupted(simulate(model, duration=time))
    if not run.completed:
        raise InvalidParameterError(
            "modes", "at", "a time that the run reaches", time, said=f"{time:g} s: {run.message}"
        )
    return run


def _last(system: System, run: Trajectory, end: State) -> Array:
    """Return the state at a run's last instant; the one that it left lies up to two steps before."""
    check_sizes(system, end, "modes", "at")
    y = end.y
    if not is_lean(run.data):
        nq, nv = system.model.nq, system.model.nv
        y[:nq], y[nq : nq + nv] = run.data["q"].values[-1], run.data["v"].values[-1]
        system.turn_on(y)
    return y


def _start(model: Scenario | System, system: System, q: ArrayLike | None, v: ArrayLike | None) -> Array:
    if isinstance(model, Scenario):
        first_q, first_v = initial_state(model, system)
        angles = initial_angles(model, system) if q is None else None
    else:
        first_q, first_v, angles = system.neutral(), np.zeros(system.model.nv), None
    given_v = np.zeros(system.model.nv) if q is not None and v is None else first_v if v is None else v
    y = system.state(first_q if q is None else q, given_v, angles)
    check_closed(system, y)
    return y
