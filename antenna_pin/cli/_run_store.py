"""The runs that figures need: those at hand in a folder, the others made there."""

from __future__ import annotations

import contextlib
import signal
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from antenna_pin.base.interruption import Ended, ended_by
from antenna_pin.cli._common import complain, not_interrupted, save_result, stem
from antenna_pin.cli._progress import progress_bar
from antenna_pin.errors import FileFormatError

if TYPE_CHECKING:
    from antenna_pin.scenario import Scenario
    from antenna_pin.trajectory import Trajectory

# What of a scenario tells where it came from, not what it is.
_ORIGIN = {"name", "description", "overrides", "folder"}


class RunStore:
    """The runs of some cases: those in a folder whose scenario is the same, the others made."""

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
            found = self._found(self.scenarios[case])
            self.runs[case] = self._made(self.scenarios[case]) if found is None else found
        return self.runs[case]

    def _found(self, scenario: Scenario) -> Trajectory | None:
        """Return a completed run of the scenario, of this version of the file format, from the folder."""
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

    def _made(self, scenario: Scenario) -> Trajectory:
        """Run a scenario and save the result; what Ctrl-C cuts short is saved, too, and ends the command."""
        from antenna_pin.errors import LedgerOpenWarning
        from antenna_pin.simulation import simulate
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

        number = 1
        while True:
            path = self.folder / f"{stem(scenario)}{f'-{number}' if number > 1 else ''}.nc"
            if not path.exists():
                return path
            try:
                old = Trajectory.load(path).scenario
            except FileFormatError:
                old = None
            if old is not None and same_scenario(old, scenario):  # cut short, or of an older format
                return path
            number += 1


def same_scenario(one: Scenario, other: Scenario) -> bool:
    """Whether two scenarios are the same but for where they came from."""
    return one.model_dump(exclude=_ORIGIN) == other.model_dump(exclude=_ORIGIN)
