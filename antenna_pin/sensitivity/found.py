"""Derivatives of a result over numbers of its scenario, as they are handed on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.base.brief import brief
from antenna_pin.base.differences import WEIGHTS
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.sensitivity.growth import Growth, growth_of
from antenna_pin.sensitivity.parameters import Parameter
from antenna_pin.trajectory import Trajectory

__all__ = ["Sensitivities", "dataset_of"]

Array = NDArray[np.float64]

# Step along derivatives of what is made of samples, in a parameter's scale.
_STEP = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class Sensitivities:
    """Derivatives of all that a run gives, over numbers of its scenario.

    Attributes:
        run: The run itself.
        parameters: The numbers, in the order of ``parameter``.
        data: By the names of the result's variables, at the times that were asked for: ``NAME``, its
            derivatives ``d_NAME`` over (..., parameter), and ``doubt_NAME``, by how much these are in doubt.
    """

    run: Trajectory
    parameters: tuple[Parameter, ...]
    data: xr.Dataset

    __repr__ = brief

    def derivative(self, variable: str) -> Array:
        """Return the derivatives of a variable of the result, (time, ..., parameter), in SI units.

        Args:
            variable: Its name, as in the result.

        Raises:
            UnknownNameError: The result has no such number.
        """
        return self._of("d_", variable)

    def doubt(self, variable: str) -> Array:
        """Return by how much :meth:`derivative` is in doubt, likewise."""
        return self._of("doubt_", variable)

    def relative(self, variable: str) -> Array:
        """Return by how much a variable changes per scale of each parameter, (time, ..., parameter).

        A hundredth of it is the change per 1 %, where scales are the parameters' values.
        """
        return np.asarray(self.derivative(variable) * np.array([one.scale for one in self.parameters]))

    def growth(self, share: float = 0.01) -> tuple[Growth, ...]:
        """Return how far derivatives can be believed: how those of the velocities grow over the samples.

        Args:
            share: Of doubt over a derivative, up to which it is believed [-].

        Raises:
            InvalidParameterError: There is no such share.
        """
        if not 0.0 < share < 1.0:
            raise InvalidParameterError("sensitivities", "share", "above 0 and below 1", share)
        scales = np.array([one.scale for one in self.parameters])
        slopes, doubts = self.derivative("v") * scales, self.doubt("v") * scales
        keys = tuple(one.key for one in self.parameters)
        return growth_of(self.data["time"].values, slopes, doubts, keys, share)

    def of(self, quantity: Callable[[xr.Dataset], Any]) -> tuple[Array, Array]:
        """Return the derivatives of what is made of samples, such as a pointing index, and their doubts.

        Samples are displaced by their derivatives, whatever made these, and the quantity is differentiated
        along: it is to be smooth but for what does not switch near by, as a largest value does.

        Args:
            quantity: Of a dataset as the result has it, at the times that were asked for: numbers, (...).

        Returns:
            (..., parameter) each; doubts are those of the samples, all on one side.
        """
        names = [str(one)[2:] for one in self.data.data_vars if str(one).startswith("d_")]
        here = self.data[names]

        def displaced(k: int, s: float, kind: str) -> Array:
            slopes = {name: self.data[f"{kind}{name}"].isel(parameter=k, drop=True) for name in names}
            parts = {name: here[name] + s * slope for name, slope in slopes.items()}
            return np.asarray(quantity(here.assign(parts)), dtype=float)

        slopes, doubts = [], []
        for k, one in enumerate(self.parameters):
            step = _STEP * one.scale
            ahead, behind = (
                np.array([displaced(k, side * j * step, "d_") for j in (1, 2, 3)]) for side in (1, -1)
            )
            sixth, fourth = np.tensordot(WEIGHTS, ahead - behind, 1) / step
            carried = np.abs(displaced(k, step, "doubt_") - displaced(k, -step, "doubt_")) / (2.0 * step)
            slopes.append(sixth)
            doubts.append(np.abs(sixth - fourth) + carried)
        return np.stack(slopes, axis=-1), np.stack(doubts, axis=-1)

    def _of(self, kind: str, variable: str) -> Array:
        if f"d_{variable}" not in self.data:
            known = [str(name)[2:] for name in self.data if str(name).startswith("d_")]
            raise UnknownNameError("sensitivities", "variable with derivatives", variable, known)
        return np.asarray(self.data[f"{kind}{variable}"].values)


def dataset_of(
    here: xr.Dataset, slopes: dict[str, Array], doubts: dict[str, Array], parameters: tuple[Parameter, ...]
) -> xr.Dataset:
    """Return variables and derivatives side by side.

    Args:
        here: The variables.
        slopes: Derivatives by variable, (..., parameter).
        doubts: Likewise.
        parameters: The parameters.
    """
    found: dict[str, tuple[tuple[str, ...], Array, dict[str, str]]] = {}
    for name, slope in slopes.items():
        dims = (*map(str, here[name].dims), "parameter")
        unit, words = (str(here[name].attrs.get(one, "")) for one in ("units", "long_name"))
        about = {"units": f"{unit} per unit of the parameter", "long_name": f"derivative of {words or name}"}
        found[f"d_{name}"] = dims, slope, about
        found[f"doubt_{name}"] = (
            dims,
            doubts[name],
            about | {"long_name": f"doubt of the {about['long_name']}"},
        )
    labels = {
        "parameter": [one.key for one in parameters],
        "parameter_value": ("parameter", [one.value for one in parameters]),
        "parameter_scale": ("parameter", [one.scale for one in parameters]),
        "parameter_unit": ("parameter", [one.unit for one in parameters]),
    }
    return here.assign(found).assign_coords(labels)
