"""Report of a verification: matrix, worst cases, each analysis with its figures, sensitivities, budget."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from antenna_pin.analysis import interface_loads, power_density, quantity, shock_spectrum
from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import number, printed_unit, readable
from antenna_pin.errors import AntennaPinError
from antenna_pin.show import plot
from antenna_pin.show.report._page import (
    Cell,
    Item,
    PageTable,
    Picture,
    Row,
    Section,
    Status,
    statement,
)
from antenna_pin.show.report._runs import ReportedRun, reported
from antenna_pin.show.report.document import Report, page
from antenna_pin.show.report.figures import drawn, picture
from antenna_pin.show.report.results import conservation
from antenna_pin.studies.verification import point_text, result_text
from antenna_pin.trajectory import Trajectory

# Analyses of figures of runs, by how the name of one begins.
_FIGURES = {
    "joints": "functional",
    "pointing": "functional",
    "deflection": "functional",
    "stops": "functional",
    "gears": "functional",
    "drive": "loads",
    "closure": "loads",
    "coupling": "loads",
    "contact": "loads",
    "bore": "loads",
    "load": "loads",
    "control": "control",
    "base": "disturbance",
    "swept": "disturbance",
    "random": "disturbance",
    "shock": "shocks",
    "energy": "integrity",
    "momentum": "integrity",
}
_MOST_FIGURES = 4
_VERDICTS = {"met": "met", "falls short": "FALLS SHORT", "not shown": "NOT SHOWN"}
_DASH = number(None)


@takes()
def verification_report(
    facts: Mapping[str, Any],
    *,
    nominal: Trajectory | None = None,
    file: Path | None = None,
    loops: Sequence[Mapping[str, Any]] = (),
    curves: Sequence[Mapping[str, Any]] = (),
    figures: bool = True,
    processes: int = 1,
) -> Report:
    """Return the report of a verification.

    Args:
        facts: All its numbers, as its JSON file has them.
        nominal: The nominal run, for figures.
        file: Its file.
        loops: Sampled loops: ``controller``, ``frequency`` [Hz], ``response`` [-], and their margins.
        curves: Further tables of analyses: ``analysis``, ``key``, ``title``, ``head`` and ``rows``, and what
            a figure with a ``caption`` is drawn of.
        figures: Whether to draw figures.
        processes: How many draw figures, at most.
    """
    runs = [] if nominal is None else reported([("nominal run", nominal)])
    requirements = facts["requirements"]
    placed = _placed(runs, figures, processes)
    sections = [
        _matrix(facts, figures),
        _worst(facts),
        *(
            _analysis(facts, key, title, runs, placed, loops, curves, figures)
            for key, title in facts["analyses"].items()
        ),
        _sensitivities(facts, figures),
        _budget(facts, curves, figures),
        _not_covered(facts),
        _provenance(facts, file),
    ]
    short = [one for one in requirements if one["verdict"] != "met"]
    said = (
        f"{len(requirements) - len(short)} of {len(requirements)} requirements are met by the runs shown here"
    )
    statuses = [Status("verification", not short, "all met" if not short else "not all met", said)]
    statuses += [
        Status(one["requirement"], False, _VERDICTS[one["verdict"]], _sentence(one)) for one in short
    ]
    title = f"Verification: {facts['title'] or facts['name']}"
    return page(title, statuses, sections)


def _sentence(one: Mapping[str, Any]) -> str:
    text = f"{one['text'] or one['meaning']}: {_result(one)}, where {_bound(one)}"
    return f"{text}; {one['message']}" if one["message"] else text


def _text(value: float | None, units: str, digits: int = 4) -> str:
    return _DASH if value is None else readable(value, units, digits)


def _bound(one: Mapping[str, Any]) -> str:
    chance = one.get("probability")
    if not chance:
        return str(one["bound"])
    return f"{one['bound']}, with a probability of {1.0 - chance['allowed']:.6g}"


def _result(one: Mapping[str, Any]) -> str:
    chance = one.get("probability")
    if chance:
        percent = 100.0 * chance["confidence"]
        return (
            f"probability of failure {number(chance['probability'], 2)} ({number(chance['low'], 2)} to "
            f"{number(chance['high'], 2)} at {percent:g} %)"
        )
    return _value(one, one["result"])


def _value(one: Mapping[str, Any], value: float | None, digits: int = 4) -> str:
    """Return a result in the unit of its bound, on one line."""
    return result_text(one, value, digits).replace(" ", "\N{NO-BREAK SPACE}")


def _margin(one: Mapping[str, Any]) -> str:
    if one.get("probability"):
        return number(one["margin"], 3)
    return _value(one, one["margin"], 3)


def _requirement_text(one: Mapping[str, Any]) -> str:
    text = one["text"] or one["meaning"]
    return f"{text} [{one['clause']}]" if one["clause"] else str(text)


def _matrix(facts: Mapping[str, Any], figures: bool) -> Section:
    """Return the verification matrix."""
    rows = [
        Row(
            one["requirement"],
            (
                Cell(_requirement_text(one)),
                Cell(_bound(one)),
                Cell(_result(one)),
                Cell(_margin(one)),
                Cell(_VERDICTS[one["verdict"]]),
                Cell(f"analysis: {one['method']}"),
                Cell(facts["analyses"][one["analysis"]]),
            ),
        )
        for one in facts["requirements"]
    ]
    head = ("requirement", "text", "bound", "worst result", "margin", "verdict", "method", "shown under")
    table = PageTable(
        columns=head, rows=tuple(rows), caption="Verification matrix", key="matrix", sentences=True
    )
    items: list[Item] = [table]
    if figures:
        try:
            items.append(
                picture(plot.figure_margins(facts["requirements"]), "Margins of all requirements", "margins")
            )
        except AntennaPinError:
            pass
    lead = (
        "Every number below is of the runs and computations named beside it; what they show is the model's "
        "behaviour. Whether the product complies is for its customer to judge.",
    )
    meaning = (
        "Margin: distance of the worst result to the nearer bound, negative beyond; of a probability, "
        "allowed failure probability less the upper end of its interval. Not shown: a point without a "
        "number, or an interval that holds the allowed probability.",
    )
    return Section(
        key="matrix", title="Verification matrix", lead=lead, items=tuple(items), meaning=meaning,
    )  # fmt: skip


def _worst(facts: Mapping[str, Any]) -> Section:
    rows = []
    for one in facts["requirements"]:
        rows.append(
            Row(
                one["requirement"],
                (
                    Cell(f"{point_text(one) or 'the nominal values'} ({one['shown_in']})"),
                    Cell(_value(one, one["nominal"])),
                    Cell(_value(one, one["result"])),
                    Cell(_kind_of_point(one)),
                    Cell(str(one["points"])),
                    Cell(_integrity(one["integrity"])),
                ),
            )
        )
    head = (
        "requirement",
        "worst case",
        "nominal",
        "worst",
        "where",
        "points",
        "integrity of that run",
    )
    table = PageTable(
        columns=head,
        rows=tuple(rows),
        caption="Worst cases found, and the runs that show them",
        key="worst",
        sentences=True,
    )
    meaning = (
        "Integrity: error of the energy balance over what the tolerance explains, and drifts of "
        "momentum likewise; a run beyond them is not taken as shown. Files are scenarios that run.",
    )
    return Section(key="worst", title="Worst cases", items=(table,), meaning=meaning)


def _kind_of_point(one: Mapping[str, Any]) -> str:
    if one.get("probability"):
        return "a sample"
    if not one["worst_case"]:
        return "nominal"
    return "inside the corners" if one["inside"] else "a corner"


def _integrity(books: Mapping[str, Any]) -> str:
    if not books.get("outcome"):
        return "no run: equations about the start"
    parts = [str(books["outcome"]).lower().replace("_", " ")]
    error, tolerance = books.get("energy_error"), books.get("energy_tolerance")
    if error is not None and tolerance is not None:
        parts.append(f"energy {readable(abs(error), 'J', 2)} of {readable(tolerance, 'J', 2)} explained")
    for which, unit in (("linear", "kg m/s"), ("angular", "kg m^2/s")):
        drift, allowed = books.get(f"{which}_momentum_drift"), books.get(f"{which}_momentum_tolerance")
        if drift is not None and allowed is not None:
            parts.append(f"{which} momentum {readable(abs(drift), unit, 2)} of {readable(allowed, unit, 2)}")
    return ", ".join(parts)


def _placed(runs: Sequence[ReportedRun], figures: bool, processes: int) -> dict[str, list[Picture]]:
    """Return the figures of the nominal run by analysis."""
    found: dict[str, list[Picture]] = {}
    for one in drawn(runs, processes) if figures and runs else ():
        begins = (key for begin, key in _FIGURES.items() if one.name.startswith(begin))
        key = next(begins, None)
        if key is not None:
            found.setdefault(key, []).extend(one.pictures)
    return {key: pictures[:_MOST_FIGURES] for key, pictures in found.items()}


def _analysis(
    facts: Mapping[str, Any],
    key: str,
    title: str,
    runs: Sequence[ReportedRun],
    placed: Mapping[str, Sequence[Picture]],
    loops: Sequence[Mapping[str, Any]],
    curves: Sequence[Mapping[str, Any]],
    figures: bool,
) -> Section:
    """Return the section of one analysis: its requirements, its figures, its tables."""
    mine = [one for one in facts["requirements"] if one["analysis"] == key]
    items: list[Item] = []
    notes: list[str] = []
    if mine:
        rows = [
            Row(
                one["requirement"],
                (
                    Cell(f"{one['meaning']}{', ' + one['of'] if one['of'] else ''}"),
                    Cell(_value(one, one["nominal"])),
                    Cell(_result(one)),
                    Cell(_bound(one)),
                    Cell(_VERDICTS[one["verdict"]]),
                ),
            )
            for one in mine
        ]
        head = ("requirement", "quantity", "nominal", "worst", "bound", "verdict")
        items.append(
            PageTable(
                columns=head,
                rows=tuple(rows),
                caption=f"{title}: requirements",
                key=f"of-{key}",
                sentences=True,
            )
        )
    for one in curves:
        if one["analysis"] == key:
            items += list(_curve(one, runs[0].run if runs else None, figures))
            notes += [str(note) for note in one.get("notes", ())]
            if "made_by" in one:
                notes.append(f"{one['title']}: {one['made_by']}")
    extra = {"shocks": _shocks, "disturbance": _interface}.get(key)
    if extra is not None and runs:
        for part in extra(mine, runs[0].run, figures):
            (notes if isinstance(part, str) else items).append(part)  # type: ignore[arg-type]
    if key == "control":
        items += list(_loops(loops, figures))
        notes += [f"Loop {one['controller']}: {one['made_by']}" for one in loops if "made_by" in one]
    items += placed.get(key, ())
    if key == "integrity" and runs:
        books = conservation(runs)
        items += books.items
    if key not in ("integrity",) and not mine and not items:
        return Section(key=key, title=title)
    return Section(key=key, title=title, items=tuple(items), notes=tuple(notes))


def _curve(one: Mapping[str, Any], run: Trajectory | None, figures: bool) -> Iterator[Item]:
    if "rows" in one:
        rows = tuple(Row(str(name), tuple(Cell(str(cell)) for cell in cells)) for name, *cells in one["rows"])
        yield PageTable(
            columns=tuple(one["head"]),
            rows=rows,
            caption=str(one["title"]),
            key=str(one["key"]),
            sentences=bool(one.get("sentences")),
        )
    if not figures:
        return
    key, caption = f"figure-of-{one['key']}", str(one.get("caption", ""))
    if "margin" in one:
        yield picture(plot.figure_margin(one["margin"]), caption, key)
    if "measured" in one:
        frequency, small, lines = one["measured"]
        yield picture(plot.figure_loop(frequency, small, lines), caption, key)
    if "orders" in one:
        yield picture(plot.figure_orders(one["orders"]), caption, key)
    if "chain" in one:
        yield picture(plot.figure_chain(*one["chain"]), caption, key)
    if "loop" in one:
        yield picture(plot.figure_torque_angle(one["loop"]), caption, key)
    if "stress" in one and run is not None and one["stress"].time.size:
        case = run.data.attrs.get("case") or "run"
        yield picture(plot.figure_contact_stress(one["stress"], case=case), caption, key)


def _shocks(mine: Sequence[Mapping[str, Any]], run: Trajectory, figures: bool) -> Iterator[Item | str]:
    """Yield shock response spectra of the signals that requirements bound."""
    for one in dict.fromkeys(each["of"] for each in mine if each["quantity"] == "shock"):
        try:
            signal = quantity(run, one)
            found = shock_spectrum(signal.time, signal.values, units=signal.units)
        except AntennaPinError as error:
            yield f"{one}: {error}."
            continue
        frequency, largest = found["frequency"].values, found["maximum"].values
        rows = tuple(
            Row(readable(float(f), "Hz"), (Cell(readable(float(a), signal.units), float(a)),))
            for f, a in zip(frequency[::12], largest[::12], strict=True)
        )
        yield PageTable(
            columns=("natural frequency", "largest acceleration"), rows=rows, key=f"shock-{_slug(one)}",
            caption=f"Shock response spectrum of {one}, Q = 10, nominal run, by octaves",
        )  # fmt: skip
        if figures:
            drawn_ = plot.figure_spectrum(
                frequency,
                {one: largest},
                f"largest acceleration [{printed_unit(signal.units)}]",
                "natural frequency [Hz]",
            )
            yield picture(drawn_, f"Shock response spectrum of {one}", f"srs-{_slug(one)}")


def _interface(mine: Sequence[Mapping[str, Any]], run: Trajectory, figures: bool) -> Iterator[Item | str]:
    """Yield the disturbance at the interface: six axes, root mean squares and densities."""
    try:
        loads = interface_loads(run)
        time = loads["time"].values
        densities: dict[str, Any] = {}
        rows = []
        for column, unit in (("force", "N"), ("moment", "N m")):
            values = loads[column].values
            found = [power_density(time, values[:, k], units=unit) for k in range(3)]
            densities[column] = (
                ("frequency", "axis"),
                np.stack([one["power"].values for one in found], axis=1),
            )
            for k, axis in enumerate("xyz"):
                peak = float(np.abs(values[:, k]).max())
                rms = float(np.sqrt(np.trapezoid(values[:, k] ** 2, time) / (time[-1] - time[0])))
                cells = (Cell(readable(peak, unit), peak), Cell(readable(rms, unit), rms))
                rows.append(Row(f"{column} {axis}", cells))
    except AntennaPinError as error:
        yield f"Interface: {error}."
        return
    yield PageTable(
        columns=("axis of the base", "largest", "root mean square"), rows=tuple(rows), key="interface",
        caption="Disturbance on the base, nominal run: six axes about the root link's frame",
    )  # fmt: skip
    if figures:
        import xarray as xr

        data = xr.Dataset(
            densities, coords={"frequency": found[0]["frequency"].values, "axis": ["x", "y", "z"]}
        )
        yield picture(
            plot.figure_interface(data),
            "Amplitude density of the disturbance on the base",
            "interface-density",
        )
    if not any(one["quantity"].startswith("order_") for one in mine):
        yield "Orders of a wheel over its speed: no requirement of order_coefficient in this file."


def _loops(loops: Sequence[Mapping[str, Any]], figures: bool) -> Iterator[Item]:
    if not loops:
        return
    rows = tuple(
        Row(
            str(one["controller"]),
            (
                Cell(number(one["gain_margin"], 3)),
                Cell(readable(float(np.degrees(one["phase_margin"])), "deg", 3)),
                Cell(readable(one["delay_margin"], "s", 3)),
                Cell(number(one["modulus_margin"], 3)),
                Cell(number(one["loop_damping"], 3)),
                Cell(readable(one["bandwidth"], "Hz", 3)),
            ),
        )
        for one in loops
    )
    head = (
        "loop",
        "gain margin [-]",
        "phase margin",
        "delay margin",
        "distance from −1 [-]",
        "least damping ratio [-]",
        "gain 1 at",
    )
    yield PageTable(
        columns=head, rows=rows, key="loops",
        caption="Sampled loops about the start, opened at the command; hold, delay and sampling are exact",
    )  # fmt: skip
    if figures:
        frequency = np.asarray(loops[0]["frequency"])
        same = {
            str(one["controller"]): np.asarray(one["response"])
            for one in loops
            if len(one["frequency"]) == len(frequency)
        }
        yield picture(plot.figure_loop(frequency, same), "Open sampled loops", "loop-response")


def _sensitivities(facts: Mapping[str, Any], figures: bool) -> Section:
    numbers = [one["name"] for one in facts["uncertain"]]
    if not numbers:
        return Section(key="sensitivities", title="Sensitivities")
    by = {(one["requirement"], one["number"]): one for one in facts["effects"]}
    largest = {one["requirement"]: one["largest"] for one in facts["budget"]}
    rows = []
    for one in facts["requirements"]:
        cells = [_change(one, by.get((one["requirement"], name))) for name in numbers]
        rows.append(Row(one["requirement"], (*cells, Cell(largest.get(one["requirement"], "") or _DASH))))
    table = PageTable(
        columns=("requirement", *numbers, "largest"), rows=tuple(rows), key="sensitivities",
        caption="Largest change of each quantity as one number goes to its limits, all others nominal",
    )  # fmt: skip
    items: list[Item] = [table]
    if figures:
        for one in facts["requirements"]:
            mine = [each for each in facts["effects"] if each["requirement"] == one["requirement"]]
            if not any(each["change"] for each in mine):
                continue
            shown = plot.figure_effects(mine, one["units"])
            key = f"effects-{_slug(one['requirement'])}"
            items.append(picture(shown, f"Effects on {one['requirement']}", key, one["requirement"]))
    ranges = PageTable(
        columns=("number", "key", "nominal", "limits", "distribution"),
        rows=tuple(_range(one) for one in facts["uncertain"]),
        caption="Uncertain numbers",
        key="uncertain",
        sentences=True,
    )
    return Section(key="sensitivities", title="Sensitivities", items=(*items, ranges))


def _change(requirement: Mapping[str, Any], one: Mapping[str, Any] | None) -> Cell:
    if one is None or one["change"] is None:
        return Cell(_DASH)
    return Cell(_value(requirement, one["change"], 3), one["change"])


def _range(one: Mapping[str, Any]) -> Row:
    note = f" ({one['note']})" if one["note"] else ""
    cells = (
        Cell(one["key"]),
        Cell(_text(one["nominal"], one["units"])),
        Cell(" to ".join((one["limits"][0], one["limits"][-1])) + note),
        Cell(one["distribution"]),
    )
    return Row(one["name"], cells)


def _budget(facts: Mapping[str, Any], curves: Sequence[Mapping[str, Any]], figures: bool) -> Section:
    of = {one["requirement"]: one for one in facts["requirements"]}
    rows = [
        Row(
            one["requirement"],
            (
                Cell(_value(of[one["requirement"]], one["sum"], 3), one["sum"]),
                Cell(_value(of[one["requirement"]], one["root_sum_square"], 3), one["root_sum_square"]),
                Cell(one["largest"] or _DASH),
                Cell(_value(of[one["requirement"]], one["largest_change"], 3), one["largest_change"]),
            ),
        )
        for one in facts["budget"]
    ]
    items: list[Item] = []
    meaning: tuple[str, ...] = ()
    if rows:
        head = ("requirement", "arithmetic sum", "root sum square", "largest contributor", "its change")
        caption = "Tolerance budget: changes of one number at a time, summed"
        items.append(PageTable(columns=head, rows=tuple(rows), caption=caption, key="budget"))
        meaning = ("Sums hold where effects add; the worst case above has all interactions.",)
    chains = [one for one in curves if one["analysis"] == "budget"]
    for one in chains:
        items += list(_curve(one, None, figures))
    notes = tuple(f"{one['title']}: {one['made_by']}" for one in chains)
    return Section(key="budget", title="Tolerance budget", items=tuple(items), meaning=meaning, notes=notes)


def _not_covered(facts: Mapping[str, Any]) -> Section:
    empty = [
        title
        for key, title in facts["analyses"].items()
        if key != "integrity" and not any(one["analysis"] == key for one in facts["requirements"])
    ]
    lead = ["No analysis here covers:"]
    rows = tuple(
        Row(subject.partition(":")[0], (Cell(subject.partition(":")[2].strip() or "not computed"),))
        for subject in facts["not_covered"]
    )
    table = PageTable(columns=("subject", "what is left out"), rows=rows, key="not-covered", sentences=True)
    notes = (f"Analyses without a requirement in this file: {', '.join(empty)}.",) if empty else ()
    return Section(key="not-covered", title="Not covered", lead=tuple(lead), items=(table,), notes=notes)


def _provenance(facts: Mapping[str, Any], file: Path | None) -> Section:
    versions = ", ".join(f"{name} {version}" for name, version in facts["versions"].items())
    case = f", case {facts['case']}" if facts["case"] else ""
    statements = [
        statement(
            "repeat this report", facts["command"] or "antenna-pin verify " + shlex.quote(facts["file"]), True
        ),
        statement("scenario", f"{facts['scenario']}{case}"),
        statement("requirements", facts["file"], True),
        statement("points evaluated", f"{facts['points']}, a line each in {facts['store']}/journal"),
        statement("all numbers", "verification.json, matrix.csv", True),
        statement(
            "tables of analyses", "analyses.json, each with the command or Python call that repeats it"
        ),
        statement("nominal scenario", "nominal.toml", True),
        statement("worst cases", "worst/REQUIREMENT.toml, each a scenario that antenna-pin run takes"),
        statement("identity of scenario, functions and versions", facts["digest"], True),
        statement("finished (UTC)", facts["finished"]),
        statement("versions", versions),
    ]
    if file is not None:
        statements.insert(3, statement("nominal run", str(file), True))
    return Section(key="provenance", title="Provenance", statements=tuple(statements))


def _slug(text: str) -> str:
    return "".join(letter if letter.isalnum() else "-" for letter in text.lower()).strip("-")
