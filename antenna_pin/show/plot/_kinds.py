"""Kinds of joints and runs of figures, and the catalogue's figure of runs."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from antenna_pin.analysis import gears_of, is_round_off, shakes_of, stops_and_latches
from antenna_pin.errors import FileFormatError, InvalidParameterError, UnknownNameError
from antenna_pin.show.plot._runs import LabelledRun, Runs, long_enough, unit_of
from antenna_pin.show.plot._style import Width
from antenna_pin.trajectory import names_along

# Number of samples by which a joint's motion is detected.
_LOOKS = 500


@dataclass(frozen=True, slots=True)
class JointKind:
    """Joints that a figure can be of.

    Attributes:
        noun: Name in refusals.
        words: Requirement on a run, after "with".
        names: Returns such joints of a run.
        play: Whether joints with play come first; else joints without play only.
        asked: Whether mechanisms without play have such figures on request only.
    """

    noun: str
    words: str
    names: Callable[[LabelledRun], list[str]]
    play: bool = True
    asked: bool = False


@dataclass(frozen=True, slots=True)
class RunKind:
    """Runs that a figure can be of."""

    words: str  # requirement on a run, after "with"
    holds: Callable[[LabelledRun], bool]  # predicate of a run


def _described(run: LabelledRun, table: str) -> list[str]:
    """Return the keys of a table of a run's scenario, none without it."""
    try:
        return list(json.loads(run.data.attrs["scenario"])[table])
    except (KeyError, TypeError, ValueError):
        return []


def _sweeps(run: LabelledRun) -> bool:
    """Return whether the base is swept; one sine has one piece, without growth."""
    found = [one["shakes"].get("pieces", ()) for one in shakes_of(run.data).values()]
    return any(len(pieces) > 1 for pieces in found)


def _with_play(run: LabelledRun) -> list[str]:
    """Return joints with clearance in a run or in its scenario."""
    return list(dict.fromkeys([*run.clearance_joints, *_described(run, "clearance")]))


def _moves(run: LabelledRun, joint: str) -> bool:
    """Return whether a joint's angle or position changes by more than round-off."""
    for dim, variable in (("joint", "motion_angle"), ("sliding_joint", "slide_position")):
        if joint in names_along(run.data, dim) and variable in run.data:
            some = run.data[variable].isel(time=slice(None, None, max(1, run.time.size // _LOOKS)))
            way = float(np.ptp(some.sel({dim: joint}).values))
            return way > 0.0 and not is_round_off(way, unit_of(variable), {"rad": 1.0, "m": 1.0})
    return False


TURNING = JointKind("joint", "a joint that turns about an axis", lambda run: run.joints, asked=True)
SLIDING = JointKind(
    "sliding joint", "a joint that slides along its axis", lambda run: run.sliding_joints, asked=True
)
GUIDED = JointKind("joint", "a joint that turns or slides", lambda run: [*run.joints, *run.sliding_joints])
PLAYLESS = JointKind(
    "joint",
    "a joint without play that moves",
    lambda run: [name for name in GUIDED.names(run) if _moves(run, name)],
    play=False,
)
TOUCHING = JointKind("joint with clearance", "contact in a joint", lambda run: run.clearance_joints)
MOVING = JointKind(
    "joint", "a joint that moves", lambda run: [*run.joints, *run.sliding_joints, *_with_play(run)]
)

LOOPED = JointKind(
    "joint", "a closed loop", lambda run: MOVING.names(run) if "closure" in run.data.dims else []
)

CLOSED = RunKind("a closure of a loop", lambda run: "closure" in run.data.sizes)
COUPLED = RunKind("a coupling of joints", lambda run: "coupling" in run.data.sizes)
FLEXIBLE = RunKind("flexible links", lambda run: "elastic_part" in run.data.sizes)
TRACED = RunKind(
    "a spring that has a table, hysteresis or a constant torque",
    lambda run: "traced_spring" in run.data.sizes,
)
PRESCRIBED = RunKind("a prescribed motion", lambda run: "motion" in run.data.sizes)
GEARED = RunKind("a gear, a belt or a cable", lambda run: bool(gears_of(run.data)))
STOPPED = RunKind("an end stop or a latch", lambda run: any(stops_and_latches(run.data)))
CONTROLLED = RunKind("a controller", lambda run: "tick_signal" in run.data or "control_reference" in run.data)
FORCED = RunKind(
    "a force on a link", lambda run: "force_place" in run.data.sizes and "applied_force" in run.data
)
SHAKEN = RunKind("a shaken base", lambda run: bool(shakes_of(run.data)))
SWEPT = RunKind("a base that is swept through frequencies", lambda run: _sweeps(run))
RANDOM = RunKind(
    "a base that is shaken at random",
    lambda run: any("density" in one["shakes"] for one in shakes_of(run.data).values()),
)
FREE_BASE = RunKind("a free base", lambda run: "base_position" in run.data)
POINTED = RunKind("a scenario with a table [pointing]", lambda run: bool(_described(run, "pointing")))


def _names(kind: JointKind, runs: Sequence[LabelledRun]) -> list[str]:
    return list(dict.fromkeys(name for run in runs for name in kind.names(run)))


def none_with(kind: JointKind | RunKind, runs: Sequence[LabelledRun]) -> InvalidParameterError:
    """Return the refusal of runs of which none is of a kind."""
    return refusal(f"at least one run with {kind.words}", runs)


def refusal(rule: str, runs: Sequence[LabelledRun]) -> InvalidParameterError:
    """Return the refusal of runs of which none meets a rule."""
    return InvalidParameterError("figure", "runs", rule, ", ".join(run.label for run in runs))


def joints_of(kind: JointKind, runs: Sequence[LabelledRun]) -> list[str]:
    """Return the joints of a kind that runs are about.

    Kinds without play have all joints without play. Others have joints with clearance in a run, else joints
    with clearance in a scenario, else the first joint of the kind.
    """
    known = _names(kind, runs)
    if not kind.play:
        play_in = {name for run in runs for name in _with_play(run)}
        return [name for name in known if name not in play_in]
    for play in (lambda run: run.clearance_joints, _with_play):
        found = [name for name in dict.fromkeys(n for run in runs for n in play(run)) if name in known]
        if found:
            return found
    return known[:1]


def wanted_joints(kind: JointKind, runs: Sequence[LabelledRun]) -> list[str]:
    """Return the joints of a kind that have figures by default."""
    found = joints_of(kind, runs)
    if kind.asked and not any(name in _with_play(run) for run in runs for name in found):
        return []
    return found


def choose_joint(kind: JointKind, runs: Sequence[LabelledRun], joint: str | None) -> str:
    """Return the requested joint, or the first that the runs are about.

    Raises:
        UnknownNameError: No run has such a joint of that name.
        InvalidParameterError: No run of two samples or more has one.
        FileFormatError: The runs record no joints at all.
    """
    known = _names(kind, runs)
    if joint is not None and known and joint not in known:
        raise UnknownNameError("figure", kind.noun, joint, known)
    drawn = long_enough(runs)
    found = joints_of(kind, drawn) if joint is None else [n for n in _names(kind, drawn) if n == joint]
    if found:
        return found[0]
    if not any("joint" in run.data.coords for run in runs):
        raise FileFormatError("figure: the runs record no joint's motion; are they antenna_pin results?")
    raise none_with(kind, runs)


@dataclass(frozen=True, slots=True)
class RunFigure:
    """A figure of runs.

    Attributes:
        name: Name in the catalogue, and of its file without a format.
        title: Title; "{joint}" stands for the joint.
        function: Draws runs with ``options``, the joint if it is of one, and a width.
        options: Arguments of the function that make it this figure.
        of: Kind of its joint; None for a figure of whole runs.
        needs: Kind of its runs; None for all.
        compares: Whether every run is drawn beside the ideal one.
        standard: Whether it is drawn by default.
        reported: Whether it is in a report.
    """

    name: str
    title: str
    function: Callable[..., Figure]
    options: Mapping[str, Any] = field(default_factory=dict)
    of: JointKind | None = None
    needs: RunKind | None = None
    compares: bool = True
    standard: bool = True
    reported: bool = True

    @property
    def touching(self) -> bool:
        """Return whether the figure is of runs with contact only."""
        return self.of is TOUCHING

    @property
    def needed(self) -> str:
        """Requirement on a run of the figure; empty where there is none."""
        kind = self.of or self.needs
        return kind.words if kind is not None else ""

    def draw(self, runs: Runs, *, joint: str | None = None, width: Width = "page", **options: Any) -> Figure:
        """Return the figure.

        Args:
            runs: Trajectories, or pairs of a label and a dataset or trajectory.
            joint: Name of the joint; the runs' own if left out. Unused for a figure of whole runs.
            width: "column" (88 mm) or "page" (180 mm).
            **options: Further arguments of the function, such as ``zoom``.
        """
        of_joint = {} if self.of is None else {"joint": joint}
        return self.function(runs, **self.options, **of_joint, width=width, **options)
