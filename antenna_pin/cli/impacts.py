"""``antenna-pin impacts``: the impacts of a run one by one."""

from __future__ import annotations

from typing import Annotated

import typer

from antenna_pin.cli._common import complain, label_of, load_result, refuse, say
from antenna_pin.cli._export import CsvOption, JsonOption, csv_target, say_json, write_csv
from antenna_pin.cli._tables import print_rows, text_of
from antenna_pin.cli.analyse import JointOption, ResultArgument

_IMPACT = {
    "onset": "onset [s]",
    "duration": "duration [s]",
    "approach_speed": "approach speed [m/s]",
    "separation_speed": "separation speed [m/s]",
    "restitution": "restitution [-]",
    "peak_force": "peak force [N]",
    "peak_time": "time of peak [s]",
    "peak_depth": "peak depth [m]",
    "impulse": "impulse [N s]",
    "dissipated": "energy lost [J]",
}
_FLAGS = {"ended": "ended", "floored": "floored"}


def impacts(
    file: ResultArgument,
    joint: JointOption = None,
    strongest: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="List only the N impacts of largest force.")
    ] = None,
    as_json: JsonOption = False,
    csv: CsvOption = None,
) -> None:
    """List the impacts of a run, or export them.

    An impact is one contact's; those of the same surfaces that overlap, as at both ends of a bore that are
    met at once, are one blow of the joint, and bear its number.
    """
    target = csv_target(csv)
    run = load_result(file, scenario=False)
    if not run.data.sizes.get("clearance_joint", 0):
        refuse(f"{file}: the run has no joint with clearance and so no impacts; take a case that has one")

    import numpy as np

    from antenna_pin.analysis import impacts as table_of
    from antenna_pin.trajectory import blow_counts, surfaces

    table = table_of(run, joint)
    if strongest is not None:
        order = np.argsort(-table["peak_force"].values, kind="stable")[:strongest]
        table = table.isel(impact=np.sort(order))
    columns = [table[name].values for name in _IMPACT]
    flags = [table[name].values for name in _FLAGS]
    head = ("contact", "blow", *_IMPACT.values(), *_FLAGS.values())
    names = table["contact"].values, table["blow"].values
    if as_json:
        each = zip(*names, *columns, *flags, strict=True)
        keys = ("contact", "blow", *_IMPACT, *_FLAGS)
        found = [dict(zip(keys, values, strict=True)) for values in each]
        say_json({"file": str(file), "impacts": found})
    if target is None and not as_json:
        rows = [
            [
                str(contact),
                str(blow),
                *(text_of(float(x)) for x in row),
                *("yes" if x else "no" for x in marks),
            ]
            for contact, blow, row, marks in zip(
                *names, zip(*columns, strict=True), zip(*flags, strict=True), strict=True
            )
        ]
        if not rows:
            complain(f"{file}: no impacts")
            return
        narrow = [name.replace(" [", "\n[") for name in head]
        print_rows(f"{label_of(run, file)}: impacts", narrow, rows)
        for surface, count in blow_counts(run.data).items() if strongest is None else ():
            mine = surfaces(run.data)[run.data["episode_contact"].values] == surface
            if count and joint in (None, surface.rpartition(".")[0]):
                say(f"blows of {surface}: {count}, of {int(mine.sum())} contacts")
    if target is not None:
        write_csv(target, head, zip(*names, *columns, *flags, strict=True), silent=as_json)
