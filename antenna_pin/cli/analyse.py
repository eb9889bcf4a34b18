"""``antenna-pin analyse``: what a run shows, in tables."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.cli._common import label_of, load_result, say
from antenna_pin.cli._elastic import print_elastic
from antenna_pin.cli._export import CsvOption, JsonOption, csv_target, exported, parts_of
from antenna_pin.cli._loops import loops_of, print_loops
from antenna_pin.cli._records import plain_number, records
from antenna_pin.cli._tables import print_rows, text_of
from antenna_pin.cli._zeros import Zeros
from antenna_pin.errors import InvalidParameterError
from antenna_pin.numerals import bare

if TYPE_CHECKING:
    from antenna_pin.trajectory import Trajectory

ResultArgument = Annotated[Path, typer.Argument(metavar="FILE", help="Result file of a run.")]
JointOption = Annotated[str | None, typer.Option(help="Joint with clearance; all of them if left out.")]

# Rows of the table of contacts: where each entry comes from, and what it is called.
_ROWS = (
    ("loads", "episodes", "impacts"),
    ("blows", "blows", "blows of the joint, ends that meet at once being one"),
    ("impacts", "floored", "impacts below the law's floor of speed"),
    ("impacts", "touching", "still touching at the end"),
    ("impacts", "median_approach_speed", "median approach speed [m/s]"),
    ("impacts", "largest_approach_speed", "largest approach speed [m/s]"),
    ("impacts", "median_restitution", "median restitution delivered [-]"),
    ("impacts", "median_duration", "median duration [s]"),
    ("loads", "contact_share", "share of the time in contact [-]"),
    ("loads", "peak_force", "peak force [N]"),
    ("loads", "mean_force", "mean force [N]"),
    ("loads", "mean_force_in_contact", "mean force in contact [N]"),
    ("loads", "rms_force", "rms force [N]"),
    ("loads", "impulse", "impulse [N s]"),
    ("loads", "dissipated", "energy lost [J]"),
)
_PEAKS = 3
# What a CSV file has, one row for each number.
_PARTS = (
    "deviation",
    "impacts",
    "loads",
    "settling",
    "closures",
    "couplings",
    "drives",
    "elastic",
    "frequencies",
)


def analyse(
    file: ResultArgument,
    ideal: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Result of the ideal joint, to compare with.")
    ] = None,
    longest_gap: Annotated[
        str, typer.Option(help="Longest time apart that counts as lasting contact ('1 ms').")
    ] = "1 ms",
    as_json: JsonOption = False,
    csv: CsvOption = None,
) -> None:
    """Say what a run shows: deviation, impacts, loads, settling, closed loops, dominant frequencies."""
    from antenna_pin.units import quantity

    target = csv_target(csv)
    gap = quantity(bare(longest_gap), "s", "--longest-gap")
    run = load_result(file, scenario=False)
    found: dict[str, Any] = {"file": str(file), "case": run.data.attrs.get("case", "")}
    found["outcome"] = run.outcome.name
    zeros = Zeros([run])
    notes = [] if run.completed else [f"the run ended early: {run.message}"]
    if run.data.sizes["time"] < 2:
        notes.append("one sample: no deviation, no frequencies")
    if ideal is not None and run.data.sizes["time"] > 1:
        reference = load_result(ideal, scenario=False)
        zeros = Zeros([run, reference])
        found["deviation"] = _deviation(run, reference, notes, zeros)
    if run.data.sizes.get("clearance_joint", 0):
        found |= _contact(run, gap)
    else:
        notes.append("no joint with clearance: no impacts, loads and settling")
    if run.constraints:
        found |= loops_of(run)
    if "elastic_part" in run.data.sizes:
        found["elastic"] = _elastic(run)
    found["frequencies"] = _frequencies(run, notes)
    if exported({**found, "notes": notes}, parts_of(found, _PARTS), as_json, target):
        return
    _print(label_of(run, file), found, zeros)
    zeros.say()
    for note in notes:
        say(note)


def _deviation(
    run: Trajectory, reference: Trajectory, notes: list[str], zeros: Zeros
) -> list[dict[str, Any]]:
    from antenna_pin.analysis import deviation_measures

    ends = [float(one.data["time"].values[-1]) for one in (run, reference)]
    if ends[0] > ends[1]:
        notes.append(f"compared with the ideal run up to its end at {ends[1]:g} s")
    return [
        {
            "of": one.of,
            "units": one.units,
            "maximum": plain_number(one.maximum),
            "time_of_maximum": one.time_of_maximum,
            "rms": plain_number(one.rms),
            "end": plain_number(one.end),
            "growth": str(one.growth),
            "round_off": zeros.is_zero(one.maximum, one.units),
        }
        for one in deviation_measures(run, reference)
    ]


def _contact(run: Trajectory, longest_gap: float) -> dict[str, Any]:
    from antenna_pin.analysis import blow_statistics, impact_statistics, impacts, load_statistics, settling

    loads = load_statistics(run)
    joints = loads.drop_dims("contact").rename(
        {str(name): str(name).removeprefix("joint_") for name in loads if str(name).startswith("joint_")}
    )
    return {
        "impacts": records(impact_statistics(impacts(run)), "contact"),
        "blows": records(blow_statistics(run), "clearance_joint"),
        "loads": records(joints, "clearance_joint") + records(loads.drop_dims("clearance_joint"), "contact"),
        "settling": [
            {
                "joint": one.joint,
                "time": one.time,
                "note": one.note,
                "longest_gap": one.longest_gap,
                "share_before": plain_number(one.share_before),
                "share_after": plain_number(one.share_after),
                "decay_rate": plain_number(one.decay_rate),
                "decay_r2": plain_number(one.decay_r2),
                "decays": one.decays,
                "driven": one.driven,
            }
            for one in settling(run, longest_gap=longest_gap)
        ],
    }


def _elastic(run: Trajectory) -> list[dict[str, Any]]:
    from antenna_pin.analysis import elastic_motion, elastic_parts_of

    about = elastic_parts_of(run)
    return [
        {**one, "units": "m" if about[one["of"]]["slides"] else "rad"}
        for one in records(elastic_motion(run), "elastic_part")
    ]


def _frequencies(run: Trajectory, notes: list[str]) -> list[dict[str, Any]]:
    from antenna_pin.analysis import dominant_frequencies, scales_of, signals

    result: list[dict[str, Any]] = []
    found = signals(run)
    scales = scales_of(found.values())
    for name, one in found.items():
        try:
            peaks = dominant_frequencies(one.time, one.read, _PEAKS, scale=scales[one.units])
        except InvalidParameterError as error:
            notes.append(f"no frequencies: {error}")
            break
        result.append(
            {
                "of": name,
                "units": one.units,
                "resolution": float(peaks.attrs["resolution"]),
                "round_off": bool(peaks.attrs["round_off"]),
                "frequency": [float(x) for x in peaks["frequency"].values],
                "amplitude": [float(x) for x in peaks["amplitude"].values],
            }
        )
    return result


def _print(label: str, found: dict[str, Any], zeros: Zeros) -> None:
    """Print the tables of an analysis."""
    if "deviation" in found:
        rows = [
            [
                f"{one['of']} [{one['units']}]",
                *(text_of(one[key]) for key in ("maximum", "time_of_maximum", "rms", "end")),
                one["growth"],
            ]
            for one in found["deviation"]
            if not one["round_off"]
        ]
        head = ("", "maximum", "at [s]", "rms", "at the end", "growth")
        if rows:
            print_rows(f"{label}: deviation from the ideal run", head, rows)
        if still := [one["of"] for one in found["deviation"] if one["round_off"]]:
            typer.echo(f"deviation that is zero to round-off: {', '.join(still)}")
    if "loads" in found:
        _print_contacts(label, found, zeros)
        _print_settling(label, found["settling"])
    if "constraints" in found:
        print_loops(label, found, zeros)
    if "elastic" in found:
        print_elastic(label, found["elastic"])
    rows = [
        [
            f"{one['of']} [{one['units']}]",
            *(f"{f:.4g} ({a:.3g})" for f, a in zip(one["frequency"], one["amplitude"], strict=True)),
            *["-"] * (_PEAKS - len(one["frequency"])),
        ]
        for one in found["frequencies"]
        if one["frequency"]
    ]
    quiet = [one["of"] for one in found["frequencies"] if one["round_off"]]
    if len(found["frequencies"]) > len(quiet) and not rows:
        typer.echo("no frequency stands out")
    if rows:
        title = f"{label}: dominant frequencies [Hz] (amplitude), resolution"
        title += f" {found['frequencies'][0]['resolution']:.3g} Hz"
        print_rows(title, ("", "first", "second", "third"), rows)
    if quiet:
        typer.echo(f"nothing above round-off: {', '.join(quiet)}")


def _print_contacts(label: str, found: dict[str, Any], zeros: Zeros) -> None:
    """Print impacts and loads, one column per joint and contact."""
    columns = [str(one["of"]) for one in found["loads"]]
    entries = {kind: {one["of"]: one for one in found[kind]} for kind in ("impacts", "blows", "loads")}
    rows = [
        [text, *(zeros.text(entries[kind].get(column, {}).get(name), text) for column in columns)]
        for kind, name, text in _ROWS
    ]
    for percent in found["loads"][0]["force_percentile"]:
        forces = [entries["loads"][column]["force_percentile"][percent] for column in columns]
        name = f"force not exceeded for {percent} % of the time [N]"
        rows.append([name, *(zeros.text(force, name) for force in forces)])
    print_rows(f"{label}: impacts and load", ("", *columns), rows)


def _print_settling(label: str, found: Sequence[dict[str, Any]]) -> None:
    rows = [
        [
            f"apart for no more than {1e3 * found[0]['longest_gap']:g} ms from [s]",
            *(text_of(one["time"]) if one["time"] is not None else "never" for one in found),
        ]
    ]
    for name, text in (
        ("share_before", "share of the time in contact before [-]"),
        ("share_after", "share of the time in contact after [-]"),
        ("decay_rate", "decay of approach speeds [1/s]"),
        ("decay_r2", "R2 of an exponential decay [-]"),
    ):
        rows.append([text, *(text_of(one[name]) for one in found)])
        if name == "decay_rate":
            rows[-1][1:] = ["no decay" if one["decays"] is False else text_of(one[name]) for one in found]
    print_rows(f"{label}: settling into lasting contact", ("", *(one["joint"] for one in found)), rows)
    for one in found:
        if one["time"] is None:
            typer.echo(f"{one['joint']} does not settle: {one['note']}")
        elif one["driven"]:
            typer.echo(f"{one['joint']} is driven: it may part again after the run, as its load turns")
