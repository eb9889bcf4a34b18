"""Modes as a result: a labelled table, what was linearised, and what can be asked of it."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import number
from antenna_pin.base.views import ModesRecorder, ResponsePlotter, View, as_html
from antenna_pin.dynamics import BASE, System
from antenna_pin.errors import InvalidParameterError
from antenna_pin.linear.eigen import Eigen, solve
from antenna_pin.linear.linearisation import Linearisation, linearise
from antenna_pin.linear.play import At
from antenna_pin.linear.shares import bodies_of, kinetic_shares, strain_shares
from antenna_pin.linear.spinning import rotors
from antenna_pin.scenario import Scenario

__all__ = ["COMPONENTS", "Modes", "modes_at"]

Array = NDArray[np.float64]

#: Components of a motion of a body, or of a force on one.
COMPONENTS = ("x", "y", "z", "rx", "ry", "rz")

_TAU = 2.0 * np.pi

# Modes that are shown in a shell, and the shell's screen.
_SHOWN = 12
_COLUMNS, _LINES = 80, 24


@dataclass(frozen=True, slots=True, eq=False)
class Modes:
    """The modes of a mechanism about a state.

    They show themselves: ``plot(source, targets)``, a frequency response, and ``record("modes.html")``.

    Attributes:
        data: Along ``mode``, in rising order of frequency: ``frequency`` and ``damped_modulus`` [Hz],
            ``damping_ratio`` [-] (NaN of what does not vibrate), ``kind`` (rigid, free, elastic, unstable),
            ``root_real`` and ``root_imag`` (both eigenvalues with damping [1/s]), ``shape`` per coordinate of
            velocity, to unit modal mass, ``body_motion`` (at the mass centre, world axes), ``kinetic_share``
            by body, ``strain_share`` by what stores it, and with a base that is held ``participation``
            [sqrt(kg), sqrt(kg) m] and ``effective_mass`` [kg, kg m^2] about the base's origin in its axes,
            with ``rigid_mass`` of the whole. ``shape`` and ``body_motion`` are complex about a state that
            moves.
        linearisation: What they are the modes of.
        notes: What is to be known of them, in sentences.
        scenario: Of the mechanism; None for a system built in Python.
    """

    data: xr.Dataset
    linearisation: Linearisation
    notes: tuple[str, ...]
    scenario: Scenario | None = None

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
        """Numbers of the vibrations, as ``mode`` counts them, from 1."""
        return [
            int(m)
            for m, kind in zip(self.data["mode"].values, self.data["kind"].values, strict=True)
            if kind == "elastic"
        ]

    def shape(self, mode: int) -> NDArray[np.complex128]:
        """Return the shape of a mode in the coordinates of velocities, (nv,), to unit modal mass.

        Args:
            mode: Its number, from 1.
        """
        numbers = [int(m) for m in self.data["mode"].values]
        if mode not in numbers:
            last = numbers[-1] if numbers else 0
            raise InvalidParameterError("modes", "mode", f"a number from 1 to {last}", mode)
        return np.asarray(self.data["shape"].sel(mode=mode).values, dtype=complex)

    def to_dict(self) -> dict[str, Any]:
        """Return the table in plain numbers; complex ones as two lists, None where there is none."""
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
    """Return numbers as JSON has them: None for what is none, two lists of parts for complex ones."""
    array = np.asarray(values)
    if np.iscomplexobj(array):
        return {"real": _plain(array.real), "imag": _plain(array.imag)}
    if array.ndim:
        return [_plain(one) for one in array]
    value = array.item()
    return None if isinstance(value, float) and not np.isfinite(value) else value


@takes()
def modes_at(at: At, scenario: Scenario | None = None) -> Modes:
    """Return the modes about a state.

    Args:
        at: The state, with what of it is taken.
        scenario: Of the mechanism, if it comes from one.
    """
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
    names, strain = strain_shares(linear, shapes.astype(complex))
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
            kinetic_shares(bodies, shapes.astype(complex)),
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
    """Return which coordinate is accelerated most, by how much, and in which unit."""
    k = int(np.argmax(np.abs(acceleration)))
    name = system.names_v[k]
    slides = name.endswith((".vx", ".vy", ".vz")) or any(
        slot.kind == "prismatic" and slot.v.start == k for slot in system.mechanism.joints.values()
    )
    return name, float(abs(acceleration[k])), "m/s^2" if slides else "rad/s^2"
