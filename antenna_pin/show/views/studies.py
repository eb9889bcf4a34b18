"""Figures and report of a completed study, of modes and of orbits."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import xarray as xr
from numpy.typing import ArrayLike

from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError, OutputError, UnknownNameError
from antenna_pin.show.plot import figure_multipliers, figure_response, study_figures, study_sensitivities
from antenna_pin.show.record import record_several
from antenna_pin.show.report import Report, report, study_report
from antenna_pin.show.views.runs import Width, saved_report
from antenna_pin.studies.linear import Modes, first_source, frequency_response, swing
from antenna_pin.studies.nonlinear import Orbit, orbit_table
from antenna_pin.studies.sweep import Study, open_study, sensitivities
from antenna_pin.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@takes()
def modes_plotted(
    modes: Modes,
    source: str | None = None,
    targets: str | Sequence[str] | None = None,
    *,
    frequencies: ArrayLike | None = None,
    width: Width = "page",
) -> Figure:
    """Return magnitude and phase of a frequency response.

    Args:
        modes: About which state.
        source: What swings, such as ``drives.NAME`` or ``base.fx``; the first of
            :func:`antenna_pin.studies.linear.sources_of` if left out.
        targets: What answers (:func:`antenna_pin.studies.linear.frequency_response`).
        frequencies: Rising and positive [Hz].
        width: "column" (88 mm) or "page" (180 mm).

    Raises:
        UnknownNameError: A source or target that there is not.
        InvalidParameterError: There is nothing that could swing it.
    """
    start = first_source(modes) if source is None else source
    return figure_response(frequency_response(modes, start, targets, frequencies), width=width)


@takes()
def modes_recorded(
    modes: Modes,
    path: str | os.PathLike[str],
    numbers: Iterable[int] | None = None,
    *,
    amplitude: float = 1.0,
) -> Path:
    """Write one page on which every mode swings; return its path.

    Args:
        modes: About which state.
        path: ``NAME.html``.
        numbers: Of the modes, from 1; all that vibrate if left out.
        amplitude: Times what is drawn by itself [-].

    Raises:
        InvalidParameterError: Nothing vibrates here, or there is no such mode.
        OutputError: It cannot be written there.
    """
    chosen = list(numbers) if numbers is not None else modes.elastic
    if not chosen:
        raise InvalidParameterError("modes", "numbers", "given, as nothing vibrates here", chosen)
    swings = [swing(modes, number, amplitude) for number in chosen]
    return record_several(swings, path, title=str(modes.data.attrs["title"]))


def _table(orbit: Orbit) -> xr.Dataset:
    if orbit.system is None:
        raise InvalidParameterError("orbit", "system", "that of its flow, which names its numbers", None)
    return orbit_table(orbit, orbit.system, orbit.scenario)


@takes()
def orbit_plotted(orbit: Orbit, *, width: Width = "column") -> Figure:
    """Return Floquet multipliers in the complex plane, with the unit circle.

    Args:
        orbit: The orbit.
        width: "column" (88 mm) or "page" (180 mm).
    """
    return figure_multipliers(_table(orbit), width=width)


@takes()
def orbit_reported(
    orbit: Orbit, path: str | os.PathLike[str] | None = None, *, beside: Any = (), **options: Any
) -> Report:
    """Return a report on the orbit; write it if a path is given.

    Args:
        orbit: The orbit.
        path: ``NAME.html``.
        beside: Runs and other findings in it, one or several.
        **options: Further ones of :func:`antenna_pin.show.report.report`: ``title``, ``figures``, ...

    Raises:
        OutputError: It cannot be written there.
    """
    one = isinstance(beside, Trajectory | xr.Dataset) or not isinstance(beside, Iterable)
    several = [beside] if one else list(beside)
    return saved_report(lambda: report(cast("Any", [*several, _table(orbit)]), **options), path)


@takes()
def figures_of_study(table: xr.Dataset) -> dict[str, tuple[str, Any]]:
    """Return title and drawing of the figures that a study allows, by name.

    Args:
        table: What :func:`antenna_pin.open_study` returns.
    """
    found = {one.name: (one.title, one.draw) for one in study_figures(table)}
    if table.attrs["method"] in ("morris", "saltelli"):
        for response in json.loads(table.attrs["responses"]):

            def drawn(name: str = response, **more: Any) -> Any:
                return study_sensitivities(sensitivities(table, name), name, **more)

            found[f"{response}-sensitivities"] = (f"{response}: sensitivity", drawn)
    return found


def _opened(study: Study, store: str | os.PathLike[str] | None) -> xr.Dataset:
    path = Path(f"{study.name}.study") if store is None else Path(store)
    if not path.is_dir():
        raise OutputError(
            f"{study.name}: store must be the folder written by run_study(study), got {path}, which is not "
            "there; run it first, or pass store="
        )
    return open_study(path)


class StudyFigures:
    """Figures of a study that has been run: ``study.plot("peak_force-response")``."""

    def __init__(self, study: Study) -> None:
        """Bind the figures to a study."""
        self._study = study

    def __call__(
        self,
        name: str | None = None,
        *,
        store: str | os.PathLike[str] | None = None,
        width: Width = "column",
    ) -> Figure:
        """Return a figure.

        Args:
            name: Which one; the first that the study allows if left out.
            store: Folder of its runs; ``NAME.study`` here if left out.
            width: "column" (88 mm) or "page" (180 mm).

        Raises:
            UnknownNameError: It allows none of that name.
            OutputError: It has not been run there.
        """
        found = figures_of_study(_opened(self._study, store))
        if name is not None and name not in found:
            raise UnknownNameError(self._study.name, "figure", name, found)
        figure: Figure = found[name or next(iter(found))][1](width=width)
        return figure

    def names(self, store: str | os.PathLike[str] | None = None) -> dict[str, str]:
        """Return the figures that the study allows: what each shows, by name."""
        return {name: title for name, (title, _) in figures_of_study(_opened(self._study, store)).items()}

    def __repr__(self) -> str:
        """List the figures, where it has been run."""
        try:
            names = self.names()
        except OutputError as error:
            return f"<figures of {error}>"
        return "\n".join(
            ["Figures of this study: plot(NAME)", *(f"  {name}  {title}" for name, title in names.items())]
        )


@takes()
def reported(
    study: Study,
    path: str | os.PathLike[str] | None = None,
    *,
    store: str | os.PathLike[str] | None = None,
    title: str | None = None,
    figures: bool = True,
) -> Report:
    """Return a report on the study; write it if a path is given.

    Args:
        study: The study.
        path: ``NAME.html``.
        store: Folder of its runs; ``NAME.study`` here if left out.
        title: Of the report; the study's if left out.
        figures: Whether to draw figures.

    Raises:
        OutputError: It has not been run there, or the report cannot be written.
    """
    return saved_report(lambda: study_report(_opened(study, store), title=title, figures=figures), path)
