"""Figures, recording and report of a run, as its own methods."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

import xarray as xr

from antenna_pin.base.arguments import takes
from antenna_pin.base.files import check_writable
from antenna_pin.errors import FileFormatError, InvalidParameterError, OutputError, UnknownNameError
from antenna_pin.show.plot import CATALOGUE, RunFigure, allowed_figures, run_figure
from antenna_pin.show.record import Recording, check_film, record, save_picture, save_video
from antenna_pin.show.report import Report, report
from antenna_pin.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Width = Literal["column", "page"]
_FILMS = (".mp4", ".gif")


class Drawing:
    """Figure of a run, ready to be drawn: ``run.plot.contact_forces()``."""

    def __init__(self, run: Trajectory, figure: RunFigure) -> None:
        """Bind a figure to a run."""
        self.__doc__ = f"{_title(figure)}: figure {figure.name!r} of the catalogue."
        self._run, self._figure = run, figure

    def __call__(
        self, *, beside: Any = (), joint: str | None = None, width: Width = "page", **options: Any
    ) -> Figure:
        """Return the figure.

        Args:
            beside: Other runs in it, each a trajectory or a pair of a label and one; an ideal one among them
                is what the others are compared with.
            joint: The joint that it is of; the first that the run is about if left out.
            width: "column" (88 mm) or "page" (180 mm).
            **options: Further ones of the figure's own, such as ``zoom``.

        Raises:
            InvalidParameterError: The runs do not have what the figure shows; the message lists what they do.
            UnknownNameError: There is no such joint.
        """
        if width not in ("column", "page"):
            raise InvalidParameterError("plot", "width", "'column' or 'page'", width)
        runs = [*_several(beside), self._run]
        allowed = list(allowed_figures(runs, joint, [self._figure.name]))
        if not allowed:
            needed = f"drawn of runs with {self._figure.needed}" if self._figure.needed else "drawn otherwise"
            have = ", ".join(dir(RunFigures(self._run)))
            raise InvalidParameterError(
                "plot", self._figure.name, needed, said=f"one without; this run has {have}"
            )
        return self._figure.draw(runs, joint=allowed[0].joint, width=width, **options)

    def __repr__(self) -> str:
        """Show what it draws."""
        return f"<{_title(self._figure)}: plot.{self._figure.name}(beside=..., joint=..., width=...)>"


class RunFigures:
    """Figures of a run: ``run.plot("contact_forces")``, or ``run.plot.contact_forces()``.

    Completion and ``repr`` list the figures that the run allows.
    """

    def __init__(self, run: Trajectory) -> None:
        """Bind the figures to a run."""
        self._run = run

    def __call__(
        self,
        name: str | None = None,
        *,
        beside: Any = (),
        joint: str | None = None,
        width: Width = "page",
        **options: Any,
    ) -> Figure:
        """Return a figure of the run, the first allowed if no name is given.

        Further arguments and errors are those of :class:`Drawing`.

        Raises:
            UnknownNameError: There is no figure of that name.
        """
        if name is not None and not isinstance(name, str):
            raise InvalidParameterError("plot", "name", "the name of a figure", name)
        chosen = self._names()[0] if name is None else name
        drawing = Drawing(self._run, run_figure(chosen))
        return drawing(beside=beside, joint=joint, width=width, **options)

    def __getattr__(self, name: str) -> Drawing:
        """Return a figure by its name."""
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return Drawing(self._run, run_figure(name))
        except UnknownNameError as error:
            raise AttributeError(str(error)) from None

    def _names(self) -> list[str]:
        return list(dict.fromkeys(one.figure.name for one in allowed_figures([self._run], names=CATALOGUE)))

    def __dir__(self) -> list[str]:
        """Return the names of figures that the run allows; none of a lean result."""
        try:
            return self._names()
        except FileFormatError:
            return []

    def __repr__(self) -> str:
        """List the figures that the run allows, by name."""
        names = self.__dir__()
        if not names:
            return "<no figures: the run has no series>"
        widest = max(map(len, names))
        lines = [f"  {name:<{widest}}  {_title(CATALOGUE[name])}" for name in names]
        return "\n".join(["Figures of this run, each drawn by plot(NAME):", *lines])

    def _repr_html_(self) -> str:
        """List them in a notebook."""
        rows = "".join(
            f"<tr><td style='text-align:left'><code>{escape(name)}</code></td>"
            f"<td style='text-align:left'>{escape(_title(CATALOGUE[name]))}</td></tr>"
            for name in self.__dir__()
        )
        return f"<table><caption>Figures of this run: plot(NAME)</caption>{rows}</table>"


def _title(figure: RunFigure) -> str:
    return figure.title.format(joint="a joint")


def _several(runs: Any) -> list[Any]:
    """Return runs, or pairs of a label and a run, as a list."""
    pair = isinstance(runs, tuple) and len(runs) == 2 and isinstance(runs[0], str)
    one = pair or isinstance(runs, Trajectory | xr.Dataset)
    several = [runs] if one else list(runs) if isinstance(runs, Iterable) else [runs]
    for each in several:
        run = each[1] if isinstance(each, tuple) and len(each) == 2 else each
        if not isinstance(run, Trajectory | xr.Dataset):
            raise InvalidParameterError("plot", "beside", "runs, or pairs of a label and a run", each)
    return several


@takes()
def recorded(
    run: Trajectory,
    path: str | os.PathLike[str] | None = None,
    *,
    ideal: Trajectory | xr.Dataset | None = None,
    view: Literal["mechanism", "joint"] = "mechanism",
    joint: str | None = None,
    **options: Any,
) -> Recording:
    """Return a recording of the run; write it if a path is given.

    Args:
        run: The run.
        path: ``NAME.html``, the page; ``NAME.png``, a picture of its start; ``NAME.mp4`` or ``NAME.gif``, a
            video, by a browser (:func:`antenna_pin.show.record.save_video` has more to choose).
        ideal: A run that is drawn as a ghost beside.
        view: ``mechanism``, or ``joint``, a clearance joint close up.
        joint: Which clearance joint; the first if left out.
        **options: Further ones of :func:`antenna_pin.show.record.record`: ``magnify``, ``speed``, ``start``,
            ...

    Raises:
        OutputError: It cannot be written there.
        AntennaPinError: What :func:`antenna_pin.show.record.record` refuses.
    """
    target = None if path is None else Path(path)
    suffix = "" if target is None else target.suffix.lower()
    if target is not None:
        if suffix not in (".html", ".png", *_FILMS):
            raise OutputError(
                f"record: path must end in .html (page), .png (picture), .mp4 or .gif (video), got {target}"
            )
        if suffix == ".html":
            check_writable(target, suffix)
        else:
            check_film(target, suffix)
    made = record(run, ideal, view=view, joint=joint, **options)
    if target is not None and suffix in _FILMS:
        save_video(made, target)
    elif target is not None and suffix == ".png":
        save_picture(made, target)
    elif target is not None:
        made.save(target)
    return made


@takes()
def reported(
    run: Trajectory, path: str | os.PathLike[str] | None = None, *, beside: Any = (), **options: Any
) -> Report:
    """Return a report on the run; write it if a path is given.

    Args:
        run: The run.
        path: ``NAME.html``.
        beside: Other runs that it compares, each a trajectory or a pair of a label and one; an ideal one is
            what deviations are from.
        **options: Further ones of :func:`antenna_pin.show.report.report`: ``title``, ``figures``,
            ``recordings``, ``window``, ``quantities``.

    Raises:
        OutputError: It cannot be written there.
        AntennaPinError: What :func:`antenna_pin.show.report.report` refuses.
    """
    return saved_report(lambda: report(cast("Any", [*_several(beside), run]), **options), path)


def saved_report(make: Callable[[], Report], path: str | os.PathLike[str] | None) -> Report:
    """Return a report; write it if a path is given, checked before the work."""
    if path is not None:
        check_writable(path, ".html")
    made = make()
    if path is not None:
        made.save(path)
    return made
