"""Scenario with changed numbers: its curves and its file."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.analysis import Line, answer, journal_motion, quantity
from antenna_pin.apps.live.knobs import Knob, knobs_of, play_names
from antenna_pin.base.arguments import check_number
from antenna_pin.base.files import check_writable, replacing
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.run.session import start
from antenna_pin.scenario import Scenario, found_from, scenario_toml
from antenna_pin.trajectory import Outcome, Trajectory, contact_kinds, contacts_of, names_along

Array = NDArray[np.float64]

#: How much of a run is shown if nobody says [s].
SPAN = 0.5


@dataclass(frozen=True, slots=True)
class Curve:
    """A quantity over time, or one over another.

    Attributes:
        name: What it is, for a legend.
        x: Time [s], or across, (n,).
        y: The quantity, or up, (n,).
        unit: Of y, as variables of a run have it.
    """

    name: str
    x: Array
    y: Array
    unit: str


@dataclass(frozen=True, slots=True)
class Curves:
    """Panels of a run: three.

    Attributes:
        first: The journal's path across the bearing [m], at each place where it is examined; of a joint
            without play its angle.
        second: Normal forces summed over the contacts of each kind; of a joint without play its rate.
        third: The joint's acceleration.
        outline: What rigid parts leave the journal, (m, 2) [m]; empty without play.
    """

    first: tuple[Curve, ...]
    second: tuple[Curve, ...]
    third: tuple[Curve, ...]
    outline: Array


class Explored:
    """A scenario that is being explored.

    Args:
        scenario: Where it starts from.
        joint: Joint that is shown; the first with play, or the first that moves.
        span: How much of the run is made [s].

    Attributes:
        joints: Joints that may be shown.
        joint: Which one is.
        values: What was turned, by place.
    """

    def __init__(self, scenario: Scenario, joint: str | None = None, span: float = SPAN) -> None:
        """Find what may be turned, or refuse what cannot be explored."""
        check_number("explore", "duration", span, "positive", "s")
        fast: dict[str, Any] = {"integrator.engine": "compiled", "duration": min(span, scenario.duration)}
        for name in play_names(scenario):
            fast[f"clearance.{name}.geometry"] = "closed-form"
        if scenario.output.form != "full":
            fast["output.form"] = "full"
        self._given = scenario
        self._begun = scenario.with_overrides(fast)
        self.joints, self._sliding = _joints(self._begun)
        if joint is None:
            joint = next(iter(self.joints), None)
            if joint is None:
                raise InvalidParameterError(
                    "explore", "scenario", "one with a joint that moves", scenario.name
                )
        self.values: dict[str, float] = {}
        self.look_at(joint)

    def look_at(self, joint: str) -> None:
        """Look at another joint; what was turned stays so.

        Raises:
            UnknownNameError: There is none of that name.
        """
        if joint not in self.joints:
            raise UnknownNameError("explore", "joint", joint, self.joints)
        self.joint = joint
        span = self._begun.duration
        ends = min(0.01, 0.1 * span), max(self._given.duration, span)
        time = Knob("Run", "time shown", "duration", "s", span, *ends, logarithmic=True)
        self.knobs = [*knobs_of(self._begun, joint, self._sliding), time]
        self._all = {knob.place: knob for knob in self.knobs} | getattr(self, "_all", {})

    @property
    def has_play(self) -> bool:
        """Return whether the selected joint has play."""
        return self.joint in play_names(self._begun)

    def value(self, knob: Knob) -> float:
        """Return the present value of a knob [unit]."""
        return self.values.get(knob.place, knob.value)

    def turn(self, place: str, value: float) -> None:
        """Set a number."""
        if value == self._all[place].value:
            self.values.pop(place, None)
        else:
            self.values[place] = value

    def reset(self) -> None:
        """Undo all that was turned."""
        self.values.clear()

    @property
    def settings(self) -> dict[str, Any]:
        """Values that replace those of the scenario, by place."""
        found: dict[str, Any] = {}
        for place, value in self.values.items():
            found |= self._all[place].settings(value)
        return found

    def scenario(self) -> Scenario:
        """Return the scenario as it is now.

        Raises:
            AntennaPinError: Invalid, with the reason in one line.
        """
        return self._begun.with_overrides(self.settings) if self.values else self._begun

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the present scenario as a file of its own: same numbers, same curves.

        Raises:
            AntennaPinError: It is none, or cannot be written.
        """
        target = check_writable(path, ".toml")
        text = scenario_toml(found_from(self.scenario(), target.resolve().parent))
        with replacing(target) as partial:
            partial.write_text(text, encoding="utf-8")
        return target

    def curves(self, run: Trajectory) -> Curves:
        """Return the panels of a run."""
        third = _over_time(run, self.joint, 2)
        if not self.has_play:
            first, second = (_over_time(run, self.joint, order) for order in (0, 1))
            return Curves((first,), (second,), (third,), np.zeros((0, 2)))
        data = run.data
        motion = journal_motion(data, self.joint)
        offset = motion["offset"].values
        path = tuple(
            Curve(_PLACES.get(str(place), str(place)), offset[:, k, 0], offset[:, k, 1], "m")
            for k, place in enumerate(motion["place"].values)
        )
        time, kinds = np.asarray(data["time"].values, dtype=float), contact_kinds(data)
        force = {
            name: data["normal_force"].sel(contact=name).values for name in contacts_of(data, self.joint)
        }
        forces = tuple(
            Curve(kind, time, np.sum([force[one] for one in force if kinds[one] == kind], axis=0), "N")
            for kind in dict.fromkeys(kinds[one] for one in force)
        )
        return Curves(path, forces, (third,), np.asarray(motion.attrs["outline"], dtype=float))


_PLACES = {"+": "end +", "-": "end \N{MINUS SIGN}", "centre": "journal's centre"}


# Position, rate and acceleration of joints that turn and of those that slide, by the axis of their names.
_MOTIONS = {
    "joint": ("motion_angle", "motion_rate", "motion_acceleration"),
    "sliding_joint": ("slide_position", "slide_rate", "slide_acceleration"),
}
_ORDERS = ("position", "rate", "acceleration")


def _over_time(run: Trajectory, joint: str, order: int) -> Curve:
    """Return the motion of a joint, or a derivative of it, over time.

    Of a joint without an axis, such as one of a ball, that of the first that has one; where none has, the
    kinetic energy of all.
    """
    data = run.data
    time = np.asarray(data["time"].values, dtype=float)
    moving = {name: names for names in _MOTIONS for name in names_along(data, names)}
    if not moving:
        return Curve("kinetic energy", time, np.asarray(data["kinetic_energy"].values, dtype=float), "J")
    one = joint if joint in moving else next(iter(moving))
    found = quantity(data, f"{_MOTIONS[moving[one]][order]}[{one}]")
    return Curve(f"{_ORDERS[order]}, {one}", time, np.asarray(found.values, dtype=float), found.units)


def _joints(scenario: Scenario) -> tuple[list[str], frozenset[str]]:
    """Return the selectable joints, those with play first, and which of them slide."""
    units = start(scenario, record=False).names()
    moving = {name.removesuffix(".angle"): units[name] for name in units if name.endswith(".angle")}
    shaken = scenario.families.get("shake", {})  # what carries the base
    joints = [name for name in moving if "." not in name and name not in shaken]
    sliding = frozenset(name for name in joints if moving[name] == "m")
    return list(dict.fromkeys([*play_names(scenario), *joints])), sliding


def said_of(run: Trajectory) -> tuple[str, tuple[Line, ...]]:
    """Return how a run ended, and what has happened in it, in lines."""
    told = answer(run)
    ended = told.ended if run.outcome is Outcome.COMPLETED else f"{told.ended} \N{EM DASH} {run.message}"
    return ended, told.lines
