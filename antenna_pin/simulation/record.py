"""From the samples of a run to a result: all that its states imply, by the schema of results."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.constraints import Anchor
from antenna_pin.dynamics import System, bearing_names, constraint_counts, facts_of_couplings, observed
from antenna_pin.elements import Motion
from antenna_pin.mechanism import quaternion
from antenna_pin.simulation.bristles import bristles_of
from antenna_pin.simulation.carried import mechanism_attributes
from antenna_pin.simulation.ledger import Audit
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.motors import motors_of
from antenna_pin.simulation.parts import Parts
from antenna_pin.simulation.samples import Chunk, Late, Samples
from antenna_pin.simulation.seen import Seen
from antenna_pin.simulation.singular import Singular
from antenna_pin.simulation.sources import SERIES, TOTALS, episodes_of, sizes_of
from antenna_pin.simulation.ticks import Ticked
from antenna_pin.simulation.tops import Tops
from antenna_pin.trajectory import ENDED_WELL, Outcome
from antenna_pin.trajectory.columns import first_not_finite
from antenna_pin.trajectory.labelled import Unlabelled

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Recording", "at_present", "labelled_at", "open_ledger", "recorded", "series_at"]


# --- what a result has of the controllers of a run: their instants, what they noted and commanded ---


def labels_of_ticks(ticked: Sequence[Ticked], lean: bool) -> dict[str, Any]:
    """Return the labels of controllers; of a result with series those of their instants too."""
    if not ticked:
        return {}
    labels: dict[str, Any] = {"sampled": [one.name for one in ticked]}
    if not lean:
        labels["tick"] = sum(len(one.times) for one in ticked)
        labels["signal"] = [f"{one.name}.{column}" for one in ticked for column in one.columns]
    return labels


def values_of_ticks(ticked: Sequence[Ticked]) -> dict[str, Any]:
    """Return the variables of controllers, their instants in the order of time."""
    if not ticked:
        return {}
    times = np.concatenate([one.times for one in ticked])
    which = np.concatenate([np.full(len(one.times), k) for k, one in enumerate(ticked)])
    signals = np.full((len(times), sum(len(one.columns) for one in ticked)), np.nan)
    row = column = 0
    for one in ticked:
        signals[row : row + len(one.times), column : column + len(one.columns)] = one.values
        row, column = row + len(one.times), column + len(one.columns)
    order = np.lexsort((which, times))
    return {
        "tick_time": times[order],
        "tick_controller": which[order].astype(np.int64),
        "tick_signal": signals[order],
        "ticks": np.array([len(one.times) for one in ticked], dtype=np.int64),
        "saturated_ticks": np.array(
            [0 if one.saturated is None else (one.values[:, one.saturated] > 0.0).sum() for one in ticked],
            dtype=np.int64,
        ),
    }


Array = NDArray[np.float64]

# --- what a result says of closures, couplings and motions: what they are, and how well they were held ---

# Of positions, angles and their rates, in the order of ``Observed.residual``.
_RESIDUALS = ("position_residual", "angle_residual", "velocity_residual", "rate_residual")


def constraint_attributes(
    system: System, first: Array, last: Array, residual: Array, passed: Sequence[Singular]
) -> dict[str, str]:
    """Return the attributes of a dataset that describe its constraints; none of a tree that nothing holds.

    ``closures`` (JSON) has of each closure its ``kind``, how many ``equations`` it is, whether it has an
    ``axis`` (z of the placements) and, of its two sides, ``first_body``,
    ``first_placement``, ``second_body`` and ``second_placement``: the link and the frame there, position [m]
    and attitude (quaternion xyzw). If there are couplings, ``couplings`` (JSON) has of each its ``follower``
    and ``leader`` (joints), ``multiplier`` and ``offset``, whether its follower ``slides``, and its leader
    (``leader_slides``). ``constraints`` (JSON) has how many equations there are, of closures and couplings
    and of motions, how many are independent at the start, the freedoms of the tree, those that closures and
    couplings leave and those that are left, where redundant equations are
    (:func:`antenna_pin.dynamics.constraint_counts`),
    the largest residuals at samples [m, rad, m/s, rad/s], the energy that corrections of the state after each
    step put in, in all [J], and the singular positions passed: ``time`` [s] and ``share``, what is left of
    the least independent equation there.

    Args:
        system: What was run.
        first: [q, v, x] at the first sample.
        last: At the last.
        residual: The largest at samples, (4,), as of ``Observed.residual``.
        passed: The singular positions.
    """
    if system.plan is None:
        return {}
    booked = system.model.nq + system.model.nv + system.projection_x[0]
    put_in = last[booked] - first[booked]
    couplings = facts_of_couplings(system.mechanism, system.couplings)
    return {
        "closures": json.dumps(
            {
                name: {
                    "kind": one.kind,
                    "equations": one.holds.rows,
                    "axis": one.holds.axis,
                    **_side("first", one.first),
                    **_side("second", one.second),
                }
                for name, one in system.closures.items()
            }
        ),
        **({"couplings": json.dumps(couplings)} if couplings else {}),
        "constraints": json.dumps(
            {
                **constraint_counts(system, first),
                **dict(zip(_RESIDUALS, residual.tolist(), strict=True)),
                "projection_energy": float(put_in),
                "singular": [one._asdict() for one in passed],
            }
        ),
    }


def _side(name: str, anchor: Anchor) -> dict[str, Any]:
    return {
        f"{name}_body": anchor.link,
        f"{name}_placement": [*map(float, anchor.origin), *quaternion(anchor.rotation).tolist()],
    }


# --- the samples of a run in the order of time, block by block: from parts on the disk, and from memory ---

#: Samples of a block: few enough that all which they imply takes little room. Blocks are the same ones
#: however a record is spread over disk and memory, or round-off might tell.
BLOCK = 8192


def _chunks(samples: Samples, parts: Parts | None) -> Iterator[Chunk]:
    if parts is not None:
        yield from map(parts.read, range(len(parts.rows)))
    yield samples.held


def _with_late(chunk: Chunk, late: Sequence[Late], samples: Samples) -> Chunk:
    """Return a chunk with late samples at their places; where there is one of their time that one stays."""
    there = set(chunk.times[np.searchsorted(chunk.times, [one.time for one in late])].tolist())
    new = [one for one in late if one.time not in there]
    if not new:
        return chunk
    places = np.searchsorted(chunk.times, [one.time for one in new])
    programs = list(chunk.programs)
    # What held at the sample before holds on to the next event.
    states = [one.state.copy() for one in new]
    for place, one, state in zip(places.tolist(), new, states, strict=True):
        samples.hold(one.time, state, programs[max(place - 1, 0)])
    for place, _ in sorted(zip(places.tolist(), new, strict=True), key=lambda one: -one[0]):
        programs.insert(place, programs[max(place - 1, 0)])
    return Chunk(
        np.insert(chunk.times, places, [one.time for one in new]),
        np.insert(chunk.states, places, states, axis=0),
        np.insert(chunk.memories, places, np.array([one.memory for one in new]), axis=0),
        programs,
    )


def _merged(samples: Samples, parts: Parts | None) -> Iterator[Chunk]:
    first = {one.time: one for one in reversed(samples.late)}  # of those of one time the first
    late = [first[time] for time in sorted(first)]
    before: Chunk | None = None
    for chunk in _chunks(samples, parts):
        if not len(chunk.times):
            continue
        if late and late[0].time <= chunk.times[-1]:
            count = sum(one.time <= chunk.times[-1] for one in late)
            mine, late = late[:count], late[count:]
            if before is not None:  # whose last program goes on before this chunk's first sample
                chunk = Chunk.joined([before.part(-1, None), chunk])
            chunk = _with_late(chunk, mine, samples)
            if before is not None:
                chunk = chunk.part(1, None)
        before = chunk
        yield chunk


def blocks_of(samples: Samples, parts: Parts | None = None) -> Iterator[Chunk]:
    """Yield the samples of a run, in blocks of :data:`BLOCK` and one of the rest.

    Args:
        samples: Those in memory.
        parts: Those before them.

    Raises:
        FileFormatError: A part is not as it was written.
    """
    waiting: list[Chunk] = []
    for chunk in _merged(samples, parts):
        waiting.append(chunk)
        count = sum(len(one.times) for one in waiting)
        if count < BLOCK:
            continue
        whole = Chunk.joined(waiting)
        for first in range(0, count - BLOCK + 1, BLOCK):
            yield whole.part(first, first + BLOCK)
        waiting = [whole.part(count - count % BLOCK, None)]
    rest = Chunk.joined(waiting)
    if len(rest.times):
        yield rest


def count_of(samples: Samples, parts: Parts | None = None) -> int:
    """Return how many samples a run has."""
    if not samples.late:
        return len(samples.times) + (0 if parts is None else sum(parts.rows))
    return sum(len(chunk.times) for chunk in _merged(samples, parts))


Values = Mapping[str, Any]


def recorded(run: Run, title: str, case: str, versions: dict[str, str], *, lean: bool = False) -> Unlabelled:
    """Return what the dataset of a finished run is made of (docs/trajectory.md lists the variables).

    Args:
        run: The run, all of its samples in memory.
        title: Of the scenario.
        case: Of the scenario.
        versions: Of the libraries.
        lean: Whether to leave out the series: a result of numbers and contact episodes only.
    """
    recording = Recording(run)
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
    """Return the series of a run at its first sample and at its present state, as a result has them."""
    held, outcome = run.samples.held, (run.outcome, run.message)
    t, memory = run.stepper.t, run.workspace.memory
    here = Chunk(np.array([t]), run.here[np.newaxis], memory[np.newaxis], [run.samples.program])
    samples = Samples(run.workspace, 1.0, (), run.begin, t)
    before = held.times[:1] < t
    samples.take_up(Chunk.joined([held.part(0, 1), here]) if before.any() else here)
    recording = Recording(run, samples=samples)
    ((_, values),) = recording.blocks()
    run.outcome, run.message = outcome  # what is recorded of an instant is no judgement of the run
    return recording.unlabelled(values, {}).labelled()


def open_ledger(run: Run) -> str:
    """Return how a run's ledger does not close, in words, by the samples that it has; "" if it does."""
    outcome, message = run.outcome, run.message
    for _ in Recording(run).blocks():
        pass
    found = run.message if run.outcome is Outcome.LEDGER_OPEN else ""
    run.outcome, run.message = outcome, message
    return found


def series_at(run: Run, chunk: Chunk) -> Values:
    """Return the series that some states of a run's system imply, by name, (n, ...) each.

    Args:
        run: Any run of the system.
        chunk: The states, and what held there besides.
    """
    return _implied(run, chunk)[1]


def labelled_at(run: Run, chunk: Chunk) -> xr.Dataset:
    """Return the same as a result has it; the states may be those of several runs, one after the other.

    What is integrated along a run counts from the first of them on.

    Args:
        run: Any run of the system.
        chunk: The states, and what held there besides.
    """
    recording, values = _implied(run, chunk)
    return recording.unlabelled(values, {}).labelled()


def _implied(run: Run, chunk: Chunk) -> tuple[Recording, Values]:
    outcome = run.outcome, run.message
    samples = Samples(run.workspace, 1.0, (), float(chunk.times[0]), float(chunk.times[-1]))
    samples.take_up(chunk)
    recording = Recording(run, samples=samples)
    blocks = [values for _, values in recording.blocks()]
    run.outcome, run.message = outcome  # what is recorded of a few states is no judgement of the run
    return recording, {name: np.concatenate([one[name] for one in blocks]) for name in blocks[0]}


class Recording:
    """What the samples of a finished run imply, found block by block; totals and peaks as they come.

    Args:
        run: The run.
        parts: Its samples before those that it has in memory.
        samples: Others than its own, that are to be recorded.

    Attributes:
        count: Samples in all.
    """

    def __init__(self, run: Run, parts: Parts | None = None, samples: Samples | None = None) -> None:
        """Count the samples."""
        self.run = run
        self._parts = parts
        self._samples = run.samples if samples is None else samples
        self.count = count_of(self._samples, parts)
        self._labels: dict[str, Any] = {}
        self._last: Seen | None = None
        self._totals: dict[str, Any] = {}
        self._peaks: dict[str, Any] = {}
        self._audit = Audit(run)
        motions = np.array([isinstance(drive, Motion) for drive in run.system.drives.values()], dtype=bool)
        # States that are not the run's own are no samples that follow one another.
        self._tops = Tops(run, motions, between=samples is None) if motions.any() else None

    def blocks(self) -> Iterator[tuple[int, Values]]:
        """Yield the number of a block's first sample, and the series there by name, ``time`` among them."""
        first = 0
        for chunk in blocks_of(self._samples, self._parts):
            system = self.run.system
            found = observed(system, chunk.times, chunk.states, chunk.memories, chunk.programs)
            seen = Seen(self.run, *chunk, found, None if self._last is None else self._last.end)
            values: dict[str, Any] = {"time": seen.times}
            with np.errstate(invalid="ignore", over="ignore"):  # what is not finite is told by the outcome
                for source in SERIES:
                    values |= source(seen)
                self._judge(seen, values)
                self._labels = self._labels or _labels(seen)
                self._sum_up(seen, values)
            self._last = seen
            first += len(seen.times)
            if first == self.count:
                self._close()
            yield first - len(seen.times), values

    def _close(self) -> None:
        """Let a run that came to its end not count as one where its ledger does not close."""
        run = self.run
        if run.outcome in ENDED_WELL and (opening := self._audit.opening()) is not None:
            run.outcome = Outcome.LEDGER_OPEN
            run.message = f"at t = {opening.time:.9g} s {opening.text}: {run.outcome.value}"

    def _judge(self, seen: Seen, values: Values) -> None:
        """Let a run that came to its end not count as one where what is recorded of it is not finite."""
        run, first = self.run, len(seen.times)
        if run.outcome not in ENDED_WELL:
            return
        found: tuple[Outcome, str] | None = None
        for k, failure in sorted(seen.found.failures.items())[:1]:
            found, first = (Outcome.FUNCTION_FAILED, failure.seen), k
        for name, part in values.items() if found is None else ():
            k = first_not_finite(part)
            if k < first:
                found, first = (Outcome.NOT_FINITE, f"{name} is not finite"), k
        if found is not None:
            run.outcome, what = found
            run.message = f"at t = {seen.times[first]:.9g} s, {what}: {run.outcome.value}"

    def _sum_up(self, seen: Seen, values: Values) -> None:
        """Take what is said of the whole run from a block."""
        self._totals = {name: values[of][-1] for name, of in TOTALS.items()}
        for name, sizes in sizes_of(seen, values).items():
            most = sizes.max(axis=0)
            self._peaks[name] = np.maximum(self._peaks.get(name, most), most)
        self._audit.add(seen, values, self._labels)
        if self._tops is not None:
            self._tops.add(seen)

    def unlabelled(self, series: Values, about: Mapping[str, Any], *, lean: bool = False) -> Unlabelled:
        """Return the data of the blocks so far with these series; of the run, once all have been made.

        Args:
            series: By name, ``time`` among them; none for a lean result.
            about: Attributes that tell what was run.
            lean: Whether to leave out the series.
        """
        assert self._last is not None
        first, last = self._last.start, self._last.end
        attributes = {
            "form": "lean" if lean else "full",
            **about,
            "end_time": float(self._last.times[-1]),
            "samples": self.count,
            "gap_difference": self.run.search.gap_difference,
            "conservation": json.dumps(self._audit.conservation()),
        }
        ticked = self.run.ticks.ticked
        values = {**series, **self._totals, **self._peaks, **episodes_of(self.run), **values_of_ticks(ticked)}
        if self._tops is not None:
            values["peak_effort"], values["time_of_peak_effort"] = self._tops.located()
        labels = self._labels | labels_of_ticks(ticked, lean) | ({} if lean else {"time": series["time"]})
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
        )


def _labels(seen: Seen) -> dict[str, Any]:
    """Return the labels of all dimensions and coordinates that the system has."""
    system = seen.system
    configuration, velocity = list(system.names_q), list(system.names_v)
    labels: dict[str, Any] = {
        "axis": ("x", "y", "z"),
        "configuration": configuration,
        "coordinate": velocity,
        "joint": seen.joints[0],
    }
    if system.mechanism.base == "free" or system.clearances:
        labels["quaternion"] = ("x", "y", "z", "w")
    places = [(j.name, *place) for j in system.clearances for place in j.geometry.contact_places]
    for name, found in (
        ("sliding_joint", seen.slides[0]),
        ("contact", system.contact_names),
        ("contact_joint", [joint for joint, _, _ in places]),
        ("contact_kind", [kind for _, kind, _ in places]),
        ("contact_end", [end for _, _, end in places]),
        ("clearance_joint", [joint.name for joint in system.clearances]),
        ("drive", list(system.drives)),
        ("controller", [name for name, drive in system.drives.items() if drive.tracks]),
        ("motion", [name for name, drive in system.drives.items() if isinstance(drive, Motion)]),
        ("motor", motors_of(seen)),
        ("spring", [name for name in system.springs if name not in system.elastic]),
        ("element", [f"{table}.{name}" for table in system.others for name in system.families[table]]),
        ("bristle", bristles_of(seen, "bend")),
        ("dwelling", bristles_of(seen, "dwell")),
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
        labels["episode"] = len(seen.run.episodes)
    modes = seen.run.actions.modes
    if modes:
        labels["change"] = [one.name for one in modes.changed if one.time > seen.run.after]
    if seen.run.events or modes or seen.run.actions.happened:
        labels["event"] = [one.name for one in seen.run.actions.happened]
    return labels
