"""Numbers of a system that a parameter changes, and a system's own copy in which they are changed in place.

A parameter s acts on a motion through the arrays that a system is made of: the words of its elements, masses
and placements of bodies, what closures are made of, gravity. Their derivatives N' over s are found by
building the system at neighbouring values; then arrays N + N' s, in place, have the rates' derivative over
s by any step, as small as a contact's depth wants it.
"""

from __future__ import annotations

import dataclasses
import math
import pickle
from collections.abc import Callable, Mapping, Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.differences import WEIGHTS
from antenna_pin.dynamics import System, Workspace, acting_in
from antenna_pin.engine import CompiledStepper
from antenna_pin.errors import InvalidParameterError
from antenna_pin.mechanism import body_tree

__all__ = ["InPlace", "Numbers"]

Array = NDArray[np.float64]

# Whole numbers among the words of a system read as floats below this; what changes them changes its kind.
_WHOLE = 1e-290
# Step of differences of builds, in a parameter's scale; and differences of their orders, over the derivative,
# from which on they are no function that can be differentiated.
_STEP, _ROUGH = 1e-3, 1e-6


class Numbers:
    """A system, and the derivatives of its numbers over some parameters, each in its scale.

    Args:
        system: The system.
        built: Of each parameter what builds the system so many scales farther, ``(s) -> System``.
        names: Of the parameters, for messages.

    Raises:
        InvalidParameterError: A parameter changes what the system is made of, not its numbers alone.
    """

    def __init__(
        self, system: System, built: Sequence[Callable[[float], System]], names: Sequence[str]
    ) -> None:
        """Build the neighbours, and differentiate."""
        self._system, self.count = system, len(built)
        here = _arrays(system)
        self.slopes: dict[str, Array] = {key: np.zeros((self.count, one.size)) for key, one in here.items()}
        #: Of each parameter, by the place of an element, its own numbers' derivatives.
        self.of_elements: list[dict[str, dict[str, float]]] = []
        for k, (build, name) in enumerate(zip(built, names, strict=True)):
            ahead, behind = ([build(side * j * _STEP) for j in (1, 2, 3)] for side in (1, -1))
            tables = [[_arrays(one) for one in side] for side in (ahead, behind)]
            for key, array in here.items():
                ahead_of, behind_of = (_alike(key, array, side, name) for side in tables)
                self.slopes[key][k] = _slope(ahead_of, behind_of, name)
            elements = [[_of_elements(one) for one in side] for side in (ahead, behind)]
            own: dict[str, dict[str, float]] = {}
            for place, values in _of_elements(system).items():
                for key in values:
                    one, other = (np.array([[there[place][key]] for there in side]) for side in elements)
                    change = float(_slope(one, other, name)[0])
                    if change != 0.0:
                        own.setdefault(place, {})[key] = change
            self.of_elements.append(own)

    def own_system(self) -> System:
        """Return a copy of the system, whose numbers may be changed in place."""
        copied: System = pickle.loads(pickle.dumps(self._system))
        return copied


class InPlace:
    """Changes the numbers of a system's own copy, of a workspace and of a stepper, and back.

    Args:
        numbers: Which, and by how much.
        workspace: Of the copy; its model and program are changed.
        stepper: Its arrays are.
        whole: Whether the copy's own program is changed as well, from which other workspaces take theirs.
    """

    def __init__(
        self, numbers: Numbers, workspace: Workspace, stepper: CompiledStepper, *, whole: bool = False
    ) -> None:
        """Find what changes."""
        self.count, model = numbers.count, workspace.model
        self._of_elements = numbers.of_elements
        own = stepper.numbers
        bodies = workspace.bodies
        arrays = {
            "program": [workspace.program, workspace.system.program] if whole else [workspace.program],
            "tree": [own.tree] if bodies is None else [own.tree, bodies],
            "plan": [own.plan],
            "gravity": [own.gravity],
        }
        #: Of the program, by parameter: what an event sets does not go with it any more.
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
        #: Of the bodies' numbers, flat, of constraints', and of gravity, likewise.
        self.tree, self.plan = numbers.slopes["tree"], numbers.slopes["plan"]
        self.gravity = numbers.slopes["gravity"]
        self._of_model = bool(self._heavier or self._moved or self._armature.any() or self.gravity.any())
        #: How far each is displaced at present, (count,).
        self.present = np.zeros(self.count)

    def displace(self, s: Array) -> Callable[[], None]:
        """Change the numbers by parameters, (count,) in their scales; return what changes them back."""
        kept = []
        for flat, at, slopes in self._parts:
            values = flat[at]
            kept.append((flat, at, values))
            flat[at] = values + s @ slopes[:, at]
        before, self.present = self.present, s
        changed_back = self._displace_model(s) if self._of_model else None

        def back() -> None:
            for flat, at, values in kept:
                flat[at] = values
            self.present = before
            if changed_back is not None:
                changed_back()

        return back

    def _displace_model(self, s: Array) -> Callable[[], None]:
        """Change Pinocchio's numbers likewise."""
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

        def back() -> None:
            for i, one in inertias:
                model.inertias[i] = one
            for i, one in places:
                model.jointPlacements[i] = one
            model.armature, model.gravity.linear = armature, gravity

        return back

    def of_element(self, place: str) -> Mapping[str, float]:
        """Return by how much the numbers of an element, by its place, are displaced at present."""
        found: dict[str, float] = {}
        for s, table in zip(self.present.tolist(), self._of_elements, strict=True):
            for key, change in table.get(place, {}).items():
                found[key] = found.get(key, 0.0) + s * change
        return found

    def let_go(self, words: NDArray[np.int_]) -> None:
        """Let words of the program go with parameters no more: an event has set them."""
        self.program[:, words] = 0.0


def _arrays(system: System) -> dict[str, Array]:
    """Return the arrays that a system's motion goes by, flat, by name."""
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
    }


def _of_elements(system: System) -> dict[str, dict[str, float]]:
    """Return the numbers of a system's elements, by place and name."""
    return {
        one.place: {
            field.name: float(value)
            for field in dataclasses.fields(one.element)
            if isinstance(value := getattr(one.element, field.name), float) and math.isfinite(value)
        }
        for one in acting_in(system)
        if dataclasses.is_dataclass(one.element)
    }


def _alike(key: str, here: Array, there: Sequence[Mapping[str, Array]], name: str) -> Array:
    """Return neighbours' arrays, (3, size), or refuse those of another kind."""
    found = [one[key] for one in there]
    for one in found:
        sizes = np.abs(np.array([here, one])) if one.shape == here.shape else None
        whole = None if sizes is None else (sizes[0] != sizes[1]) & (sizes.max(axis=0) < _WHOLE)
        if whole is None or whole.any():
            rule = "one that changes numbers of the mechanism alone, not what it is made of or how often"
            raise InvalidParameterError("sensitivities", "key", rule, said=name)
    return np.array(found)


def _slope(ahead: Array, behind: Array, name: str) -> Array:
    """Return a derivative, of each number, from three neighbours on both sides, (3, size) each."""
    with np.errstate(invalid="ignore"):
        sixth, fourth = WEIGHTS @ (ahead - behind) / _STEP
    size = np.maximum(np.abs(ahead).max(axis=0), np.abs(sixth))
    if (np.abs(sixth - fourth) > _ROUGH * size).any():
        rule = "one of which the mechanism's numbers are smooth functions near its value"
        raise InvalidParameterError("sensitivities", "key", rule, said=name)
    # What stays the same is not to go with round-off; infinite numbers stay as they are.
    return np.where((ahead == behind).all(axis=0) | ~np.isfinite(sixth), 0.0, sixth)
