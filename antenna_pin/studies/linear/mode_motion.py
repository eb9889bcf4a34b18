"""Mode shapes as periodic motions: trajectories for recordings."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import number
from antenna_pin.base.rules import Positive
from antenna_pin.dynamics import System, acting_in
from antenna_pin.elements import Modal
from antenna_pin.run.simulation.attributes import mechanism_attributes
from antenna_pin.studies.linear.modal_analysis import Modes, bodies_of
from antenna_pin.studies.linear.operating_point import At
from antenna_pin.trajectory import Counts, Outcome, Trajectory

# What a body moves or turns by at most where nothing else is said: of the mechanism's size, and [rad].
_WAY, _TURN = 0.08, 0.25
# Swings shown, pictures of each.
_SWINGS, _PICTURES = 3, 48


@takes()
def swing(modes: Modes, mode: int, amplitude: Positive = 1.0) -> Trajectory:
    """Return an undamped motion in one mode, scaled for visibility.

    The time covers one period; a motion without frequency takes one second.

    Args:
        modes: The modes.
        mode: Its number, from 1.
        amplitude: Factor on the default amplitude, at which no body turns by more than 0.25 rad or moves by
            more than 8 % of the mechanism's size [-].

    Raises:
        InvalidParameterError: The mode is unknown, or the amplitude is not positive.
    """
    shape = modes.shape(mode)
    linear = modes.linearisation
    system, at = linear.system, linear.at
    frequency = float(modes.frequency[mode - 1])
    period = 1.0 / frequency if frequency > 0.0 else 1.0
    phase = np.linspace(0.0, 2.0 * np.pi * _SWINGS, _SWINGS * _PICTURES + 1)
    factor = amplitude * _largest(modes, shape)
    steps = factor * (np.outer(np.sin(phase), shape.real) + np.outer(np.cos(phase), shape.imag))
    rates = factor * (np.outer(np.cos(phase), shape.real) - np.outer(np.sin(phase), shape.imag))
    q = np.array([pin.integrate(system.model, at.q, step) for step in steps])
    v = rates * 2.0 * np.pi / period
    time = phase / (2.0 * np.pi) * period
    row = modes.data.sel(mode=mode)
    kind, ratio = str(row["kind"].item()), float(row["damping_ratio"].item())
    said = f"mode {mode}: {number(frequency)} Hz" if frequency > 0.0 else f"mode {mode}: {kind}"
    if frequency > 0.0 and np.isfinite(ratio):
        said += f", damping {number(100.0 * ratio)} %"
    said += ", drawn as large as can be seen"
    configuration, velocity = list(system.names_q), list(system.names_v)
    discrete = _element_modes(system, at)
    data = xr.Dataset(
        {
            "q": (("time", "configuration"), q, {"units": "m, rad or 1"}),
            "v": (("time", "coordinate"), v, {"units": "m/s or rad/s"}),
            "element_mode": (("time", "element"), np.tile(list(discrete.values()), (len(time), 1))),
        },
        coords={
            "time": ("time", time, {"units": "s"}),
            "configuration": configuration,
            "coordinate": velocity,
            "element": list(discrete),
        },
        attrs={
            "form": "full",
            "title": modes.data.attrs["title"],
            "case": " - ".join(filter(None, (modes.data.attrs["case"], said))),
            "end_time": float(time[-1]),
            "samples": len(time),
            **mechanism_attributes(system),
        },
    )
    return Trajectory(
        data=data, outcome=Outcome.COMPLETED, message=said, counts=Counts(), scenario=modes.scenario, end=None
    )


def _element_modes(system: System, at: At) -> dict[str, int]:
    """Return the modes of elements in the state, by place."""
    numbers = {one.place: one.element.mode for one in acting_in(system) if isinstance(one.element, Modal)}
    changed = {place: int(number) for place, number in at.adjusted if place.endswith(".mode")}
    return {place: changed.get(f"{place}.mode", number) for place, number in numbers.items()}


def _largest(modes: Modes, shape: NDArray[np.complex128]) -> float:
    """Return the scale factor of a shape for visibility."""
    linear = modes.linearisation
    bodies = bodies_of(linear.system, linear.at.q)
    model = linear.system.model
    data = model.createData()
    pin.forwardKinematics(model, data, linear.at.q)
    places = np.array([place.translation for place in list(data.oMi)[1:]])
    spread = float(np.linalg.norm(np.ptp(places, axis=0)))
    levers = [float(np.linalg.norm(own.lever)) for own in list(model.inertias)[1:]]
    size = max(spread, *levers, 0.05)
    moved = np.abs(np.einsum("bik,k->bi", bodies.motion, shape))
    ways, turns = np.linalg.norm(moved[:, :3], axis=1), np.linalg.norm(moved[:, 3:], axis=1)
    limits = [_WAY * size / one for one in ways if one > 0.0] + [_TURN / one for one in turns if one > 0.0]
    return min(limits, default=0.0)
