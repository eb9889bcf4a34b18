"""Result of a run: labelled arrays with units, provenance and outcome."""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import os
import platform
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Self, cast

from antenna_pin.base.arguments import takes
from antenna_pin.base.files import check_writable, replacing
from antenna_pin.base.state import State
from antenna_pin.base.views import (
    RecorderView,
    Reporter,
    RunFiguresView,
    RunNumbersView,
    View,
    as_html,
    as_text,
    item_of,
)
from antenna_pin.errors import FileFormatError
from antenna_pin.trajectory.check import problem_of
from antenna_pin.trajectory.file import FORMAT, read, write
from antenna_pin.trajectory.labelled import Column, Content, Unlabelled
from antenna_pin.trajectory.outcome import ENDED_WELL, Counts, Outcome
from antenna_pin.trajectory.quantities import GROUPS, entries_of, reduced
from antenna_pin.trajectory.read import names_along
from antenna_pin.trajectory.touches import blow_counts, met_by_elements, met_by_meshes

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr
    from numpy.typing import NDArray

    from antenna_pin.scenario import Scenario

_LIBRARIES = ("antenna_pin", "pin", "coal", "numpy", "scipy", "numba", "xarray", "h5netcdf")


@cache
def _version(name: str) -> str:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return "not installed as a package"


def library_versions() -> dict[str, str]:
    """Return the versions of this package and of the libraries that its numbers depend on."""
    return {"python": platform.python_version(), **{name: _version(name) for name in _LIBRARIES}}


@cache
def code_digest() -> str:
    """Return a digest of the package's sources in a checkout; "" if installed.

    An installed package is identified by its version.
    """
    package = Path(__file__).resolve().parents[1]
    if not (package.parent / "pyproject.toml").is_file():
        return ""
    whole = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        whole.update(path.read_bytes())
    return whole.hexdigest()[:16]


class RunEvent(NamedTuple):
    """Event of a run: of the user's, or of an element whose mode changes."""

    name: str  # such as ``latch root: latched``
    time: float  # [s]
    energy: float  # that its action added [J]


class _UnlabelledSlot:
    __slots__ = ("_unlabelled",)  # what the data of a result are made of, beside its fields


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory(_UnlabelledSlot):
    """Sampled result of a run.

    Notebooks display it. Readers are methods: ``run.plot("contact_forces")``, ``run.record("run.html")``,
    ``run.report("report.html")``, ``run.analyse()`` (the readers of :mod:`antenna_pin.show.views`). A
    quantity over time is ``run["hinge.angle"]``, by the names of ``run.analyse.quantities()``.

    Attributes:
        data: Labelled by time, contact, axis and more; units and long names on each (docs/trajectory.md).
        outcome: Reason why the run ended.
        message: The outcome as text, with the place and what to try.
        counts: Steps, evaluations, wall time.
        scenario: Its scenario, enough to repeat it; None for a system built in Python.
        end: Final state, to continue from: ``simulate(scenario, start=run.end)``.
    """

    data: xr.Dataset
    outcome: Outcome
    message: str
    counts: Counts
    scenario: Scenario | None = None
    end: State | None = None

    plot = View[RunFiguresView]()
    record = View[RecorderView]()
    report = View[Reporter]()
    analyse = View[RunNumbersView]()

    @classmethod
    def later(cls, unlabelled: Unlabelled, **fields: Any) -> Self:
        """Return a result whose data are made on first access.

        Args:
            unlabelled: Data without labels.
            **fields: The other fields.
        """
        made = cls(data=cast("xr.Dataset", None), **fields)
        object.__delattr__(made, "data")
        object.__setattr__(made, "_unlabelled", unlabelled)
        return made

    if not TYPE_CHECKING:  # a checker is to know no other names than those that there are

        def __getattr__(self, name: str) -> Any:
            """Make the data on first access."""
            if name != "data":
                said = f"{type(self).__name__!r} object has no attribute {name!r}"
                raise AttributeError(said, name=name, obj=self)
            unlabelled = self._unlabelled
            if unlabelled is not None:
                object.__setattr__(self, "data", unlabelled.labelled())
                object.__setattr__(self, "_unlabelled", None)  # after: another thread may ask meanwhile
            return object.__getattribute__(self, "data")

    def __getitem__(self, name: str) -> xr.DataArray:
        """Return a quantity over time by name: ``run["hinge.angle"]``, ``run["kinetic_energy"]``.

        Raises:
            UnknownNameError: There is none of that name.
            FileFormatError: The result is a lean one, without series.
        """
        return item_of(self, name)

    @property
    def time(self) -> NDArray[np.float64]:
        """Times of the samples, (samples,) [s]; some stand twice, where something jumps."""
        found: NDArray[np.float64] = self.data["time"].values
        return found

    @property
    def events(self) -> tuple[RunEvent, ...]:
        """Events in order of time."""
        if "event" not in self.data.sizes:
            return ()
        columns = (self.data[name].values.tolist() for name in ("event", "event_time", "event_energy"))
        return tuple(map(RunEvent, *columns))

    @property
    def constraints(self) -> dict[str, Any]:
        """Counts and residuals of closures, couplings and motions; {} without any."""
        found: dict[str, Any] = json.loads(self.data.attrs.get("constraints", "{}"))
        return found

    @property
    def assumed(self) -> tuple[str, ...]:
        """Ignored parts of the URDF, and assumptions, as text."""
        lines = (json.loads(self.data.attrs.get(name, "[]")) for name in ("left_out", "assumed"))
        return tuple(line for each in lines for line in each)

    @property
    def advice(self) -> str:
        """Advice for further runs; empty without any."""
        return str(self.data.attrs.get("advice", ""))

    @property
    def completed(self) -> bool:
        """True if the run reached its end, or the event that ends it."""
        return self.outcome in ENDED_WELL

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the NetCDF file ``NAME.nc``, under a temporary name first; return its path.

        Raises:
            OutputError: The name ends otherwise, or it cannot be written there.
        """
        target = check_writable(path, ".nc")
        with replacing(target) as partial:
            write(self.stored(), partial)
        return target

    def stored(self) -> xr.Dataset | Content:
        """Return the data with all fields as attributes, for a file."""
        unlabelled: Unlabelled | None = getattr(self, "_unlabelled", None)
        data = self.data if unlabelled is None else unlabelled.content()
        attributes = {
            **data.attrs,
            "format": FORMAT,
            "outcome": self.outcome.name,
            "outcome_message": self.message,
            "counts": json.dumps(asdict(self.counts)),
            "scenario": "" if self.scenario is None else self.scenario.model_dump_json(),
            "end": "" if self.end is None else self.end.to_json(),
        }
        return replace(data, attrs=attributes) if isinstance(data, Content) else data.assign_attrs(attributes)

    @classmethod
    def load(cls, path: str | os.PathLike[str], *, scenario: bool = True) -> Self:
        """Read a file that :meth:`save` wrote.

        Args:
            path: The file.
            scenario: Whether to read the scenario, which doubles the time.

        Raises:
            FileFormatError: Not a result file, or an unknown version of the format.
        """
        source = Path(path)
        data = read(source)
        problem = problem_of(data)
        if problem is None:
            name = "outcome"
            try:
                outcome = Outcome[data.attrs[name]]
                name = "counts"
                counts = Counts(**json.loads(data.attrs[name]))
                name = "scenario"
                text = data.attrs[name]
                whole = _scenario(text) if text and scenario else None
                name = "end"
                text = data.attrs.get(name, "")
                end = State.from_json(text) if text else None
            except (KeyError, TypeError, ValueError, RecursionError) as error:
                problem = f"an attribute {name!r} that cannot be read ({error})"
            else:
                message = data.attrs["outcome_message"]
                return cls(
                    data=data, outcome=outcome, message=message, counts=counts, scenario=whole, end=end
                )
        raise FileFormatError(
            f"{source}: must be a whole result of antenna-pin, got {problem}; run the scenario again"
        )

    def summary(self) -> dict[str, Any]:
        """Return the run in plain numbers: how it ended, counts, peaks, impulses, conservation (SI units).

        With closed loops and prescribed motions also their number of equations, residuals and
        what they carried.
        """
        ended = {"outcome": self.outcome.name, "message": self.message, "counts": asdict(self.counts)}
        return summary_of(self.data, ended, self.constraints)

    def __repr__(self) -> str:
        """Show what was run, how it ended and what has happened; ``summary()`` has all numbers."""
        return as_text(self)

    def _repr_html_(self) -> str:
        """Return an HTML view of the run for notebooks."""
        return as_html(self)


@takes()
def open_run(path: str | os.PathLike[str]) -> Trajectory:
    """Return a run that was saved, ``NAME.nc``.

    Raises:
        FileFormatError: Not a complete result, or an unknown version of the format.
    """
    return Trajectory.load(path)


def _scenario(text: str) -> Scenario:
    from antenna_pin.scenario import Scenario

    return Scenario.model_validate_json(text)


def columns_of(run: Trajectory) -> dict[str, Column]:
    """Return all variables of a result by name, with coordinates."""
    unlabelled: Unlabelled | None = getattr(run, "_unlabelled", None)
    if unlabelled is None:
        found = run.data.variables.items()
        return {str(name): Column(tuple(map(str, one.dims)), one.values, one.attrs) for name, one in found}
    coordinates, variables = unlabelled.columns()
    return {**variables, **coordinates}


def summary_of(data: xr.Dataset, ended: Mapping[str, Any], constraints: Mapping[str, Any]) -> dict[str, Any]:
    """Return a run in plain numbers (SI units)."""
    title = data.attrs.get("title", "")
    result: dict[str, Any] = {
        "title": title,
        "case": data.attrs.get("case", ""),
        "outcome": ended["outcome"],
        "message": ended["message"],
        "time": float(data.attrs["end_time"]),
        "samples": int(data.attrs["samples"]),
        "counts": ended["counts"],
        "conservation": json.loads(data.attrs["conservation"]),
        "gap_difference": float(data.attrs["gap_difference"]),
        "motion": entries_of(data, "joint"),
        "contacts": {},
    }
    result |= {
        key: entries_of(data, GROUPS[key].dim)
        for key in ("slides", "elastic_parts")
        if GROUPS[key].dim in data.sizes
    }
    if constraints:
        result["constraints"] = constraints
        sides = ("first_body", "second_body")
        result["closures"] = _connected(data, "closures", "closure", kind="kind", links=sides)
        works = entries_of(data, "drive")
        result["motions"] = {
            name: one | {"work": works[name]["work"]}
            for name, one in _connected(data, "drives", "motion", joint="joint").items()
        }
    if "coupling" in data.sizes:
        joints = ("follower", "leader")
        result["couplings"] = _connected(data, "couplings", "coupling", joints=joints)
    result |= met_by_elements(data)
    if gears := met_by_meshes(data):
        result["gears"] = gears
    result |= {
        key: entries_of(data, GROUPS[key].dim)
        for key in ("controllers", "bearings", "forces")
        if GROUPS[key].dim in data.sizes
    }
    if "contact" not in data.sizes:
        return result
    index, end = data["episode_contact"].values, float(data.attrs["end_time"])
    result["contacts"] = {
        name: {
            one.key(): reduced(one, data, index == number, end)
            for one in GROUPS["contacts"].variables
            if one.key()
        }
        for number, name in enumerate(names_along(data, "contact"))
    }
    result["blows"] = {name: {"blows": count} for name, count in blow_counts(data).items()}
    return result


def _connected(data: xr.Dataset, attribute: str, dim: str, **keys: Any) -> dict[str, dict[str, Any]]:
    """Return keys of entries of an attribute, before the recorded numbers along a dimension."""
    about = json.loads(data.attrs[attribute])
    return {
        name: {
            key: about[name][of] if isinstance(of, str) else [about[name][each] for each in of]
            for key, of in keys.items()
        }
        | numbers
        for name, numbers in entries_of(data, dim).items()
    }
