"""The settled motions and diagrams that figures need: those at hand in a folder, the others made there."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from antenna_pin.cli._common import complain, not_interrupted, save_result, stem
from antenna_pin.cli._progress import progress_bar, study_bar
from antenna_pin.cli._run_store import same_scenario
from antenna_pin.errors import FileFormatError

if TYPE_CHECKING:
    import xarray as xr

    from antenna_pin.nonlinear import Made
    from antenna_pin.plot import Attractor, AttractorFigure, Diagram, DiagramFigure
    from antenna_pin.scenario import Scenario
    from antenna_pin.trajectory import Trajectory

# Of a settled motion a stretch this long is drawn, sampled so often. [periods], [1/period]
_PERIODS, _SAMPLES = 10, 4000
# Points of each value of a diagram, and those cut before them.
_COUNT, _CUT = 40, 10
# Accuracies of the runs: of points that are judged to a millionth of the motion's range, and to 1e-4.
_FINE, _COARSE = 1e-5, 1e-4


def quick(scenario: str, accuracy: float) -> list[str]:
    """Return the settings of long runs of a scenario: compiled, with gaps in closed form."""
    from antenna_pin.scenario import load_scenario

    joints = load_scenario(scenario).clearance
    settings = ["integrator.engine=compiled", f"integrator.accuracy={accuracy:g}"]
    return [*settings, *(f"clearance.{joint}.geometry=closed-form" for joint in joints)]


@dataclass(slots=True)
class AttractorStore:
    """Settled motions and diagrams of a scenario, kept in a folder.

    Attributes:
        folder: Where they are kept.
        name: Of the scenario.
        load: Returns a case of it with settings before those of the command line.
        points: Of a settled motion [-].
        values: Of a diagram [-].
        progress: Whether bars are shown.
    """

    folder: Path
    name: str
    load: Callable[[str | None, Sequence[str]], Scenario]
    points: int
    values: int
    progress: bool

    def check(self, figures: Sequence[AttractorFigure | DiagramFigure]) -> None:
        """Refuse what cannot be made, before anything is: every scenario is read."""
        from antenna_pin.plot import AttractorFigure

        for each in figures:
            for case in each.cases if isinstance(each, AttractorFigure) else (None,):
                self._scenario(case, _FINE)

    def attractors(self, figure: AttractorFigure, figures: Sequence[AttractorFigure]) -> dict[str, Attractor]:
        """Return the settled motions that a figure takes, with what other figures take of them."""
        noted = [name for each in figures if set(each.cases) & set(figure.cases) for name in (each.x, each.y)]
        return {
            case: self._attractor(case, label, tuple(dict.fromkeys(noted)))
            for case, label in figure.cases.items()
        }

    def diagram(self, wanted: Diagram) -> xr.Dataset:
        """Return a bifurcation diagram from fresh starts, at the period of the drives."""
        import numpy as np

        from antenna_pin.nonlinear import Stroboscope, bifurcation, open_diagram
        from antenna_pin.sweep import Standing
        from antenna_pin.units import any_quantity

        scenario = self._scenario(None, _COARSE)
        first, last = (found[0] for found in map(any_quantity, (wanted.first, wanted.last)) if found)
        values = np.linspace(first, last, self.values)
        path = self.folder / f"{self.name}-{wanted.name}.nc"
        with contextlib.suppress(FileFormatError):
            found = open_diagram(path)
            if self._alike(found, scenario) and np.array_equal(found["value"].values, values):
                complain(f"{wanted.name}: using {path}")
                return found
        complain(f"{wanted.name}: running {self.values} values")
        with study_bar(wanted.name, self.progress) as report:

            def tell(now: Made) -> None:
                if report is not None:
                    report(Standing("run", now.done, now.count, 0))

            return bifurcation(
                scenario,
                wanted.parameter,
                [float(value) for value in values],
                Stroboscope(),
                wanted.quantities,
                count=_COUNT,
                transient=_CUT,
                out=path,
                progress=tell,
            )

    def _scenario(self, case: str | None, accuracy: float) -> Scenario:
        return self.load(case, quick(self.name, accuracy))

    def _attractor(self, case: str, label: str, quantities: tuple[str, ...]) -> Attractor:
        from antenna_pin.nonlinear import Stroboscope, open_section, poincare, save_table
        from antenna_pin.plot import Attractor
        from antenna_pin.plot.attractors import SAME

        scenario = self._scenario(case, _FINE)
        path = self.folder / f"{stem(scenario)}-section.nc"
        section = None
        with contextlib.suppress(FileFormatError):
            found = open_section(path)
            enough = found.sizes["point"] >= self.points and set(quantities) <= set(map(str, found))
            section = found if enough and self._alike(found, scenario) else None
        if section is None:
            complain(f"{label}: running {self.points} periods or more")
            with progress_bar(label, self.progress) as report:
                section = poincare(
                    scenario, Stroboscope(), quantities, count=self.points, tolerance=SAME, progress=report
                )
            with not_interrupted():
                save_table(section, path)
        else:
            complain(f"{label}: using {path}")
        return Attractor(label, section, self._stretch(scenario, section))

    def _stretch(self, scenario: Scenario, section: xr.Dataset) -> Trajectory:
        """Return how the motion goes on behind the points."""
        import dataclasses

        from antenna_pin.simulation import simulate
        from antenna_pin.simulation.run import settings_of
        from antenna_pin.state import State
        from antenna_pin.trajectory import Trajectory

        path = self.folder / f"{stem(scenario)}-stretch.nc"
        state = State.from_json(str(section.attrs["state"]))
        period = float(section.attrs["period"])
        with contextlib.suppress(FileFormatError):
            found = Trajectory.load(path)
            # It begins where the section has ended.
            if found.completed and float(found.data["time"].values[0]) == state.reached:
                return found
        settings = dataclasses.replace(settings_of(scenario), output_rate=_SAMPLES / period)
        run = simulate(scenario, start=state, duration=_PERIODS * period, settings=settings)
        with not_interrupted():
            save_result(run, path)
        return Trajectory.load(path)

    def _alike(self, table: xr.Dataset, scenario: Scenario) -> bool:
        """Whether a table is of a scenario."""
        from antenna_pin.scenario import Scenario

        return same_scenario(Scenario.model_validate_json(str(table.attrs["scenario"])), scenario)
