"""Views of a result: figures, recording, report and numbers as methods.

Readers stand above what they read, and are made of libraries that take a while to load. So a class of results
names a reader of the room ``views`` by a :class:`View`, which fetches it when it is used; :data:`VIEWS` is
the table of all of them, and the only place where a lower layer names a higher one. The
protocols say to editors and type checkers what comes of it.
"""

from __future__ import annotations

import base64
import hashlib
import importlib
import inspect
import os
import types
from collections.abc import Iterable
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Literal, Protocol, TypeVar, overload

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

# --- pages --------------------------------------------------------------------------------------------------


def script(text: str) -> str:
    """Return a text as content of a script element, with its end tags escaped."""
    return "\n" + text.replace("</script", r"<\/script").replace("<!--", r"<\!--") + "\n"


def policy(*scripts: str) -> str:
    """Return a page's security policy: no network, no scripts but its own.

    Text that got into a page as markup, from a file of a stranger's, could run nothing and send nothing away.
    """
    digests = (hashlib.sha256(text.encode()).digest() for text in scripts)
    own = " ".join(f"'sha256-{base64.b64encode(digest).decode()}'" for digest in digests) or "'none'"
    rules = (
        "default-src 'none'",
        f"script-src {own}",
        "style-src 'unsafe-inline'",  # colours and places of single elements
        "img-src data: blob:",
        "font-src data:",
        "connect-src data: blob:",  # textures of meshes, which stand in the page
        "base-uri 'none'",
        "form-action 'none'",
    )
    return f'<meta http-equiv="Content-Security-Policy" content="{"; ".join(rules)}">\n'


def in_frame(page: str, height: str) -> str:
    """Return a whole page as an isolated frame in a notebook."""
    source = escape(page, quote=True)
    return (
        f'<iframe srcdoc="{source}" sandbox="allow-scripts" style="width:100%;height:{height};border:0" '
        "allowfullscreen></iframe>"
    )


# --- figures of runs ----------------------------------------------------------------------------------------
#
# What stands between the marks is written by ``python scripts/pages/reference.py --write``, of the
# catalogue of figures (:mod:`antenna_pin.show.plot.catalogue`).


class DrawingView(Protocol):
    """Figure of a run, ready to be drawn."""

    def __call__(
        self,
        *,
        beside: Any = (),
        joint: str | None = None,
        width: Literal["column", "page"] = "page",
        **options: Any,
    ) -> Figure:
        """Draw it."""
        ...


# <!-- table: figure_names -->
FigureName = Literal[
    "motion_angle",
    "motion_rate",
    "motion_acceleration",
    "slide_position",
    "slide_rate",
    "slide_acceleration",
    "joint_motion",
    "angle_between_runs",
    "rate_between_runs",
    "contact_forces",
    "journal_orbit",
    "bore_load",
    "eccentricity",
    "contact_scenarios",
    "joint_load",
    "steady_force",
    "closure_forces",
    "coupling_torques",
    "drive_efforts",
    "applied_forces",
    "control",
    "stops",
    "gears",
    "deflection",
    "hysteresis",
    "spectra",
    "spectrogram",
    "swept_response",
    "random_density",
    "shock_spectrum",
    "base_position",
    "base_velocity",
    "base_acceleration",
    "base_attitude",
    "base_angular_velocity",
    "base_angular_acceleration",
    "joints_angle",
    "joints_rate",
    "joints_acceleration",
    "body_position",
    "body_velocity",
    "body_acceleration",
    "pointing",
    "energy",
    "momentum",
]


class NamedFigures(Protocol):
    """Figures of runs, each ready to be drawn."""

    motion_angle: DrawingView
    """Angle of a joint."""
    motion_rate: DrawingView
    """Rate of a joint."""
    motion_acceleration: DrawingView
    """Acceleration of a joint."""
    slide_position: DrawingView
    """Position of a joint."""
    slide_rate: DrawingView
    """Rate of a joint."""
    slide_acceleration: DrawingView
    """Acceleration of a joint."""
    joint_motion: DrawingView
    """Motion of a joint."""
    angle_between_runs: DrawingView
    """Angle of a joint, runs less one another."""
    rate_between_runs: DrawingView
    """Rate of a joint, runs less one another."""
    contact_forces: DrawingView
    """Contact forces in a joint."""
    journal_orbit: DrawingView
    """Orbit of the journal in a joint."""
    bore_load: DrawingView
    """Load around the bore of a joint."""
    eccentricity: DrawingView
    """Eccentricity and tilt in a joint."""
    contact_scenarios: DrawingView
    """Contact scenarios of a joint."""
    joint_load: DrawingView
    """Force through a joint."""
    steady_force: DrawingView
    """Force through a joint in the second half of the run."""
    closure_forces: DrawingView
    """Forces of the closures."""
    coupling_torques: DrawingView
    """Torques of the couplings."""
    drive_efforts: DrawingView
    """What the drives exert."""
    applied_forces: DrawingView
    """Forces on links."""
    control: DrawingView
    """What controllers measure and command."""
    stops: DrawingView
    """End stops and latches."""
    gears: DrawingView
    """Gears, belts and cables."""
    deflection: DrawingView
    """Deflections of flexible links."""
    hysteresis: DrawingView
    """Torque of springs over angle."""
    spectra: DrawingView
    """Spectra, a joint."""
    spectrogram: DrawingView
    """Spectrogram, a joint."""
    swept_response: DrawingView
    """Response to the swept base."""
    random_density: DrawingView
    """Power spectral density on the shaken base."""
    shock_spectrum: DrawingView
    """Shock response spectrum on the shaken base."""
    base_position: DrawingView
    """Position of the base."""
    base_velocity: DrawingView
    """Velocity of the base."""
    base_acceleration: DrawingView
    """Acceleration of the base."""
    base_attitude: DrawingView
    """Attitude of the base."""
    base_angular_velocity: DrawingView
    """Angular velocity of the base."""
    base_angular_acceleration: DrawingView
    """Angular acceleration of the base."""
    joints_angle: DrawingView
    """Angle of all joints."""
    joints_rate: DrawingView
    """Rate of all joints."""
    joints_acceleration: DrawingView
    """Acceleration of all joints."""
    body_position: DrawingView
    """Position of the body that a joint moves."""
    body_velocity: DrawingView
    """Velocity of the body that a joint moves."""
    body_acceleration: DrawingView
    """Acceleration of the body that a joint moves."""
    pointing: DrawingView
    """Boresight and pointing error."""
    energy: DrawingView
    """Energy: work, storage and losses."""
    momentum: DrawingView
    """Drift of momentum."""


# <!-- end -->


# --- views --------------------------------------------------------------------------------------------------

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
    return getattr(importlib.import_module(f"antenna_pin.show.views.{file}"), function)


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
    """A reader of results, found under an attribute's name and loaded at first use.

    Attributes:
        name: Of the view, as ``Class.name``.
    """

    def __init__(self) -> None:
        """Wait for the name."""
        self.name = ""

    def __set_name__(self, owner: type, name: str) -> None:
        """Store the name of class and attribute; the first, where a class is rebuilt."""
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


class RunFiguresView(NamedFigures, Protocol):
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


class RecorderView(Protocol):
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


class RunNumbersView(Protocol):
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


class StudyFiguresView(Protocol):
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
