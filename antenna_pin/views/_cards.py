"""What runs, scenarios, systems, modes, orbits and studies show of themselves."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.analysis import answer
from antenna_pin.base.readable import number, readable
from antenna_pin.scenario import scenario_toml
from antenna_pin.views._card import Card, Fact, Fold, measured, table

if TYPE_CHECKING:
    import xarray as xr

    from antenna_pin.linear import Modes
    from antenna_pin.nonlinear import Orbit
    from antenna_pin.scenario import Scenario
    from antenna_pin.sweep import Study
    from antenna_pin.trajectory import Trajectory

__all__ = ["modes_card", "orbit_card", "run_card", "scenario_card", "study_card"]


Array = NDArray[np.float64]

# --- a sketch of a run's motion for notebooks, in plain SVG ---

# Variables of the card's style, which has a colour for light and for dark pages.
_COLOURS = tuple(f"var(--line-{k})" for k in range(1, 7))
_WIDTH, _HEIGHT, _LEFT, _RIGHT, _TOP, _BOTTOM = 420, 150, 62, 8, 8, 22
_COLUMNS = 120  # of the sketch: in each, the least and the largest value are kept


def motion_sketch(data: xr.Dataset) -> str:
    """Return the angles of a run's joints over time as inline SVG; nothing if there is nothing to draw."""
    if "time" not in data.coords:  # a result without series
        return ""
    time = np.asarray(data["time"].values, dtype=float)
    every = [str(name) for name in data["joint"].values] if "joint" in data.coords else []
    names = every[: len(_COLOURS)]
    if not names or time.size < 2 or not time[-1] > time[0]:
        return ""
    angles = np.asarray(data["motion_angle"].values, dtype=float)[:, : len(names)]
    if not np.isfinite(angles).any():
        return ""
    low, high = float(np.nanmin(angles)), float(np.nanmax(angles))
    span = high - low if high > low else max(abs(high), 1.0)
    right, bottom = _WIDTH - _RIGHT, _HEIGHT - _BOTTOM
    lines = "".join(
        f'<path d="{_path(time, angles[:, k], low, span)}" fill="none" '
        f'style="stroke:{_COLOURS[k]}" stroke-width="1.4"><title>{escape(name)}</title></path>'
        for k, name in enumerate(names)
    )
    keys = "".join(
        f'<span style="color:{_COLOURS[k]};margin-right:.8em">{escape(name)}</span>'
        for k, name in enumerate(names)
    )
    texts = "".join(
        f'<text x="{x}" y="{y}" text-anchor="{anchor}">{escape(text)}</text>'
        for x, y, anchor, text in (
            (_LEFT - 6, _TOP + 10, "end", readable(high, "rad", 3)),
            (_LEFT - 6, bottom, "end", readable(low, "rad", 3)),
            (_LEFT, _HEIGHT - 5, "start", readable(float(time[0]), "s", 3)),
            (right, _HEIGHT - 5, "end", readable(float(time[-1]), "s", 3)),
        )
    )
    left = f" (and {len(every) - len(names)} joints more)" if len(every) > len(names) else ""
    return (
        f'<div><svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" width="{_WIDTH}" '
        'style="max-width:100%;height:auto" role="img" aria-label="angles of the joints over time" '
        'font-size="11" fill="currentColor">'
        f'<path d="M{_LEFT},{_TOP}V{bottom}H{right}" fill="none" stroke="currentColor" stroke-width=".7"/>'
        f"{lines}{texts}</svg><div>{keys}<span>angle over time{left}</span></div></div>"
    )


def _path(time: Array, values: Array, low: float, span: float) -> str:
    """Return the line as an SVG path, thinned to what a screen can show, peaks kept."""
    # Columns of equal time, not of equal number of samples: these crowd at impacts.
    column = np.minimum(((time - time[0]) / (time[-1] - time[0]) * _COLUMNS).astype(int), _COLUMNS - 1)
    starts = np.flatnonzero(np.diff(column, prepend=-1))
    kept: set[int] = {0, time.size - 1}
    for first, last in zip(starts, [*starts[1:], time.size], strict=True):
        part = values[first:last]
        if np.isfinite(part).any():
            kept |= {int(first + np.nanargmin(part)), int(first + np.nanargmax(part))}
    picked = np.array(sorted(kept))
    picked = picked[np.isfinite(values[picked])]
    wide, high = _WIDTH - _LEFT - _RIGHT, _HEIGHT - _TOP - _BOTTOM
    x = _LEFT + wide * (time[picked] - time[0]) / (time[-1] - time[0])
    y = _TOP + high * (1.0 - (values[picked] - low) / span)
    return "M" + "L".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))


# What a run in a few words is counted by.
_COUNTED = (
    "time",
    "joint",
    "sliding_joint",
    "clearance_joint",
    "contact",
    "closure",
    "episode",
    "event",
    "sampled",
    "tick",
)
_ROWS = 40  # of a table
_TEXT = 160  # letters of a cell


def run_card(run: Trajectory) -> Card:
    """Return how a run ended, what has happened, its motion, and what data there are."""
    data = run.data
    attributes, sizes = data.attrs, data.sizes
    named = [str(attributes[key]) for key in ("title", "case") if attributes.get(key)]
    held = ", ".join(f"{size} {name}" for name, size in sizes.items() if name in _COUNTED)
    facts = [
        Fact(run.outcome.name.replace("_", " ").lower(), run.message, run.completed),
        Fact("data", f"{len(data.data_vars)} variables of {held}"),
    ]
    folds = [Fold("data", f"{len(data.data_vars)} variables", _variables(data))]
    if "conservation" in attributes:  # a whole result, not one that is being put together
        found, summary = answer(run), run.summary()
        facts[1:1] = [Fact("run", found.ended.partition(", ")[2]), *map(_fact, found.lines)]
        rows = list(_motions(summary))
        sketch = motion_sketch(data)
        folds[:0] = [
            Fold(
                "motion",
                f"{len(rows)} joints",
                table(rows[:_ROWS], ("", "at the end", "rate at the end", "largest acceleration")) + sketch,
                bool(sketch),
            ),
            *_contacts(summary),
            Fold("kept", "energy and momentum", table(list(_kept(summary)))),
        ]
    facts[len(facts) - 1 : -1] = [Fact("assumed", line) for line in run.assumed]
    hint = "summary() has the numbers; plot(NAME), record(FILE), report(FILE), analyse()"
    return Card(
        "Trajectory of", ", case ".join(named) or "a system built in Python", tuple(facts), tuple(folds), hint
    )


def _fact(line: Any) -> Fact:
    return Fact(line.about, line.text)


def _motions(summary: Mapping[str, Any]) -> Iterator[list[Any]]:
    for name, one in summary["motion"].items():
        yield [
            name,
            measured(one["angle"], "rad"),
            measured(one["rate"], "rad/s"),
            measured(one["peak_acceleration"], "rad/s^2"),
        ]
    for name, one in summary.get("slides", {}).items():
        yield [
            name,
            measured(one["position"], "m"),
            measured(one["slide_rate"], "m/s"),
            measured(one["peak_slide_acceleration"], "m/s^2"),
        ]


def _contacts(summary: Mapping[str, Any]) -> Iterator[Fold]:
    contacts = summary["contacts"]
    if not contacts:
        return
    rows = [
        [
            name,
            str(one["episodes"]),
            measured(one["peak_force"], "N"),
            measured(one["peak_depth"], "m"),
            measured(one["largest_approach_speed"], "m/s"),
            measured(one["dissipated"], "J"),
        ]
        for name, one in contacts.items()
    ]
    head = ("", "impacts", "largest normal force", "greatest depth", "fastest approach", "energy lost")
    peak = max(one["peak_force"] for one in contacts.values())
    said = f"{len(contacts)}, largest normal force {readable(peak, 'N')}"
    yield Fold("contacts", said, table(rows[:_ROWS], head))


def _kept(summary: Mapping[str, Any]) -> Iterator[list[Any]]:
    kept = summary["conservation"]
    for key, name, unit in (
        ("energy_error", "energy balance error", "J"),
        ("energy_error_relative", "energy balance error, relative", "1"),
        ("linear_momentum_drift_relative", "linear momentum drift, relative", "1"),
        ("angular_momentum_drift_relative", "angular momentum drift, relative", "1"),
    ):
        if kept.get(key) is not None:
            yield [name, measured(kept[key], unit, 2)]


def _variables(data: xr.Dataset) -> str:
    rows = [
        [name, ", ".join(map(str, one.dims)), one.attrs.get("units", ""), one.attrs.get("long_name", "")]
        for name, one in data.data_vars.items()
    ]
    return table(rows, ("variable", "along", "unit", "what it is"))


# Tables of a scenario that stand by themselves, in the order in which they are read.
_TABLES = (
    "clearance",
    "drives",
    "springs",
    "stops",
    "latches",
    "gears",
    "bearings",
    "forces",
    "shake",
    "closures",
    "couplings",
    "rotors",
    "flexible",
    "references",
    "controllers",
    "events",
)
_LONGEST = 16_000  # letters of the scenario's text


def scenario_card(scenario: Scenario) -> Card:
    """Return what a scenario is: its mechanism, what has play, what drives it; all of it as a file has it."""
    name = scenario.name + (f", case {scenario.case}" if scenario.case else "")
    facts = [Fact("title", scenario.title), Fact("case", scenario.description)]
    facts.append(Fact("duration", readable(scenario.duration, "s")))
    facts.append(Fact("mechanism", str(scenario.mechanism.urdf)))
    known = [*_TABLES, *(n for n in type(scenario).model_fields if n not in _TABLES)]
    for key in known:
        held = getattr(scenario, key, None)
        if isinstance(held, Mapping) and held and key != "materials":
            facts.append(Fact(key, _by_kind(held)))
    if scenario.overrides:
        facts.append(Fact("set over it", ", ".join(scenario.overrides)))
    text = scenario_toml(scenario)
    left = len(text) - _LONGEST
    shown = text if left <= 0 else f"{text[:_LONGEST]}\n# and {left} letters more"
    folds = (Fold("as a file", "all keys, SI units", f"<pre>{escape(shown)}</pre>"),)
    return Card("Scenario", name, tuple(one for one in facts if one.text), folds)


def _by_kind(held: Mapping[str, Any]) -> str:
    """Return the names of entries, those of a kind together."""
    kinds: dict[str, list[str]] = {}
    for name, one in held.items():
        kinds.setdefault(str(getattr(one, "model", "") or getattr(one, "kind", "")), []).append(name)
    return "; ".join(f"{', '.join(names)}{f' ({kind})' if kind else ''}" for kind, names in kinds.items())


def study_card(study: Study) -> Card:
    """Return what a study varies, and what it keeps of each run."""
    facts = [
        Fact("title", study.title),
        Fact("scenario", f"{study.scenario}{f', case {study.case}' if study.case else ''}"),
    ]
    if study.sampling is not None:
        facts.append(Fact("runs", f"{study.sampling.count}, {study.sampling.method}, seed {study.seed}"))
    facts += [
        Fact("varied", ", ".join(study.parameters)),
        Fact("kept of each", ", ".join(study.responses)),
        Fact("full results", study.results),
    ]
    varied = [[name, _given(one)] for name, one in study.parameters.items()]
    kept = [[name, _given(one)] for name, one in study.responses.items()]
    folds = (
        Fold("parameters", str(len(varied)), table(varied[:_ROWS])),
        Fold("responses", str(len(kept)), table(kept[:_ROWS])),
    )
    return Card("Study", study.name, tuple(one for one in facts if one.text), folds)


def _given(one: Any) -> str:
    """Return what is given of an entry of a file."""
    given = one.model_dump(mode="json", exclude_unset=True, exclude_none=True)
    return _short(
        ", ".join(f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in given.items())
    )


def _short(text: str) -> str:
    """Return a text, without its middle where it is long."""
    return text if len(text) <= _TEXT else f"{text[: _TEXT - 5]} ..."


def modes_card(modes: Modes) -> Card:
    """Return the table of modes."""
    data = modes.data
    title = ", case ".join(str(data.attrs[key]) for key in ("title", "case") if data.attrs.get(key))
    kinds = [str(kind) for kind in data["kind"].values]
    said = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds))
    rows = [
        [str(int(mode)), measured(frequency, "Hz", 6), measured(ratio), kind]
        for mode, frequency, ratio, kind in zip(
            data["mode"].values, modes.frequency, modes.damping_ratio, kinds, strict=True
        )
    ]
    facts = [Fact("modes", f"{len(kinds)} ({said})"), *(Fact("note", one) for one in modes.notes)]
    more = f"first {_ROWS} of {len(rows)}; data has all" if len(rows) > _ROWS else "all"
    head = ("mode", "frequency", "damping ratio", "kind")
    folds = (Fold("frequencies", more, table(rows[:_ROWS], head), True),)
    return Card("Modes of", title or "a system built in Python", tuple(facts), folds)


def orbit_card(orbit: Orbit) -> Card:
    """Return a periodic solution: its period, whether it is stable, its multipliers."""
    stable = orbit.stable
    words = {True: "stable: neighbours come nearer", False: "unstable", None: "neither stable nor unstable"}
    about = "" if orbit.scenario is None else f"of {orbit.scenario.name}, "
    facts = [
        Fact("stability", words[stable], stable),
        Fact("multipliers", f"{len(orbit.multipliers)}, to {number(orbit.doubt, 2)}"),
        Fact("in a period", f"{orbit.onsets[0]} contacts begin, {orbit.onsets[1]} events"),
        Fact("closed to", f"{number(orbit.residual, 2)} error scales, after {orbit.iterations} iterations"),
        Fact("told by", f"the state at {readable(orbit.start.time, 's')}"),
    ]
    rows = [
        [
            measured(one.real, digits=6),
            measured(one.imag, digits=6),
            measured(abs(one), digits=6),
            measured(growth, "1/s", 6),
        ]
        for one, growth in zip(orbit.multipliers, orbit.exponents, strict=True)
    ]
    head = ("real part", "imaginary part", "size", "exponent")
    folds = (Fold("multipliers", "the largest first", table(rows[:_ROWS], head), True),)
    title = f"{about}period {readable(orbit.period, 's', 6)}"
    return Card("Orbit", title, tuple(facts), folds)
