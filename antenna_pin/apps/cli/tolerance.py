"""``antenna-pin tolerance``: fits, play over temperature, and chains of tolerances of a scenario."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import figure_target, load, say, stem
from antenna_pin.apps.cli._export import csv_target, exported, save_plot
from antenna_pin.apps.cli._options import option
from antenna_pin.apps.cli._tables import Columns, length_text, print_columns
from antenna_pin.base.rules import ABOVE_ZERO, Positive
from antenna_pin.errors import InvalidParameterError, UnknownNameError

if TYPE_CHECKING:
    from antenna_pin.scenario import Scenario

# Temperatures of the figure; a play is nearly a line over them.
_POINTS = 81


def tolerance(
    scenario: options.Scenario,
    case: options.Case = None,
    settings: options.Set = None,
    capability: Annotated[Positive, option("C_p of the processes that make holes and shafts.")] = 1.0,
    least_ratio: Annotated[
        Positive, option("Least play over its own tolerance (3: ECSS-E-ST-33-01C, 2009).")
    ] = 3.0,
    plot: Annotated[
        Path | None, option("Figure of the play over temperature: png, pdf or svg.", "FILE", "--plot")
    ] = None,
    chain: Annotated[
        str | None, option("Chain of [tolerances] that --plot draws instead.", "NAME", "--chain")
    ] = None,
    coldest: Annotated[str, option("Lowest temperature of the figure.", "TEMPERATURE")] = "-60 degC",
    hottest: Annotated[str, option("Highest temperature.", "TEMPERATURE")] = "100 degC",
    width: options.FigureWidth = options.Width.PAGE,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Compute fits, plays at temperature, and chains of tolerances.

    Worst case, root sum square and distribution; clearances over their own tolerance.
    """
    target, figure = csv_target(csv), figure_target(plot, "tolerance", "--plot")
    if figure is not None:
        low, high = _kelvin(coldest, "--coldest"), _kelvin(hottest, "--hottest")
        if not low < high:
            raise InvalidParameterError("tolerance", "--hottest", f"above --coldest = {coldest}", hottest)
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

        steps = [low + k * (high - low) / (_POINTS - 1) for k in range(_POINTS)]
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


_FITS: Columns = {
    "fit": lambda one: one["joint"],
    "": lambda one: one["fit"],
    "hole [um]": lambda one: f"{_micro(one['hole_lower'])} to {_micro(one['hole_upper'])}",
    "shaft [um]": lambda one: f"{_micro(one['shaft_lower'])} to {_micro(one['shaft_upper'])}",
    "least play": lambda one: length_text(one["least_play"]),
    "mean": lambda one: length_text(one["mean_play"]),
    "largest": lambda one: length_text(one["largest_play"]),
    "standard deviation": lambda one: length_text(one["standard_deviation"]),
}
_PLAYS: Columns = {
    "joint": lambda one: one["joint"],
    "radial play": lambda one: length_text(one["radial_play"]),
    "at the reference": lambda one: length_text(one["radial_play_at_reference"]),
    "axial play": lambda one: length_text(one["axial_play"]),
    "bearing": lambda one: _degrees(one["bearing_temperature"]),
    "journal": lambda one: _degrees(one["journal_temperature"]),
    "play gone at": lambda one: _degrees(one["closing_temperature"]),
}
_CHAINS: Columns = {
    "chain": lambda one: one["chain"],
    "nominal": lambda one: length_text(one["nominal"]),
    "mean": lambda one: length_text(one["mean"]),
    "worst case": lambda one: _span(one["worst_case_least"], one["worst_case_largest"]),
    "root sum square": lambda one: _span(one["root_sum_square_least"], one["root_sum_square_largest"]),
    "0.135 % to 99.865 %": lambda one: _span(one["quantile_0_00135"], one["quantile_0_99865"]),
    "standard deviation": lambda one: length_text(one["standard_deviation"]),
    "mean over tolerance": lambda one: f"{one['mean_over_tolerance']:.3g}",
    "below least": lambda one: _share(one["probability_below_least"]),
    "above most": lambda one: _share(one["probability_above_most"]),
}


def _print(
    label: str, joints: list[dict[str, Any]], chains: list[dict[str, Any]], least_ratio: float
) -> None:
    fits = [one for one in joints if "fit" in one]
    if fits:
        print_columns(f"{label}: fits, ISO 286; radial play at the temperatures of the parts", fits, _FITS)
        for one in fits:
            ratio = one["play_over_tolerance"]
            verdict = "at least" if ratio >= least_ratio else "less than"
            source = "required by ECSS-E-ST-33-01C (2009)" if least_ratio == 3.0 else "of --least-ratio"
            say(
                f"{one['joint']}: mean play {ratio:.3g} times its own tolerance, {verdict} the "
                f"{least_ratio:g} {source}"
            )
    if joints:
        print_columns(f"{label}: play at the temperatures of the parts", joints, _PLAYS)
    if chains:
        print_columns(f"{label}: chains of tolerances", chains, _CHAINS)
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
