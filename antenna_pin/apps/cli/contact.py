r"""``antenna-pin contact``: the contact laws by name, their forces, what they deliver, and data.

Rooms are imported inside the commands, so ``--help`` does not wait for them. Errors leave here as exceptions;
:mod:`antenna_pin.apps.cli` turns them into one line and an exit code.
"""

from __future__ import annotations

import dataclasses
import math
import re
import textwrap
from collections.abc import Container
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._export import csv_target, exported, figures_asked, save_figures
from antenna_pin.apps.cli._options import argument, option
from antenna_pin.apps.cli._tables import (
    Columns,
    formatted,
    length_text,
    number_text,
    power_above,
    print_columns,
    print_rows,
)
from antenna_pin.apps.cli._usage import clearance_of, command_group, list_of, positive_quantity
from antenna_pin.base.readable import bare, number
from antenna_pin.errors import InvalidParameterError, UnknownNameError

if TYPE_CHECKING:
    from antenna_pin.analysis import ScenarioPair
    from antenna_pin.analysis.law_studies import ExperimentFindings, ExperimentFit


_FINDINGS = """
Reproduced: equation (6) gives ten rows of the Hertz column to the rounding of the table, with one modulus of
{modulus:.3f} GPa (206 GPa and a Poisson's ratio of {poisson:.4f}; 0.3 gives {excess:.2f} % more). Row
{misprint} does not fit: its load by (6) gives {mended:.3f}e-2 mm instead of the {printed:.3f}e-2 mm
printed, and with that its load by (14) fits too: a misprint, mended in the columns reproduced. Equation (14)
gives the conformal column with R_i R_j / play of {radii} mm for the three plays, that is with a bore of some
{bore:.2f} mm radius, but for {odd}, which are off by what stands beside them.

The pin cannot have such a radius: 3000 N would shear it off. So the column holds an unknown factor (a slip
of units, perhaps); (14) with a pin of {pin:g} mm radius gives {factor:.1f} times the column. Nor is (14) a
law of this joint: it is Hertz's for spheres, in N, held against loads per millimetre.

What fits: with nothing fitted and the length of the contact assumed, {best} has the smallest mean error of
those that reach every point, {best_mean:.1f} %; the paper's own (28) has {paper_mean:.1f} %, its two columns
{hertz_mean:.1f} % and {conformal_mean:.1f} %, as it says. (28'), here liu-2013-corrected, is (28) put right:
the displacement is that of two contacts in series, so half of it makes the width of one. By play it is
{small:.1f} %, {middle:.1f} % and {large:.1f} % off in the mean.

What the data cannot decide: which law is right. The joint with the largest play is the stiffest at low load,
against every law here, so a law that stiffens with depth and not with play is off by at least {least:.0f} %
in row {first} or row {second}. At 3000 N two plays have the same displacement, so one may be a copy. The
length of the contact and the radius of the pin are not given; a free length would move the errors by as much
as the laws differ, and so does taking the displacement for that of one contact or of two. Only the plays of
0.067 and 0.094 mm are fit to judge a law by.
"""


def experiment(
    journal_radius: Annotated[str, option("Radius of the pin; the paper gives none.")] = "5 mm",
    length: Annotated[str, option("Length of the contact; the paper takes 1 mm.")] = "1 mm",
    out: options.FigureFolder = None,
    formats: options.FigureFormats = "png",
    width: options.FigureWidth = options.Width.PAGE,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Compare the laws with the pin joint measured by Liu et al. (2013)."""
    from antenna_pin.analysis.law_studies import experiment_findings

    target = csv_target(csv)
    suffixes = figures_asked(out, formats)
    radius = positive_quantity(journal_radius, "m", "--journal-radius")
    line = positive_quantity(length, "m", "--length")
    found = experiment_findings(journal_radius=radius, length=line)
    if not exported(_facts(found), _fits(found), as_json, target):
        _print(found, radius, line)
    if out is not None:
        from antenna_pin.show.plot import figures_of_experiment

        save_figures(
            figures_of_experiment(journal_radius=radius, length=line, width=width.value), out, suffixes
        )


def _facts(findings: ExperimentFindings) -> dict[str, Any]:
    """Return the table, printed and reproduced, and each law's errors [m], [N], [-]."""
    from antenna_pin.analysis.law_studies import LIU_2013

    rows = [
        dataclasses.asdict(point)
        | {
            "hertz_reproduced": findings.table.hertz(row),
            "conformal_reproduced": findings.table.conformal(row),
        }
        for row, point in enumerate(LIU_2013)
    ]
    return {"journal_radius": findings.journal_radius, "rows": rows, "fits": _fits(findings)}


def _fits(findings: ExperimentFindings) -> list[dict[str, Any]]:
    """Return load and error of every law at every point."""
    from antenna_pin.analysis.law_studies import LIU_2013, ranked

    return [
        {"law": fit.law, "contacts": fit.contacts, "row": row + 1, "play": point.clearance}
        | {"displacement": point.depth, "measured": point.load, "load": load, "error": error}
        for fit in ranked((*findings.fits, *findings.printed))
        for row, (point, load, error) in enumerate(zip(LIU_2013, fit.loads, fit.errors, strict=True))
    ]


def _print(findings: ExperimentFindings, radius: float, line: float) -> None:
    """Print the table, the errors of the laws, and what follows."""
    from antenna_pin.analysis.law_studies import LIU_2013, LIU_2013_PLAYS, ranked

    rows: Columns = {
        "row": lambda row: str(row + 1),
        "play [mm]": lambda row: f"{1e3 * LIU_2013[row].clearance:.3f}",
        "displacement [1e-2 mm]": lambda row: f"{1e5 * LIU_2013[row].depth:.3f}",
        "measured": lambda row: f"{LIU_2013[row].load:.0f}",
        "Hertz": lambda row: f"{LIU_2013[row].hertz:.0f}",
        "by (6)": lambda row: f"{findings.table.hertz(row):.1f}",
        "conformal": lambda row: f"{LIU_2013[row].conformal:.0f}",
        "by (14)": lambda row: f"{findings.table.conformal(row):.1f}",
        "": lambda row: _remark(findings, row),
    }
    title = "Table 1 of Liu et al. 2013: loads [N], as printed and reproduced"
    print_columns(title, range(len(LIU_2013)), rows)
    plays = (f"play {1e3 * play:g} mm" for play in LIU_2013_PLAYS)
    print_rows(
        f"size of the errors [%], the displacement that of 1 contact or of 2 in series; pin radius"
        f" {length_text(radius)}, length {length_text(line)}",
        ("law", "contacts", *plays, "mean", "largest", "points"),
        [_errors(fit) for fit in ranked((*findings.fits, *findings.printed))],
    )
    for paragraph in _paragraphs(findings):
        typer.echo(textwrap.fill(paragraph, 110) + "\n")


def _remark(findings: ExperimentFindings, row: int) -> str:
    """Return the remark on a row of the table."""
    from antenna_pin.analysis.law_studies import LIU_2013

    if row in findings.table.misprinted:
        return f"misprint: {1e5 * findings.table.depths[row]:.3f}"
    if not findings.table.conformal_fits[row]:
        error = LIU_2013[row].conformal / findings.table.conformal(row) - 1.0
        return f"(14) off by {100.0 * error:+.1f} %"
    return ""


def _errors(fit: ExperimentFit) -> tuple[str, ...]:
    """Return a row of the table of errors."""
    from antenna_pin.analysis.law_studies import LIU_2013, LIU_2013_PLAYS

    sizes = (*map(fit.mean_of, LIU_2013_PLAYS), fit.mean, fit.largest)
    return (
        fit.law,
        "" if fit.contacts is None else str(fit.contacts),
        *(formatted(100.0 * size, ".1f") for size in sizes),
        f"{fit.in_range} of {len(LIU_2013)}",
    )


def _paragraphs(findings: ExperimentFindings) -> list[str]:
    """Return what fits and what the data cannot decide, in words."""
    from antenna_pin.analysis.law_studies import LIU_2013, LIU_2013_PLAYS

    table, corrected = findings.table, findings.fit("liu-2013-corrected")
    (misprint,) = table.misprinted
    odd = [str(row + 1) for row, fits in enumerate(table.conformal_fits) if not fits]
    small, middle, large = (100.0 * corrected.mean_of(play) for play in LIU_2013_PLAYS)
    values = {
        "modulus": 1e-9 * table.modulus,
        "poisson": findings.poisson,
        "excess": 100.0 * findings.modulus_excess,
        "misprint": misprint + 1,
        "mended": 1e5 * table.depths[misprint],
        "printed": 1e5 * LIU_2013[misprint].depth,
        "radii": ", ".join(f"{1e3 * radius:.2f}" for radius in table.radii),
        "bore": 1e3 * findings.bore_radius,
        "odd": "rows " + ", ".join(odd) if odd else "no row",
        "pin": 1e3 * findings.journal_radius,
        "factor": findings.conformal_factor,
        "best": findings.best.law,
        "best_mean": 100.0 * findings.best.mean,
        "paper_mean": 100.0 * findings.fit("liu-2013").mean,
        "small": small,
        "middle": middle,
        "large": large,
        "hertz_mean": 100.0 * findings.printed[0].mean,
        "conformal_mean": 100.0 * findings.printed[1].mean,
        "least": 100.0 * findings.least_error.error,
        "first": findings.least_error.first + 1,
        "second": findings.least_error.second + 1,
    }
    return [paragraph.format(**values) for paragraph in _FINDINGS.strip().split("\n\n")]


def scenarios(
    bearing_radius: Annotated[str, option("Radius of the bearing.")] = "10 mm",
    radial_clearance: Annotated[str, option("Bearing radius minus journal radius.")] = "0.2 mm",
    bearing_length: Annotated[str, option("Length of the bearing.")] = "50 mm",
    axial_clearance: Annotated[
        str, option("Half the difference of the flanges' distance and the bearing's length.")
    ] = "0.2 mm",
    bearing_outer_radius: Annotated[str, option("Outer radius of the bearing.")] = "12 mm",
    flange_radius: Annotated[str, option("Radius of the journal's flanges.")] = "14 mm",
    penetration: Annotated[str, option("Largest depth at any contact; 0 for rigid parts.")] = "0 mm",
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """List the 16 contact scenarios and which of them a joint's shape allows."""
    from antenna_pin.analysis import SCENARIO_COLUMNS, possible_scenarios, scenario_rows
    from antenna_pin.base.units import quantity
    from antenna_pin.joints.geometry import RevoluteClearance

    target = csv_target(csv)
    radius = positive_quantity(bearing_radius, "m", "--bearing-radius")
    length = positive_quantity(bearing_length, "m", "--bearing-length")
    clearance = clearance_of(radial_clearance, radius, "contact scenarios")
    shape = RevoluteClearance(
        bearing_radius=radius,
        journal_radius=radius - clearance,
        bearing_length=length,
        flange_distance=length + 2.0 * positive_quantity(axial_clearance, "m", "--axial-clearance"),
        bearing_outer_radius=positive_quantity(bearing_outer_radius, "m", "--bearing-outer-radius"),
        flange_radius=positive_quantity(flange_radius, "m", "--flange-radius"),
    )
    depth = quantity(bare(penetration), "m", "--penetration")
    pairs = possible_scenarios(shape, depth)
    found = [_pair(pair) for pair in pairs]
    if exported({"penetration": depth, "scenarios": found}, found, as_json, target):
        return
    parts = f"parts that penetrate by up to {length_text(depth)}" if depth > 0.0 else "rigid parts"
    print_rows(f"contact scenarios of {parts}", SCENARIO_COLUMNS, scenario_rows(pairs), numbers=False)
    typer.echo(f"{sum(pair.possible for pair in pairs)} of {len(pairs)} are possible")


def _pair(pair: ScenarioPair) -> dict[str, Any]:
    """Return a pair of scenarios in plain values [m], [rad]."""
    names = {"radial": pair.radial.name.lower(), "axial": pair.axial.name.lower(), "possible": pair.possible}
    low, high = (pair.tilts.low, pair.tilts.high) if pair.possible else (None, None)
    centre, axis = (None, None) if pair.pose is None else (each.tolist() for each in pair.pose)
    pose = {"least_tilt": low, "largest_tilt": high, "centre": centre, "axis": axis}
    return names | pose | {"reason": pair.reason}


app = command_group("contact", "Contact laws: by name, side by side, certified, and against measurements.")


# --- list ---


def list_laws(as_json: options.Json = False, csv: options.Csv = None) -> None:
    """List the laws of every family, their parameters with units, and known materials."""
    from antenna_pin.contact import (
        DISSIPATIONS,
        FRICTION_LAWS,
        MATERIALS,
        NORMAL_LAWS,
        is_elastic,
        law_parameters,
    )

    target = csv_target(csv)
    families = {
        title: {name: law for name, law in NORMAL_LAWS.items() if is_elastic(name) == elastic}
        for title, elastic in (
            ("elastic laws: can be combined with any dissipation", True),
            ("complete laws: include their authors' dissipation", False),
        )
    } | {
        "dissipations: combined with an elastic law": DISSIPATIONS,
        "friction laws": FRICTION_LAWS,
    }
    found = [
        {"family": title.split(":")[0], "law": name, "what_it_is": _first_line(law), "parameter": parameter}
        | {"unit": about.unit, "default": about.default, "from_joint": about.from_joint}
        for title, laws in families.items()
        for name, law in laws.items()
        for parameter, about in law_parameters(law).items()
    ]
    materials: list[dict[str, Any]] = [
        {"material": name, "young": one.young, "poisson": one.poisson, "density": one.density}
        | {"source": one.source}
        for name, one in MATERIALS.items()
    ]
    if exported({"parameters": found, "materials": materials}, found, as_json, target):
        return
    for title, laws in families.items():
        rows = [(name, _first_line(law), _parameters(law)) for name, law in laws.items()]
        print_rows(title, ("name", "what it is", "parameters"), rows, numbers=False)
    typer.echo(
        "* follows from the joint where a scenario leaves it out: dimensions, materials, effective mass"
    )
    columns = ("name", "young [Pa]", "poisson [-]", "density [kg/m^3]", "source")
    print_rows(
        "materials: known without a table",
        columns,
        [[value if isinstance(value, str) else number(value) for value in one.values()] for one in materials],
        numbers=False,
    )


def _parameters(law: type[Any]) -> str:
    """Return the parameters of a law with units and defaults, on one line."""
    from antenna_pin.contact import law_parameters

    texts = []
    for name, parameter in law_parameters(law).items():
        unit = "-" if parameter.unit == "1" else parameter.unit.replace("**", "^").replace("*", " ")
        star = "*" if parameter.from_joint else ""
        default = "" if parameter.default is None else f" = {parameter.default:g}"
        texts.append(f"{name}{star}{default} [{unit}]")
    return ", ".join(texts) or "none"


# What the formulas of docstrings are made of, as text.
_SYMBOLS = (
    (r"\\[td]?frac\{([^{}]*)\}\{([^{}]*)\}", r"(\1)/(\2)"),
    (r"\\[td]?frac\\(\w+?)(\d)", r"\\\1/\2 "),
    (r"\\[td]?frac(\d)(\d)", r"\1/\2 "),
    (r"\\dot\s*\\delta", "rate"),
    (r"\\delta", "depth"),
    (r"\\sqrt\s*(\w+)", r"sqrt(\1)"),
    (r"\\pi", "pi"),
    (r"\\chi", "chi"),
    (r"\\(max|exp|min|ln)\b", r"\1"),
    (r"\\,|~", " "),
    (r"\^\*", "*"),
    (r"[{}\\]", ""),
    (r"\s+", " "),
)


def _first_line(law: type[Any]) -> str:
    """Return the first line of a law's docstring, formulas as plain text."""

    def plain(match: re.Match[str]) -> str:
        text = match.group(1)
        for pattern, by in _SYMBOLS:
            text = re.sub(pattern, by, text)
        return text.strip()

    line = re.sub(r":math:`(.*?)`", plain, (law.__doc__ or "").strip().split("\n\n")[0])
    return re.sub(r":\w+:`[~.]?(?:\w+\.)*(\w+)`", r"\1", " ".join(line.replace("``", "").split()))


def _chosen(
    command: str,
    names: list[str],
    fitting: list[str],
    words: tuple[str, str, str],
    every: Container[str],
) -> list[str]:
    """Return the selected laws, each once, or refuse an unsuitable or unknown one.

    ``words``: noun of the laws, name of the parameter, rule for a suitable one; ``every``: names of all laws.
    """
    what, parameter, rule = words
    for name in names:
        if name not in fitting:
            if name in every:
                raise InvalidParameterError(command, parameter, rule, name)
            raise UnknownNameError(command, what, name, fitting)
    return list(dict.fromkeys(names))


# --- curve ---


def curve(
    laws: Annotated[list[str] | None, argument("Elastic laws; all if left out.", "[LAWS]...")] = None,
    bearing_radius: Annotated[str, option("Radius of the bearing.")] = "10 mm",
    radial_clearance: Annotated[str, option("Bearing radius minus journal radius.")] = "0.2 mm",
    length: Annotated[str, option("Length of the line of contact.")] = "50 mm",
    material: Annotated[str, option("Material of bearing and journal.")] = "steel",
    depths: Annotated[
        str, option("Depths of the table; one unit at the end counts for all.", "LIST")
    ] = "0.1, 1, 5, 20 um",
    out: options.FigureFolder = None,
    formats: options.FigureFormats = "png",
    width: options.FigureWidth = options.Width.PAGE,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Compare the forces of the elastic laws of one joint at the same depth."""
    from antenna_pin.analysis.law_studies import (
        differing_factor,
        elastic_laws_of_joint,
        force_table,
        laws_left_out,
    )
    from antenna_pin.contact import MATERIALS, NORMAL_LAWS, is_elastic

    target = csv_target(csv)
    suffixes = figures_asked(out, formats)
    radius = positive_quantity(bearing_radius, "m", "--bearing-radius")
    clearance = clearance_of(radial_clearance, radius, "contact curve")
    if material not in MATERIALS:
        raise UnknownNameError("contact curve", "material", material, MATERIALS)
    points = list_of(depths, "m", "--depths")
    elastic = [name for name in NORMAL_LAWS if is_elastic(name)]
    rule = f"an elastic one of {', '.join(elastic)}; this one has a dissipation"
    wanted = _chosen("contact curve", laws or elastic, elastic, ("elastic law", "law", rule), NORMAL_LAWS)
    joint: dict[str, Any] = {
        "bearing_radius": radius,
        "journal_radius": radius - clearance,
        "length": positive_quantity(length, "m", "--length"),
        "bearing": MATERIALS[material],
        "journal": MATERIALS[material],
    }
    left_out = {name: why for name, why in laws_left_out(**joint).items() if name in wanted}
    if laws and left_out:
        raise next(iter(left_out.values()))
    holding = elastic_laws_of_joint(**joint)
    chosen = {name: holding[name] for name in wanted if name in holding}
    table = force_table(chosen, points)
    limits = {name: law.depth_limit for name, law in chosen.items()}
    found = [
        {"law": name, "depth": depth, "force": force, "depth_limit": limits[name]}
        for name, forces in table.items()
        for depth, force in zip(points, forces, strict=True)
    ]
    said = {"forces": found, "left_out": {name: str(reason) for name, reason in left_out.items()}}
    if not exported(said, found, as_json, target):
        rows = [
            (
                name,
                *map(number_text, forces),
                length_text(limits[name]) if math.isfinite(limits[name]) else "none",
            )
            for name, forces in table.items()
        ]
        print_rows("force [N]", ("law", *(f"at {length_text(d)}" for d in points), "depth limit"), rows)
        for depth, forces in zip(points, zip(*table.values(), strict=True), strict=True):
            if (factor := differing_factor(forces)) is not None:
                typer.echo(f"at {length_text(depth)} the laws differ by {factor:.3g} times")
        for name, reason in left_out.items():
            typer.echo(f"left out: {name} ({reason})")
    if out is not None:
        from antenna_pin.show.plot import figure_force_curves

        figure = figure_force_curves(chosen, depths=points, width=width.value)
        save_figures({"force_curves": figure}, out, suffixes)


# --- restitution ---


def restitution(
    dissipations: Annotated[
        list[str] | None,
        argument("Dissipations that take a restitution; all if left out.", "[DISSIPATIONS]..."),
    ] = None,
    asked: Annotated[
        str, option("Restitutions, separated by commas.", "LIST")
    ] = "0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 1",
    mass: Annotated[str, option("Effective mass.")] = "1 kg",
    speed: Annotated[str, option("Approach speed.")] = "0.1 m/s",
    simulate: Annotated[bool, option("Also integrate impacts, to compare with the closed forms.")] = True,
    out: options.FigureFolder = None,
    formats: options.FigureFormats = "png",
    width: options.FigureWidth = options.Width.PAGE,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Certify dissipations: the restitution each delivers, in closed form and in integrated impacts.

    The contact is Hertz's, of 1e10 N/m^1.5: one mass on a wall, and a pair of free bodies. Dissipations that
    refuse a restitution of 0 are left out there.
    """
    from antenna_pin.analysis.law_studies import largest_errors, restitution_table
    from antenna_pin.base.arguments import check_number
    from antenna_pin.contact import DISSIPATIONS, law_parameters

    target = csv_target(csv)
    suffixes = figures_asked(out, formats)
    values = list_of(asked, "1", "--asked", positive=False)
    for value in values:
        check_number("contact restitution", "--asked", value, "in [0, 1]")
    taking = [name for name, law in DISSIPATIONS.items() if "restitution" in law_parameters(law)]
    words = ("dissipation", "dissipation", f"one that takes a restitution: {', '.join(taking)}")
    chosen = _chosen("contact restitution", dissipations or taking, taking, words, DISSIPATIONS)
    impact = {
        "mass": positive_quantity(mass, "kg", "--mass"),
        "speed": positive_quantity(speed, "m/s", "--speed"),
    }
    rows = restitution_table(chosen, values, simulate=simulate, **impact)
    found = [dataclasses.asdict(row) for row in rows]
    if not exported({"restitution": found}, found, as_json, target):
        names = ("dissipation", "asked", "closed form", "wall", "free pair")
        lines = [
            (
                row.dissipation,
                f"{row.asked:g}",
                *(formatted(value, ".7f") for value in (row.closed_form, row.on_wall, row.of_pair)),
                *(length_text(value, 7) for value in (row.closed_form_depth, row.depth_on_wall)),
            )
            for row in rows
        ]
        print_rows("restitution [-] and peak depth", (*names, "depth, closed form", "depth, wall"), lines)
        if simulate:
            off, deeper = largest_errors(rows)
            typer.echo(
                "closed form against integrated impacts, largest errors:"
                f" {power_above(off)} in restitution, {power_above(deeper)} of the peak depth"
            )
    if out is not None:
        from antenna_pin.show.plot import figure_restitution

        fine = [0.005 + 0.995 * k / 199 for k in range(200)]
        smooth = restitution_table(chosen, fine, simulate=False, **impact)
        save_figures(
            {"restitution": figure_restitution(rows, closed_form=smooth, width=width.value)}, out, suffixes
        )


# In the order in which --help shows them.
app.command("list")(list_laws)
for _command in (curve, restitution, experiment, scenarios):
    app.command()(_command)
