"""``antenna-pin tolerance``: fits, play over temperature, and chains of tolerances of a scenario."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.apps.cli._common import (
    CaseOption,
    ScenarioArgument,
    SetOption,
    Width,
    WidthOption,
    figure_target,
    load,
    say,
    stem,
)
from antenna_pin.apps.cli._export import CsvOption, JsonOption, csv_target, exported, save_plot
from antenna_pin.apps.cli._tables import length_text, print_rows
from antenna_pin.base.rules import ABOVE_ZERO, Positive
from antenna_pin.errors import InvalidParameterError, UnknownNameError

if TYPE_CHECKING:
    from antenna_pin.scenario import Scenario

# Temperatures of the figure; a play is nearly a line over them.
_POINTS = 81


def tolerance(
    scenario: ScenarioArgument,
    case: CaseOption = None,
    settings: SetOption = None,
    capability: Annotated[
        Positive, typer.Option(help="C_p of the processes that make holes and shafts.")
    ] = 1.0,
    least_ratio: Annotated[
        Positive, typer.Option(help="Least play over its own tolerance (3: ECSS-E-ST-33-01C, 2009).")
    ] = 3.0,
    plot: Annotated[
        Path | None,
        typer.Option("--plot", metavar="FILE", help="Figure of the play over temperature: png, pdf or svg."),
    ] = None,
    chain: Annotated[
        str | None,
        typer.Option("--chain", metavar="NAME", help="Chain of [tolerances] that --plot draws instead."),
    ] = None,
    coldest: Annotated[
        str, typer.Option(metavar="TEMPERATURE", help="Lowest temperature of the figure.")
    ] = "-60 degC",
    hottest: Annotated[str, typer.Option(metavar="TEMPERATURE", help="Highest temperature.")] = "100 degC",
    width: WidthOption = Width.PAGE,
    as_json: JsonOption = False,
    csv: CsvOption = None,
) -> None:
    """Compute fits, plays at temperature, and chains of tolerances.

    Worst case, root sum square and distribution; clearances over their own tolerance.
    """
    target, figure = csv_target(csv), figure_target(plot, "tolerance", "--plot")
    loaded = load(scenario, case, settings)
    if chain is not None and chain not in loaded.tolerances:
        raise UnknownNameError("tolerance", "chain", chain, loaded.tolerances)
    if chain is not None and figure is None:
        raise InvalidParameterError("tolerance", "--plot", "given with --chain, which it draws", said="none")
    joints, chains = _joints(loaded, capability), _chains(loaded)
    facts = {
        "scenario": loaded.name,
        "case": loaded.case,
        "least_ratio": least_ratio,
        "joints": joints,
        "chains": chains,
    }
    if not exported(
        facts,
        [*joints, *({k: v for k, v in one.items() if k != "shares"} for one in chains)],
        as_json,
        target,
    ):
        _print(stem(loaded), joints, chains, least_ratio)
    if figure is not None and chain is not None:
        from antenna_pin.scenario.assemble import tolerance_chain
        from antenna_pin.show.plot import figure_chain

        bounds = loaded.tolerances[chain]
        found = tolerance_chain(loaded, chain)
        save_plot(figure_chain(found, bounds.least, bounds.most, width=width.value), figure, as_json)
    elif figure is not None:
        from antenna_pin.scenario.assemble import play_over_temperature
        from antenna_pin.show.plot import figure_play_over_temperature

        ends = (_kelvin(coldest, "--coldest"), _kelvin(hottest, "--hottest"))
        if not ends[0] < ends[1]:
            raise InvalidParameterError("tolerance", "--hottest", f"above --coldest = {coldest}", hottest)
        steps = [ends[0] + k * (ends[1] - ends[0]) / (_POINTS - 1) for k in range(_POINTS)]
        plays = {one["joint"]: play_over_temperature(loaded, one["joint"], steps) for one in joints}
        save_plot(figure_play_over_temperature(plays, width=width.value), figure, as_json)


def _joints(scenario: Scenario, capability: float) -> list[dict[str, Any]]:
    """Return numbers of each joint with play, in SI units."""
    from antenna_pin.scenario import TouchingSpec
    from antenna_pin.scenario.assemble import closing_temperature, joint_play

    found = []
    for name, table in scenario.clearance.items():
        if not isinstance(table, TouchingSpec):
            continue
        play, fit = joint_play(scenario, name), table.limits_of_fit
        grown = play.radial - play.reference
        row: dict[str, Any] = {
            "joint": name,
            "radial_play": play.radial,
            "radial_play_at_reference": play.reference,
            "axial_play": play.axial,
            "bearing_temperature": play.bearing_temperature,
            "journal_temperature": play.journal_temperature,
            "closing_temperature": closing_temperature(scenario, name),
        }
        if fit is not None:
            row |= {
                "fit": fit.name,
                "hole_lower": fit.hole.lower,
                "hole_upper": fit.hole.upper,
                "shaft_lower": fit.shaft.lower,
                "shaft_upper": fit.shaft.upper,
                "least_play": fit.least + grown,
                "mean_play": fit.mean + grown,
                "largest_play": fit.largest + grown,
                "standard_deviation": fit.sigma(capability),
                "play_over_tolerance": (fit.mean + grown) / fit.tolerance,
            }
        found.append(row)
    return found


def _chains(scenario: Scenario) -> list[dict[str, Any]]:
    """Return numbers of each chain, in SI units."""
    from antenna_pin.scenario.assemble import tolerance_chain

    found = []
    for name, spec in scenario.tolerances.items():
        chain = tolerance_chain(scenario, name)
        low, high = chain.worst_case
        rss = chain.root_sum_square
        row: dict[str, Any] = {
            "chain": name,
            "nominal": chain.nominal,
            "mean": chain.mean,
            "worst_case_least": low,
            "worst_case_largest": high,
            "root_sum_square_least": rss[0],
            "root_sum_square_largest": rss[1],
            "standard_deviation": chain.sigma,
            "mean_over_tolerance": chain.tolerance_ratio,
            "quantile_0_00135": chain.quantile(0.00135),
            "quantile_0_99865": chain.quantile(0.99865),
            "least": spec.least,
            "most": spec.most,
            "probability_below_least": None if spec.least is None else chain.probability_below(spec.least),
            "probability_above_most": None if spec.most is None else 1.0 - chain.probability_below(spec.most),
            "shares": chain.shares,
        }
        found.append(row)
    return found


def _print(
    label: str, joints: list[dict[str, Any]], chains: list[dict[str, Any]], least_ratio: float
) -> None:
    fits = [one for one in joints if "fit" in one]
    if fits:
        head = ["fit", "", "hole [um]", "shaft [um]", "least play", "mean", "largest", "standard deviation"]
        rows = [
            [
                one["joint"],
                one["fit"],
                f"{_micro(one['hole_lower'])} to {_micro(one['hole_upper'])}",
                f"{_micro(one['shaft_lower'])} to {_micro(one['shaft_upper'])}",
                *(length_text(one[key]) for key in ("least_play", "mean_play", "largest_play")),
                length_text(one["standard_deviation"]),
            ]
            for one in fits
        ]
        print_rows(f"{label}: fits, ISO 286; radial play at the temperatures of the parts", head, rows)
        for one in fits:
            ratio = one["play_over_tolerance"]
            verdict = "at least" if ratio >= least_ratio else "less than"
            source = "required by ECSS-E-ST-33-01C (2009)" if least_ratio == 3.0 else "of --least-ratio"
            say(
                f"{one['joint']}: mean play {ratio:.3g} times its own tolerance, {verdict} the "
                f"{least_ratio:g} {source}"
            )
    if joints:
        head = [
            "joint",
            "radial play",
            "at the reference",
            "axial play",
            "bearing",
            "journal",
            "play gone at",
        ]
        rows = [
            [
                one["joint"],
                length_text(one["radial_play"]),
                length_text(one["radial_play_at_reference"]),
                length_text(one["axial_play"]),
                _degrees(one["bearing_temperature"]),
                _degrees(one["journal_temperature"]),
                _degrees(one["closing_temperature"]),
            ]
            for one in joints
        ]
        print_rows(f"{label}: play at the temperatures of the parts", head, rows)
    if chains:
        head = ["chain", "nominal", "mean", "worst case", "root sum square", "0.135 % to 99.865 %"]
        head += ["standard deviation", "mean over tolerance", "below least", "above most"]
        rows = [
            [
                one["chain"],
                length_text(one["nominal"]),
                length_text(one["mean"]),
                _span(one["worst_case_least"], one["worst_case_largest"]),
                _span(one["root_sum_square_least"], one["root_sum_square_largest"]),
                _span(one["quantile_0_00135"], one["quantile_0_99865"]),
                length_text(one["standard_deviation"]),
                f"{one['mean_over_tolerance']:.3g}",
                _share(one["probability_below_least"]),
                _share(one["probability_above_most"]),
            ]
            for one in chains
        ]
        print_rows(f"{label}: chains of tolerances", head, rows)
        for one in chains:
            shares = sorted(one["shares"].items(), key=lambda item: -item[1])
            parts = ", ".join(f"{name} {100.0 * share:.3g} %" for name, share in shares)
            say(f"{one['chain']}: shares in the variance: {parts}")
    if not joints and not chains:
        say(f"{label}: no joint with play and no [tolerances.NAME]")


def _micro(value: float) -> str:
    return f"{1e6 * value:+.4g}" if value else "0"


def _span(low: float, high: float) -> str:
    return f"{length_text(low)} to {length_text(high)}"


def _share(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"


def _degrees(value: float) -> str:
    return f"{value - 273.15:.4g} degC" if math.isfinite(value) else "-"


def _kelvin(text: str, option: str) -> float:
    from antenna_pin.base.units import QuantityError, quantity

    try:
        found = quantity(text, "K", option)
    except QuantityError as error:
        rule, _, said = error.reason.removeprefix("must be ").partition(", got ")
        raise InvalidParameterError("tolerance", option, rule, said=said) from None
    if not found > 0.0:
        raise InvalidParameterError("tolerance", option, ABOVE_ZERO, text)
    return found
