"""A system at perturbed states and parameters.

A parameter s acts on a motion through the arrays that a system is made of: packed parameters of its elements,
masses and placements of bodies, closures, gravity. Their derivatives N' over s are found by building the
system at neighbouring values; then arrays N + N' s, in place, give the derivative of the rates over s with
any step, as small as the depth of a contact requires.
"""

from __future__ import annotations

import dataclasses
import math
import pickle
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.arrays import Array
from antenna_pin.base.calculus import WEIGHTS, few
from antenna_pin.base.settings import RunSettings
from antenna_pin.dynamics import System, Workspace, acting_in
from antenna_pin.errors import InvalidParameterError
from antenna_pin.integrate import method_named
from antenna_pin.mechanism import BODY, body_tree
from antenna_pin.run.engine import Carrying, CompiledStepper, SystemSlopes, Tangents, moves_rows
from antenna_pin.run.simulation.steps import scale_vector, stepper_of
from antenna_pin.studies.nonlinear.coordinates import ElementMemory, Units, perturbation_slices

# --- numbers of a system that parameters change -------------------------------------------------------------

# Integers among the words of a system read as floats below this; their change changes kinds.
_WHOLE = 1e-290
# Difference step of builds, in a parameter's scale; relative difference of two orders of a function without
# derivative.
_STEP, _ROUGH = 1e-3, 1e-6


class ParameterSlopes:
    """A system, and the derivatives of its numbers over parameters, each in its scale.

    Each of ``built`` builds the system so many scales farther, ``(s) -> System``; names are for messages.

    Raises:
        InvalidParameterError: A parameter changes what the system is made of, not its numbers alone.
    """

    def __init__(
        self, system: System, built: Sequence[Callable[[float], System]], names: Sequence[str]
    ) -> None:
        self._system, self.count = system, len(built)
        elements = list(_element_numbers(system))
        here = _system_arrays(system, elements)
        slopes = [_slopes(here, elements, *one) for one in zip(built, names, strict=True)]
        ends = np.cumsum([one.size for one in here.values()])
        parts = np.split(np.array(slopes).reshape(self.count, ends[-1]), ends[:-1], axis=1)
        self.slopes: dict[str, Array] = dict(zip(here, parts, strict=True))
        #: Derivatives of elements' numbers, by parameter and place.
        self.element_slopes: list[dict[str, dict[str, float]]] = [{} for _ in range(self.count)]
        for own, changes in zip(self.element_slopes, self.slopes.pop("elements").tolist(), strict=True):
            for (place, name), change in zip(elements, changes, strict=True):
                if change != 0.0:
                    own.setdefault(place, {})[name] = change

    def copy_system(self) -> System:
        """Return a copy of the system, whose numbers may be changed in place."""
        copied: System = pickle.loads(pickle.dumps(self._system))
        return copied


class ParameterShift:
    """Shifts of parameters applied in place to a system's copy, its workspace and its stepper.

    If ``whole``, the copy's own program is changed as well, from which other workspaces take theirs.
    """

    def __init__(
        self, numbers: ParameterSlopes, workspace: Workspace, stepper: CompiledStepper, *, whole: bool = False
    ) -> None:
        self.count, model = numbers.count, workspace.model
        self._of_elements = numbers.element_slopes
        own = stepper.numbers
        bodies = workspace.bodies
        arrays = {
            "program": [workspace.program, workspace.system.program] if whole else [workspace.program],
            "tree": [own.tree] if bodies is None else [own.tree, bodies],
            "plan": [own.plan],
            "gravity": [own.gravity],
        }
        #: Derivatives of the program, by parameter, without words set by events.
        self.program = numbers.slopes["program"].copy()
        self._parts: list[tuple[Array, NDArray[np.int_], Array]] = []
        for key, flats in arrays.items():
            slopes = self.program if key == "program" else numbers.slopes[key]
            at = np.flatnonzero(np.abs(slopes).any(axis=0))
            if len(at):
                self._parts += [(one.view(np.float64).reshape(-1), at, slopes) for one in flats]
        self._model = model
        joints = range(model.njoints)
        self._inertias = numbers.slopes["inertias"].reshape(self.count, len(joints), 10)
        self._places = numbers.slopes["placements"].reshape(self.count, len(joints), 12)
        self._armature = numbers.slopes["armature"]
        self._heavier = [i for i in joints if self._inertias[:, i].any()]
        self._moved = [i for i in joints if self._places[:, i].any()]
        #: Derivatives of bodies, constraints and gravity, flat, by parameter.
        self.tree, self.plan = numbers.slopes["tree"], numbers.slopes["plan"]
        self.gravity = numbers.slopes["gravity"]
        self._of_model = bool(self._heavier or self._moved or self._armature.any() or self.gravity.any())
        #: Present shift of each parameter, (count,).
        self.present = np.zeros(self.count)

    @contextmanager
    def shifted(self, s: Array) -> Iterator[None]:
        """Shift the numbers by parameters, (count,) in their scales, and back."""
        kept = []
        for flat, at, slopes in self._parts:
            values = flat[at]
            kept.append((flat, at, values))
            flat[at] = values + s @ slopes[:, at]
        before, self.present = self.present, s
        with self._shifted_model(s) if self._of_model else nullcontext():
            try:
                yield
            finally:
                for flat, at, values in kept:
                    flat[at] = values
                self.present = before

    @contextmanager
    def _shifted_model(self, s: Array) -> Iterator[None]:
        """Shift Pinocchio's numbers likewise."""
        model = self._model
        inertias = [(i, model.inertias[i].copy()) for i in self._heavier]
        for i, one in inertias:
            numbers = one.toDynamicParameters() + s @ self._inertias[:, i]
            model.inertias[i] = pin.Inertia.FromDynamicParameters(numbers)
        places = [(i, model.jointPlacements[i].copy()) for i in self._moved]
        for i, one in places:
            change = s @ self._places[:, i]
            rotation = one.rotation + change[3:].reshape(3, 3)
            model.jointPlacements[i] = pin.SE3(rotation, one.translation + change[:3])
        armature, gravity = model.armature.copy(), model.gravity.linear.copy()
        if self._armature.any():
            model.armature = armature + s @ self._armature
        if self.gravity.any():
            model.gravity.linear = gravity + s @ self.gravity
        try:
            yield
        finally:
            for i, one in inertias:
                model.inertias[i] = one
            for i, one in places:
                model.jointPlacements[i] = one
            model.armature, model.gravity.linear = armature, gravity

    def element_changes(self, place: str) -> Mapping[str, float]:
        """Return the present shifts of an element's numbers, by its place."""
        found: dict[str, float] = {}
        for s, table in zip(self.present.tolist(), self._of_elements, strict=True):
            for key, change in table.get(place, {}).items():
                found[key] = found.get(key, 0.0) + s * change
        return found

    def release_words(self, words: NDArray[np.int_]) -> None:
        """Detach words of the program from parameters: an event has set them."""
        self.program[:, words] = 0.0


def _system_arrays(system: System, elements: Sequence[tuple[str, str]]) -> dict[str, Array]:
    """Return the arrays that determine a system's motion, flat, by name."""
    of_elements = _element_numbers(system)
    model, tree = system.model, body_tree(system.mechanism)
    inertias = [one.toDynamicParameters() for one in model.inertias]
    places = [np.append(one.translation, one.rotation.reshape(-1)) for one in model.jointPlacements]
    return {
        "program": system.program,
        "tree": tree.view(np.float64).reshape(-1),
        "plan": np.zeros(0) if system.plan is None else system.plan.words,
        "gravity": np.array(model.gravity.linear),
        "inertias": np.concatenate(inertias),
        "placements": np.concatenate(places),
        "armature": np.array(model.armature),
        "elements": np.array([of_elements.get(one, math.nan) for one in elements], dtype=float),
    }


def _element_numbers(system: System) -> dict[tuple[str, str], float]:
    """Return the numbers of a system's elements, by place and name."""
    return {
        (one.place, field.name): float(value)
        for one in acting_in(system)
        if dataclasses.is_dataclass(one.element)
        for field in dataclasses.fields(one.element)
        if isinstance(value := getattr(one.element, field.name), float) and math.isfinite(value)
    }


def _slopes(
    here: Mapping[str, Array],
    elements: Sequence[tuple[str, str]],
    build: Callable[[float], System],
    name: str,
) -> Array:
    """Return the derivatives of all arrays, concatenated, or refuse a discontinuity."""
    values = np.concatenate(list(here.values()))

    def there(j: int) -> Array:
        if j == 0:
            return values
        found = _system_arrays(build(j * _STEP), elements)
        alike = all(found[key].shape == one.shape for key, one in here.items())
        other = np.concatenate(list(found.values())) if alike else values
        sizes = np.abs([values, other])
        if not alike or ((values != other) & (sizes.max(axis=0) < _WHOLE)).any():
            rule = "one that changes numbers of the mechanism alone, not what it is made of or how often"
            raise InvalidParameterError("sensitivities", "key", rule, said=name)
        return other

    slope, apart = few(there, _STEP)
    if (apart > _ROUGH * np.maximum(np.abs(values), np.abs(slope))).any():
        rule = "one of which the mechanism's numbers are smooth functions near its value"
        raise InvalidParameterError("sensitivities", "key", rule, said=name)
    return slope


# --- a system at perturbed states ---------------------------------------------------------------------------

StateFunction = Callable[[float, Array], Array]

#: Difference steps in error scales. At joints with play, whose scales are a clearance and 0.01 m/s, they are
#: finer, small beside the kinks of laws and large beside the round-off of poses; near kinks and in shallow
#: contacts they are refined.
STEP = 1e-4
_IN_PLAY = 1e-5


class PerturbedSystem:
    """Functions of time and state, evaluated at perturbed states.

    Perturbations include the parameters ``numbers``; if ``whole``, these displace the system's own program,
    too.
    """

    def __init__(
        self,
        system: System,
        settings: RunSettings,
        numbers: ParameterSlopes | None = None,
        *,
        whole: bool = False,
    ) -> None:
        self.system = system = system if numbers is None else numbers.copy_system()
        self.workspace, self.memory = Workspace(system), ElementMemory(system)
        scales = scale_vector(system, settings.scales)
        self.stepper = stepper_of(self.workspace, method_named(settings.method), scales, settings)
        self.bristles = np.asarray(system.bristle_x, dtype=int)
        self.parts = perturbation_slices(system, len(self.memory), 0 if numbers is None else numbers.count)
        self.numbers = (
            None if numbers is None else ParameterShift(numbers, self.workspace, self.stepper, whole=whole)
        )
        self._of_rows: list[int] = []  # numbers that constraints go with
        self._y, self._memory = np.zeros(system.manifold.size), self.workspace.memory.copy()

    def rates(self, time: float, y: Array) -> Array:
        """Return [acceleration (nv), rate of x (nx)] with contacts and program of the moment."""
        return self.stepper.rates(time, y)

    def flow(self, time: float, y: Array) -> Array:
        """Return the perturbation per second along the flow, (perturbation,)."""
        nq, nv = self.system.model.nq, self.system.model.nv
        way, rate, bristles, *_, clock = self.parts
        rates, out = self.rates(time, y), np.zeros(clock.stop)
        out[way], out[rate], out[bristles] = y[nq : nq + nv], rates[:nv], rates[nv + self.bristles]
        out[clock] = 1.0
        return out

    def tangents(self, units: Units) -> Tangents | None:
        """Return analytic derivatives, at least of onsets, or None."""
        if not Tangents.knows_contacts(self.system):
            return None
        return Tangents(self.system, self.stepper, np.concatenate(units), WEIGHTS)

    def stage_propagation(self, tangents: Tangents | None, coarse: Array) -> Carrying | None:
        """Return the propagation of tangents by the integrator's stages, or None."""
        if tangents is None or not Carrying.takes(self.stepper):
            return None
        steps = coarse.copy()
        steps[self.parts[-1]] = 1.0 / STEP
        return Carrying(self.stepper, tangents, steps)

    def link_parameters(self, tangents: Tangents | None, units: Units) -> bool:
        """Pass parameter slopes and element memory to analytic derivatives; return whether they accept."""
        own, numbers = self.stepper.numbers, self.numbers
        tree = own.tree.view(np.float64).reshape(-1)
        if numbers is not None and self.system.plan is not None:
            moved = moves_rows(self.system, numbers.program, numbers.plan)
            self._of_rows = np.flatnonzero(moved).tolist()
        program, bodies, plan, gravity = (
            np.zeros((0, size)) for size in (len(own.program), len(tree), len(own.plan), 3)
        )
        if numbers is not None:
            program, bodies, plan, gravity = numbers.program, numbers.tree, numbers.plan, numbers.gravity
        kept = self.memory.words, self.memory.units(units.position, units.rate)
        return tangents is not None and tangents.follow(SystemSlopes(program, bodies, plan, gravity, *kept))

    def coarseness(self, units: Units, in_play: float | None = None) -> Array:
        """Return the inverse of the largest step of each part of a perturbation, (perturbation,).

        Steps at joints with play, over their units, are ``in_play``, by default those of forces.
        """
        way, rate, bristles, *_, numbers, kept, _ = self.parts
        out = np.zeros(self.parts[-1].stop)
        out[way], out[rate], out[bristles] = 1.0 / units.position, 1.0 / units.rate, 1.0 / units.bristle
        out[kept] = 1.0 / (STEP * self.memory.units(units.position, units.rate))
        steps, finer = np.full(self.system.model.nv, STEP), _IN_PLAY if in_play is None else in_play
        for joint in self.system.clearances:
            steps[self.system.mechanism.joint(joint.name).v] = finer
        out[way] /= steps
        out[rate] /= steps
        out[bristles] /= finer
        out[numbers] = 1.0 / STEP
        return out

    def at(self, function: StateFunction, time: float, y: Array, displacement: Array) -> Array:
        """Return a function's value at a perturbed state."""
        nq, nv = self.system.model.nq, self.system.model.nv
        way, rate, bristles, speeds, masses, numbers, own, clock = (displacement[one] for one in self.parts)
        memory, kept, program = self.workspace.memory, self._memory, self.workspace.program
        shift = self.numbers.shifted(numbers) if self.numbers is not None and numbers.any() else nullcontext()
        with shift:
            words = program[self.memory.words]
            self._y[:] = y
            self.workspace.retract(self._y, way)
            self._y[nq : nq + nv] += rate
            self._y[nq + nv + self.bristles] += bristles
            kept[:] = memory
            memory["approach_speed"] *= np.exp(speeds)
            memory["effective_mass"] *= np.exp(masses)
            program[self.memory.words] += own
            try:
                return np.array(function(time + float(clock[0]), self._y))
            finally:
                memory[:], program[self.memory.words] = kept, words

    def over(self, function: StateFunction, time: float, y: Array, way: Array, step: float) -> Array:
        """Return the derivative of a function along a perturbation, of two orders, (2, ...)."""
        return np.asarray(WEIGHTS @ _odd(lambda point: self.at(function, time, y, point * step * way)) / step)

    def over_numbers(self, time: float, y: Array, way: Array, step: float) -> Array:
        """Return derivatives of the rates over parameters, of two orders, (2, ...)."""
        assert self.numbers is not None
        shifted = self.numbers.shifted

        def rates(point: float) -> Array:
            with shifted(point * step * way):
                return self.rates(time, y).copy()

        return np.asarray(WEIGHTS @ _odd(rates) / step)

    def constraint_slopes(self, time: float, y: Array) -> Array:
        """Return derivatives of constraint gaps and rates over parameters, (2, rows, parameters)."""
        workspace, numbers, constraints = self.workspace, self.numbers, self.workspace.constraints
        assert constraints is not None
        out = np.zeros((2, len(constraints.every_gap), 0 if numbers is None else numbers.count))
        if numbers is None:
            return out
        shifted = numbers.shifted

        def residuals(way: Array) -> Array:
            with shifted(way):
                workspace.prepare_motions(time, y)
                constraints.residuals(time, y, workspace.program)
                return np.array([constraints.every_gap, constraints.every_speed])

        for k, way in ((k, STEP * np.eye(numbers.count)[k]) for k in self._of_rows):
            odd = _odd(lambda point, way=way: residuals(point * way))  # type: ignore[misc]
            out[:, :, k] = np.tensordot(WEIGHTS[0], odd, 1) / STEP
        return out


def _odd(function: Callable[[float], Array]) -> Array:
    """Return the differences of a function between opposite points 1, 2, 3, (3, ...)."""
    values = np.array([function(point) for point in (1.0, 2.0, 3.0, -1.0, -2.0, -3.0)])
    return np.asarray(values[:3] - values[3:])


# --- a system at perturbed parameters -----------------------------------------------------------------------


class PerturbedParameters:
    """Copy of a system with one parameter perturbed at a time.

    Results of states depend on the arrays that rates depend on, so that a copy with these perturbed gives
    their derivatives. Two things are in no array, and there a perturbed system is built: functions in Python,
    and the axes of joints in Pinocchio's model.

    The function ``built(parameter, s)`` builds a perturbed system, s in the parameter's scale.
    """

    def __init__(
        self,
        system: System,
        settings: RunSettings,
        numbers: ParameterSlopes,
        built: Callable[[int, float], System],
    ) -> None:
        self._settings, self._built = settings, built
        self._near = near = PerturbedSystem(system, settings, numbers, whole=True)
        bodies = numbers.slopes["tree"].view(BODY)
        asked = bool(near.workspace.paths or near.system.callables)
        #: Whether perturbed systems of each parameter are built.
        self.builds = (bodies["axis"] != 0.0).any(axis=(1, 2)) | asked
        others = [one.any(axis=1) for key, one in numbers.slopes.items() if key != "program"]
        #: Whether they differ in their programs alone, which belong to states.
        self.by_program = ~(np.any(others, axis=0) | self.builds)

    @contextmanager
    def at(self, k: int, s: float) -> Iterator[PerturbedSystem]:
        """Yield the system with a parameter shifted by s scales."""
        if s != 0.0 and self.builds[k]:
            yield PerturbedSystem(self._built(k, s), self._settings)
            return
        own, far = self._near.numbers, np.zeros(len(self.builds))
        assert own is not None
        far[k] = s
        with own.shifted(far):
            yield self._near
