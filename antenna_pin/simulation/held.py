"""What a result says of closures, couplings and motions: what they are, and how well they were held."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.constraints import Anchor
from antenna_pin.dynamics import System, constraint_counts, facts_of_couplings
from antenna_pin.mechanism import quaternion
from antenna_pin.simulation.singular import Singular

__all__ = ["constraint_attributes"]

Array = NDArray[np.float64]

# Of positions, angles and their rates, in the order of ``Observed.residual``.
_RESIDUALS = ("position_residual", "angle_residual", "velocity_residual", "rate_residual")


def constraint_attributes(
    system: System, first: Array, last: Array, residual: Array, passed: Sequence[Singular]
) -> dict[str, str]:
    """Return the attributes of a dataset that describe its constraints; none of a tree that nothing holds.

    ``closures`` (JSON) has of each closure its ``kind``, how many ``equations`` it is, whether it has an
    ``axis`` (z of the placements) and, of its two sides, ``first_body``,
    ``first_placement``, ``second_body`` and ``second_placement``: the link and the frame there, position [m]
    and attitude (quaternion xyzw). If there are couplings, ``couplings`` (JSON) has of each its ``follower``
    and ``leader`` (joints), ``multiplier`` and ``offset``, whether its follower ``slides``, and its leader
    (``leader_slides``). ``constraints`` (JSON) has how many equations there are, of closures and couplings
    and of motions, how many are independent at the start, the freedoms of the tree, those that closures and
    couplings leave and those that are left, where redundant equations are
    (:func:`antenna_pin.dynamics.constraint_counts`),
    the largest residuals at samples [m, rad, m/s, rad/s], the energy that corrections of the state after each
    step put in, in all [J], and the singular positions passed: ``time`` [s] and ``share``, what is left of
    the least independent equation there.

    Args:
        system: What was run.
        first: [q, v, x] at the first sample.
        last: At the last.
        residual: The largest at samples, (4,), as of ``Observed.residual``.
        passed: The singular positions.
    """
    if system.plan is None:
        return {}
    booked = system.model.nq + system.model.nv + system.projection_x[0]
    put_in = last[booked] - first[booked]
    couplings = facts_of_couplings(system.mechanism, system.couplings)
    return {
        "closures": json.dumps(
            {
                name: {
                    "kind": one.kind,
                    "equations": one.holds.rows,
                    "axis": one.holds.axis,
                    **_side("first", one.first),
                    **_side("second", one.second),
                }
                for name, one in system.closures.items()
            }
        ),
        **({"couplings": json.dumps(couplings)} if couplings else {}),
        "constraints": json.dumps(
            {
                **constraint_counts(system, first),
                **dict(zip(_RESIDUALS, residual.tolist(), strict=True)),
                "projection_energy": float(put_in),
                "singular": [one._asdict() for one in passed],
            }
        ),
    }


def _side(name: str, anchor: Anchor) -> dict[str, Any]:
    return {
        f"{name}_body": anchor.link,
        f"{name}_placement": [*map(float, anchor.origin), *quaternion(anchor.rotation).tolist()],
    }
