"""Views of a result: figures, recording, report and numbers as methods.

Readers stand above what they read, and are made of libraries that take a while to load. So a class of results
names a reader of the room ``views`` by a :class:`View`, which fetches it when it is used; :data:`VIEWS` is
the table of all of them, and the one place where what lies below knows the name of what lies above. The
protocols say to editors and type checkers what comes of it.
"""

from __future__ import annotations

import importlib
import inspect
import os
import types
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Literal, Protocol, TypeVar, overload

from antenna_pin.base.run_figures import FigureName, NamedFigures

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = [
    "VIEWS",
    "ModesRecorder",
    "Page",
    "Recorder",
    "Reporter",
    "ResponsePlotter",
    "RunFigures",
    "RunNumbers",
    "StudyFigures",
    "StudyReporter",
    "View",
    "Plotter",
    "as_html",
    "as_text",
    "item_of",
]

T = TypeVar("T")
Path_ = str | os.PathLike[str]
Width = Literal["column", "page"]

#: The reader of each view, as ``file.name`` in the room ``views``, by class and name.
VIEWS = {
    "Trajectory.plot": "runs.RunFigures",
    "Trajectory.record": "runs.recorded",
    "Trajectory.report": "runs.reported",
    "Trajectory.analyse": "numbers.RunNumbers",
    "Study.plot": "studies.StudyFigures",
    "Study.report": "studies.reported",
    "Orbit.plot": "studies.orbit_plotted",
    "Orbit.report": "studies.orbit_reported",
    "Modes.plot": "studies.modes_plotted",
    "Modes.record": "studies.modes_recorded",
    "Trajectory.item": "numbers.item_of",
    "Trajectory.card": "_cards.run_card",
    "Scenario.card": "_cards.scenario_card",
    "Study.card": "_cards.study_card",
    "Modes.card": "_cards.modes_card",
    "Orbit.card": "_cards.orbit_card",
    "System.card": "_cards.system_card",
}


def _reader(name: str) -> Any:
    file, _, function = VIEWS[name].partition(".")
    return getattr(importlib.import_module(f"antenna_pin.views.{file}"), function)


def as_html(result: object) -> str:
    """Return a result, or what was run, as HTML for a notebook."""
    return str(_reader(f"{type(result).__name__}.card")(result).html())


def item_of(result: object, name: str) -> xr.DataArray:
    """Return a quantity of a result by name, over time."""
    found: xr.DataArray = _reader(f"{type(result).__name__}.item")(result, name)
    return found


def as_text(result: object) -> str:
    """Return it as text for a shell, of 80 columns and at most 24 lines."""
    return str(_reader(f"{type(result).__name__}.card")(result).text())


class View(Generic[T]):
    """A reader of a result that is found under a name of its class, and loaded when it is used.

    Attributes:
        name: Of the view, as ``Class.name``.
    """

    def __init__(self) -> None:
        """Wait for the name."""
        self.name = ""

    def __set_name__(self, owner: type, name: str) -> None:
        """Take the name of the class and of the attribute; the first, where a class is made anew."""
        self.name = self.name or f"{owner.__name__}.{name}"

    @overload
    def __get__(self, instance: None, owner: type) -> Any: ...

    @overload
    def __get__(self, instance: object, owner: type) -> T: ...

    def __get__(self, instance: object | None, owner: type) -> Any:
        """Return the reader, bound to a result; of the class what is bound."""
        made = _reader(self.name)
        if instance is None:
            return made
        return types.MethodType(made, instance) if inspect.isfunction(made) else made(instance)


class Page(Protocol):
    """A page that needs nothing but itself, and shows itself in a notebook."""

    @property
    def html(self) -> str:
        """The page."""
        ...

    def save(self, path: Path_) -> Path:
        """Write it; return its path."""
        ...


class RunFigures(NamedFigures, Protocol):
    """``run.plot``: figures by name."""

    def __call__(
        self,
        name: FigureName | None = None,
        *,
        beside: Any = (),
        joint: str | None = None,
        width: Width = "page",
        **options: Any,
    ) -> Figure:
        """Draw one."""
        ...


class Recorder(Protocol):
    """``run.record``."""

    def __call__(
        self,
        path: Path_ | None = None,
        *,
        ideal: Any = None,
        view: Literal["mechanism", "joint"] = "mechanism",
        joint: str | None = None,
        **options: Any,
    ) -> Page:
        """Record it."""
        ...


class Reporter(Protocol):
    """``run.report``, ``orbit.report``."""

    def __call__(self, path: Path_ | None = None, *, beside: Any = (), **options: Any) -> Page:
        """Report on it."""
        ...


class RunNumbers(Protocol):
    """``run.analyse``: all numbers, or those of one analysis by its name."""

    def __call__(self, ideal: Any = None, *, longest_gap: float | str = 1e-3) -> dict[str, Any]:
        """Return all numbers of ``antenna-pin analyse``."""
        ...

    def __getattr__(self, name: str) -> Any: ...

    def frame(self, part: str, ideal: Any = None) -> Any:
        """Return a part of it as a table."""
        ...

    def spectrum(self, of: str, **options: Any) -> xr.Dataset:
        """Return the spectrum of a quantity."""
        ...

    def spectrogram(self, of: str, **options: Any) -> xr.Dataset:
        """Return the spectrum of a quantity as it changes."""
        ...

    def pointing(self, ideal: Any = None, **options: Any) -> xr.Dataset:
        """Return pointing indices."""
        ...


class Plotter(Protocol):
    """``orbit.plot``."""

    def __call__(self, *, width: Width = "column") -> Figure:
        """Draw it."""
        ...


class ResponsePlotter(Protocol):
    """``modes.plot``."""

    def __call__(
        self,
        source: str | None = None,
        targets: str | Iterable[str] | None = None,
        *,
        width: Width = "page",
        **options: Any,
    ) -> Figure:
        """Draw a frequency response."""
        ...


class ModesRecorder(Protocol):
    """``modes.record``."""

    def __call__(self, path: Path_, modes: Iterable[int] | None = None, *, amplitude: float = 1.0) -> Path:
        """Record mode shapes."""
        ...


class StudyFigures(Protocol):
    """``study.plot``."""

    def __call__(
        self, name: str | None = None, *, store: Path_ | None = None, width: Width = "column"
    ) -> Figure:
        """Draw a figure."""
        ...


class StudyReporter(Protocol):
    """``study.report``."""

    def __call__(self, path: Path_ | None = None, *, store: Path_ | None = None, **options: Any) -> Page:
        """Report on it."""
        ...
