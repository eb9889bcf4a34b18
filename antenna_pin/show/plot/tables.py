"""Figures of datasets that commands save beside runs, by kind."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import xarray as xr
from matplotlib.figure import Figure

from antenna_pin.analysis import portrait_of
from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.show.plot.fits import (
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
from antenna_pin.show.plot.grammar import DatasetFigure
from antenna_pin.show.plot.periodic import (
    figure_bifurcation,
    figure_branch,
    figure_exponents,
    figure_multipliers,
    figure_section,
)
from antenna_pin.show.plot.phase import figure_phase
from antenna_pin.trajectory import KINDS, kind_of

TableFigure = DatasetFigure

_MULTIPLIERS = ("multipliers", "Floquet multipliers", figure_multipliers)
# Of each kind of dataset, but fits, its figures: file, title, and what draws it.
_OF: dict[str, tuple[tuple[str, str, Callable[..., Figure]], ...]] = {
    "orbit": (_MULTIPLIERS,),
    "branch": (("branch", "Periodic solutions", figure_branch), _MULTIPLIERS),
    "portrait": (
        ("portrait", "Phase portrait", lambda table, **more: figure_phase(portrait_of(table), **more)),
    ),
    "section": (("section", "Section", figure_section),),
    "bifurcation": (("bifurcation", "Bifurcation diagram", figure_bifurcation),),
    "exponents": (("exponents", "Lyapunov exponents", figure_exponents),),
    "identifiability": (("identifiability", "Identifiability", figure_identifiability),),
    "experiments": (("experiments", "Comparison of experiments", figure_experiments),),
    "sensitivity": (("sensitivity", "Sensitivities", figure_sensitivity),),
}


@takes()
def table_figures(table: xr.Dataset) -> Iterator[TableFigure]:
    """Yield the figures of a dataset of motions, fits or tests.

    Args:
        table: A dataset as :func:`antenna_pin.trajectory.open_table` returns it.

    Raises:
        InvalidParameterError: It is of none of these kinds.
    """
    kind = kind_of(table)
    if kind == "fit":
        yield from _of_fit(table)
    elif kind not in _OF:
        rule = f"a dataset of {', '.join(KINDS.values())}"
        raise InvalidParameterError("plot", "table", rule, said=repr(table.attrs.get("format")))
    else:
        for name, title, draw in _OF[kind]:
            yield TableFigure(name, title, partial(draw, table))


def _of_fit(table: xr.Dataset) -> Iterator[TableFigure]:
    every = curves_of_fit(table)
    parts = [every[k : k + MOST] for k in range(0, len(every), MOST)]
    for k, part in enumerate(parts, start=1):
        name = "fit" if len(parts) == 1 else f"fit-{k}"
        yield TableFigure(
            name, f"Records against the fit: {', '.join(part)}", partial(figure_fit, table, part)
        )
    if table.sizes["parameter"] > 1:
        yield TableFigure("correlation", "Correlations of the parameters", partial(figure_correlation, table))
    if has_profiles(table):
        yield TableFigure("profiles", "Profile of each parameter", partial(figure_profiles, table))
