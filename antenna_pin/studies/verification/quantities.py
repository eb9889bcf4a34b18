"""Catalogue of the quantities that requirements bound."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.analysis import (
    closure_loads,
    coupling_loads,
    drive_loads,
    elastic_motion,
    impact_statistics,
    impacts,
    load_statistics,
    own_number,
    quantity,
)
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.scenario.requirements import RequirementSpec
from antenna_pin.studies.sweep.measures import MEASURES
from antenna_pin.studies.verification.design_quantities import design_quantities
from antenna_pin.studies.verification.quantity import Analysis, Case, Find, Value, VerifiedQuantity, chosen
from antenna_pin.trajectory import Trajectory, names_along
from antenna_pin.trajectory.columns import Variable
from antenna_pin.trajectory.quantities import SUMMARIES, TABLES, slides_along


@dataclass(frozen=True, slots=True)
class _Measure:
    """Requirement as the arguments of a study's measure."""

    measure: str
    of: str | None
    index: str
    component: str
    value: str
    window: float | None
    drift_spacing: float | None
    period: float | None
    confidence: float


_POINTING = ("index", "component", "value", "window", "drift_spacing", "period", "level")
_BOOKS = ("energy_", "linear_momentum", "angular_momentum", "gross_work")


def _analysis_of(name: str) -> Analysis:
    if name.startswith(_BOOKS):
        return "integrity"
    if name in ("blows", "impacts", "approach_speed", "impulse", "largest_blow", "fastest_touch"):
        return "shocks"
    loads = ("force", "torque", "effort", "moment", "load", "tension")
    return "loads" if any(part in name for part in loads) else "functional"


_ROWS = {one.name: one for one in SUMMARIES}


def _measure(name: str) -> Find:
    def find(case: Case, spec: RequirementSpec) -> Value:
        about = _Measure(
            name, spec.of, spec.index, spec.component, spec.value,
            spec.window, spec.drift_spacing, spec.period, spec.level,
        )  # fmt: skip
        measure = MEASURES[name]
        reference = case.reference() if measure.compares else None
        value = float(measure.find(case.run, about, reference))
        return (value, _unit(_ROWS[name], case.run.data, measure.of, spec.of)) if measure.sliding else value

    return find


def _of_measures() -> Iterator[VerifiedQuantity]:
    for name, one in MEASURES.items():
        units = one.units
        yield VerifiedQuantity(
            name,
            units if not one.sliding else "",
            one.meaning,
            "functional" if name == "pointing" else _analysis_of(name),
            one.of,
            _measure(name),
            options=_POINTING if name == "pointing" else (),
            needs_series=one.series,
            compares=one.compares,
        )


# --- elements in a summary: stops, latches, gears ---

_FAMILIES = ("stops", "latches", "gears")


def _of_element(variable: Variable) -> Find:
    keys = {variable.key(), variable.key(slides=True)}

    def find(case: Case, spec: RequirementSpec) -> Value:
        if "summary" not in case.memo:
            case.memo["summary"] = case.run.summary()
        summary = case.memo["summary"]
        found: dict[str, float] = {}
        for family in _FAMILIES:
            for name, numbers in summary.get(family, {}).items():
                for key in keys & numbers.keys():
                    value = numbers[key]
                    number = math.nan if value is None else float(value)
                    found[f"{family}.{name}"] = number
        value = chosen(variable.name, "element", spec.of, found)
        return value, _unit(variable, case.run.data, "element", spec.of)

    return find


# --- tables with a row for each named thing ---

_TABLES: dict[str, tuple[Callable[[Trajectory], xr.Dataset], Analysis]] = {
    "closure loads": (closure_loads, "loads"),
    "coupling loads": (coupling_loads, "loads"),
    "drive loads": (drive_loads, "loads"),
    "elastic motion": (elastic_motion, "functional"),
    "loads": (load_statistics, "loads"),
    "joint loads": (load_statistics, "loads"),
    "impact statistics": (lambda run: impact_statistics(impacts(run)), "shocks"),
}


def _unit(variable: Variable, data: xr.Dataset, dim: str, of: str | None) -> str:
    """Return the unit of a quantity of what turns or slides; "" where several differ."""
    if not variable.sliding:
        return variable.units
    slides = slides_along(data, dim)
    mine = {one for name, one in slides.items() if of is None or of in (name, name.partition(".")[2])}
    return variable.unit(mine.pop()) if len(mine) == 1 else ""


def _of_table(table: str, variable: Variable) -> Find:
    make, _ = _TABLES[table]
    (dim,) = variable.dims

    def find(case: Case, spec: RequirementSpec) -> Value:
        if table not in case.memo:
            case.memo[table] = make(case.run)
        data = case.memo[table]
        names = names_along(data, dim)
        values = np.asarray(data[variable.name].values, dtype=float)
        value = chosen(variable.name, dim.replace("_", " "), spec.of, dict(zip(names, values, strict=True)))
        return value, _unit(variable, case.run.data, dim, spec.of)

    return find


def _of_series(variable: Variable) -> Find:
    """Return the reduction of a series, as peak and end of controllers, motors and springs."""
    assert variable.reduced is not None
    by, of = variable.reduced
    (dim,) = variable.dims

    def find(case: Case, spec: RequirementSpec) -> Value:
        data = case.run.data
        if of not in data:
            raise UnknownNameError(variable.name, "series of the result", of, ())
        values = np.asarray(data[of].values, dtype=float)
        reduced = np.abs(values).max(axis=0) if by == "peak" else values[-1]
        own = str(data[of].dims[1])
        found = dict(zip(names_along(data, own), reduced.tolist(), strict=True))
        value = chosen(variable.name, dim.replace("_", " "), spec.of, found)
        return value, _unit(variable, data, own, spec.of)

    return find


_SERIES = ("controllers", "motors", "traced springs", "point springs", "frictions")


def _of_tables(known: set[str]) -> Iterator[VerifiedQuantity]:
    for variable in TABLES["elements"].values():
        if variable.name not in known:
            units = "" if variable.sliding else variable.units
            analysis: Analysis = _analysis_of(variable.name)
            yield VerifiedQuantity(
                variable.name, units, variable.meaning, analysis, "element", _of_element(variable)
            )
    for table in _SERIES:
        for variable in TABLES[table].values():
            if variable.reduced is None:
                continue
            units = "" if variable.sliding else variable.units
            analysis = "control" if table == "controllers" else _analysis_of(variable.name)
            yield VerifiedQuantity(
                variable.name, units, variable.meaning, analysis, variable.dims[0], _of_series(variable),
                needs_series=True,
            )  # fmt: skip
    for table, (_, analysis) in _TABLES.items():
        for variable in TABLES[table].values():
            name = f"{table.replace(' ', '_')}.{variable.name}"
            units = "" if variable.sliding else variable.units
            yield VerifiedQuantity(
                name, units, variable.meaning, analysis, variable.dims[0], _of_table(table, variable),
                needs_series=True,
            )  # fmt: skip


# --- signals: any quantity over time of a run ---


def _signal(case: Case, spec: RequirementSpec) -> tuple[Any, Any, str]:
    """Return times [s] and values of a signal in its time span, and the unit."""
    if spec.of is None:
        raise InvalidParameterError(
            spec.quantity, "of", "the name of a signal, as phase --list shows them", None
        )
    name = f"signal {spec.of}"
    if name not in case.memo:
        case.memo[name] = quantity(case.run, spec.of)
    found = case.memo[name]
    time, values = np.asarray(found.time, dtype=float), np.asarray(found.values, dtype=float)
    if values.ndim > 1:
        values = np.linalg.norm(values, axis=1)
    low = -math.inf if spec.after is None else spec.after
    high = math.inf if spec.before is None else spec.before
    inside = (time >= low) & (time <= high)
    if not inside.any():
        key = "after" if low > time[0] else "before"
        rule = f"a time with samples of the run, which ends at {time[-1]:g} s"
        raise InvalidParameterError(
            spec.quantity, key, rule, said=f"{spec.after if key == 'after' else high:g} s"
        )
    return time[inside], values[inside], found.units


def _rms(time: Any, values: Any) -> float:
    if len(time) < 2:
        return float(abs(values[0]))
    return math.sqrt(float(np.trapezoid(values**2, time)) / float(time[-1] - time[0]))


_STATISTICS: dict[str, tuple[str, Callable[[Any, Any], float]]] = {
    "signal_peak": ("largest size of a signal", lambda time, values: float(np.abs(values).max())),
    "signal_largest": ("largest value of a signal", lambda time, values: float(values.max())),
    "signal_least": ("least value of a signal", lambda time, values: float(values.min())),
    "signal_range": ("largest less least value of a signal", lambda time, values: float(np.ptp(values))),
    "signal_rms": ("root mean square of a signal", _rms),
    "signal_end": ("last value of a signal", lambda time, values: float(values[-1])),
}


def _statistic(reduce: Callable[[Any, Any], float]) -> Find:
    def find(case: Case, spec: RequirementSpec) -> Value:
        time, values, units = _signal(case, spec)
        return reduce(time, values), units

    return find


def _shock(case: Case, spec: RequirementSpec) -> Value:
    from antenna_pin.analysis import shock_spectrum

    time, values, units = _signal(case, spec)
    found = shock_spectrum(time, values, quality=spec.quality, units=units)
    frequency, response = found["frequency"].values, found["maximum"].values
    if spec.band is not None:
        inside = (frequency >= spec.band[0]) & (frequency <= spec.band[1])
        if not inside.any():
            rule = (
                f"one with natural frequencies of the spectrum, {frequency[0]:.3g} to {frequency[-1]:.3g} Hz"
            )
            raise InvalidParameterError(spec.quantity, "band", rule, said=f"{spec.band} Hz")
        response = response[inside]
    return float(response.max()), units


def _band_rms(case: Case, spec: RequirementSpec) -> Value:
    from antenna_pin.analysis import band_rms, power_density

    time, values, units = _signal(case, spec)
    density = power_density(time, values, units=units)
    return float(band_rms(density, None if spec.band is None else [spec.band])["rms"].values[0]), units


def _of_signals() -> Iterator[VerifiedQuantity]:
    span = ("after", "before")
    for name, (meaning, reduce) in _STATISTICS.items():
        yield VerifiedQuantity(
            name, "", meaning, "functional", "signal", _statistic(reduce), span, needs_series=True
        )
    yield VerifiedQuantity(
        "shock", "", "largest value of the shock response spectrum of a signal", "shocks", "signal", _shock,
        (*span, "band", "quality"), needs_series=True,
    )  # fmt: skip
    yield VerifiedQuantity(
        "band_rms", "", "root mean square of a signal in a band of frequencies", "disturbance", "signal",
        _band_rms, (*span, "band"), needs_series=True,
    )  # fmt: skip


# --- disturbance at the interface ---


def _interface(column: str, unit: str) -> Find:
    def find(case: Case, spec: RequirementSpec) -> float:
        from antenna_pin.analysis import band_rms, interface_loads, power_density

        if "interface" not in case.memo:
            case.memo["interface"] = interface_loads(case.run)
        loads = case.memo["interface"]
        time, values = np.asarray(loads["time"].values), np.asarray(loads[column].values)
        if spec.of is None:
            signal = np.linalg.norm(values, axis=1)
        elif spec.of in ("x", "y", "z"):
            signal = values[:, "xyz".index(spec.of)]
        else:
            raise UnknownNameError(spec.quantity, "axis", spec.of, ("x", "y", "z"))
        if spec.band is None:
            return float(np.abs(signal).max())
        density = power_density(time, signal, units=unit)
        return float(band_rms(density, [spec.band])["rms"].values[0])

    return find


def _of_interface() -> Iterator[VerifiedQuantity]:
    for name, units, column in (("interface_force", "N", "force"), ("interface_moment", "N m", "moment")):
        meaning = f"largest {column} of the mechanism on its base; in a band its root mean square"
        yield VerifiedQuantity(
            name, units, meaning, "disturbance", "axis", _interface(column, units), ("band",),
            needs_series=True,
        )  # fmt: skip


# --- sampled controllers ---


def _ticks(case: Case, spec: RequirementSpec, signals: tuple[str, ...]) -> list[Any]:
    """Return signals of a sampled controller at its sampling times within the time span."""
    data = case.run.data
    known = names_along(data, "signal") if "tick_signal" in data else []
    own = sorted({name.partition(".")[0] for name in known})
    of = spec.of if spec.of is not None or len(own) != 1 else own[0]
    if of not in own:
        raise UnknownNameError(spec.quantity, "sampled controller", of or "any", own)
    time = np.asarray(data["tick_time"].values, dtype=float)
    low, high = spec.after or 0.0, math.inf if spec.before is None else spec.before
    columns = []
    for signal in signals:
        if f"{of}.{signal}" not in known:
            raise UnknownNameError(spec.quantity, f"signal of {of}", signal, known)
        columns.append(np.asarray(data["tick_signal"].sel(signal=f"{of}.{signal}").values, dtype=float))
    mine = np.isfinite(columns[0]) & (time >= low) & (time <= high)
    if not mine.any():
        said = f"{low:g} s to {high:g} s"
        raise InvalidParameterError(spec.quantity, "after", "a time span with sampling times", said=said)
    return [column[mine] for column in columns]


def _unit_of_controller(case: Case, spec: RequirementSpec) -> str:
    """Return the unit of a controller's measurement; "" if unknown."""
    tables = case.scenario.controllers
    table = tables.get(spec.of or next(iter(tables), ""))
    measures = str(getattr(table, "measures", "") or "")
    kind, _, joint = measures.partition(" ")
    if kind != "angle" or not joint:
        return ""
    return "m" if joint in names_along(case.run.data, "sliding_joint") else "rad"


def _tracking_error(case: Case, spec: RequirementSpec) -> Value:
    measured, reference = _ticks(case, spec, ("measured", "reference"))
    return float(np.abs(reference - measured).max()), _unit_of_controller(case, spec)


def _saturated_share(case: Case, spec: RequirementSpec) -> Value:
    (saturated,) = _ticks(case, spec, ("saturated",))
    return float(saturated.mean())


def _of_controllers() -> Iterator[VerifiedQuantity]:
    span = ("after", "before")
    yield VerifiedQuantity(
        "tracking_error", "", "largest size of reference less measurement at the sampling times", "control",
        "controller", _tracking_error, span,
    )  # fmt: skip
    yield VerifiedQuantity(
        "saturated_share", "1", "share of the sampling times at which limits held the command", "control",
        "controller", _saturated_share, span,
    )  # fmt: skip


def run_quantities() -> Iterator[VerifiedQuantity]:
    """Yield all quantities of runs; of one name the first counts."""
    measured = list(_of_measures())
    yield from measured
    yield from _of_tables({one.name for one in measured})
    for made in (_of_signals(), _of_interface(), _of_controllers()):
        yield from made


def _own(case: Case, spec: RequirementSpec) -> float:
    return own_number(spec.quantity, case.sources.get(spec.quantity, ""), spec.quantity, case.run)


def _all() -> dict[str, VerifiedQuantity]:
    found: dict[str, VerifiedQuantity] = {}
    for one in chain(run_quantities(), design_quantities()):
        found.setdefault(one.name, one)
    return found


#: Quantities of requirements by name.
QUANTITIES: dict[str, VerifiedQuantity] = _all()


def quantity_of(spec: RequirementSpec, place: str) -> VerifiedQuantity:
    """Return the quantity of a requirement.

    Args:
        spec: The requirement.
        place: Place of the requirement, for messages.

    Raises:
        UnknownNameError: The quantity is unknown.
        ScenarioError: A key is given that the quantity does not take.
    """
    if ":" in spec.quantity:
        found = VerifiedQuantity(
            spec.quantity, spec.units, f"function {spec.quantity}", "functional", "", _own, ("units",)
        )
    elif spec.quantity in QUANTITIES:
        found = QUANTITIES[spec.quantity]
    else:
        raise UnknownNameError(f"{place}.quantity", "quantity", spec.quantity, QUANTITIES)
    found.refuse_options(place, spec)
    return found
