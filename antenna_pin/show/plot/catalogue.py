"""Catalogue of the figures of runs, which ``plot``, ``report`` and figures of papers draw.

A figure is a function in a file of this room and a :class:`RunFigure` in that file's ``FIGURES``, in the
order of folders, pages and docs.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable, Iterator
from typing import NamedTuple

from matplotlib.figure import Figure

from antenna_pin.base.arguments import takes
from antenna_pin.errors import UnknownNameError
from antenna_pin.show.plot import against_ideal, audit, contacts, elements, exerted, journal, motion, spectra
from antenna_pin.show.plot._kinds import MOVING, RunFigure, choose_joint, joints_of, wanted_joints
from antenna_pin.show.plot._runs import Run, labelled, long_enough
from antenna_pin.show.plot._style import Width

#: Every figure of runs by its name, in the order in which they are shown.
CATALOGUE: dict[str, RunFigure] = {
    figure.name: figure
    for figure in (
        *motion.FIGURES,
        *against_ideal.JOINT_FIGURES,
        *contacts.FORCE_FIGURES,
        *journal.FIGURES,
        *contacts.FIGURES,
        *exerted.FIGURES,
        *elements.FIGURES,
        *spectra.FIGURES,
        *against_ideal.FIGURES,
        *audit.FIGURES,
    )
}


class Allowed(NamedTuple):
    """Figure of a joint (None: of whole runs) that runs allow."""

    figure: RunFigure
    joint: str | None

    @property
    def title(self) -> str:
        """Title of the figure."""
        return self.figure.title.format(joint=self.joint)

    def draw(self, runs: Iterable[Run], *, width: Width = "page") -> Figure:
        """Return the figure of runs, "column" (88 mm) or "page" (180 mm) wide."""
        return self.figure.draw(runs, joint=self.joint, width=width)


@takes()
def run_figure(name: str) -> RunFigure:
    """Return a figure of the catalogue.

    Raises:
        UnknownNameError: It has none of that name.
    """
    if name not in CATALOGUE:
        raise UnknownNameError("figures", "figure", name, CATALOGUE)
    return CATALOGUE[name]


@takes()
def allowed_figures(
    runs: Iterable[Run], joint: str | None = None, names: Collection[str] | None = None
) -> Iterator[Allowed]:
    """Yield the figures that runs of their kind have.

    Figures of joints come joint by joint: of those with clearance in a run, or in a scenario; or else of the
    first. Every other joint that moves has one of all of its motion.

    Args:
        runs: Trajectories, or pairs of a label and a dataset or trajectory.
        joint: The one joint to draw.
        names: The figures wanted; the standard ones if left out.

    Raises:
        UnknownNameError: There is no such joint or no such figure.
    """
    every = labelled(runs)
    long = long_enough(every)
    if joint is not None and any(run.joints or run.clearance_joints for run in every):
        choose_joint(MOVING, every, joint)
    for name in names or ():
        run_figure(name)
    wanted = [each for each in CATALOGUE.values() if (each.standard if names is None else each.name in names)]
    for kind, figures in itertools.groupby(wanted, key=lambda figure: figure.of):
        drawn = list(figures)
        if kind is None:
            yield from (
                Allowed(each, None)
                for each in drawn
                if each.needs is None or any(map(each.needs.holds, long))
            )
            continue
        known = {name for run in long for name in kind.names(run)}
        found = joints_of(kind, long) if names is not None else wanted_joints(kind, long)
        if not kind.play:
            known &= set(found)
        for name in found if joint is None else sorted({joint} & known):
            yield from (Allowed(each, name) for each in drawn)
