"""From the samples of a run to a result: all that its states imply, by the schema of results."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from antenna_pin.dynamics import bearing_names, observed
from antenna_pin.elements import Motion
from antenna_pin.simulation.blocks import blocks_of, count_of
from antenna_pin.simulation.bristles import bristles_of
from antenna_pin.simulation.carried import mechanism_attributes
from antenna_pin.simulation.held import constraint_attributes
from antenna_pin.simulation.ledger import Audit
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.motors import motors_of
from antenna_pin.simulation.parts import Parts
from antenna_pin.simulation.samples import Chunk, Samples
from antenna_pin.simulation.seen import Seen
from antenna_pin.simulation.sources import SERIES, TOTALS, episodes_of, sizes_of
from antenna_pin.simulation.tick_record import labels_of_ticks, values_of_ticks
from antenna_pin.simulation.tops import Tops
from antenna_pin.trajectory import ENDED_WELL, Outcome
from antenna_pin.trajectory.columns import first_not_finite
from antenna_pin.trajectory.labelled import Unlabelled

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Recording", "at_present", "labelled_at", "open_ledger", "recorded", "series_at"]

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
