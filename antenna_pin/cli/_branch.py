"""Branches of periodic solutions as a command has them: over what, from where to where, and what is told."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.base.numerals import bare
from antenna_pin.cli._common import say
from antenna_pin.cli._export import plain
from antenna_pin.cli._tables import print_rows
from antenna_pin.errors import InvalidParameterError

if TYPE_CHECKING:
    import xarray as xr

    from antenna_pin.scenario import Scenario

OverOption = Annotated[
    str | None,
    typer.Option(metavar="KEY", help="Follow the orbit over a key of the scenario, as in --set."),
]
ValuesOption = Annotated[
    str | None, typer.Option(metavar="FIRST:LAST", help="Range of --over, as '1 N*m:3 N*m'; given with it.")
]
AmplitudeOption = Annotated[
    list[str] | None,
    typer.Option(
        "--quantity",
        "-q",
        metavar="NAME",
        help="Whose amplitude over a period to note along --over. May be repeated.",
    ),
]
ArcOption = Annotated[
    float, typer.Option(help="First step along --over, in error scales and of the parameter's whole range.")
]
MostOrbitsOption = Annotated[int, typer.Option("--most", metavar="N", help="Orbits along --over at most.")]


def ends_of(text: str | None, over: str, known: Scenario) -> tuple[float, float, str]:
    """Return the ends of a range of a key, in SI units, and its unit ("" if none is said)."""
    from antenna_pin.base.units import any_quantity

    rule = "given with --over as FIRST:LAST, such as '1 N*m:3 N*m'"
    parts = [] if text is None else [bare(part.strip()) for part in text.split(":")]
    found = [any_quantity(part) for part in parts]
    if len(found) != 2 or None in found:
        raise InvalidParameterError("orbit", "--values", rule, said="nothing" if text is None else text)
    (first, one), (last, other) = (end for end in found if end is not None)
    if one and other and one != other:
        raise InvalidParameterError("orbit", "--values", "of one unit from first to last", text)
    for part in parts:
        known.with_overrides({over: part})  # says what is wrong with key or unit
    return first, last, one or other


def facts_of(branch: xr.Dataset) -> dict[str, Any]:
    """Return a branch as plain data."""
    facts: dict[str, Any] = plain(
        {
            "parameter": branch.attrs["parameter"],
            "message": branch.attrs["message"],
            "orbits": rows_of_branch(branch),
            "bifurcations": [
                {"kind": str(kind), "value": float(at), "doubt": float(doubt), "after": int(after)}
                for kind, at, doubt, after in zip(
                    *(branch[name].values for name in ("kind", "at", "at_doubt", "after")), strict=True
                )
            ],
        }
    )
    return facts


def rows_of_branch(branch: xr.Dataset) -> list[dict[str, Any]]:
    """Return a row for each orbit of a branch."""
    import numpy as np

    parts = (np.nan_to_num(branch[f"multiplier_{part}"].values) for part in ("real", "imaginary"))
    real, imaginary = (part if part.shape[1] else np.zeros((len(part), 1)) for part in parts)
    unit = branch["value"].attrs["units"]
    rows = []
    for k in range(branch.sizes["point"]):
        row = {
            f"{branch.attrs['parameter']} [{unit or 'SI'}]": float(branch["value"].values[k]),
            "stability": str(branch["stability"].values[k]),
            "period [s]": float(branch["period"].values[k]),
            "largest multiplier, real [-]": float(real[k, 0]),
            "largest multiplier, imaginary [-]": float(imaginary[k, 0]),
            "largest multiplier, size [-]": float(np.hypot(real[k, 0], imaginary[k, 0])),
            "doubt [-]": float(branch["doubt"].values[k]),
        }
        for q, name in enumerate(branch["quantity"].values if "quantity" in branch else ()):
            row[f"amplitude of {name} [{branch['amplitude_unit'].values[q]}]"] = float(
                branch["amplitude"].values[q, k]
            )
        rows.append(plain(row))
    return rows


def print_branch(branch: xr.Dataset) -> None:
    """Print where a branch is stable, and what happens to it."""
    from antenna_pin.analysis import said_of_multiplier, stability_spans, unexplained_changes
    from antenna_pin.base.readable import printed_unit

    unit = printed_unit(str(branch["value"].attrs["units"]))
    head = f"{branch.attrs['parameter']} [{unit}]" if unit else str(branch.attrs["parameter"])
    say(f"{branch.sizes['point']} orbits: {branch.attrs['message']}")
    rows = [
        [
            one.stability,
            f"{one.first:.6g}",
            f"{one.last:.6g}",
            str(one.orbits),
            said_of_multiplier(one.largest[1]),
        ]
        for one in stability_spans(branch)
    ]
    print_rows(f"Orbits over {head}", ["", "from", "to", "orbits", "largest multiplier"], rows)
    for before, behind in unexplained_changes(branch):
        say(f"between {before:.6g} and {behind:.6g} a multiplier passes 1; another branch may cross there")
    if not branch.sizes["bifurcation"]:
        say("no fold, branch point, flip, torus or graze between them")
        return
    parts = [branch[name].values for name in ("kind", "at", "at_doubt")]
    rows = [[str(kind), f"{at:.9g}", f"{doubt:.2g}"] for kind, at, doubt in zip(*parts, strict=True)]
    print_rows("What happens to them", ["", head, "known to"], rows)
