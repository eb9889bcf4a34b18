"""Modes of scenarios, systems and runs, with energy shares of bodies, as labelled tables."""

from __future__ import annotations

import itertools
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import check_number, takes
from antenna_pin.base.arrays import Array, Complex
from antenna_pin.base.interruption import uninterrupted
from antenna_pin.base.readable import number
from antenna_pin.base.state import State
from antenna_pin.base.views import ModesRecorder, ResponsePlotter, View, as_html
from antenna_pin.dynamics import BASE, System, check_closed, first_modes
from antenna_pin.errors import FileFormatError, InvalidParameterError
from antenna_pin.run.simulation import simulate
from antenna_pin.run.simulation.inputs import check_sizes
from antenna_pin.scenario import Scenario, scenario_named
from antenna_pin.scenario.assemble import build_system, initial_angles, initial_state
from antenna_pin.studies.linear.eigenmodes import Eigen, solve
from antenna_pin.studies.linear.linearisation import Linearisation, linearise, rotors
from antenna_pin.studies.linear.operating_point import At, Play, prepared
from antenna_pin.trajectory import Trajectory, is_lean

# --- energy shares of bodies --------------------------------------------------------------------------------


class _Bodies(NamedTuple):
    """Bodies of a mechanism in one configuration, as linear maps."""

    # generalized velocity to each body's twist at its mass centre in world axes, (bodies, 6, nv)
    motion: Array
    inertia: Array  # spatial inertia of each at its mass centre in world axes, (bodies, 6, 6)
    # generalized force of inertia under an acceleration of the root with all else at rest relative to it,
    # (nv, 6); the root's origin and axes, those of the world with a fixed base
    coupling: Array
    rigid: Array  # inertia of the whole as one rigid body about that origin, (6, 6)


def bodies_of(system: System, q: Array) -> _Bodies:
    """Return the maps from velocity coordinates to bodies in a configuration."""
    model = system.model
    data = model.createData()
    pin.computeJointJacobians(model, data, q)
    count = model.njoints - 1
    motion, inertia = np.zeros((count, 6, model.nv)), np.zeros((count, 6, 6))
    coupling, rigid = np.zeros((model.nv, 6)), np.zeros((6, 6))
    root = data.oMi[1] if system.mechanism.base == "free" else pin.SE3.Identity()
    for k in range(count):
        own = model.inertias[k + 1]
        at_centre = pin.SE3(np.eye(3), own.lever)
        world = data.oMi[k + 1] * at_centre
        turned = pin.SE3(world.rotation, np.zeros(3))
        local = np.array(pin.getJointJacobian(model, data, k + 1, pin.ReferenceFrame.LOCAL))
        local = local.reshape(6, model.nv)  # of one column Pinocchio makes a vector
        motion[k] = turned.toActionMatrix() @ at_centre.inverse().toActionMatrix() @ local
        about = pin.Inertia(own.mass, np.zeros(3), own.inertia)
        inertia[k] = turned.act(about).matrix()
        carried = turned.toActionMatrix() @ (world.inverse() * root).toActionMatrix()
        coupling += motion[k].T @ inertia[k] @ carried
        rigid += carried.T @ inertia[k] @ carried
    return _Bodies(motion, inertia, coupling, rigid)


def _kinetic_shares(bodies: _Bodies, shapes: Complex) -> Array:
    """Return each body's share of a mode's kinetic energy, (modes, bodies) [-]."""
    moved = np.einsum("bik,km->bim", bodies.motion, shapes)
    energy = np.einsum("bim,bij,bjm->mb", moved.conj(), bodies.inertia, moved).real
    total = energy.sum(axis=1, keepdims=True)
    return np.asarray(energy / np.where(total > 0.0, total, 1.0))


def _strain_shares(linear: Linearisation, shapes: Complex) -> tuple[list[str], Array]:
    """Return the shares of a mode's potential energy, (modes, parts) [-], and names.

    Joints by name, for their drives, springs and contacts; ``springs between points``, or with forces
    ``elements on links``; and ``loops, gravity and loads``, for what constraint forces and accelerations
    store as what carries them turns. NaN where none is stored.
    """
    system = linear.system
    parts = linear.forces.parts
    names, energy = [], []
    of_joints = parts["joints"] @ shapes
    whole = linear.directions @ linear.stiffness
    reduced = np.linalg.lstsq(linear.directions, shapes, rcond=None)[0]
    total = np.einsum("km,km->m", shapes.conj(), whole @ reduced).real
    for name, slot in system.mechanism.joints.items():
        own = -np.einsum("km,km->m", shapes[slot.v].conj(), of_joints[slot.v]).real
        if np.any(parts["joints"][slot.v]):
            names.append(name)
            energy.append(own)
    if system.point_springs or system.forces:
        names.append("elements on links" if system.forces else "springs between points")
        energy.append(-np.einsum("km,km->m", shapes.conj(), parts["points"] @ shapes).real)
    rest = total - np.sum(energy, axis=0) if energy else total
    largest = np.abs(total).max(initial=0.0)
    if np.abs(rest).max(initial=0.0) > 1e-9 * largest:
        names.append("loops, gravity and loads")
        energy.append(rest)
    table = np.array(energy).reshape(len(names), len(total)).T
    shares = np.full_like(table, np.nan)
    stored = np.abs(total) > 1e-12 * largest
    shares[stored] = table[stored] / total[stored, None]
    return names, shares


# --- modes --------------------------------------------------------------------------------------------------

#: Components of a motion of a body, or of a force on one.
COMPONENTS = ("x", "y", "z", "rx", "ry", "rz")

_TAU = 2.0 * np.pi

# Modes that are shown in a shell, and the shell's screen.
_SHOWN = 12
_COLUMNS, _LINES = 80, 24


@dataclass(frozen=True, slots=True, eq=False)
class Modes:
    """Modes of a mechanism about a state.

    ``plot(source, targets)`` draws a frequency response, ``record("modes.html")`` the shapes.
    """

    # along ``mode``, in rising order of frequency: ``frequency`` and ``damped_modulus`` [Hz],
    # ``damping_ratio`` [-] (NaN of what does not vibrate), ``kind`` (rigid, free, elastic, unstable),
    # ``root_real`` and ``root_imag`` (both eigenvalues with damping [1/s]), ``shape`` per coordinate of
    # velocity, to unit modal mass, ``body_motion`` (at the mass centre, world axes), ``kinetic_share`` by
    # body, ``strain_share`` by what stores it, and with a base that is held ``participation`` [sqrt(kg),
    # sqrt(kg) m] and ``effective_mass`` [kg, kg m^2] about the base's origin in its axes, with ``rigid_mass``
    # of the whole. ``shape`` and ``body_motion`` are complex about a state that moves
    data: xr.Dataset
    linearisation: Linearisation  # the linearised equations
    notes: tuple[str, ...]  # assumptions and limits, in sentences
    scenario: Scenario | None = None  # of the mechanism; None for a system built in Python

    plot = View[ResponsePlotter]()
    record = View[ModesRecorder]()

    @property
    def frequency(self) -> Array:
        """Undamped frequencies, (n,) [Hz]."""
        return np.asarray(self.data["frequency"].values)

    @property
    def damping_ratio(self) -> Array:
        """Damping ratios, (n,) [-]."""
        return np.asarray(self.data["damping_ratio"].values)

    @property
    def elastic(self) -> list[int]:
        """Numbers of the elastic modes, counted like ``mode``, from 1."""
        return [
            int(m)
            for m, kind in zip(self.data["mode"].values, self.data["kind"].values, strict=True)
            if kind == "elastic"
        ]

    def shape(self, mode: int) -> NDArray[np.complex128]:
        """Return the shape of a mode, (nv,), normalized to unit modal mass.

        Modes are numbered from 1.
        """
        numbers = [int(m) for m in self.data["mode"].values]
        if mode not in numbers:
            last = numbers[-1] if numbers else 0
            raise InvalidParameterError("modes", "mode", f"a number from 1 to {last}", mode)
        return np.asarray(self.data["shape"].sel(mode=mode).values, dtype=complex)

    def to_dict(self) -> dict[str, Any]:
        """Return the table in plain numbers: complex as pairs, missing as None."""
        attributes = self.data.attrs
        table: dict[str, Any] = {
            name: attributes[name] for name in ("title", "case", "time", "play", "loads", "hold")
        }
        for dim in ("coordinate", "body", "component", "part"):
            if dim in self.data.coords:
                table[dim] = [str(name) for name in self.data[dim].values]
        if "rigid_mass" in self.data:
            table["rigid_mass"] = _plain(self.data["rigid_mass"].values)
        names = [str(name) for name, variable in self.data.data_vars.items() if "mode" in variable.dims]
        table["modes"] = [
            {"mode": int(mode)} | {name: _plain(self.data[name].sel(mode=mode).values) for name in names}
            for mode in self.data["mode"].values
        ]
        return {**table, "notes": list(self.notes)}

    def __repr__(self) -> str:
        """Show the first modes: frequency, damping, kind; all others are in ``data``."""
        attributes, table = self.data.attrs, self.data
        modes = table["mode"].values
        title = ", case ".join(str(attributes[key]) for key in ("title", "case") if attributes.get(key))
        whose = f"Modes of {title or 'a system built in Python'}, {len(modes)} in all"
        lines = wrap(whose, _COLUMNS, subsequent_indent="  ")
        lines.append(f"{'mode':>6}{'frequency [Hz]':>17}{'damping ratio':>16}  kind")
        rows = zip(modes, self.frequency, self.damping_ratio, table["kind"].values, strict=True)
        for mode, frequency, ratio, kind in list(rows)[:_SHOWN]:
            lines.append(f"{int(mode):>6}{number(frequency, 6):>17}{number(ratio, 4):>16}  {kind}")
        if len(modes) > _SHOWN:
            lines.append(f"and {len(modes) - _SHOWN} more: data[['frequency', 'damping_ratio', 'kind']]")
        notes = (wrap(f"note: {one}", _COLUMNS, subsequent_indent="  ") for one in self.notes)
        return "\n".join([*lines, *itertools.chain(*notes)][:_LINES])

    def _repr_html_(self) -> str:
        """Show the table in a notebook."""
        return as_html(self)


def _plain(values: ArrayLike) -> Any:
    """Return numbers as JSON types: null for NaN, two lists for complex ones."""
    array = np.asarray(values)
    if np.iscomplexobj(array):
        return {"real": _plain(array.real), "imag": _plain(array.imag)}
    if array.ndim:
        return [_plain(one) for one in array]
    value = array.item()
    return None if isinstance(value, float) and not np.isfinite(value) else value


@takes()
def modes_at(at: At, scenario: Scenario | None = None) -> Modes:
    """Return the modes about a state."""
    linear = linearise(at)
    eigen = solve(linear)
    return Modes(_table(linear, eigen, scenario), linear, tuple(_notes(linear, eigen)), scenario)


def _table(linear: Linearisation, eigen: Eigen, scenario: Scenario | None) -> xr.Dataset:
    at, system = linear.at, linear.system
    shapes: NDArray[Any] = linear.directions @ eigen.shape
    if linear.still:
        shapes = shapes.real
    bodies = bodies_of(system, at.q)
    moved = np.einsum("bik,km->mbi", bodies.motion, shapes)
    names, strain = _strain_shares(linear, shapes.astype(complex))
    # Of what does not vibrate neither has a meaning.
    vibrates = np.array([kind == "elastic" for kind in eigen.kind], dtype=bool)
    modulus, ratio = (np.where(vibrates, one, np.nan) for one in (eigen.modulus, eigen.damping_ratio))
    variables: dict[str, Any] = {
        "frequency": (("mode",), eigen.frequency / _TAU, {"units": "Hz", "long_name": "undamped"}),
        "damped_modulus": (
            ("mode",),
            modulus / _TAU,
            {"units": "Hz", "long_name": "modulus of the damped eigenvalues"},
        ),
        "damping_ratio": (("mode",), ratio, {"units": "1", "long_name": "damping ratio"}),
        "kind": (("mode",), np.array(eigen.kind, dtype=str), {"long_name": "what it is"}),
        "root_real": (("mode", "root"), eigen.roots.real, {"units": "1/s", "long_name": "damped eigenvalue"}),
        "root_imag": (("mode", "root"), eigen.roots.imag, {"units": "1/s", "long_name": "damped eigenvalue"}),
        "shape": (("mode", "coordinate"), shapes.T, {"long_name": "to unit modal mass"}),
        "body_motion": (
            ("mode", "body", "component"),
            moved,
            {"long_name": "of the mass centre, and turning, world axes, to unit modal mass"},
        ),
        "kinetic_share": (
            ("mode", "body"),
            _kinetic_shares(bodies, shapes.astype(complex)),
            {"units": "1", "long_name": "share of the kinetic energy"},
        ),
    }
    if names:
        variables["strain_share"] = (
            ("mode", "part"),
            strain,
            {"units": "1", "long_name": "share of the potential energy"},
        )
    if linear.still and (system.mechanism.base == "fixed" or BASE in at.hold):
        factors = shapes.T @ bodies.coupling
        variables["participation"] = (
            ("mode", "component"),
            factors,
            {"units": "sqrt(kg), sqrt(kg) m", "long_name": "participation of the base's acceleration"},
        )
        variables["effective_mass"] = (
            ("mode", "component"),
            factors**2,
            {"units": "kg, kg m^2", "long_name": "effective mass, about the base's origin"},
        )
        variables["rigid_mass"] = (
            ("component",),
            np.diag(bodies.rigid).copy(),
            {"units": "kg, kg m^2", "long_name": "of the whole as one body"},
        )
    coordinates: dict[str, Any] = {
        "mode": np.arange(1, len(eigen.frequency) + 1),
        "coordinate": list(system.names_v),
        "body": list(system.mechanism.bodies),
        "component": list(COMPONENTS),
    }
    if names:
        coordinates["part"] = names
    attributes = {
        "title": system.mechanism.name if scenario is None else scenario.title or scenario.name,
        "case": "" if scenario is None else scenario.case or "",
        "time": at.time,
        "play": dict(at.play),
        "loads": {name: load.tolist() for name, load in at.loads.items()},
        "hold": list(at.hold),
    }
    return xr.Dataset(variables, coords=coordinates, attrs=attributes)


def _notes(linear: Linearisation, eigen: Eigen) -> Sequence[str]:
    notes = []
    pushed = linear.directions.T @ linear.acceleration
    if linear.at.rest and np.abs(pushed).max(initial=0.0) > 1e-9:
        worst, size, unit = _largest(linear.system, linear.acceleration)
        notes.append(
            f"the state is not in balance: what would set it moving, {worst} by {number(size)} {unit}, is "
            "taken to be held by forces that do not change"
        )
    for joint in linear.forces.rough:
        notes.append(
            f"at {joint} a force has a kink here, and no derivative: its stiffness is a guess; a flange that "
            'presses flat has one under load = "point"'
        )
    for joint in rotors(linear.system, linear.at.v):
        notes.append(
            f"motions of {joint}, which spins, are seen in axes that do not: whirl as the bearing feels it"
        )
    if "unstable" in eigen.kind:
        count = eigen.kind.count("unstable")
        modes = "1 mode runs" if count == 1 else f"{count} modes run"
        notes.append(f"{modes} away: about this state the motion is unstable")
    free = eigen.kind.count("free")
    if free:
        notes.append(
            f"{free} motion{'s' if free > 1 else ''} that nothing resists: of frequency 0, called free"
        )
    return notes


def _largest(system: System, acceleration: Array) -> tuple[str, float, str]:
    """Return index, size and unit of the largest acceleration."""
    k = int(np.argmax(np.abs(acceleration)))
    name = system.names_v[k]
    slides = name.endswith((".vx", ".vy", ".vz")) or any(
        slot.slides and slot.v.start == k for slot in system.mechanism.joints.values()
    )
    return name, float(abs(acceleration[k])), "m/s^2" if slides else "rad/s^2"


# --- modes of scenarios, systems and runs -------------------------------------------------------------------


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
        model: A scenario, its name or path, or a system; or a run, for its last state.
        at: A time to which a scenario is run first [s], a run for its last state, or a state; by default the
            start.
        q: Configuration instead, (nq,).
        v: Velocity with q, (nv,); zero by default.
        play: Treatment of joints with play, one for all or by name: ``ideal``, ``free`` in their play, or
            ``contact`` with the contacts of the state. By default ``contact`` with a load, else ``ideal``.
        load: Force that presses the journal into the bearing, in bearing axes, (3,) [N]; by joint if several
            have play. The journal rests where its contacts alone balance the load.
        approach_speed: Approach speed stored for contacts under a load [m/s], on which the damping of many
            laws depends; by default their joint's floor.
        hold: Names of joints that do not move; ``base`` is a free base.
        moving: Whether the state's velocities and accelerations count. If not, it is at rest, with unbalanced
            forces compensated.

    Raises:
        AntennaPinError: Arguments are invalid; one line gives the reason.
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
        raise InvalidParameterError("modes", "q" if q is not None else "v", "left out with at", "both")
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
        system, y, play=play, load=load, approach_speed=approach_speed, hold=hold, moving=moving, **more
    )
    return modes_at(found, scenario)


def _end(run: Trajectory) -> State:
    if run.end is None:
        raise FileFormatError("modes: a run must have its end to be linearised there, got none; run it again")
    return run.end


def _reached(model: Scenario | System, time: float) -> Trajectory | None:
    """Return a run up to a time; None at the start."""
    check_number("modes", "at", time, "zero or more", "s")
    if time == 0.0:
        return None
    run = uninterrupted(simulate(model, duration=time))
    if not run.completed:
        raise InvalidParameterError(
            "modes", "at", "a time that the run reaches", time, said=f"{time:g} s: {run.message}"
        )
    return run


def _last(system: System, run: Trajectory, end: State) -> Array:
    """Return the state at a run's last time, beyond the stored one."""
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
