"""Text and HTML summaries of runs, scenarios, systems, modes, orbits, studies."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.analysis import answer
from antenna_pin.base.readable import number, readable
from antenna_pin.scenario import scenario_toml
from antenna_pin.trajectory.quantities import HEADINGS, RUN

if TYPE_CHECKING:
    import xarray as xr

    from antenna_pin.dynamics import System
    from antenna_pin.scenario import Scenario
    from antenna_pin.studies.linear import Modes
    from antenna_pin.studies.nonlinear import Orbit
    from antenna_pin.studies.sweep import Study
    from antenna_pin.trajectory import Trajectory

_TEXT_COLUMNS, _LINES = 80, 24

# Pages say whether they are dark in several ways: the system's, JupyterLab's, Sphinx' and VS Code's.
_LIGHT = (
    "--good:#00734f;--bad:#b3261e;--line-1:#0072b2;--line-2:#c44e00;--line-3:#00734f;--line-4:#a8417a;"
    "--line-5:#8a6100;--line-6:#2a7fb8"
)
_DARK = (
    "--good:#4cc38a;--bad:#ff8a70;--line-1:#6cb6ff;--line-2:#ff9d5c;--line-3:#4cc38a;--line-4:#e5a3c9;"
    "--line-5:#f2c14e;--line-6:#8fd3ff"
)
_SAYS_LIGHT = ('html[data-theme="light"]', '[data-jp-theme-light="true"]', "body.vscode-light")
_SAYS_DARK = ('html[data-theme="dark"]', '[data-jp-theme-light="false"]', "body.vscode-dark")
_RULES = {
    "": "font:14px/1.45 system-ui,sans-serif;max-width:60rem;text-align:left;overflow-wrap:anywhere",
    " header": "border-bottom:1px solid color-mix(in srgb,currentColor 25%,transparent);padding:.2rem 0",
    " header i": "opacity:.75;font-style:normal;margin-right:.5em",
    " dl": "display:grid;grid-template-columns:minmax(6em,max-content) 1fr;gap:.1rem .9rem;margin:.4rem 0",
    " dt": "opacity:.75;font-weight:400",
    " dd": "margin:0",
    " summary": "cursor:pointer;padding:.15rem 0",
    " summary span": "opacity:.75",
    " details>div": "overflow-x:auto;padding:0 0 .4rem 1rem",
    " table": "border-collapse:collapse;font-size:13px;margin:0;overflow-wrap:normal",
    " tr": "background:none",
    " td": "text-align:left;padding:.1rem .9rem .1rem 0;vertical-align:top;border:0",
    " th": "text-align:left;padding:.1rem .9rem .1rem 0;vertical-align:bottom;border:0;opacity:.75;"
    "font-weight:400",
    " .n": "text-align:right;font-variant-numeric:tabular-nums",
    " td.n": "white-space:nowrap",
    " pre": "margin:0;font-size:12px;white-space:pre-wrap;background:none;color:inherit",
    " .good": "color:var(--good)",
    " .bad": "color:var(--bad)",
}


def _style() -> str:
    own = ".antenna-pin-card"
    rules = "".join(f"{own}{place}{{{rule}}}" for place, rule in _RULES.items())
    light, dark = (",".join(f"{one} {own}" for one in said) for said in (_SAYS_LIGHT, _SAYS_DARK))
    return (
        f"<style>{own}{{{_LIGHT}}}@media(prefers-color-scheme:dark){{{own}{{{_DARK}}}}}"
        f"{light}{{{_LIGHT}}}{dark}{{{_DARK}}}{rules}</style>"
    )


@dataclass(frozen=True, slots=True)
class Fact:
    """Fact and its subject."""

    about: str
    text: str
    good: bool | None = None  # None for neither good nor bad


@dataclass(frozen=True, slots=True)
class Fold:
    """Foldable part."""

    title: str
    said: str  # beside the title
    html: str
    open: bool = False  # at first


@dataclass(frozen=True, slots=True)
class Card:
    """Summary of an object."""

    kind: str
    title: str
    facts: tuple[Fact, ...]
    folds: tuple[Fold, ...] = ()  # in a notebook only
    hint: str = ""  # on further methods, in a shell only

    def text(self) -> str:
        """Return it as text, of 80 columns and at most 24 lines."""
        widest = min(max((len(fact.about) for fact in self.facts), default=0), 24)
        lines = textwrap.wrap(f"{self.kind} {self.title}", _TEXT_COLUMNS, subsequent_indent="  ")
        for fact in self.facts:
            about = f"  {fact.about:<{widest}}  "
            whole = f"{about}{fact.text}"
            lines += textwrap.wrap(whole, _TEXT_COLUMNS, subsequent_indent=" " * (widest + 4)) or [about]
        last = textwrap.wrap(self.hint, _TEXT_COLUMNS - 2, initial_indent="  ", subsequent_indent="  ")
        room = _LINES - len(last)
        if len(lines) > room:
            lines = [*lines[: room - 1], f"  ... and {len(lines) - room + 1} lines more"]
        return "\n".join([*lines, *last])

    def html(self) -> str:
        """Return it as HTML for a notebook."""
        return f'{_style()}<div class="antenna-pin-card">{"".join(self._parts())}</div>'

    def _parts(self) -> Iterator[str]:
        yield f"<header><i>{escape(self.kind)}</i><b>{escape(self.title)}</b></header>"
        said = "".join(
            f"<dt>{escape(fact.about)}</dt><dd{_look(fact.good)}>{escape(fact.text)}</dd>"
            for fact in self.facts
        )
        yield f"<dl>{said}</dl>" if said else ""
        for fold in self.folds:
            yield (
                f"<details{' open' if fold.open else ''}><summary>{escape(fold.title)} "
                f"<span>{escape(fold.said)}</span></summary><div>{fold.html}</div></details>"
            )


def _look(good: bool | None) -> str:
    return "" if good is None else f' class="{"good" if good else "bad"}"'


@dataclass(frozen=True, slots=True)
class RoundedNumber:
    """Rounded number with its unit, and all its digits as title."""

    value: float
    text: str


def number_cell(value: float | None, unit: str = "1", digits: int = 4) -> RoundedNumber | str:
    """Return a cell of a rounded number, with all its digits as title."""
    if value is None or value != value:
        return readable(None)
    return RoundedNumber(float(value), readable(float(value), unit, digits))


def table(rows: Sequence[Sequence[Any]], head: Sequence[str] = ()) -> str:
    """Return rows of texts and numbers (:func:`measured`) as HTML."""
    columns = [any(isinstance(one, RoundedNumber) for one in column) for column in zip(*rows, strict=True)]
    right = ['class="n"' if numbers else "" for numbers in columns] or [""] * len(head)
    cells = (_element("th", look, escape(one)) for look, one in zip(right, head, strict=False))
    top = f"<tr>{''.join(cells)}</tr>" if head else ""
    body = "".join(f"<tr>{''.join(map(_cell, right, row))}</tr>" for row in rows)
    return f"<table>{top}{body}</table>"


def _cell(look: str, one: Any) -> str:
    if isinstance(one, RoundedNumber):
        return _element("td", f'{look} title="{one.value!r}"', escape(one.text))
    return _element("td", look, escape(str(one)))


def _element(name: str, attributes: str, text: str) -> str:
    return f"<{name}{attributes and ' '}{attributes}>{text}</{name}>"


_NAMES = 12  # of things of a kind
_SYSTEM_ROWS = 60  # of a table


def system_card(system: System) -> Card:
    """Return a system's card: mechanism, joints by kind, elements by family, state."""
    mechanism, model = system.mechanism, system.model
    joints = dict(_joints(system))
    mass = float(sum(one.mass for one in model.inertias))
    nx = system.manifold.nx
    facts = [
        Fact("base", f"{mechanism.base}; {readable(mass, 'kg')} in all"),
        Fact("state", f"{model.nq} numbers of configuration, {model.nv} of velocity, {nx} integrated"),
        Fact("joints", _elements_by_kind(joints)),
        *(Fact(family, _elements_by_kind(kinds)) for family, kinds in _acting(system)),
    ]
    places = [(name, slot.q, slot.v) for name, slot in mechanism.joints.items()]
    if mechanism.base == "free":
        places.insert(0, ("base", mechanism.base_q, mechanism.base_v))
    rows = [
        [name, joints.get(name, "free"), ", ".join(system.names_q[q]), ", ".join(system.names_v[v])]
        for name, q, v in places
    ]
    more = f"first {_SYSTEM_ROWS} of {len(rows)}" if len(rows) > _SYSTEM_ROWS else "names of q and v"
    folds = (Fold("coordinates", more, table(rows[:_SYSTEM_ROWS], ("", "", "configuration", "velocity"))),)
    return Card("System of", mechanism.name, tuple(fact for fact in facts if fact.text), folds)


def _joints(system: System) -> Iterator[tuple[str, str]]:
    """Yield what each joint is: with play, held, on a bearing, or of the tree."""
    play = {joint.name: type(joint.geometry).__name__ for joint in system.clearances}
    for name, slot in system.mechanism.joints.items():
        if name in play:
            yield name, f"with play, {play[name]}"
        elif name in system.held:
            yield name, f"{system.held[name]}, held by constraint"
        elif name in system.elastic:
            yield name, "elastic part"
        else:
            yield name, "on a bearing" if name in system.on_bearings else str(slot.kind)


def _acting(system: System) -> Iterator[tuple[str, dict[str, str]]]:
    """Yield elements by family, and constraints: names and kinds."""
    for family, elements in system.families.items():
        yield (
            family,
            {name: type(one).__name__ for name, one in elements.items() if name not in system.elastic},
        )
    loops = {name: str(one.kind) for name, one in system.closures.items() if name not in system.held}
    yield "closures", loops
    yield "couplings", dict.fromkeys(system.couplings, "")


def _elements_by_kind(kinds: Mapping[str, str], most: int = _NAMES) -> str:
    """Return names by kind, at most so many each: "root, first (Latch)"."""
    names: dict[str, list[str]] = {}
    for name, kind in kinds.items():
        names.setdefault(kind, []).append(name)
    texts = []
    for kind, some in names.items():
        more = f" and {len(some) - most} more" if len(some) > most else ""
        texts.append(f"{', '.join(some[:most])}{more}{f' ({kind})' if kind else ''}")
    return "; ".join(texts)


Array = NDArray[np.float64]

# --- a sketch of a run's motion for notebooks, in plain SVG ---

# Variables of the card's style, which has a colour for light and for dark pages.
_COLOURS = tuple(f"var(--line-{k})" for k in range(1, 7))
_WIDTH, _HEIGHT, _LEFT, _RIGHT, _TOP, _BOTTOM = 420, 150, 62, 8, 8, 22
_COLUMNS = 120  # of the sketch: in each, the least and the largest value are kept


def motion_sketch(data: xr.Dataset) -> str:
    """Return the joints' angles over time as inline SVG; empty without any."""
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
    """Return a curve as an SVG path, thinned to screen resolution, peaks included."""
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
_COUNTED = "time joint sliding_joint clearance_joint contact closure episode event sampled tick".split()
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
        facts[1:1] = [
            Fact("run", found.ended.partition(", ")[2]),
            *(Fact(line.about, line.text) for line in found.lines),
        ]
        tables = [_group(summary[key]) for key in ("motion", "slides") if summary.get(key)]
        joints = len(summary["motion"]) + len(summary.get("slides", ()))
        sketch = motion_sketch(data)
        folds[:0] = [
            Fold("motion", f"{joints} joints", "".join(tables) + sketch, bool(sketch)),
            *_contacts(summary),
            Fold("kept", "energy and momentum", table(list(_conservation(summary)))),
        ]
    facts[len(facts) - 1 : -1] = [Fact("assumed", line) for line in run.assumed]
    hint = "summary() has the numbers; plot(NAME), record(FILE), report(FILE), analyse()"
    return Card(
        "Trajectory of", ", case ".join(named) or "a system built in Python", tuple(facts), tuple(folds), hint
    )


def _group(group: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the table of a group of a summary."""
    head = [HEADINGS[key] for key in next(iter(group.values()))]
    rows = [
        [
            name,
            *(
                str(value) if of.form == "count" else number_cell(value, of.unit(slides))
                for value, (of, slides) in zip(one.values(), head, strict=True)
            ),
        ]
        for name, one in group.items()
    ]
    return table(rows[:_ROWS], ("", *(of.words(slides) for of, slides in head)))


def _contacts(summary: Mapping[str, Any]) -> Iterator[Fold]:
    if contacts := summary["contacts"]:
        peak = max(one["peak_force"] for one in contacts.values())
        said = f"{len(contacts)}, {HEADINGS['peak_force'][0].words()} {readable(peak, 'N')}"
        yield Fold("contacts", said, _group(contacts))


def _conservation(summary: Mapping[str, Any]) -> Iterator[list[Any]]:
    kept = summary["conservation"]
    for key in ("energy_error", *(name for name in kept if name.endswith("_relative"))):
        if kept.get(key) is not None:
            yield [RUN[key].words(), number_cell(kept[key], RUN[key].unit(), 2)]


def _variables(data: xr.Dataset) -> str:
    rows = [
        [name, ", ".join(map(str, one.dims)), one.attrs.get("units", ""), one.attrs.get("long_name", "")]
        for name, one in data.data_vars.items()
    ]
    return table(rows, ("variable", "along", "unit", "what it is"))


# Tables of a scenario that stand by themselves, in the order in which they are read.
_TABLES = """
    clearance drives springs stops latches gears bearings forces shake closures couplings rotors flexible
    references controllers events
""".split()
_LONGEST = 16_000  # letters of the scenario's text


def scenario_card(scenario: Scenario) -> Card:
    """Return a scenario's card: mechanism, play, elements, and its whole file."""
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


def _by_kind(entries: Mapping[str, Any]) -> str:
    """Return the names of entries, those of a kind together."""
    kinds = {
        name: str(getattr(one, "model", "") or getattr(one, "kind", "")) for name, one in entries.items()
    }
    return _elements_by_kind(kinds, len(kinds))


def study_card(study: Study) -> Card:
    """Return a study's card: varied parameters, responses."""
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
    varied = [[name, _entry(one)] for name, one in study.parameters.items()]
    kept = [[name, _entry(one)] for name, one in study.responses.items()]
    folds = (
        Fold("parameters", str(len(varied)), table(varied[:_ROWS])),
        Fold("responses", str(len(kept)), table(kept[:_ROWS])),
    )
    return Card("Study", study.name, tuple(one for one in facts if one.text), folds)


def _entry(one: Any) -> str:
    """Return what is given of an entry of a file."""
    given = one.model_dump(mode="json", exclude_unset=True, exclude_none=True)
    text = ", ".join(f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in given.items())
    return text if len(text) <= _TEXT else f"{text[: _TEXT - 5]} ..."


def modes_card(modes: Modes) -> Card:
    """Return the table of modes."""
    data = modes.data
    title = ", case ".join(str(data.attrs[key]) for key in ("title", "case") if data.attrs.get(key))
    kinds = [str(kind) for kind in data["kind"].values]
    said = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds))
    rows = [
        [str(int(mode)), number_cell(frequency, "Hz", 6), number_cell(ratio), kind]
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
    rows = []
    for one, growth in zip(orbit.multipliers, orbit.exponents, strict=True):
        parts = [number_cell(part, digits=6) for part in (one.real, one.imag, abs(one))]
        rows.append([*parts, number_cell(growth, "1/s", 6)])
    head = ("real part", "imaginary part", "size", "exponent")
    folds = (Fold("multipliers", "the largest first", table(rows[:_ROWS], head), True),)
    title = f"{about}period {readable(orbit.period, 's', 6)}"
    return Card("Orbit", title, tuple(facts), folds)
