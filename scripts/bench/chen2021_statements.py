"""What Chen and Cui (2021) say of their attractors, and what is found here for each contact law.

The diagrams are made first, in a folder, NAME-LAW.nc for the laws ``ambrosio`` (the default case), ``tanh``,
``external`` and ``printed-slip``, such as

    antenna-pin bifurcation chen2021/friction --out chen/friction-ambrosio.nc
    antenna-pin bifurcation chen2021/friction --case tanh --values 0.005:0.2:40 --out chen/friction-tanh.nc
    antenna-pin bifurcation chen2021/clearance --case tanh --out chen/clearance-tanh.nc

    python scripts/bench/chen2021_statements.py chen

Bands of the force are made here: of five periods behind ten.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from antenna_pin import simulate
from antenna_pin.analysis import quantity
from antenna_pin.errors import AntennaPinError, FileFormatError
from antenna_pin.show.plot import ATTRACTORS, DiagramFigure
from antenna_pin.studies.nonlinear import load_plan, open_diagram

LAWS = {"ambrosio": None, "tanh": "tanh", "external": "external", "printed-slip": "printed-slip"}
FRICTIONS = (0.05, 0.10, 0.15)
_BEHIND, _PERIODS, _PERIOD = 10, 5, 2.0


def band(law: str, friction: float) -> str:
    """Return the least and the largest force through s2 behind the transient [N]."""
    plan = load_plan("chen2021/friction", {} if LAWS[law] is None else {"case": LAWS[law]})
    scenario = plan.base([f"{plan.parameter}={friction}", "output.rate=2 kHz"])
    run = simulate(scenario, duration=(_BEHIND + _PERIODS) * _PERIOD)
    force = quantity(run, "|joint_force[s2]|")
    late = force.values[force.time >= _BEHIND * _PERIOD]
    return f"{late.min():.0f} to {late.max():.0f} ({late.max() / late.min():.2f})"


def main() -> None:
    """Print the findings."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="of the diagrams")
    parser.add_argument("--no-bands", action="store_true", help="leave the force's bands out")
    asked = parser.parse_args()
    for law in LAWS:
        print(f"\n{law}")
        if not asked.no_bands:
            bands = ", ".join(f"{friction:.2f}: {band(law, friction)}" for friction in FRICTIONS)
            print(f"  force through s2 [N] and its ratio, friction {bands}")
        for figure in ATTRACTORS["chen2021"]:
            if not isinstance(figure, DiagramFigure):
                continue
            path = asked.folder / f"{figure.diagram.name.partition('/')[2]}-{law}.nc"
            try:
                diagram = open_diagram(path)
            except FileFormatError as error:
                print(f"  Figure {figure.number}: {error}")
                continue
            said = {True: "agrees", False: "differs", None: "cannot be decided"}[figure.judge(diagram)]
            print(f"  Figure {figure.number}: {said}: {figure.describe(diagram)}")
            if figure.number == 16:
                print(f"    extent of the points in y: {_extents(diagram)}")


def _extents(diagram: object) -> str:
    """Return how far the points of the ball's velocity along Y lie apart near some clearances."""
    over = np.asarray(diagram["value"].values) - 15e-3  # type: ignore[index]
    points = diagram["journal_velocity[s2].y"].values[0]  # type: ignore[index]
    extent = np.nanmax(points, axis=1) - np.nanmin(points, axis=1)
    parts = []
    for clearance in (0.2e-3, 0.3e-3, 0.42e-3, 0.5e-3, 0.67e-3, 0.9e-3):
        k = int(np.argmin(np.abs(over - clearance)))
        parts.append(f"{1e3 * over[k]:.2f} mm {1e6 * extent[k]:.3g} um/s")
    return ", ".join(parts)


if __name__ == "__main__":
    try:
        main()
    except AntennaPinError as error:
        sys.exit(str(error))
