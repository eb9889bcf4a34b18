r"""Command line ``antenna-pin contact``: the contact laws by name, their forces, what they deliver, and data.

Rooms are imported inside the commands, so ``--help`` does not wait for them. Errors leave here as exceptions;
:mod:`antenna_pin.cli` turns them into one line and an exit code.
"""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from antenna_pin.cli._tables import print_rows
from antenna_pin.errors import InvalidParameterError, OutputError, UnknownNameError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from antenna_pin.contact import ElasticLaw, ExperimentFit, Material

__all__ = ["app"]

app = typer.Typer(
    name="contact",
    help="Contact laws: by name, side by side, certified, and against measurements.",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode=None,
)


class FigureWidth(StrEnum):
    """Widths of figures."""

    COLUMN = "column"
    PAGE = "page"


OutOption = Annotated[
    Path | None, typer.Option(metavar="DIR", help="Folder for figures, made if missing; none if left out.")
]
FormatOption = Annotated[
    str, typer.Option("--format", metavar="LIST", help="Any of png, pdf, svg, separated by commas.")
]
WidthOption = Annotated[FigureWidth, typer.Option(help="Width of the figures: 88 mm or 180 mm.")]


# --- list ---


@app.command("list")
def list_laws() -> None:
    """List the laws of every family: what each is, its parameters with units."""
    from antenna_pin.contact import DISSIPATIONS, FRICTION_LAWS, NORMAL_LAWS, is_elastic

    families = {
        "elastic laws: any dissipation can stand beside them": {
            name: law for name, law in NORMAL_LAWS.items() if is_elastic(name)
        },
        "whole laws: with the dissipation of their authors": {
            name: law for name, law in NORMAL_LAWS.items() if not is_elastic(name)
        },
        "dissipations: beside an elastic law": DISSIPATIONS,
        "friction laws": FRICTION_LAWS,
    }
    for title, laws in families.items():
        rows = [(name, _first_line(law), _parameters(law)) for name, law in laws.items()]
        print_rows(title, ("name", "what it is", "parameters"), rows, justify="left")
    typer.echo("* follows from the joint's dimensions and materials where a scenario leaves it out")


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
    """Return what a law is by the first line of its docstring, formulas as plain text."""

    def plain(match: re.Match[str]) -> str:
        text = match.group(1)
        for pattern, by in _SYMBOLS:
            text = re.sub(pattern, by, text)
        return text.strip()

    line = re.sub(r":math:`(.*?)`", plain, (law.__doc__ or "").strip().split("\n\n")[0])
    return re.sub(r":\w+:`[~.]?(?:\w+\.)*(\w+)`", r"\1", " ".join(line.replace("``", "").split()))


# --- curve ---


@app.command()
def curve(
    laws: Annotated[
        list[str] | None, typer.Argument(metavar="[LAWS]...", help="Elastic laws; all if left out.")
    ] = None,
    bearing_radius: Annotated[str, typer.Option(help="Radius of the bearing.")] = "10 mm",
    radial_clearance: Annotated[str, typer.Option(help="Bearing radius minus journal radius.")] = "0.2 mm",
    length: Annotated[str, typer.Option(help="Length of the line of contact.")] = "50 mm",
    material: Annotated[str, typer.Option(help="Material of bearing and journal.")] = "steel",
    depths: Annotated[
        str, typer.Option(metavar="LIST", help="Depths of the table; one unit at the end counts for all.")
    ] = "0.1, 1, 5, 20 um",
    out: OutOption = None,
    formats: FormatOption = "png",
    width: WidthOption = FigureWidth.PAGE,
) -> None:
    """Compare the forces of the elastic laws of one joint at the same depth."""
    from antenna_pin.contact import MATERIALS, force_table

    suffixes = _formats(formats)
    radius = _positive(bearing_radius, "m", "--bearing-radius")
    clearance = _clearance(radial_clearance, radius, "contact curve")
    if material not in MATERIALS:
        raise UnknownNameError("contact curve", "material", material, MATERIALS)
    points = _list_of(depths, "m", "--depths")
    chosen, left_out = _elastic_laws(
        laws, radius, radius - clearance, _positive(length, "m", "--length"), MATERIALS[material]
    )
    table = force_table(chosen, points)
    limits = {name: getattr(law, "depth_limit", math.inf) for name, law in chosen.items()}
    rows = [
        (name, *map(_number, forces), _length(limits[name]) if math.isfinite(limits[name]) else "none")
        for name, forces in table.items()
    ]
    print_rows("force [N]", ("law", *(f"at {_length(d)}" for d in points), "depth limit"), rows)
    for depth, forces in zip(points, zip(*table.values(), strict=True), strict=True):
        known = [force for force in forces if math.isfinite(force)]
        if len(known) > 1:
            typer.echo(f"at {_length(depth)} the laws differ by {max(known) / min(known):.3g} times")
    for name, reason in left_out.items():
        typer.echo(f"left out: {name} ({reason})")
    if out is not None:
        _folder(out)
        from antenna_pin.plot import figure_force_curves

        _save({"force_curves": figure_force_curves(chosen, depths=points, width=width.value)}, out, suffixes)


def _elastic_laws(
    names: Sequence[str] | None,
    bearing_radius: float,
    journal_radius: float,
    length: float,
    material: Material,
) -> tuple[dict[str, ElasticLaw], dict[str, str]]:
    """Return the elastic laws of a joint, and why some do not hold for it; of those named, all must hold."""
    from antenna_pin.contact import NORMAL_LAWS, elastic_laws_of_joint, is_elastic, make_normal_law
    from antenna_pin.contact.stiffness import effective_modulus

    elastic = [name for name in NORMAL_LAWS if is_elastic(name)]
    wanted = list(dict.fromkeys(names or elastic))
    for name in wanted:
        if name in NORMAL_LAWS and name not in elastic:
            raise InvalidParameterError(
                "contact curve",
                "law",
                f"an elastic one of {', '.join(elastic)}; this one has a dissipation",
                name,
            )
        if name not in elastic:
            raise UnknownNameError("contact curve", "elastic law", name, elastic)
    holding = elastic_laws_of_joint(
        bearing_radius=bearing_radius,
        journal_radius=journal_radius,
        length=length,
        bearing=material,
        journal=material,
    )
    left_out = {}
    joint = {
        "length": length,
        "journal_radius": journal_radius,
        "bearing_radius": bearing_radius,
        "modulus": effective_modulus(material, material),
    }
    for name in wanted:
        if name not in holding:
            try:
                make_normal_law(name, joint)
            except InvalidParameterError as refusal:
                if names:
                    raise
                left_out[name] = str(refusal)
    return {name: holding[name] for name in wanted if name in holding}, left_out


# --- restitution ---


@app.command()
def restitution(
    dissipations: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[DISSIPATIONS]...", help="Dissipations that take a restitution; all if left out."
        ),
    ] = None,
    asked: Annotated[
        str, typer.Option(metavar="LIST", help="Restitutions asked for, separated by commas.")
    ] = "0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 1",
    mass: Annotated[str, typer.Option(help="Effective mass.")] = "1 kg",
    speed: Annotated[str, typer.Option(help="Approach speed.")] = "0.1 m/s",
    simulate: Annotated[bool, typer.Option(help="Integrate impacts beside the closed forms.")] = True,
    out: OutOption = None,
    formats: FormatOption = "png",
    width: WidthOption = FigureWidth.PAGE,
) -> None:
    """Certify dissipations: the restitution each delivers, in closed form and in integrated impacts.

    On a Hertz contact of 1e10 N/m^1.5: of one mass on a wall, and of a pair of free bodies. Dissipations that
    refuse a restitution of 0 are left out there.
    """
    from antenna_pin.contact import DISSIPATIONS, law_parameters, restitution_table

    suffixes = _formats(formats)
    values = _list_of(asked, "1", "--asked", positive=False)
    for value in values:
        if not 0.0 <= value <= 1.0:
            raise InvalidParameterError("contact restitution", "--asked", "in [0, 1]", value)
    taking = [name for name, law in DISSIPATIONS.items() if "restitution" in law_parameters(law)]
    chosen = list(dict.fromkeys(dissipations or taking))
    for name in chosen:
        if name in DISSIPATIONS and name not in taking:
            raise InvalidParameterError(
                "contact restitution",
                "dissipation",
                f"one that takes a restitution: {', '.join(taking)}",
                name,
            )
        if name not in taking:
            raise UnknownNameError("contact restitution", "dissipation", name, taking)
    impact = {"mass": _positive(mass, "kg", "--mass"), "speed": _positive(speed, "m/s", "--speed")}
    if out is not None:
        _folder(out)
    rows = restitution_table(chosen, values, simulate=simulate, **impact)
    print_rows(
        "restitution [-] and peak depth",
        ("dissipation", "asked", "closed form", "wall", "free pair", "depth, closed form", "depth, wall"),
        [
            (
                row.dissipation,
                f"{row.asked:g}",
                *(_fixed(value) for value in (row.closed_form, row.on_wall, row.of_pair)),
                *(_length(value, 7) for value in (row.closed_form_depth, row.depth_on_wall)),
            )
            for row in rows
        ],
    )
    if simulate:
        pairs = [(x, row.closed_form) for row in rows for x in (row.on_wall, row.of_pair)]
        off = max((abs(x - y) for x, y in pairs if math.isfinite(y)), default=math.nan)
        deeper = max(
            (
                abs(row.depth_on_wall / row.closed_form_depth - 1.0)
                for row in rows
                if math.isfinite(row.closed_form_depth)
            ),
            default=math.nan,
        )
        typer.echo(
            "closed form against integrated impacts, largest errors:"
            f" {_power_above(off)} in restitution, {_power_above(deeper)} of the peak depth"
        )
    if out is not None:
        from antenna_pin.plot import figure_restitution

        fine = [0.005 + 0.995 * k / 199 for k in range(200)]
        smooth = restitution_table(chosen, fine, simulate=False, **impact)
        _save({"restitution": figure_restitution(rows, closed_form=smooth, width=width.value)}, out, suffixes)


# --- experiment ---

_MISPRINTED = 5  # row of the table whose displacement does not fit the paper's own columns, from 0

_FINDINGS = """
Reproduced: equation (6) gives ten rows of the Hertz column to the rounding of the table, with one modulus of
{modulus:.3f} GPa (206 GPa and a Poisson's ratio of {poisson:.4f}; 0.3 gives 0.07 % more). Row {misprint}
does not fit: its load by (6) asks for {mended:.3f}e-2 mm instead of the {printed:.3f}e-2 mm printed, and
with that its load by (14) fits too: a misprint, mended in the columns reproduced. Equation (14) gives the
conformal column with R_i R_j / play of {radii} mm for the three plays, that is with a bore of some
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
against every law here, so a law that stiffens with depth and not with play is off by at least 23 % in row 6
or row 10. At 3000 N two plays have the same displacement, so one may be a copy. The length of the contact
and the radius of the pin are not given; a free length would move the errors by as much as the laws differ,
and so does taking the displacement for that of one contact or of two. Only the plays of 0.067 and 0.094 mm
are fit to judge a law by.
"""


@app.command()
def experiment(
    journal_radius: Annotated[str, typer.Option(help="Radius of the pin; the paper gives none.")] = "5 mm",
    length: Annotated[str, typer.Option(help="Length of the contact; the paper takes 1 mm.")] = "1 mm",
    out: OutOption = None,
    formats: FormatOption = "png",
    width: WidthOption = FigureWidth.PAGE,
) -> None:
    """Hold the laws against the pin joint that Liu et al. measured in 2013."""
    from antenna_pin.contact import LIU_2013, compare_with_experiment

    suffixes = _formats(formats)
    radius, line = _positive(journal_radius, "m", "--journal-radius"), _positive(length, "m", "--length")
    if out is not None:
        _folder(out)
    table = _Reproduction()
    print_rows(
        "Table 1 of Liu et al. 2013: loads [N], as printed and reproduced",
        (
            "row",
            "play [mm]",
            "displacement [1e-2 mm]",
            "measured",
            "Hertz",
            "by (6)",
            "conformal",
            "by (14)",
            "",
        ),
        [
            (
                str(row + 1),
                f"{1e3 * point.clearance:.3f}",
                f"{1e5 * point.depth:.3f}",
                f"{point.load:.0f}",
                f"{point.hertz:.0f}",
                f"{table.hertz(row):.1f}",
                f"{point.conformal:.0f}",
                f"{table.conformal(row):.1f}",
                table.remark(row),
            )
            for row, point in enumerate(LIU_2013)
        ],
    )
    fits = compare_with_experiment(journal_radius=radius, length=line)
    printed = {
        "printed: Hertz": [p.hertz / p.load - 1.0 for p in LIU_2013],
        "printed: conformal": [p.conformal / p.load - 1.0 for p in LIU_2013],
    }
    errors = [(fit.law, str(fit.contacts), list(fit.errors)) for fit in fits]
    errors += [(name, "", values) for name, values in printed.items()]
    print_rows(
        f"size of the errors [%], the displacement that of 1 contact or of 2 in series; pin radius"
        f" {_length(radius)}, length {_length(line)}",
        ("law", "contacts", *(f"play {1e3 * play:g} mm" for play in _plays()), "mean", "largest", "points"),
        [_error_row(*entry) for entry in sorted(errors, key=_rank)],
    )
    for paragraph in _findings(table, fits, printed, radius):
        typer.echo(textwrap.fill(paragraph, 110) + "\n")
    if out is not None:
        _save(_experiment_figures(radius, line, width.value), out, suffixes)


def _rank(entry: tuple[str, str, list[float]]) -> tuple[int, float]:
    """Return what sorts errors: laws that reach every point first, then by the mean."""
    known = [abs(value) for value in entry[2] if math.isfinite(value)]
    return len(entry[2]) - len(known), sum(known) / max(len(known), 1)


def _error_row(law: str, contacts: str, errors: Sequence[float]) -> tuple[str, ...]:
    from antenna_pin.contact import LIU_2013

    sizes = [abs(error) for error in errors]
    groups = [
        [size for size, point in zip(sizes, LIU_2013, strict=True) if point.clearance == play]
        for play in _plays()
    ]
    means = [100.0 * sum(group) / len(group) for group in (*groups, sizes)]
    reached = sum(map(math.isfinite, sizes))
    largest = 100.0 * max(sizes) if reached == len(sizes) else math.nan
    return (law, contacts, *(_percent(x) for x in (*means, largest)), f"{reached} of {len(sizes)}")


def _plays() -> list[float]:
    """Return the radial plays of the table [m]."""
    from antenna_pin.contact import LIU_2013

    return sorted({point.clearance for point in LIU_2013})


class _Reproduction:
    """The columns of the paper's table, by (6) with one modulus and by (14) with one radius for each play.

    A row is reproduced if a parameter of its column lies in the interval that the rounding of its load and of
    its displacement leaves.
    """

    def __init__(self) -> None:
        from antenna_pin.contact import LIU_2013

        self.points = LIU_2013
        rows = range(len(self.points))
        slopes = [self._interval(row, lambda p: p.hertz, lambda p, d: 0.25e-3 * math.pi * d) for row in rows]
        self.modulus = _common(slopes)
        # Row 6 by itself: the displacement that its load by (6) asks for, at the precision of the table.
        odd = self.points[_MISPRINTED]
        self.mended = round(odd.hertz / (0.25e-3 * math.pi * self.modulus), 8)
        self.hertz_reproduced = [low <= self.modulus <= high for low, high in slopes]
        radii = [
            self._interval(row, lambda p: p.conformal**2, lambda p, d: (4.0 / 3.0 * self.modulus) ** 2 * d**3)
            for row in rows
        ]
        of_play = {
            play: _common([radii[row] for row in rows if self.points[row].clearance == play])
            for play in _plays()
        }
        self.radius = [of_play[point.clearance] for point in self.points]
        self.conformal_reproduced = [low <= self.radius[row] <= high for row, (low, high) in enumerate(radii)]

    def depth(self, row: int) -> float:
        """Return the displacement of a row [m], mended where it is misprinted."""
        return (
            getattr(self, "mended", self.points[row].depth) if row == _MISPRINTED else self.points[row].depth
        )

    def _interval(self, row: int, column: Any, divisor: Any) -> tuple[float, float]:
        """Return between what the parameter of a column lies by the rounding of one row."""
        import dataclasses

        point = self.points[row]
        ends = []
        for sign in (-1.0, 1.0):
            moved = dataclasses.replace(
                point, hertz=point.hertz + 0.5 * sign, conformal=point.conformal + 0.5 * sign
            )
            ends.append(column(moved) / divisor(moved, self.depth(row) - 0.5e-8 * sign))
        return ends[0], ends[1]

    def hertz(self, row: int) -> float:
        """Return the load by (6) [N]."""
        return 0.25e-3 * math.pi * self.modulus * self.depth(row)

    def conformal(self, row: int) -> float:
        """Return the load by (14) [N]."""
        return float(4.0 / 3.0 * self.modulus * math.sqrt(self.radius[row]) * self.depth(row) ** 1.5)

    def remark(self, row: int) -> str:
        """Return what is to be said of a row."""
        if row == _MISPRINTED:
            return f"misprint: {1e5 * self.mended:.3f}"
        if not self.conformal_reproduced[row]:
            error = self.points[row].conformal / self.conformal(row) - 1.0
            return f"(14) off by {100.0 * error:+.1f} %"
        return ""


def _common(intervals: Sequence[tuple[float, float]]) -> float:
    """Return the middle of where most intervals overlap, the last of equals."""
    best, found = 0, 0.0
    for low, _ in intervals:
        holding = [(a, b) for a, b in intervals if a <= low <= b]
        if len(holding) >= best:
            best, found = len(holding), 0.5 * (low + min(b for _, b in holding))
    return found


def _findings(
    table: _Reproduction, fits: Iterable[ExperimentFit], printed: Mapping[str, Sequence[float]], pin: float
) -> list[str]:
    """Return what fits and what the data cannot decide."""
    by_name = {(fit.law, fit.contacts): fit for fit in fits}
    best = min(
        (fit for fit in by_name.values() if fit.in_range == len(table.points)), key=lambda fit: fit.mean
    )
    plays = dict.fromkeys(zip((p.clearance for p in table.points), table.radius, strict=True))
    bores = [0.5 * play + math.sqrt(radius * play + 0.25 * play**2) for play, radius in plays]
    odd = [str(row + 1) for row, good in enumerate(table.conformal_reproduced) if not good]
    hertz_mean, conformal_mean = (100.0 * sum(map(abs, e)) / len(e) for e in printed.values())
    values = {
        "modulus": 1e-9 * table.modulus,
        "poisson": math.sqrt(1.0 - 103e9 / table.modulus),
        "misprint": _MISPRINTED + 1,
        "mended": 1e5 * table.mended,
        "printed": 1e5 * table.points[_MISPRINTED].depth,
        "radii": ", ".join(f"{1e3 * radius:.2f}" for _, radius in plays),
        "bore": 1e3 * sum(bores) / len(bores),
        "odd": "rows " + ", ".join(odd) if odd else "no row",
        "pin": 1e3 * pin,
        "factor": math.sqrt((pin + _plays()[0]) * pin / _plays()[0] / table.radius[0]),
        "best": best.law,
        "best_mean": 100.0 * best.mean,
        "paper_mean": 100.0 * by_name["liu-2013", 1].mean,
        "small": 100.0 * by_name["liu-2013-corrected", 1].mean_of(_plays()[0]),
        "middle": 100.0 * by_name["liu-2013-corrected", 1].mean_of(_plays()[1]),
        "large": 100.0 * by_name["liu-2013-corrected", 1].mean_of(_plays()[2]),
        "hertz_mean": hertz_mean,
        "conformal_mean": conformal_mean,
    }
    return [paragraph.format(**values) for paragraph in _FINDINGS.strip().split("\n\n")]


def _experiment_figures(radius: float, length: float, width: Literal["column", "page"]) -> dict[str, Figure]:
    """Return the paper's figures 3, 5 and 6, with what this project adds."""
    from antenna_pin.contact import LiuPinJoint, make_normal_law
    from antenna_pin.contact.comparison import force_within
    from antenna_pin.contact.experiment import LIU_2013_STEEL
    from antenna_pin.contact.stiffness import effective_modulus
    from antenna_pin.plot import figure_contact_width, figure_experiment

    modulus = effective_modulus(LIU_2013_STEEL, LIU_2013_STEEL)
    table = _Reproduction()
    of_play = {point.clearance: own for point, own in zip(table.points, table.radius, strict=True)}

    def load(law: str, contacts: int = 1) -> Any:
        def at(play: float, depth: float) -> float:
            joint = {"length": length, "journal_radius": radius, "bearing_radius": radius + play}
            return force_within(make_normal_law(law, {**joint, "modulus": modulus}), depth / contacts)

        return at

    def conformal(play: float, depth: float) -> float:
        return float(4.0 / 3.0 * table.modulus * math.sqrt(of_play[play]) * depth**1.5)

    paper = {"(6), Hertz": load("liu-2013-hertz"), "(14), radii of the table": conformal}
    new = {
        "(28), Liu et al. 2013": load("liu-2013"),
        "(28), half depth in width": load("liu-2013-corrected"),
        "Johnson, 2 contacts": load("johnson", 2),
        "Liu foundation, 1 contact": load("liu-foundation"),
        "ESDU 78035, 1 contact": load("esdu-78035"),
    }
    joint = LiuPinJoint(
        length=length, journal_radius=radius, bearing_radius=radius + _plays()[0], modulus=modulus
    )
    return {
        "liu2013_figure3": figure_experiment(paper, width=width),
        "liu2013_figure5": figure_experiment({**paper, **new}, width=width),
        "liu2013_figure6": figure_contact_width(joint, width="column"),
    }


# --- scenarios ---


@app.command()
def scenarios(
    bearing_radius: Annotated[str, typer.Option(help="Radius of the bearing.")] = "10 mm",
    radial_clearance: Annotated[str, typer.Option(help="Bearing radius minus journal radius.")] = "0.2 mm",
    bearing_length: Annotated[str, typer.Option(help="Length of the bearing.")] = "50 mm",
    axial_clearance: Annotated[
        str, typer.Option(help="Half of what the flanges' distance exceeds the bearing's length by.")
    ] = "0.2 mm",
    bearing_outer_radius: Annotated[str, typer.Option(help="Outer radius of the bearing.")] = "12 mm",
    flange_radius: Annotated[str, typer.Option(help="Radius of the journal's flanges.")] = "14 mm",
    penetration: Annotated[
        str, typer.Option(help="Largest depth at any contact; 0 for rigid parts.")
    ] = "0 mm",
) -> None:
    """Say which of the 16 contact scenarios a joint's shape allows, each with a pose or a reason."""
    from antenna_pin.analysis import SCENARIO_COLUMNS, possible_scenarios, scenario_rows
    from antenna_pin.geometry import RevoluteClearance
    from antenna_pin.units import quantity

    radius = _positive(bearing_radius, "m", "--bearing-radius")
    length = _positive(bearing_length, "m", "--bearing-length")
    clearance = _clearance(radial_clearance, radius, "contact scenarios")
    shape = RevoluteClearance(
        bearing_radius=radius,
        journal_radius=radius - clearance,
        bearing_length=length,
        flange_distance=length + 2.0 * _positive(axial_clearance, "m", "--axial-clearance"),
        bearing_outer_radius=_positive(bearing_outer_radius, "m", "--bearing-outer-radius"),
        flange_radius=_positive(flange_radius, "m", "--flange-radius"),
    )
    depth = quantity(_bare(penetration), "m", "--penetration")
    pairs = possible_scenarios(shape, depth)
    parts = f"parts that penetrate by up to {_length(depth)}" if depth > 0.0 else "rigid parts"
    print_rows(f"contact scenarios of {parts}", SCENARIO_COLUMNS, scenario_rows(pairs), justify="left")
    typer.echo(f"{sum(pair.possible for pair in pairs)} of {len(pairs)} are possible")


# --- reading and printing ---


def _positive(text: str, unit: str, option: str) -> float:
    from antenna_pin.units import quantity

    value = quantity(_bare(text), unit, option)
    if not value > 0.0:
        raise InvalidParameterError("contact", option, "positive", text)
    return value


def _clearance(text: str, bearing_radius: float, place: str) -> float:
    value = _positive(text, "m", "--radial-clearance")
    if not value < bearing_radius:
        raise InvalidParameterError(
            place, "--radial-clearance", f"below the bearing's radius, {_length(bearing_radius)}", text
        )
    return value


def _bare(text: str) -> str | float:
    """Return a number where the text is one: it is in SI units then."""
    try:
        return float(text)
    except ValueError:
        return text


def _list_of(text: str, unit: str, option: str, positive: bool = True) -> tuple[float, ...]:
    """Return the quantities of a list; one unit at its end counts for all, as in ``0.1,1,5 um``."""
    from antenna_pin.units import quantity

    parts = [part.strip() for part in text.split(",") if part.strip()]
    if not parts:
        raise InvalidParameterError("contact", option, "one value or more, separated by commas", text)
    shared = re.fullmatch(r"[-+.\deE]+?\s*([a-zA-Zµμ].*)", parts[-1])
    if (
        shared
        and isinstance(_bare(parts[-1]), str)
        and all(isinstance(_bare(part), float) for part in parts[:-1])
    ):
        parts[:-1] = [f"{part} {shared.group(1)}" for part in parts[:-1]]
    if positive:
        return tuple(_positive(part, unit, option) for part in parts)
    return tuple(quantity(_bare(part), unit, option) for part in parts)


def _formats(text: str) -> list[str]:
    suffixes = list(dict.fromkeys(part.strip() for part in text.split(",") if part.strip()))
    for suffix in suffixes or [""]:
        if suffix not in ("png", "pdf", "svg"):
            raise UnknownNameError("--format", "figure format", suffix, ("png", "pdf", "svg"))
    return suffixes


def _folder(out: Path) -> None:
    """Refuse a folder for figures that is a file, before any work."""
    if out.exists() and not out.is_dir():
        raise OutputError(f"--out {out}: this is a file; name a folder for the figures")


def _save(figures: Mapping[str, Figure], out: Path, suffixes: Sequence[str]) -> None:
    from antenna_pin.plot import save_contact_figures

    for path in save_contact_figures(figures, out, suffixes):
        typer.echo(path)


def _number(value: float) -> str:
    return f"{value:.4g}" if math.isfinite(value) and abs(value) < 1e4 else _integer(value)


def _integer(value: float) -> str:
    return f"{value:.0f}" if math.isfinite(value) else "-"


def _fixed(value: float) -> str:
    return f"{value:.7f}" if math.isfinite(value) else "-"


def _percent(share: float) -> str:
    return f"{share:.1f}" if math.isfinite(share) else "-"


def _length(value: float, digits: int = 4) -> str:
    """Return a length with a unit that suits it."""
    if not math.isfinite(value):
        return "-"
    size, unit = next(
        ((size, unit) for size, unit in ((1.0, "m"), (1e-3, "mm")) if value >= 0.1 * size), (1e-6, "um")
    )
    return f"{value / size:.{digits}g} {unit}"


def _power_above(value: float) -> str:
    """Return the power of ten that a size does not exceed."""
    if not value > 0.0:
        return "0"
    return f"1e{math.ceil(math.log10(value))}"
