"""Recorder of a run: from samples to a result, with efforts' peaks between the samples."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace, bearing_names, observed
from antenna_pin.elements import Motion
from antenna_pin.errors import FunctionError
from antenna_pin.integrate import method_named
from antenna_pin.run.simulation.attributes import constraint_attributes, mechanism_attributes
from antenna_pin.run.simulation.controllers import ControllerRecord
from antenna_pin.run.simulation.ledger import LedgerAudit
from antenna_pin.run.simulation.loop import Run
from antenna_pin.run.simulation.sample_files import SampleFiles, blocks_of, count_of
from antenna_pin.run.simulation.samples import Chunk, Samples
from antenna_pin.run.simulation.steps import stepper_of
from antenna_pin.run.simulation.variables import (
    SERIES,
    TOTALS,
    SampleBlock,
    bristles_of,
    episodes_of,
    motors_of,
    sizes_of,
)
from antenna_pin.trajectory import ENDED_WELL, Outcome
from antenna_pin.trajectory.columns import first_not_finite
from antenna_pin.trajectory.labelled import Unlabelled
from antenna_pin.trajectory.quantities import OF_SAMPLES

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]
Values = Mapping[str, Any]

# --- largest efforts of drives ------------------------------------------------------------------------------

_MOST = 4  # candidates per drive
_STEPS = 200  # trial steps between two samples
_LOOKS = np.linspace(0.0, 1.0, 5)  # within a step, at first
_BESIDE = 0.1  # of the time between samples: a vertex nearer to a sample is searched on both sides of it
_COARSE = 0.01  # relative height above a neighbouring sample beyond which a parabola is unreliable


class _PeakCandidate(NamedTuple):
    """Three samples around a possible maximum."""

    most: float  # largest value of the parabola through the samples [N m] ([N])
    bound: float  # upper bound of the expected maximum; infinite for coarse samples [N m] ([N])
    time: float  # time of the vertex of the parabola [s]
    samples: Chunk  # the three samples

    def sides(self, coarse: bool) -> list[Chunk]:
        """Return the pairs of samples that may enclose the maximum."""
        first, middle, last = self.samples.times.tolist()
        late = (self.time - middle) / (last - middle if self.time > middle else middle - first)
        sides = coarse or late < _BESIDE, coarse or late > -_BESIDE
        return [self.samples.part(k, k + 2) for k, may_be in enumerate(sides) if may_be]


class _RepeatedStep(NamedTuple):
    """Repeated step between two samples."""

    time: float  # begin of the step [s]
    state: Array  # state at the begin, [q, v, x]
    size: float  # size of the step [s]
    sizes: Array  # sizes of efforts within the step [N m] ([N]), (points, drives)


class EffortPeaks:
    """Largest efforts of drives, located between the samples.

    Around the samples that exceed their neighbours, the four of the highest parabolas, the run is integrated
    again from the sample before, by its own method, and the largest size is searched in the dense output. A
    maximum without a sign in the samples, faster than the effort itself, is not found. Commands of sampled
    controllers, at which an effort jumps, are seen besides (:class:`mode_changes.RunningPeaks`).

    Args:
        between: Whether the samples are consecutive, so that the run can be repeated between them.
    """

    def __init__(self, run: Run, *, between: bool) -> None:
        """Begin before the first sample."""
        self._run, self._between = run, between
        count = len(run.system.drives)
        self._largest, self._times = np.full(count, -np.inf), np.full(count, np.nan)
        self._places: list[list[_PeakCandidate]] = [[] for _ in range(count)]
        self._before: tuple[Chunk, Array] | None = None

    def add(self, block: SampleBlock) -> None:
        """Add the samples of a block."""
        chunk = Chunk(block.times, block.states, block.memories, list(block.programs))
        sizes = np.abs(block.found.effort["effort"])
        if self._before is not None:
            chunk, sizes = (
                Chunk.joined([self._before[0], chunk]),
                np.concatenate([self._before[1], sizes]),
            )
        self._before = chunk.part(-2, None), sizes[-2:].copy()
        for m, size in enumerate(sizes.T):
            top = int(np.argmax(size))
            if size[top] > self._largest[m]:
                self._largest[m], self._times[m] = size[top], chunk.times[top]
            if not self._between:
                continue
            most, when = _vertices(chunk.times, size)
            here = np.argsort(-most, kind="stable")[:_MOST].tolist()
            coarse = most - np.minimum(size[:-2], size[2:]) > _COARSE * most
            bound = np.where(coarse, np.inf, 2.0 * most - size[1:-1])
            places = self._places[m] + [
                _PeakCandidate(float(most[k]), float(bound[k]), float(when[k]), chunk.part(k, k + 3))
                for k in here
                if math.isfinite(most[k])
            ]
            self._places[m] = sorted(places, key=lambda one: -one.most)[:_MOST]

    def located(self) -> tuple[Array, Array]:
        """Return the largest effort [N m] ([N]) and its time [s], (drives,) each."""
        if any(self._places):
            again = _Reintegration(self._run)
            for m, places in enumerate(self._places):
                coarse = any(place.bound == math.inf for place in places)
                able = [place for place in places if coarse or place.bound > self._largest[m]]
                ends = [side for place in able for side in place.sides(coarse)]
                size, time = again.largest(m, ends)
                if size > self._largest[m]:
                    self._largest[m], self._times[m] = size, time
            self._places = [[] for _ in self._places]
        commanded = self._run.actions.modes.peaks.drives
        later = commanded["effort"] > self._largest
        return np.where(later, commanded["effort"], self._largest), np.where(
            later, commanded["time"], self._times
        )


class _Reintegration:
    """Repeated integration between two samples of a run."""

    def __init__(self, run: Run) -> None:
        """Allocate once."""
        self._system = run.system
        self._workspace, settings = Workspace(run.system), run.settings
        method, tree = method_named(settings.method), run.stepper.numbers.tree
        self._stepper = stepper_of(self._workspace, method, run.stepper.scales, settings, tree)
        self._made: dict[float, list[_RepeatedStep]] = {}

    def largest(self, m: int, between: Sequence[Chunk]) -> tuple[float, float]:
        """Return size and time of a drive's largest effort between pairs of samples.

        Minus infinity if there are changes between all of them.
        """
        tops = []
        for begin, ends in {float(ends.times[0]): ends for ends in between}.items():
            if begin not in self._made:
                self._made[begin] = self._steps(ends)
            tops += [(float(step.sizes[:, m].max()), step, ends) for step in self._made[begin]]
        best = -math.inf, 0.0
        for _, step, ends in sorted(tops, key=lambda one: -one[0])[:2]:
            best = max(best, self._in_step(m, step, ends))
            looks = step.sizes[:, m]
            rises = _vertices(_LOOKS, looks)[0] - looks[1:-1]
            if np.all(rises <= _COARSE * looks.max()) and 0 < int(np.argmax(looks)) < len(_LOOKS) - 1:
                break  # else another may be higher, or its top in the step beside
        return best

    def _steps(self, ends: Chunk) -> list[_RepeatedStep]:
        """Return the steps between two samples; none across a change."""
        (begin, end), (before, after), stepper = ends.times, ends.programs, self._stepper
        if not (
            begin < end
            and np.array_equal(before.view(np.int64), after.view(np.int64))
            and np.array_equal(*ends.memories["touching"])
        ):
            return []
        made: list[tuple[float, Array, float]] = []
        self._take_up(ends)
        times, states = [], []
        try:
            stepper.restart(begin, ends.states[0])
            h = end - begin
            for _ in range(_STEPS):
                h = min(h, end - stepper.t)
                error = stepper.attempt(h)
                if error < 1.0:
                    stepper.prepare_dense()
                    made.append((stepper.t, stepper.start[: ends.states.shape[1]].copy(), h))
                    own = self._states(_LOOKS)
                    times.append(own[0])
                    states.append(own[1])
                    stepper.accept()
                    if end - stepper.t <= 4.0 * math.ulp(end):
                        break
                h *= min(4.0, 0.9 * max(error, 1e-6) ** -0.25) if error < 1e4 else 0.1  # not a number, too
            else:
                return []  # steps that come to nothing
        except FunctionError:
            return []  # a user's function fails between the samples
        sizes = self._sizes(np.concatenate(times), np.concatenate(states), ends)
        return [
            _RepeatedStep(*one, own)
            for one, own in zip(made, sizes.reshape(len(made), len(_LOOKS), -1), strict=True)
        ]

    def _take_up(self, ends: Chunk) -> None:
        self._workspace.program[:], self._workspace.memory[:] = ends.programs[0], ends.memories[0]

    def _states(self, fractions: Array) -> tuple[Array, Array]:
        """Return times [s] and states within the trial step, projected onto the constraints."""
        stepper, program = self._stepper, self._workspace.program
        times = stepper.t + stepper.h * fractions
        states = np.zeros((len(fractions), self._system.manifold.size))
        for state, theta, t in zip(states, fractions.tolist(), times.tolist(), strict=True):
            stepper.interpolate(theta, state)
            if self._workspace.constraints is not None:
                self._workspace.hold(t, state, program)
        return times, states

    def _sizes(self, times: Array, states: Array, ends: Chunk) -> Array:
        """Return sizes of efforts, (n, drives); minus infinity where undefined."""
        count = len(times)
        memories, programs = ends.memories[:1].repeat(count, axis=0), [ends.programs[0]] * count
        efforts = observed(self._system, times, states, memories, programs).effort["effort"]
        sizes = np.abs(efforts)
        return np.where(np.isfinite(sizes), sizes, -np.inf)

    def _in_step(self, m: int, step: _RepeatedStep, ends: Chunk) -> tuple[float, float]:
        """Return size and time of the largest effort in a step."""
        self._take_up(ends)
        self._stepper.restart(step.time, step.state)
        self._stepper.attempt(step.size)
        self._stepper.prepare_dense()
        top = int(np.argmax(step.sizes[:, m]))
        fractions = np.linspace(_LOOKS[max(top - 1, 0)], _LOOKS[min(top + 1, len(_LOOKS) - 1)], 9)
        times, states = self._states(fractions)
        sizes = self._sizes(times, states, ends)[:, m]
        k = int(np.argmax(sizes))
        best = float(sizes[k]), float(times[k])
        _, tops = _vertices(fractions, sizes)
        if 0 < k < len(fractions) - 1 and math.isfinite(tops[k - 1]):
            times, states = self._states(tops[k - 1 : k])
            best = max(best, (float(self._sizes(times, states, ends)[0, m]), float(times[0])))
        return best


def _vertices(times: Array, sizes: Array) -> tuple[Array, Array]:
    """Return value and time of the vertices of parabolas through three samples, (n - 2,).

    Minus infinity if the vertex is not among them.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        back, on = times[:-2] - times[1:-1], times[2:] - times[1:-1]
        left, right = ((sizes[k : len(sizes) - 2 + k] - sizes[1:-1]) / d for k, d in ((0, back), (2, on)))
        bend = (right - left) / (on - back)
        slope = left - bend * back
        top = -0.5 * slope / bend
        value = sizes[1:-1] - 0.25 * slope**2 / bend
    inside = (bend < 0.0) & (back < top) & (top < on) & np.isfinite(value)
    return np.where(inside, value, -np.inf), np.where(inside, times[1:-1] + top, -np.inf)


# --- recorder -----------------------------------------------------------------------------------------------


def controller_labels(records: Sequence[ControllerRecord], lean: bool) -> dict[str, Any]:
    """Return the labels of controllers, in a full result with their sample times."""
    if not records:
        return {}
    labels: dict[str, Any] = {"sampled": [one.name for one in records]}
    if not lean:
        labels["tick"] = sum(len(one.times) for one in records)
        labels["signal"] = [f"{one.name}.{column}" for one in records for column in one.columns]
    return labels


def controller_values(records: Sequence[ControllerRecord]) -> dict[str, Any]:
    """Return the variables of controllers, sample times in order."""
    if not records:
        return {}
    times = np.concatenate([one.times for one in records])
    which = np.concatenate([np.full(len(one.times), k) for k, one in enumerate(records)])
    signals = np.full((len(times), sum(len(one.columns) for one in records)), np.nan)
    row = column = 0
    for one in records:
        signals[row : row + len(one.times), column : column + len(one.columns)] = one.values
        row, column = row + len(one.times), column + len(one.columns)
    order = np.lexsort((which, times))
    return {
        "tick_time": times[order],
        "tick_controller": which[order].astype(np.int64),
        "tick_signal": signals[order],
        "ticks": np.array([len(one.times) for one in records], dtype=np.int64),
        "saturated_ticks": np.array(
            [0 if one.saturated is None else (one.values[:, one.saturated] > 0.0).sum() for one in records],
            dtype=np.int64,
        ),
    }


def result_data(
    run: Run, title: str, case: str, versions: dict[str, str], *, lean: bool = False
) -> Unlabelled:
    """Return the data of a finished run's dataset (docs/trajectory.md lists the variables)."""
    recording = Recorder(run)
    whole: dict[str, Any] = {}
    for first, values in recording.blocks():
        if lean:
            continue
        if len(values["time"]) == recording.count:
            whole = dict(values)
        for name, part in values.items() if not whole or first else ():
            if name not in whole:
                whole[name] = np.empty((recording.count, *part.shape[1:]), part.dtype)
            whole[name][first : first + len(part)] = part
    about = {"title": title, "case": case, "versions": json.dumps(versions)}
    return recording.unlabelled(whole, about, lean=lean)


def at_present(run: Run) -> xr.Dataset:
    """Return the series of a run at its first sample and its present state, labelled."""
    held, outcome = run.samples.chunk, (run.outcome, run.message)
    t, memory = run.stepper.t, run.workspace.memory
    here = Chunk(np.array([t]), run.here[np.newaxis], memory[np.newaxis], [run.samples.program])
    samples = Samples(run.workspace, 1.0, (), run.begin, t)
    before = held.times[:1] < t
    samples.take_up(Chunk.joined([held.part(0, 1), here]) if before.any() else here)
    recording = Recorder(run, samples=samples)
    ((_, values),) = recording.blocks()
    run.outcome, run.message = outcome  # which a record of one state does not judge
    return recording.unlabelled(values, {}).labelled()


def open_ledger(run: Run) -> str:
    """Return the opening of a run's ledger by its samples, as text; "" if none."""
    outcome, message = run.outcome, run.message
    for _ in Recorder(run).blocks():
        pass
    found = run.message if run.outcome is Outcome.LEDGER_OPEN else ""
    run.outcome, run.message = outcome, message
    return found


def series_at(run: Run, chunk: Chunk) -> Values:
    """Return the series implied by states of a run's system, by name, (n, ...) each."""
    return _implied(run, chunk)[1]


def labelled_at(run: Run, chunk: Chunk) -> xr.Dataset:
    """Return the series implied by states, possibly of several runs, labelled.

    Integrals along a run count from the first state.
    """
    recording, values = _implied(run, chunk)
    return recording.unlabelled(values, {}).labelled()


def _implied(run: Run, chunk: Chunk) -> tuple[Recorder, Values]:
    outcome = run.outcome, run.message
    samples = Samples(run.workspace, 1.0, (), float(chunk.times[0]), float(chunk.times[-1]))
    samples.take_up(chunk)
    recording = Recorder(run, samples=samples)
    blocks = [values for _, values in recording.blocks()]
    run.outcome, run.message = outcome  # which a record of a few states does not judge
    return recording, {name: np.concatenate([one[name] for one in blocks]) for name in blocks[0]}


class Recorder:
    """Variables of a finished run, block by block, with totals and peaks.

    Args:
        parts: Samples of the run on the disk, before those in memory.
        samples: Samples to record instead of the run's.

    Attributes:
        count: Number of samples.
    """

    def __init__(self, run: Run, parts: SampleFiles | None = None, samples: Samples | None = None) -> None:
        """Count the samples."""
        self.run = run
        self._parts = parts
        self._samples = run.samples if samples is None else samples
        self.count = count_of(self._samples, parts)
        self._labels: dict[str, Any] = {}
        self._last: SampleBlock | None = None
        self._totals: dict[str, Any] = {}
        self._peaks: dict[str, Any] = {}
        self._audit = LedgerAudit(run)
        # Only the run's own states are consecutive samples.
        located = run.system.drives and not self._samples.few
        self._tops = EffortPeaks(run, between=samples is None) if located else None

    def blocks(self) -> Iterator[tuple[int, Values]]:
        """Yield number of the first sample and series of each block, ``time`` among them."""
        first = 0
        for chunk in blocks_of(self._samples, self._parts):
            system = self.run.system
            found = observed(system, chunk.times, chunk.states, chunk.memories, chunk.programs)
            block = SampleBlock(self.run, *chunk, found, None if self._last is None else self._last.end)
            values: dict[str, Any] = {"time": block.times}
            with np.errstate(invalid="ignore", over="ignore"):  # reported by the outcome
                for source in SERIES:
                    values |= source(block)
                self._judge(block, values)
                self._labels = self._labels or _labels(block)
                self._sum_up(block, values)
            self._last = block
            first += len(block.times)
            if first == self.count:
                self._close()
            yield first - len(block.times), values

    def _close(self) -> None:
        """Set the outcome of a run whose ledger does not close."""
        run = self.run
        if run.outcome in ENDED_WELL and (opening := self._audit.opening()) is not None:
            run.outcome = Outcome.LEDGER_OPEN
            run.message = f"at t = {opening.time:.9g} s {opening.text}: {run.outcome.value}"

    def _judge(self, block: SampleBlock, values: Values) -> None:
        """Set the outcome of a run whose record is not finite."""
        run, first = self.run, len(block.times)
        if run.outcome not in ENDED_WELL:
            return
        found: tuple[Outcome, str] | None = None
        for k, failure in sorted(block.found.failures.items())[:1]:
            found, first = (Outcome.FUNCTION_FAILED, failure.seen), k
        for name, part in values.items() if found is None else ():
            k = first_not_finite(part)
            if k < first:
                found, first = (Outcome.NOT_FINITE, f"{name} is not finite"), k
        if found is not None:
            run.outcome, what = found
            run.message = f"at t = {block.times[first]:.9g} s, {what}: {run.outcome.value}"

    def _sum_up(self, block: SampleBlock, values: Values) -> None:
        """Update totals and peaks by a block."""
        self._totals = {name: values[of][-1] for name, of in TOTALS.items()}
        for name, sizes in sizes_of(block, values).items():
            most = sizes.max(axis=0)
            self._peaks[name] = np.maximum(self._peaks.get(name, most), most)
        self._audit.add(block, values, self._labels)
        if self._tops is not None:
            self._tops.add(block)

    def unlabelled(self, series: Values, about: Mapping[str, Any], *, lean: bool = False) -> Unlabelled:
        """Return the data of the blocks so far with these series."""
        assert self._last is not None
        first, last, kept = self._last.start, self._last.end, self.run.settings.output_keep
        attributes = {
            "form": "lean" if lean else "full",
            **({} if kept is None else {"kept": json.dumps(kept)}),
            **about,
            "end_time": float(self._last.times[-1]),
            "samples": self.count,
            "gap_difference": float(self.run.search.difference[0]),
            "conservation": json.dumps(self._audit.conservation()),
        }
        records = self.run.controllers.records
        values = {
            **series,
            **self._totals,
            **self._peaks,
            **episodes_of(self.run),
            **controller_values(records),
        }
        if self._tops is not None:
            largest, times = self._tops.located()
            values["peak_drive_effort"], values["time_of_peak_drive_effort"] = largest, times
            motions = [isinstance(drive, Motion) for drive in self.run.system.drives.values()]
            values["peak_effort"], values["time_of_peak_effort"] = largest[motions], times[motions]
        labels = self._labels | controller_labels(records, lean) | ({} if lean else {"time": series["time"]})
        system, singular = self.run.system, self.run.singular
        held = first.state.copy(), last.state.copy(), self._peaks["peak_residual"]
        passed = () if singular is None else tuple(singular.found)
        return Unlabelled(
            values,
            labels,
            attributes,
            of_system=lambda: mechanism_attributes(system) | constraint_attributes(system, *held, passed),
            more={},
            free_base=system.mechanism.base == "free",
            lean=lean,
            left_out=OF_SAMPLES if self._samples.few else (),
        )


def _labels(block: SampleBlock) -> dict[str, Any]:
    """Return the labels of all dimensions and coordinates of the system."""
    system = block.system
    configuration, velocity = list(system.names_q), list(system.names_v)
    labels: dict[str, Any] = {
        "axis": ("x", "y", "z"),
        "configuration": configuration,
        "coordinate": velocity,
        "joint": block.joints[0],
    }
    if system.mechanism.base == "free" or system.clearances:
        labels["quaternion"] = ("x", "y", "z", "w")
    places = [(j.name, *place) for j in system.clearances for place in j.geometry.contact_places]
    for name, found in (
        ("sliding_joint", block.slides[0]),
        ("contact", system.contact_names),
        ("contact_joint", [joint for joint, _, _ in places]),
        ("contact_kind", [kind for _, kind, _ in places]),
        ("contact_end", [end for _, _, end in places]),
        ("clearance_joint", [joint.name for joint in system.clearances]),
        ("drive", list(system.drives)),
        ("controller", [name for name, drive in system.drives.items() if drive.tracks]),
        ("motion", [name for name, drive in system.drives.items() if isinstance(drive, Motion)]),
        ("motor", motors_of(block)),
        ("spring", [name for name in system.springs if name not in system.elastic]),
        ("element", [f"{table}.{name}" for table in system.others for name in system.families[table]]),
        ("bristle", bristles_of(block, "bend")),
        ("dwelling", bristles_of(block, "dwell")),
        ("traced_spring", list(system.traced)),
        ("traced_joint", [str(system.springs[name].acts_at) for name in system.traced]),
        ("bearing", bearing_names(system)),
        ("elastic_part", list(system.elastic)),
        ("point_spring", list(system.point_springs)),
        ("force", list(system.forces)),
        ("force_place", [one.name for one in system.force_places]),
        ("closure", list(system.closures)),
        ("coupling", list(system.couplings)),
    ):
        if found:
            labels[name] = found
    if system.contact_names:
        labels["episode"] = len(block.run.episodes)
    modes = block.run.actions.modes
    if modes:
        labels["change"] = [one.name for one in modes.changed if one.time > block.run.after]
    if block.run.events or modes or block.run.actions.happened:
        labels["event"] = [one.name for one in block.run.actions.happened]
    return labels
