r"""Quantities of a run by their names in one line of text.

The grammar::

    quantity  = "time" | number | "|" number or vector "|" | signal | function
    number    = variable                                  kinetic_energy
              | joint or contact "." short name           hinge.angle, elevation.radial+.gap
              | variable "[" label { "," label } "]"      motion_angle[elevation], v[base.wx]
              | vector "." component                      joint_force[s2].x, base_position.z
    vector    = variable [ "[" label "]" ]                joint_force[s2]
    signal    = a name of analysis.signals                s2 force x
    function  = FILE.py ":" NAME | MODULE ":" NAME        own.py:crest  (antenna_pin.analysis.own)

A variable is one of the result file over time, and labels stand in the order of its dimensions, time left
out. The component of a vector or quaternion stands behind a dot, or as the last label. The label of a
dimension that has only one may be left out: with one joint with play, ``joint_force.x`` is its force. Between
bars stands the length of a vector or the size of a number. Blanks beside brackets, commas and bars are of no
meaning.

Short names, those of a session (:mod:`antenna_pin.run.session`), are ``angle``, ``rate`` and ``acceleration``
of a joint, turning or sliding, ``gap``, ``depth_rate``, ``force`` and ``touching`` of a contact.

Vectors that follow from a result are named as if they stood in it: ``body_velocity[LINK].x`` and the like, in
world axes, ``journal_velocity[JOINT].x``, in those of the bearing, and ``base_force.x`` and ``base_moment.x``
of a shaken base, in its own.
"""

from __future__ import annotations

import difflib
import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.spatial.transform import Rotation

from antenna_pin.analysis._run import AXES, RunLike, blocks, data_of, floats, label_of, sample_times, variable
from antenna_pin.analysis.bodies import mechanism_of
from antenna_pin.analysis.journal import clearance_shapes
from antenna_pin.analysis.own import is_own, own_series
from antenna_pin.analysis.shaken import base_wrench, shaken_link, shakes_of
from antenna_pin.analysis.signals import signals
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.readable import printed_unit
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.mechanism import Mechanism, link_motion
from antenna_pin.trajectory import names_along
from antenna_pin.trajectory.quantities import slides_along
from antenna_pin.trajectory.schema import VARIABLES

# --- what follows from a result: motion of links and journals, loads of a shaken base ---
#
# The velocity of the journal's centre p_J in the bearing, whose centre p_B turns with it, is
#
# .. math:: \mathbf{R}_B^T [\dot{\mathbf{p}}_J - \dot{\mathbf{p}}_B
#     - \boldsymbol{\omega}_B \times (\mathbf{p}_J - \mathbf{p}_B)],
#
# the rate of ``journal_position``, in the same axes.


class Derived(NamedTuple):
    """Vector over time of each of several owners."""

    dim: str  # dimension of the owners, beside time and axis
    units: str  # of its components
    meaning: str  # long name
    row: int  # of :func:`antenna_pin.mechanism.link_motion`; of a base's loads, force or moment

    def values(self, data: xr.Dataset, owner: str) -> Array:
        """Return the vector of one owner at the samples, (n, 3)."""
        if self.dim == "shaken_base":
            return base_wrench(data)[:, 3 * self.row : 3 * self.row + 3]
        mechanism = mechanism_of(data)
        if self.dim == "body":
            parts = [_motion(mechanism, part, owner)[1][:, self.row].copy() for part in blocks(data)]
        else:
            shape = clearance_shapes(data)[owner]
            parts = [_in_bearing(mechanism, part, shape) for part in blocks(data)]
        return np.concatenate(parts)


#: What can be asked for beside what a result holds, by name.
DERIVED: dict[str, Derived] = {
    "body_position": Derived("body", "m", "place of the link's frame in the world", 0),
    "body_velocity": Derived("body", "m/s", "velocity of the link's frame, world axes", 1),
    "body_acceleration": Derived("body", "m/s^2", "acceleration of the link's frame, world axes", 3),
    "body_angular_velocity": Derived("body", "rad/s", "angular velocity of the link, world axes", 2),
    "body_angular_acceleration": Derived(
        "body", "rad/s^2", "angular acceleration of the link, world axes", 4
    ),
    "journal_velocity": Derived(
        "clearance_joint", "m/s", "velocity of the journal's centre in the bearing", 1
    ),
    "base_force": Derived("shaken_base", "N", "force on the shaken base, its axes", 0),
    "base_moment": Derived("shaken_base", "N m", "moment on the shaken base about its frame, its axes", 1),
}


def owners_of(data: xr.Dataset) -> dict[str, list[str]]:
    """Return the names along the dimensions of derived vectors."""
    links = [link.name for link in mechanism_of(data).urdf.robot.links] if "urdf" in data.attrs else []
    joints = list(clearance_shapes(data)) if "clearance_joints" in data.attrs else []
    base = [shaken_link(data)] if shakes_of(data) else []
    return {
        "body": links,
        "clearance_joint": joints or names_along(data, "clearance_joint"),
        "shaken_base": base,
    }


def _motion(mechanism: Mechanism, data: xr.Dataset, link: str) -> tuple[Array, Array]:
    """Return attitudes and motion of a link, as :func:`antenna_pin.mechanism.link_motion`."""
    q, v, a = (floats(variable(data, name, "quantity")) for name in "qva")
    return link_motion(mechanism, link, q, v, a)


def _in_bearing(mechanism: Mechanism, data: xr.Dataset, shape: dict[str, Any]) -> Array:
    """Return the velocity of a journal's centre in its bearing, (n, 3) [m/s]."""
    places, rates, turns = [], [], []
    for side in ("bearing", "journal"):
        placement = np.asarray(shape[f"{side}_placement"], dtype=float).ravel()
        attitudes, motion = _motion(mechanism, data, str(shape[f"{side}_body"]))
        arm = attitudes @ placement[:3]
        places.append(motion[:, 0] + arm)
        rates.append(motion[:, 1] + np.cross(motion[:, 2], arm))
        turns.append((attitudes @ Rotation.from_quat(placement[3:]).as_matrix(), motion[:, 2]))
    axes, spin = turns[0]
    seen = rates[1] - rates[0] - np.cross(spin, places[1] - places[0])
    return np.asarray(np.einsum("nji,nj->ni", axes, seen))


_COMPONENTS = ("axis", "quaternion")
_NAME = re.compile(r"(?P<variable>[^\[\].|]+)(?:\[(?P<labels>.*)\])?(?:\.(?P<component>[^\[\].|]+))?")
_ORDER = {"q": 0, "v": 1, "a": 2}  # of the derivative of a configuration by time
_RATES = ("", "/s", "/s^2")
_SHOWN = 8  # names that a message offers
_SHORT = {
    "angle": ("motion_angle", "slide_position"),
    "rate": ("motion_rate", "slide_rate"),
    "acceleration": ("motion_acceleration", "slide_acceleration"),
    "gap": ("gap",),
    "depth_rate": ("depth_rate",),
    "force": ("normal_force",),
    "touching": ("touching",),
}


@dataclass(frozen=True, slots=True)
class QuantityName:
    """Parts of the name of a quantity, which a run may not have."""

    variable: str  # name of the variable, or of a signal
    labels: tuple[str, ...] = ()  # labels along its dimensions beside time, its component at last
    size: bool = False  # whether it stands between bars

    @classmethod
    def parse(cls, text: str) -> QuantityName:
        """Return the parts of a name; other text is a variable without labels."""
        name = text.strip()
        size = len(name) > 2 and name.startswith("|") and name.endswith("|")
        if size:
            name = name[1:-1].strip()
        found = _NAME.fullmatch(name)
        if found is None:
            return cls(name, (), size)
        labels = [] if found["labels"] is None else [label.strip() for label in found["labels"].split(",")]
        if found["component"] is not None:
            labels.append(found["component"])
        return cls(found["variable"], tuple(labels), size)


class Quantity(NamedTuple):
    """A number of a run at its samples."""

    name: str  # as quantities() lists it
    time: Array  # (n,) [s], uneven; some instants twice, where something jumps
    values: Array  # (n,)
    units: str  # as in the result file; "1" if none
    meaning: str  # "contact force on the journal of s2, x"

    @property
    def label(self) -> str:
        """Name and unit, for an axis."""
        unit = printed_unit(self.units)
        return f"{self.name} [{unit}]" if unit else self.name


@takes()
def quantity(run: RunLike, name: str) -> Quantity:
    """Return a recorded or derived quantity of a run.

    Args:
        run: A run, or its data.
        name: Its name; the module's text has the grammar.

    Raises:
        UnknownNameError: The run has no such variable, signal or label.
        InvalidParameterError: The name leaves open which one of several numbers it is.
        FileFormatError: The result is a lean one, without series.
    """
    data = data_of(run)
    time = sample_times(data, "quantity")
    if name.strip() == "time":
        return Quantity("time", time, time, "s", "time")
    bare = name.strip().strip("|").strip()
    if is_own(bare):
        values, units = own_series(bare, run, len(time))
        size = bare != name.strip()
        return Quantity(name.strip(), time, np.abs(values) if size else values, units, name.strip())
    wanted = _in_full(data, name) or QuantityName.parse(name)
    if wanted.variable in DERIVED:
        return _derived(data, name, wanted)
    if wanted.variable not in _recorded(data):
        return _signal(data, name, wanted)
    array = data[wanted.variable]
    dims = [str(dim) for dim in array.dims[1:]]
    labels = _found_labels(data, name, wanted, dims)
    values = floats(array.sel(dict(zip(dims, labels, strict=False))))
    units = _units(data, wanted.variable, labels)
    return _quantity(
        time, values, wanted, dims, labels, units, str(array.attrs.get("long_name", wanted.variable))
    )


def _in_full(data: xr.Dataset, name: str) -> QuantityName | None:
    """Return the full form of a short name, or None."""
    text = name.strip()
    size = len(text) > 2 and text.startswith("|") and text.endswith("|")
    owner, _, short = text.strip("|").strip().rpartition(".")
    for called in _SHORT.get(short, ()):
        if called in data and owner in names_along(data, str(data[called].dims[1])):
            return QuantityName(called, (owner,), size)
    return None


def _quantity(
    time: Array,
    values: Array,
    wanted: QuantityName,
    dims: list[str],
    labels: list[str],
    units: str,
    meaning: str,
) -> Quantity:
    """Return a quantity under its full name, or its size."""
    if wanted.size:
        values = np.abs(values) if values.ndim == 1 else np.linalg.norm(values, axis=1)
    words = ", ".join([meaning, *labels])
    written = _written(dims, wanted.variable, labels, wanted.size)
    return Quantity(written, time, values, units, f"size of {words}" if wanted.size else words)


def _derived(data: xr.Dataset, name: str, wanted: QuantityName) -> Quantity:
    """Return a component or the length of a vector that follows from the result."""
    one = DERIVED[wanted.variable]
    owners = owners_of(data)[one.dim]
    if not owners:
        what = {"clearance_joint": "a joint with play", "shaken_base": "a shaken base"}.get(
            one.dim, "the mechanism that it is of"
        )
        raise InvalidParameterError("quantity", "run", f"one with {what} for {name}", label_of(data))
    dims = [one.dim, "axis"]
    named = xr.Dataset(coords={one.dim: owners, "axis": list(AXES)})
    labels = _found_labels(named, name, wanted, dims)
    values = one.values(data, labels[0])
    if len(labels) > 1:
        values = values[:, AXES.index(labels[1])]
    time = sample_times(data, "quantity")
    return _quantity(time, values, wanted, dims, labels, one.units, one.meaning)


@takes()
def quantities(run: RunLike) -> dict[str, str]:
    """Return the names of all quantities of a run, each with its unit.

    Of a vector the length stands before its components. The sizes of numbers are left out, and signals that
    are zero throughout.
    """
    data = data_of(run)
    sample_times(data, "quantities")
    found = {"time": "s"}
    for called in _recorded(data):
        dims = [str(dim) for dim in data[called].dims[1:]]
        whole = dims[:-1] if dims[-1:] == ["axis"] else dims
        for labels in itertools.product(*(names_along(data, dim) for dim in whole)):
            units = _units(data, called, labels)
            if whole == dims:
                found[_written(dims, called, labels)] = units
                continue
            found[_written(dims, called, labels, size=True)] = units
            for axis in names_along(data, "axis"):
                found[_written(dims, called, (*labels, axis))] = units
    owners = owners_of(data)
    for called, one in DERIVED.items():
        dims = [one.dim, "axis"]
        for owner in owners[one.dim]:
            found[_written(dims, called, (owner,), size=True)] = one.units
            found |= {_written(dims, called, (owner, axis)): one.units for axis in AXES}
    found |= {name: one.units for name, one in signals(run).items()}
    return found


def _recorded(data: xr.Dataset) -> list[str]:
    """Return the variables over time that hold numbers, all of whose dimensions have labels."""
    return [
        str(name)
        for name, array in ((name, data.variables[name]) for name in data.data_vars)  # no DataArray of each
        if array.dims[:1] == ("time",)
        and array.dtype.kind in "fiub"
        and all(dim in data.coords for dim in array.dims)
    ]


def _signal(data: xr.Dataset, name: str, wanted: QuantityName) -> Quantity:
    """Return a signal of a run, or refuse an unknown name."""
    known = signals(data)
    inside = name.strip().strip("|").strip() if wanted.size else name.strip()
    if inside in known:
        one = known[inside]
        if not wanted.size:
            return Quantity(inside, one.time, one.values, one.units, inside)
        return Quantity(f"|{inside}|", one.time, np.abs(one.values), one.units, f"size of {inside}")
    variables = ["time", *_recorded(data), *DERIVED]
    shorts = [
        f"{owner}.{short}"
        for short, names in _SHORT.items()
        for variable in names
        if variable in data
        for owner in names_along(data, str(data[variable].dims[1]))
    ]
    if "." in name and "[" not in name and (near := difflib.get_close_matches(name, shorts, n=_SHOWN)):
        raise UnknownNameError("quantity", "name", name, near)
    if wanted.labels:
        raise UnknownNameError("quantity", "variable", wanted.variable, _similar(wanted.variable, variables))
    raise UnknownNameError("quantity", "name", inside, _similar(inside, [*variables, *known]))


def _similar(name: str, known: list[str]) -> list[str]:
    """Return the most similar names."""
    return difflib.get_close_matches(name, known, n=_SHOWN, cutoff=0.0)


def _found_labels(data: xr.Dataset, name: str, wanted: QuantityName, dims: list[str]) -> list[str]:
    """Return a label for each dimension, without the axis for a length."""
    given = list(wanted.labels)
    found = None
    if wanted.size and dims[-1:] == ["axis"]:
        found = _matched(data, dims[:-1], given)
    if found is None:
        found = _matched(data, dims, given)
    if found is not None:
        return found
    known = [names_along(data, dim) for dim in dims]
    for label in given:
        if dims and not any(label in names for names in known):
            # What the unknown one stands for is what none of the others does.
            taken = {k for other in given for k, names in enumerate(known) if other in names}
            free = next((k for k in range(len(dims)) if k not in taken), 0)
            raise UnknownNameError(f"quantity {name}", dims[free].replace("_", " "), label, known[free])
    every = ", ".join(_examples(data, wanted.variable, dims))
    over = " and ".join(["time", *dims])
    rule = f"that of one number, such as {every}, as {wanted.variable} is over {over}"
    raise InvalidParameterError("quantity", "name", rule, name)


def _matched(data: xr.Dataset, dims: list[str], labels: list[str]) -> list[str] | None:
    """Return labels along dimensions, the only one where none is given; or None."""
    if not dims:
        return None if labels else []
    known = names_along(data, dims[0])
    if labels and labels[0] in known:
        rest = _matched(data, dims[1:], labels[1:])
        if rest is not None:
            return [labels[0], *rest]
    if len(known) == 1:
        rest = _matched(data, dims[1:], labels)
        if rest is not None:
            return [known[0], *rest]
    return None


def _examples(data: xr.Dataset, variable: str, dims: list[str]) -> list[str]:
    every = itertools.product(*(names_along(data, dim) for dim in dims))
    return [_written(dims, variable, labels) for labels in itertools.islice(every, 3)]


def _written(dims: Sequence[str], variable: str, labels: Sequence[str], size: bool = False) -> str:
    """Return the name of a quantity in full."""
    outside = len(labels) == len(dims) and dims[-1:] and dims[-1] in _COMPONENTS
    inside = list(labels[:-1] if outside else labels)
    name = f"{variable}[{', '.join(inside)}]" if inside else variable
    if outside:
        name += f".{labels[-1]}"
    return f"|{name}|" if size else name


def _units(data: xr.Dataset, variable: str, labels: Sequence[str]) -> str:
    """Return the unit of a number, which may depend on whether its joint slides."""
    units = str(data.variables[variable].attrs.get("units", "1"))
    label = labels[0] if labels else ""
    if variable in _ORDER:
        return _unit_of_coordinate(data, label, _ORDER[variable]) or units
    known = VARIABLES.get(variable)
    if known is None or not known.sliding or len(known.dims) < 2:
        return units
    return known.unit(slides_along(data, known.dims[1]).get(label, False))


def _unit_of_coordinate(data: xr.Dataset, label: str, order: int) -> str:
    """Return the unit of a coordinate, or of its rate by order; "" if unknown."""
    if label in names_along(data, "joint") or label in names_along(data, "sliding_joint"):
        way = "rad" if label in names_along(data, "joint") else "m"
        return way + _RATES[order]
    part = label.rpartition(".")[2]
    if order == 0:
        return (
            "m" if part in ("x", "y", "z") else "1" if part in ("qx", "qy", "qz", "qw", "cos", "sin") else ""
        )
    way = "m" if part in ("vx", "vy", "vz") else "rad" if part in ("wx", "wy", "wz") else ""
    return way and way + _RATES[order]
