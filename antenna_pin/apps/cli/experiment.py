"""``antenna-pin contact experiment``: the laws against the pin joint of Liu et al. (2013)."""

from __future__ import annotations

import dataclasses
import textwrap
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._export import csv_target, exported, figures_asked, save_figures
from antenna_pin.apps.cli._options import option
from antenna_pin.apps.cli._tables import Columns, formatted, length_text, print_columns, print_rows
from antenna_pin.apps.cli._usage import positive_quantity

if TYPE_CHECKING:
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
