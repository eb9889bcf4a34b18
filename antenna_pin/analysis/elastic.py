"""Motion of the elastic parts of flexible links, and the limit of their model."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import RunLike, data_of, entries_in, floats, sample_times, variable
from antenna_pin.analysis.sampled import time_rms
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.readable import number, readable
from antenna_pin.trajectory import names_along
from antenna_pin.trajectory.quantities import table

#: Largest spin of a hub over a part's own angular frequency up to which its softening is small: 5 % [-].
SPIN_WITHIN = 0.3


@takes()
def elastic_parts_of(run: RunLike) -> dict[str, dict[str, Any]]:
    """Return the elastic parts of a run by name.

    Each has its ``hub`` and its ``body`` (links), whether it ``slides``, its ``frequency`` [Hz] and
    ``damping_ratio`` [-] with the hub held, and the mass [kg] or moment of inertia [kg m^2] ``moved``.
    """
    return entries_in(run, "elastic_parts")


@takes()
def modal_energy(run: RunLike) -> Array:
    r"""Return the energy of each elastic part against its hub, (n, parts) [J].

    :math:`\tfrac12 k x^2 + \tfrac12 D \dot x^2`, with the mass or moment of inertia D that its joint moves:
    with the hub held it only decreases.
    """
    data = data_of(run)
    moved = np.array([one["moved"] for one in elastic_parts_of(data).values()])
    rate = floats(variable(data, "deflection_rate", "modal energy"))
    return np.asarray(data["elastic_energy"].values + 0.5 * moved * rate**2, dtype=float)


@takes()
def elastic_motion(run: RunLike) -> xr.Dataset:
    """Return key numbers of the elastic parts of a run.

    Returns:
        Over ``elastic_part``: ``peak_deflection`` and ``rms_deflection`` [rad], of parts that slide [m],
        ``time_of_peak`` [s], ``peak_energy``, that of :func:`modal_energy`, and ``lost`` in the damper [J],
        ``frequency`` with the hub held [Hz] and ``spin_ratio``, the largest angular speed of the hub over the
        part's own angular frequency [-].
    """
    data = data_of(run)
    about = elastic_parts_of(data)
    times = sample_times(data, "elastic parts")
    deflection = floats(variable(data, "deflection", "elastic parts"))
    frequency = np.array([one["frequency"] for one in about.values()])
    found = {
        "peak_deflection": np.abs(deflection).max(axis=0),
        "rms_deflection": np.array([time_rms(times, column) for column in deflection.T]),
        "time_of_peak": times[np.abs(deflection).argmax(axis=0)],
        "peak_energy": modal_energy(data).max(axis=0),
        "lost": floats(data["total_elastic_loss"]),
        "frequency": frequency,
        "spin_ratio": floats(data["peak_spin"]) / (2.0 * math.pi * frequency),
    }
    return table("elastic motion", found, {"elastic_part": list(about)})


@takes()
def said_of_spin(run: RunLike) -> str:
    """Return a warning of elastic parts that soften by spin; empty without any.

    A mass on a spring that spins with its hub feels the spring less the centrifugal force: its frequency
    falls, and above a spin of its own angular frequency it runs away. A real structure stiffens.
    """
    data = data_of(run)
    about = elastic_parts_of(data)
    ratios = {
        name: float(spin) / (2.0 * math.pi * about[name]["frequency"])
        for name, spin in zip(
            names_along(data, "elastic_part"),
            data["peak_spin"].values if "peak_spin" in data else (),
            strict=False,
        )
    }
    worst = max(ratios, key=ratios.__getitem__, default=None)
    if worst is None or not ratios[worst] > SPIN_WITHIN:
        return ""
    part, ratio = about[worst], ratios[worst]
    spin = readable(2.0 * math.pi * part["frequency"] * ratio, "rad/s", 3)
    own = f"{number(ratio, 2)} of what {worst} swings with ({readable(part['frequency'], 'Hz', 4)})"
    if ratio >= 1.0:
        return (
            f"{part['hub']} spins at up to {spin}, {own}: a mass on a spring runs away there, which no real "
            "structure does; do not believe its deflection"
        )
    return (
        f"{part['hub']} spins at up to {spin}, {own}: masses on springs soften with spin, by up to "
        f"{number(100.0 * (1.0 - math.sqrt(1.0 - ratio**2)), 2)} % in frequency, where a structure stiffens"
    )
