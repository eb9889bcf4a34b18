"""``antenna-pin statics``: equilibria, torque over a travel, torque-angle loops."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import figure_target, load, say
from antenna_pin.apps.cli._export import csv_target, exported, plain, save_plot
from antenna_pin.apps.cli._options import flag, option, several
from antenna_pin.apps.cli._tables import formatted, print_rows
from antenna_pin.base.readable import bare, printed_unit, readable
from antenna_pin.errors import InvalidParameterError

if TYPE_CHECKING:
    from antenna_pin.studies.statics import Equilibrium, QuasiStaticTravel, TorqueAngleLoop

# Rows of a travel that are printed, at most.
_ROWS = 13


def statics(
    scenario: options.Scenario,
    case: options.Case = None,
    joint: Annotated[
        str | None, option("Joint (or drive) to move quasi-statically; equilibria if left out.", "JOINT")
    ] = None,
    start: Annotated[
        str | None, option("Start of the travel; the joint's lower limit if left out.", "POSITION")
    ] = None,
    stop: Annotated[
        str | None, option("End of the travel; the joint's upper limit if left out.", "POSITION")
    ] = None,
    count: Annotated[int, option("Number of positions of a travel.")] = 61,
    back: Annotated[bool, flag("--back/--out", "Move the joint back too, or out only.")] = True,
    loop: Annotated[
        str | None, option("Torque-angle loop of the joint instead of a travel, of this amplitude.", "TORQUE")
    ] = None,
    small_torque: Annotated[
        str | None, option("Torque of the lost motion; twice the friction if left out.", "TORQUE")
    ] = None,
    hold: Annotated[list[str] | None, several("Further joint that does not move.", "JOINT")] = None,
    starts: Annotated[int, option("Random poses from which equilibria are searched.")] = 16,
    settings: options.Set = None,
    plot: options.Plot = None,
    width: options.FigureWidth = options.Width.PAGE,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Find equilibria, or move a joint at vanishing rate: needed torque, stiffness, lost motion."""
    table, target = csv_target(csv), figure_target(plot, "statics", "--plot")
    needs = (("--start", start), ("--stop", stop), ("--loop", loop), ("--plot", plot))
    for name, value in needs:
        if value is not None and joint is None:
            raise InvalidParameterError("statics", name, "given with --joint JOINT", said=str(value))
    if loop is not None and (start is not None or stop is not None):
        rule = "left out with --start or --stop, a travel's; run the command twice"
        raise InvalidParameterError("statics", "--loop", rule, said=loop)
    if small_torque is not None and loop is None:
        raise InvalidParameterError(
            "statics", "--small-torque", "given with --loop TORQUE", said=small_torque
        )
    known = load(scenario, case, settings)
    from antenna_pin.studies import statics as of_mechanism

    quantities = {"start": start, "stop": stop, "loop": loop, "small_torque": small_torque}
    read: dict[str, Any] = {
        name: None if value is None else bare(value) for name, value in quantities.items()
    }
    found = of_mechanism.statics(known, joint, count=count, back=back, hold=hold or (), starts=starts, **read)
    title = ", ".join(filter(None, (known.title, known.case)))
    if found.loop is not None:
        if target is not None:
            from antenna_pin.show.plot import figure_torque_angle

            save_plot(figure_torque_angle(found.loop.data, width=width.value), target, as_json)
        if not exported(found.loop.to_dict(), _loop_rows(found.loop), as_json, table):
            _print_loop(title, found.loop)
    elif found.travel is not None:
        if target is not None:
            from antenna_pin.show.plot import figure_travel

            save_plot(figure_travel(found.travel.data, width=width.value), target, as_json)
        if not exported(found.travel.to_dict(), _travel_rows(found.travel), as_json, table):
            _print_travel(title, found.travel)
    else:
        every = list(found.equilibria)
        facts = {"title": known.title, "case": known.case, **found.to_dict()}
        if not exported(facts, [_row(k, one) for k, one in _numbered(every)], as_json, table):
            _print_equilibria(title, every)


def _numbered(every: list[Equilibrium]) -> list[tuple[str, Equilibrium]]:
    """Return equilibria and the ends of their sets, numbered."""
    rows: list[tuple[str, Equilibrium]] = []
    for k, one in enumerate(every, 1):
        rows.append((str(k), one))
        rows += [(f"{k} {end.friction}", end) for end in one.ends]
    return rows


def _row(number: str, one: Equilibrium) -> dict[str, Any]:
    row: dict[str, Any] = {"equilibrium": number, "friction": one.friction, "stability": one.stability}
    row |= {f"position {name} [{one.units[name]}]": value for name, value in one.positions.items()}
    row |= {f"effort {name}": value for name, value in one.efforts.items()}
    row["least stiffness [N m/rad]"] = float(one.stiffness[0]) if len(one.stiffness) else None
    row["residual [-]"] = one.residual
    return {name: plain(value) for name, value in row.items()}


def _print_equilibria(title: str, every: list[Equilibrium]) -> None:
    joints = list(every[0].positions)
    units = every[0].units
    head = ["equilibrium", "stability", *(f"{name} [{units[name]}]" for name in joints)]
    head.append("least stiffness [N m/rad]")
    scales = {"rad": 1.0, "m": every[0].length}
    rows = []
    for number, one in _numbered(every):
        least = formatted(float(one.stiffness[0]), ".5g") if len(one.stiffness) else "-"
        where = [formatted(one.positions[name], ".6g", scales[units[name]]) for name in joints]
        rows.append([number, one.stability, *where, least])
    print_rows(title, head, rows, numbers=False)
    for k, one in enumerate(every, 1):
        if one.contacts:
            largest = max(one.contacts, key=lambda contact: contact.force)
            say(
                f"{k}: {len(one.contacts)} contacts carry load, {largest.name} most: "
                f"{readable(largest.force, 'N')} at a depth of {readable(largest.depth, 'm')}"
            )
    if any(one.ends for one in every):
        say("forward, backward: ends of the sets that friction makes, at which all of it acts one way")


def _travel_rows(way: QuasiStaticTravel) -> list[dict[str, Any]]:
    """Return one row for each position, by names with units."""
    data = way.data
    unit, length = printed_unit(way.unit), "m" if way.sliding else "rad"
    rows = []
    for sense in data["sense"].values:
        one = data.sel(sense=sense)
        for k, place in enumerate(way.position):
            row: dict[str, Any] = {"sense": str(sense), f"position [{length}]": float(place)}
            row[f"torque [{unit}]"] = float(one["torque"].values[k])
            for s, source in enumerate(data["source"].values):
                row[f"{source} [{unit}]"] = float(one["component"].values[k, s])
            row["least stiffness [N m/rad]"] = float(one["stiffness"].values[k])
            row["residual [-]"] = float(one["residual"].values[k])
            rows.append({name: plain(value) for name, value in row.items()})
    return rows


def _print_travel(title: str, way: QuasiStaticTravel) -> None:
    data, length = way.data, "m" if way.sliding else "rad"
    unit = printed_unit(way.unit)
    senses = [str(one) for one in data["sense"].values]
    largest = max(float(abs(data[name].values).max(initial=0.0)) for name in ("torque", "component"))
    head = [f"{way.joint} [{length}]", *(f"needed, {sense} [{unit}]" for sense in senses)]
    step = max(1, -(-(len(way.position) - 1) // (_ROWS - 1)))
    rows = []
    for k in sorted({*range(0, len(way.position), step), len(way.position) - 1}):
        torques = [
            formatted(float(data["torque"].sel(sense=sense).values[k]), ".6g", largest) for sense in senses
        ]
        span = float(abs(way.position).max())
        rows.append([formatted(float(way.position[k]), ".6g", span), *torques])
    print_rows(title, head, rows)
    shares = []
    for source in data["source"].values:
        values = data["component"].sel(source=source, sense="out").values
        ends = (float(values.min()), float(values.max()))
        shares.append([str(source), *(formatted(one, ".5g", largest) for one in ends)])
    print_rows(
        "exerted along the motion on the way out", ["source", f"least [{unit}]", f"most [{unit}]"], shares
    )
    for note in way.notes:
        say(f"note: {note}")


def _loop_rows(cycle: TorqueAngleLoop) -> list[dict[str, Any]]:
    length, unit = ("m", "N") if cycle.sliding else ("rad", "N m")
    points = zip(cycle.cycle, cycle.angle, cycle.torque, strict=True)
    return [
        {"cycle": int(k), f"angle [{length}]": float(angle), f"torque [{unit}]": float(torque)}
        for k, angle, torque in points
    ]


def _print_loop(title: str, cycle: TorqueAngleLoop) -> None:
    from antenna_pin.studies.statics import DEFINITIONS

    length, unit = ("m", "N") if cycle.sliding else ("rad", "N m")
    units = {"stiffness": f"{unit}/{length}", "area": "J", "friction": unit}
    rows = [
        [name.replace("_", " "), readable(getattr(cycle, name), units.get(name, length)), words]
        for name, words in DEFINITIONS.items()
    ]
    head = ["measure", "value", "definition"]
    amplitude = readable(cycle.amplitude, unit)
    print_rows(f"{title}: {cycle.joint} under {amplitude} either way", head, rows, numbers=False)
    say(f"lost motion at {readable(cycle.small_torque, unit)}")
    for note in cycle.notes:
        say(f"note: {note}")
