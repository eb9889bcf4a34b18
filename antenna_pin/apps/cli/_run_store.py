"""Runs for figures, reused from a folder or made there."""

from __future__ import annotations

import contextlib
import itertools
import signal
import threading
import warnings
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from antenna_pin.apps.cli._common import complain, not_interrupted, save_result, stem
from antenna_pin.apps.cli._progress import diagram_bar, progress_bar, study_bar
from antenna_pin.base.capacity import cores
from antenna_pin.base.interruption import Ended, ended_by
from antenna_pin.errors import FileFormatError

if TYPE_CHECKING:
    import xarray as xr

    from antenna_pin.scenario import Scenario
    from antenna_pin.show.plot import Attractor, AttractorFigure, Diagram, DiagramFigure
    from antenna_pin.trajectory import Trajectory


# What of a scenario tells where it came from, not what it is.
_ORIGIN = {"name", "description", "overrides", "folder"}


class CaseRuns:
    """Runs of some cases, reused from a folder where the scenario is the same."""

    def __init__(self, folder: Path, name: str, scenarios: Sequence[Scenario], progress: bool) -> None:
        self.folder = folder
        self.scenarios = {scenario.case: scenario for scenario in scenarios}
        self.name = name
        self.progress = progress
        self.early = False
        self.files: dict[str | None, Path] = {}
        self.runs: dict[str | None, Trajectory] = {}

    @property
    def cases(self) -> list[str | None]:
        return list(self.scenarios)

    def run_of(self, case: str | None) -> Trajectory:
        """Return the run of a case: at hand, from a file, or made now."""
        if case not in self.runs:
            found = self._load(self.scenarios[case])
            self.runs[case] = self._run(self.scenarios[case]) if found is None else found
        return self.runs[case]

    def _load(self, scenario: Scenario) -> Trajectory | None:
        """Return a completed run of the scenario from the folder."""
        from antenna_pin.trajectory import FORMAT, Trajectory

        likely = self.folder / f"{stem(scenario)}.nc"
        others = sorted(path for path in self.folder.glob("*.nc") if path != likely)
        for path in [likely, *others]:
            try:
                run = Trajectory.load(path)
            except FileFormatError:  # not there, or something else
                continue
            current = run.data.attrs["format"] == FORMAT
            if current and run.completed and run.scenario and same_scenario(run.scenario, scenario):
                complain(f"{stem(scenario)}: using {path}")
                self.files[scenario.case] = path
                return run
        return None

    def _run(self, scenario: Scenario) -> Trajectory:
        """Run a scenario and save the result, also after an interrupt, which ends the command."""
        from antenna_pin.errors import LedgerOpenWarning
        from antenna_pin.run.simulation import simulate
        from antenna_pin.trajectory import Trajectory

        path = self._free(scenario)
        complain(f"{stem(scenario)}: running {scenario.duration:g} s")
        with contextlib.ExitStack() as stack:
            warnings.simplefilter("ignore", LedgerOpenWarning)  # said below
            with progress_bar(stem(scenario), self.progress) as report:
                run = simulate(scenario, progress=report)
                stack.enter_context(not_interrupted())
            save_result(run, path)
        self.files[scenario.case] = path
        if run.outcome.name == "INTERRUPTED":
            self.runs[scenario.case] = run  # for the index
            raise Ended if ended_by() != signal.SIGINT else KeyboardInterrupt
        if not run.completed:
            self.early = True
            complain(f"{stem(scenario)}: {run.message} (the result is in {path} and is drawn)")
        return Trajectory.load(path)  # as it is next time: what the file adds decides which figures there are

    def _free(self, scenario: Scenario) -> Path:
        """Return where a result may be written: not over a file of another scenario."""
        from antenna_pin.trajectory import Trajectory

        for number in itertools.count(1):
            path = self.folder / f"{stem(scenario)}{f'-{number}' if number > 1 else ''}.nc"
            if not path.exists():
                return path
            with contextlib.suppress(FileFormatError):
                old = Trajectory.load(path).scenario
                if old is not None and same_scenario(old, scenario):  # cut short, or of an older format
                    return path
        raise AssertionError("numbers do not end")


def same_scenario(one: Scenario, other: Scenario) -> bool:
    """Return whether two scenarios are the same but for their origin."""
    return one.model_dump(exclude=_ORIGIN) == other.model_dump(exclude=_ORIGIN)


# Of a settled motion a stretch this long is drawn, sampled so often. [periods], [1/period]
_PERIODS, _SAMPLES = 10, 4000
# Accuracy of the runs whose points are judged to a millionth of the motion's range.
_FINE = "integrator.accuracy=1e-5"


@dataclass(slots=True)
class AttractorStore:
    """Settled motions and diagrams of a paper's figures, stored in a folder."""

    folder: Path
    settings: Sequence[str]  # over the shipped diagrams' scenarios
    points: int  # of a settled motion [-]
    values: int  # of a diagram [-]
    progress: bool  # whether bars are shown

    def check(self, figures: Sequence[AttractorFigure | DiagramFigure]) -> None:
        """Refuse what cannot be made, before anything is: every scenario is read."""
        from antenna_pin.show.plot import AttractorFigure
        from antenna_pin.studies.nonlinear import load_plan

        for each in figures:
            if isinstance(each, AttractorFigure):
                for value in each.values:
                    self._at(each.over, value)
            else:
                load_plan(each.diagram.name).base(self.settings)

    def attractors(self, figure: AttractorFigure, figures: Sequence[AttractorFigure]) -> dict[str, Attractor]:
        """Return the settled motions that a figure takes, with what other figures take of them."""
        from antenna_pin.studies.sweep import StudyProgress

        alike = (each for each in figures if each.over is figure.over)
        noted = tuple(dict.fromkeys(name for each in alike for name in (each.x, each.y)))
        # Runs that do not depend on each other, in threads, as the compiled engine lets them.
        ending, done = threading.Event(), itertools.count(1)
        with (
            study_bar(figure.over.label, self.progress) as report,
            ThreadPoolExecutor(cores()) as pool,
        ):
            futures = {
                pool.submit(self._attractor, figure.over, value, label, noted, ending): value
                for value, label in figure.values.items()
            }
            found = {}
            try:
                for future in as_completed(futures):
                    found[futures[future]] = future.result()
                    if report is not None:
                        report(StudyProgress("run", next(done), len(futures), 0))
            except BaseException:
                ending.set()
                raise
        return found

    def diagram(self, wanted: Diagram) -> xr.Dataset:
        """Return a bifurcation diagram."""
        import numpy as np

        from antenna_pin.base.units import any_quantity
        from antenna_pin.studies.nonlinear import bifurcation, load_plan, open_diagram, values_of

        plan = load_plan(wanted.name)
        scenario = plan.base(self.settings)
        every = plan.argument_values()
        values = values_of(f"{every[0]}:{every[-1]}:{self.values}")
        numbers = [found[0] for found in map(any_quantity, values) if found is not None]
        path = self.folder / f"{_stem(wanted)}.nc"
        with contextlib.suppress(FileFormatError):
            found = open_diagram(path)
            if self._belongs(found, scenario) and np.array_equal(found["value"].values, numbers):
                complain(f"{wanted.name}: using {path}")
                return found
        complain(f"{wanted.name}: running {self.values} values")
        with diagram_bar(wanted.name, self.progress) as tell:
            return bifurcation(scenario, values=values, **plan.how(), out=path, progress=tell)

    def _at(self, over: Diagram, value: str) -> Scenario:
        """Return the scenario of a settled motion."""
        from antenna_pin.studies.nonlinear import load_plan

        plan = load_plan(over.name)
        return plan.base([_FINE, *self.settings, f"{plan.parameter}={value}"])

    def _attractor(
        self, over: Diagram, value: str, label: str, quantities: tuple[str, ...], ending: threading.Event
    ) -> Attractor:
        from antenna_pin.show.plot import Attractor
        from antenna_pin.show.plot.phase import SAME
        from antenna_pin.studies.nonlinear import load_plan, open_section, poincare, save_table
        from antenna_pin.studies.nonlinear.diagrams import interrupting

        scenario, plan = self._at(over, value), load_plan(over.name)
        stem = f"{_stem(over)}-{value.replace(' ', '')}"
        path = self.folder / f"{stem}-section.nc"
        section = None
        with contextlib.suppress(FileFormatError):
            found = open_section(path)
            enough = found.sizes["point"] >= self.points and set(quantities) <= set(map(str, found))
            section = found if enough and self._belongs(found, scenario) else None
        if section is None:
            complain(f"{label}: running {self.points} periods or more")
            section = poincare(
                scenario,
                plan.where(),
                quantities,
                count=self.points,
                transient=plan.transient,
                tolerance=SAME,
                progress=interrupting(ending),
            )
            save_table(section, path)
        else:
            complain(f"{label}: using {path}")
        return Attractor(label, section, self._stretch(scenario, section, self.folder / f"{stem}-stretch.nc"))

    def _stretch(self, scenario: Scenario, section: xr.Dataset, path: Path) -> Trajectory:
        """Return how the motion goes on behind the points."""
        import dataclasses

        from antenna_pin.base.interruption import uninterrupted
        from antenna_pin.base.state import State
        from antenna_pin.run.simulation import simulate
        from antenna_pin.run.simulation.inputs import settings_of
        from antenna_pin.trajectory import Trajectory

        state = State.from_json(str(section.attrs["state"]))
        period = float(section.attrs["period"])
        with contextlib.suppress(FileFormatError):
            found = Trajectory.load(path)
            # It begins where the section has ended.
            if found.completed and float(found.data["time"].values[0]) == state.reached:
                return found
        settings = dataclasses.replace(settings_of(scenario), output_rate=_SAMPLES / period)
        run = simulate(scenario, start=state, duration=_PERIODS * period, settings=settings)
        uninterrupted(run).save(path)
        return Trajectory.load(path)

    @staticmethod
    def _belongs(table: xr.Dataset, scenario: Scenario) -> bool:
        """Return whether a table belongs to a scenario."""
        from antenna_pin.scenario import Scenario

        return same_scenario(Scenario.model_validate_json(str(table.attrs["scenario"])), scenario)


def _stem(over: Diagram) -> str:
    """Return what files of a diagram are called."""
    return over.name.replace("/", "-")
