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

from antenna_pin.base.differences import few
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
        elements = list(_of_elements(system))
        here = _arrays(system, elements)
        slopes = [_slopes(here, elements, *one) for one in zip(built, names, strict=True)]
        ends = np.cumsum([one.size for one in here.values()])
        parts = np.split(np.array(slopes).reshape(self.count, ends[-1]), ends[:-1], axis=1)
        self.slopes: dict[str, Array] = dict(zip(here, parts, strict=True))
        #: Of each parameter, by the place of an element, its own numbers' derivatives.
        self.of_elements: list[dict[str, dict[str, float]]] = [{} for _ in range(self.count)]
        for own, changes in zip(self.of_elements, self.slopes.pop("elements").tolist(), strict=True):
            for (place, name), change in zip(elements, changes, strict=True):
                if change != 0.0:
                    own.setdefault(place, {})[name] = change

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


def _arrays(system: System, elements: Sequence[tuple[str, str]]) -> dict[str, Array]:
    """Return the arrays that a system's motion goes by, flat, by name, and numbers of elements."""
    of_elements = _of_elements(system)
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


def _of_elements(system: System) -> dict[tuple[str, str], float]:
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
    """Return the derivatives of all arrays, one behind the other, or refuse what has none."""
    values = np.concatenate(list(here.values()))

    def there(j: int) -> Array:
        if j == 0:
            return values
        found = _arrays(build(j * _STEP), elements)
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
