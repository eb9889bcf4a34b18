r"""Audit of a run: closure of the energy ledger, conservation of momentum.

An error of the balance is *explained* if it is at most

.. math:: \min[r\,(300 + \kappa N)\,(E + S),\, E / 10] + r^2 (300 + \kappa N)\,T + (100 + N)\,\epsilon\,E_0

with the relative tolerance r of a step and N accepted steps.

- E is the largest over the run of the gross work of drives and forces, the kinetic energy and the stored
  energy, that of gravity and of central forces counted from the start.
- :math:`\kappa` is the part of its tolerance that a step adds to the error in the mean (``GROWTH``).
- S is the energy of velocities wrong by their error scales, :math:`\max_t \sum_i M_{ii} |v_i| s_i`
  with the inertia at the start: motion far below its scale is hardly controlled.
- T is the energy of a motion as large as its scales, of velocity and of position,
  :math:`\sum_i \tfrac12 (M_{ii} s_i^2 + k_i p_i^2)`: motion within the tolerance is not controlled.
  :math:`k_i` is the stiffness that the largest displacement :math:`d_i` shows, the largest
  :math:`M_{ii} |a_i| / d_i`, at most :math:`2 E / d_i^2`.
- The last term is round-off: :math:`E_0` is the largest number in the ledger, or the energy of a motion at
  the scales of velocity if that is more.

Of momentum E and :math:`E_0` are the largest sum of magnitudes over the bodies and the largest momentum, with
the momentum of the base at its scales, of angular momentum also the linear one times the distance to the
origin; S and T are zero. A run whose events let the state jump need not conserve momentum.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.readable import number, readable
from antenna_pin.run.simulation.events import Jump
from antenna_pin.run.simulation.loop import Run
from antenna_pin.run.simulation.variables import SampleBlock
from antenna_pin.trajectory.schema import VARIABLES

Array = NDArray[np.float64]

Values = Mapping[str, Any]


# --- place at which the ledger opened: first sample, events there, largest changes ---


class Opening(NamedTuple):
    """Ledger that does not close."""

    time: float  # time of the first sample with an unexplained error [s]
    text: str  # ledger, error, and events at that sample


class FirstExcess(NamedTuple):
    """First sample with an error larger than explained."""

    time: float  # time of the sample [s]
    before: float  # time of the previous sample; NaN without one [s]
    error: float  # error, in its unit
    # numbers of the coordinate and of the element that changed most since the sample before; -1 for none
    movers: tuple[int, ...]


class ErrorTrail:
    """Samples at which an error exceeds all earlier ones and the bound known then."""

    def __init__(self) -> None:
        """Begin without a sample."""
        self._found: list[tuple[Array, Array, Array, NDArray[np.intp]]] = []
        self._largest = 0.0

    def add(
        self,
        times: Array,
        before: Array,
        errors: Array,
        least: float,
        movers: Callable[[], NDArray[np.intp]],
    ) -> None:
        """Keep the samples of a block whose error exceeds all earlier ones and ``least``."""
        so_far = np.fmax.accumulate(np.concatenate([[max(self._largest, least)], errors]))
        grown = errors > so_far[:-1]
        self._largest = max(self._largest, float(np.fmax.reduce(errors, initial=0.0)))
        if grown.any():
            self._found.append((times[grown], before[grown], errors[grown], movers()[grown]))

    def first_beyond(self, bound: float) -> FirstExcess | None:
        """Return the first sample whose error is above a bound; None if there is none."""
        for times, before, errors, movers in self._found:
            if (errors > bound).any():
                k = int(np.argmax(errors > bound))
                return FirstExcess(
                    float(times[k]), float(before[k]), float(errors[k]), tuple(movers[k].tolist())
                )
        return None


# Events in the message of an opening.
_MOST = 4


def events_between(run: Run, before: float, time: float) -> str:
    """Return the events, changes of elements and contacts between two samples, as text."""
    found = list(dict.fromkeys(_events(run, before, time)))
    more = f" and {len(found) - _MOST} more" if len(found) > _MOST else ""
    return (", ".join(found[:_MOST]) or "no event") + more


def _events(run: Run, before: float, time: float) -> Iterator[str]:

    # An event may have two samples, before and after it.
    def here(when: float) -> bool:
        return (math.isnan(before) or when >= before) and when <= time

    for one in run.actions.happened:
        if here(one.time):
            yield f"event {one.name!r}"
    for changed in run.actions.modes.changed:
        if here(changed.time):
            yield changed.name
    for episode in run.episodes:
        name = run.system.contact_names[int(episode["contact"])]
        if here(float(episode["onset"])):
            yield f"contact {name} begins"
        if here(float(episode["release"])):
            yield f"contact {name} ends"


# Entries of elements in the ledger, by the dimension of their names, with prefixes of the names.
_OWNERS = (
    ("drive", "drives.", ("drive_work",)),
    ("force", "forces.", ("force_work", "force_loss", "force_energy")),
    ("contact", "contact ", ("dissipation_normal", "dissipation_friction")),
    ("spring", "springs.", ("dissipation_damper",)),
    ("elastic_part", "elastic part ", ("elastic_energy", "dissipation_elastic")),
    ("element", "", ("element_energy", "element_loss")),
)


def entries_of(values: Values, labels: Mapping[str, Any]) -> tuple[list[str], list[Array]]:
    """Return elements with their entries in the ledger, (n,) [J]; names may repeat."""
    springs = values["spring_energy"] - values["element_energy"].sum(axis=1)
    names, columns = ["springs", "energy in contacts"], [springs, values["contact_energy"]]
    for dim, before, of in _OWNERS:
        for k, name in enumerate(labels.get(dim, ())):
            names += [f"{before}{name}"] * len(of)
            columns += [values[one][:, k] for one in of]
    return names, columns


#: Part of its tolerance that a step adds to the error of the energy at most, by method [-]. Measured on
#: oscillators over 20 s, rtol from 1e-8 to 1e-3: 0.5, 0.06, 5e-5 and 5e-3; under impacts and bristles more.
GROWTH = {
    "bogacki-shampine-32": 1.0,
    "dormand-prince-54": 0.2,
    "dormand-prince-853": 0.2,
    "radau5": 0.2,
}
#: Relative error with fixed steps, which have no tolerance, that counts as closed [-].
FIXED_STEP = 1e-2
#: Share of the scale beyond which no tolerance explains an error [-].
MOST = 0.1
# Tolerances that an error may be besides, whatever the steps: onsets, bristles (the worst of 300 trees: 170).
_BESIDES = 300.0
# Roundings of the ledger's largest number, besides one of each step.
_ROUNDINGS = 100.0
#: Share of the scale that passing a singular position of loops explains, whatever the tolerance: one
#: equation is dropped there (:class:`~antenna_pin.run.simulation.constraints.Singularities`) [-].
SINGULAR = 1e-8
# Samples of a block at which displacements of coordinates are evaluated.
_PLACES = 64

# Series of energies, works and losses, whose round-off is the ledger's.
_ENERGIES = tuple(
    one.name
    for one in VARIABLES.values()
    if one.units == "J" and "time" in one.dims and one.name != "energy_error"
)
_MOMENTA = {"linear": "kg m/s", "angular": "kg m^2/s"}


class LedgerAudit:
    """Errors of a run's energy and momentum, block by block, and their explained bounds."""

    def __init__(self, run: Run) -> None:
        """Begin without a sample."""
        self._run = run
        self._start: dict[str, Any] = {}
        self._most = dict.fromkeys(
            ("round_off", "kinetic", "stored", "gross", "slip", "energy_error", "distance"), 0.0
        )
        self._most |= {f"{name}_{of}": 0.0 for name in _MOMENTA for of in ("drift", "scale", "size")}
        self._energy, self._momenta = ErrorTrail(), {name: ErrorTrail() for name in _MOMENTA}
        self._names: list[str] = []
        self._last = math.nan

    # --- block by block -------------------------------------------------------------------------------------

    def add(self, block: SampleBlock, values: Values, labels: Mapping[str, Any]) -> None:
        """Add a block of samples."""
        audit, kept = block.found.audit, block.found.kept.sum(axis=1)
        if not self._start:
            self._begin(block, float(audit["gravity"][0]), float(kept[0]))
        start = self._start
        gross = values["drive_gross_work"].sum(axis=1) + values["force_gross_work"].sum(axis=1)
        springs = np.abs(audit["contacts"]) + np.abs(audit["springs"] - kept)
        potential = np.abs(audit["gravity"] - start["gravity"]) + np.abs(kept - start["central"])
        slip = (np.abs(block.v) * start["slip"]).sum(axis=1)
        self._extend(block, values["a"])
        error = np.abs(values["energy_error"])
        self._raise(
            gross=gross,
            kinetic=audit["kinetic"],
            stored=np.maximum(springs, potential),
            slip=slip,
            distance=np.linalg.norm(block.q[:, :3], axis=1),
            energy_error=error,
            round_off=np.array(
                [np.abs(values[name]).max(initial=0.0) for name in _ENERGIES if name in values]
            ),
        )
        times = values["time"]
        before = np.concatenate([[self._last], times[:-1]])
        self._names, columns = entries_of(values, labels)
        entries, last = [*block.v.T, *columns], start["entries"]
        start["entries"] = np.array([entry[-1] for entry in entries])
        movers = cache(lambda: self._movers(np.column_stack(entries), last))
        self._energy.add(times, before, error, self.energy_bound(), movers)
        for name, trail in self._momenta.items():
            drift = np.abs(block.kept_momentum(name) - start[name]).max(axis=1)
            size = np.abs(audit[name]).max(axis=1)
            scale = audit[f"{name}_scale"]
            self._raise(**{f"{name}_drift": drift, f"{name}_scale": scale, f"{name}_size": size})
            trail.add(times, before, drift, self.momentum_bound(name), movers)
        self._last = float(times[-1])

    def _begin(self, block: SampleBlock, gravity: float, central: float) -> None:
        """Store the start of the ledger, and the weights of velocities at their error scales."""
        system = self._run.system
        model, nv = system.model, system.model.nv
        scales = self._run.stepper.scales
        inertia = np.diag(pin.crba(model, model.createData(), np.ascontiguousarray(block.q[0])))
        self._start = {
            "gravity": gravity,
            "central": central,
            "inertia": inertia,
            "slip": inertia * scales[nv : 2 * nv],
            "scales": (scales[:nv], scales[nv : 2 * nv]),
            "q": block.q[0].copy(),
            "farthest": np.zeros(nv),
            "sharpest": np.zeros(nv),
            "entries": None,
            **{name: block.kept_momentum(name)[0] for name in _MOMENTA},
        }

    def _extend(self, block: SampleBlock, accelerations: Array) -> None:
        """Update the largest displacements and accelerations of the coordinates."""
        start, model = self._start, self._run.system.model
        for q in block.q[:: max(len(block.q) // _PLACES, 1)]:
            way = pin.difference(model, start["q"], np.ascontiguousarray(q))
            start["farthest"] = np.fmax(start["farthest"], np.abs(way))
        start["sharpest"] = np.fmax(start["sharpest"], np.nan_to_num(np.abs(accelerations)).max(axis=0))

    def _raise(self, **sizes: Array) -> None:
        for name, of in sizes.items():
            self._most[name] = float(np.fmax(self._most[name], of.max(initial=0.0)))

    def _movers(self, entries: Array, last: Array | None) -> NDArray[np.intp]:
        """Return the coordinate and the element that changed most at each sample, -1 for none.

        A coordinate by the kinetic energy of its change, an element by its largest entry.

        Args:
            entries: Velocities and entries of the ledger, (n, nv + elements).
            last: Entries at the sample before; None without one.
        """
        steps = np.abs(np.diff(entries, axis=0, prepend=entries[:1] if last is None else last[np.newaxis]))
        nv = self._run.system.model.nv
        steps[:, :nv] *= steps[:, :nv] * (0.5 * self._start["inertia"])
        found = []
        for part, begin in ((steps[:, :nv], 0), (steps[:, nv:], nv)):
            part = np.nan_to_num(part)
            moved = part.max(axis=1) > self.round_off
            found.append(np.where(moved, begin + np.argmax(part, axis=1), -1))
        return np.column_stack(found)

    # --- of the whole run -----------------------------------------------------------------------------------

    @property
    def scale(self) -> tuple[float, str]:
        """Reference energy of an error [J], and its name."""
        most = self._most
        return max(
            (most["gross"], "gross work of the drives"),
            (most["kinetic"], "largest kinetic energy"),
            (most["stored"], "largest stored energy"),
            key=lambda one: one[0],
        )

    @property
    def round_off(self) -> float:
        """Error that is round-off of the ledger's numbers [J]."""
        with np.errstate(over="ignore", invalid="ignore"):  # of a state that no run comes to
            unit = 0.5 * self._start["slip"] @ self._start["scales"][1]
        return self._roundings * float(max(self._most["round_off"], unit))

    @property
    def _roundings(self) -> float:
        return (_ROUNDINGS + self._run.counts().accepted) * float(np.finfo(float).eps)

    def _explained(self, scale: float, slip: float = 0.0, least: float = 0.0) -> float:
        """Return the error that the run's tolerance explains."""
        settings = self._run.settings
        if settings.ledger_tolerance is not None:
            return settings.ledger_tolerance * scale
        if settings.method not in GROWTH:
            return FIXED_STEP * scale
        rtol = settings.rtol
        steps = _BESIDES + GROWTH[settings.method] * self._run.counts().accepted
        passed = 0 if self._run.singular is None else len(self._run.singular.found)
        explained = (rtol * steps + SINGULAR * passed) * (scale + slip)
        return min(explained, MOST * scale) + rtol**2 * steps * least

    @property
    def _least(self) -> float:
        """Energy of all motion at its error scales [J]."""
        start, energy = self._start, self.scale[0]
        position, velocity = start["scales"]
        stiffness = np.zeros_like(position)
        moved = start["farthest"] > np.finfo(float).eps * position
        way = start["farthest"][moved]
        with np.errstate(over="ignore", invalid="ignore"):  # reported by the outcome
            by_force = start["inertia"][moved] * start["sharpest"][moved] / way
            stiffness[moved] = np.fmin(by_force, 2.0 * energy / way / way)
            return float(0.5 * (start["inertia"] * velocity**2 + stiffness * position**2).sum())

    def energy_bound(self) -> float:
        """Return the explained error of the balance [J]."""
        return self._explained(self.scale[0], self._most["slip"], self._least) + self.round_off

    def momentum_bound(self, name: str) -> float:
        """Return the explained drift of momentum [kg m/s], [kg m^2/s].

        Args:
            name: ``linear`` or ``angular``.
        """
        most, base = self._most, self._start["slip"][:6]  # of a free base; others keep no momentum
        scale = most[f"{name}_scale"]
        own = base[:3] if name == "linear" else base[3:]
        largest = scale + most[f"{name}_size"] + float(own.max(initial=0.0))
        if name == "angular":
            largest += most["distance"] * (most["linear_scale"] + most["linear_size"])
        return self._explained(largest) + self._roundings * largest

    @property
    def at_rest(self) -> bool:
        """Return whether all motion is round-off of the energies present."""
        return not self._most["kinetic"] > self.round_off

    def conservation(self) -> dict[str, Any]:
        """Return the errors of the conserved quantities, relative to non-vanishing scales."""
        most = self._most
        scale, of = self.scale
        error = most["energy_error"]
        shared = scale > self.round_off and math.isfinite(error)
        found: dict[str, Any] = {
            "energy_error": error,
            "gross_work": most["gross"],
            "energy_scale": scale,
            "energy_scale_of": of,
            "energy_error_relative": error / scale if shared else None,
            "energy_tolerance": self.energy_bound(),
        }
        keeps = self._run.system.keeps_momentum
        for name in _MOMENTA:
            drift, size = most[f"{name}_drift"], most[f"{name}_scale"]
            shared = keeps and size > 0.0 and not self.at_rest
            found[f"{name}_momentum_drift"] = drift if keeps else None
            found[f"{name}_momentum_scale"] = size
            found[f"{name}_momentum_drift_relative"] = drift / size if shared else None
            found[f"{name}_momentum_tolerance"] = self.momentum_bound(name) if keeps else None
        return found

    def opening(self) -> Opening | None:
        """Return place and size of the first opening, or None."""
        if not self._run.settings.ledger_alarm:
            return None
        found = []
        bound = self.energy_bound()
        if (first := self._energy.first_beyond(bound)) is not None:
            scale, of = self.scale
            most = readable(self._most["energy_error"], "J", 3)
            share = f", {number(self._most['energy_error'] / scale, 2)} of the {of}" if scale > 0.0 else ""
            text = f"the energy balance is off by {readable(first.error, 'J', 3)} (at most {most}{share})"
            found.append(self._opening(first, text, readable(bound, "J", 2)))
        jumps = any(event.has(Jump) for event in self._run.events)
        moving = self._run.system.keeps_momentum and not self.at_rest and not jumps
        for name, trail in self._momenta.items() if moving else ():
            bound, unit = self.momentum_bound(name), _MOMENTA[name]
            if (first := trail.first_beyond(bound)) is not None:
                most = readable(self._most[f"{name}_drift"], unit, 3)
                text = f"{name} momentum is off by {readable(first.error, unit, 3)} (at most {most})"
                found.append(self._opening(first, text, readable(bound, unit, 2)))
        return min(found, key=lambda one: one.time, default=None)

    def _opening(self, excess: FirstExcess, text: str, bound: str) -> Opening:
        settings = self._run.settings
        by = "integrator.ledger_tolerance allows" if settings.ledger_tolerance else "integrator.rtol explains"
        happened = events_between(self._run, excess.before, excess.time)
        names = [f"the motion of {name}" for name in self._run.system.names_v] + self._names
        movers = [names[k] for k in excess.movers if k >= 0]
        moved = f"; changed most: {', '.join(movers)}" if movers else ""
        since = "" if math.isnan(excess.before) else f" since {excess.before:.9g} s"
        return Opening(excess.time, f"{text}, where {by} {bound}; happened{since}: {happened}{moved}")
