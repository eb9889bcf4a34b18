"""The figures of datasets that commands save beside runs, by the kind of each."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import xarray as xr
from matplotlib.figure import Figure

from antenna_pin.analysis import portrait_of
from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.plot.fits import (
    MOST,
    curves_of_fit,
    figure_correlation,
    figure_experiments,
    figure_fit,
    figure_identifiability,
    figure_profiles,
    figure_sensitivity,
    has_profiles,
)
from antenna_pin.plot.periodic import (
    figure_bifurcation,
    figure_branch,
    figure_exponents,
    figure_multipliers,
    figure_section,
)
from antenna_pin.plot.phase import figure_phase
from antenna_pin.trajectory import KINDS, kind_of


class TableFigure(NamedTuple):
    """A figure that a dataset allows.

    Attributes:
        name: As its file is called.
        title: What it shows.
        draw: Draws it; takes ``width``.
    """

    name: str
    title: str
    draw: Callable[..., Figure]


def _of_fit(table: xr.Dataset) -> Iterator[TableFigure]:
    every = curves_of_fit(table)
    parts = [every[k : k + MOST] for k in range(0, len(every), MOST)]
    for k, part in enumerate(parts, start=1):
        yield TableFigure(
            "fit" if len(parts) == 1 else f"fit-{k}",
            f"Records against the fit: {', '.join(part)}",
            lambda part=part, **more: figure_fit(table, part, **more),
        )
    if table.sizes["parameter"] > 1:
        yield TableFigure(
            "correlation", "Correlations of the parameters", lambda **more: figure_correlation(table, **more)
        )
    if has_profiles(table):
        yield TableFigure(
            "profiles", "Profile of each parameter", lambda **more: figure_profiles(table, **more)
        )


@takes()
def table_figures(table: xr.Dataset) -> Iterator[TableFigure]:
    """Yield the figures that a dataset of what motions, fits and tests come to allows.

    Args:
        table: A dataset as :func:`antenna_pin.trajectory.open_table` returns it.

    Raises:
        InvalidParameterError: It is of none of these kinds.
    """
    kind = kind_of(table)
    if kind == "fit":
        yield from _of_fit(table)
    elif kind == "orbit":
        yield _multipliers(table)
    elif kind == "branch":
        yield TableFigure("branch", "Periodic solutions", lambda **more: figure_branch(table, **more))
        yield _multipliers(table)
    elif kind in _ALONE:
        title, draw = _ALONE[kind]
        yield TableFigure(kind, title, lambda **more: draw(table, **more))
    else:
        rule = f"a dataset of {', '.join(KINDS.values())}"
        raise InvalidParameterError("plot", "table", rule, said=repr(table.attrs.get("format")))


def _multipliers(table: xr.Dataset) -> TableFigure:
    return TableFigure("multipliers", "Floquet multipliers", lambda **more: figure_multipliers(table, **more))


# Kinds that have one figure: its title, and what draws it.
_ALONE: dict[str, tuple[str, Callable[..., Figure]]] = {
    "portrait": ("Phase portrait", lambda table, **more: figure_phase(portrait_of(table), **more)),
    "section": ("Section", figure_section),
    "bifurcation": ("Bifurcation diagram", figure_bifurcation),
    "exponents": ("Lyapunov exponents", figure_exponents),
    "identifiability": ("What the test can tell", figure_identifiability),
    "experiments": ("Experiments beside one another", figure_experiments),
    "sensitivity": ("Sensitivities", figure_sensitivity),
}
