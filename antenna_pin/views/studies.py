"""Figures and report of a study that has been run, as the study's own."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import xarray as xr

from antenna_pin.base.arguments import takes
from antenna_pin.base.files import check_writable
from antenna_pin.errors import OutputError, UnknownNameError
from antenna_pin.plot import study_figures, study_sensitivities
from antenna_pin.report import Report, study_report
from antenna_pin.sweep import Study, open_study, sensitivities

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["StudyFigures", "figures_of_study", "reported"]

Width = Literal["column", "page"]


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

            found[f"{response}-sensitivities"] = (f"{response}: what it depends on", drawn)
    return found


def _opened(study: Study, store: str | os.PathLike[str] | None) -> xr.Dataset:
    path = Path(f"{study.name}.study") if store is None else Path(store)
    if not path.is_dir():
        raise OutputError(
            f"{study.name}: store must be the folder that run_study(study) made, got {path}, which is not "
            "there; run it first, or say store="
        )
    return open_study(path)


class StudyFigures:
    """Figures of a study that has been run: ``study.plot("peak_force-response")``.

    Args:
        study: The study.
    """

    def __init__(self, study: Study) -> None:
        """Take the study."""
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
    """Return a report on the study, which shows itself in a notebook, and write it if a path is given.

    Args:
        study: The study.
        path: ``NAME.html``.
        store: Folder of its runs; ``NAME.study`` here if left out.
        title: Of the report; the study's if left out.
        figures: Whether to draw figures.

    Raises:
        OutputError: It has not been run there, or the report cannot be written.
    """
    if path is not None:
        check_writable(path, ".html")
    made = study_report(_opened(study, store), title=title, figures=figures)
    if path is not None:
        made.save(path)
    return made
