"""Numbers of a run, as its own methods."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any

import pandas as pd  # type: ignore[import-untyped]
import xarray as xr

from antenna_pin import analysis
from antenna_pin.analysis import (
    error_components,
    numbers_of,
    pointing_error,
    pointing_indices,
    quantity,
    spectrogram,
    spectrum,
)
from antenna_pin.base.arguments import takes
from antenna_pin.errors import UnknownNameError
from antenna_pin.trajectory import Trajectory


@takes()
def item_of(run: Trajectory, name: str) -> xr.DataArray:
    """Return a quantity of a run by name over time, with its unit (:func:`antenna_pin.analysis.quantity`).

    Raises:
        UnknownNameError: There is none; names that come near are listed.
        FileFormatError: The result is a lean one, without series.
    """
    found = quantity(run, name)
    about = {"units": found.units, "long_name": found.meaning}
    time = xr.Variable("time", found.time, {"units": "s"})
    return xr.DataArray(found.values, {"time": time}, name=found.name, attrs=about)


#: Functions of ``antenna_pin.analysis`` whose first argument is a run.
OF_A_RUN = """
    answer base_loads base_motion bearing_up blow_statistics blows body_motion body_poses body_twists
    bore_load boresight closure_loads coupling_loads deviation deviation_measures deviation_over_time
    drive_loads drive_power elastic_motion gear_contacts gear_impacts impacts joint_loads journal_motion
    latch_events load_statistics modal_energy orbit_angles phase_portrait pointing_error quantities
    quantity scenario_shares scenario_spans settling signals stop_impacts
""".split()


class RunNumbers:
    """Numbers of a run: ``run.analyse()`` has all that ``antenna-pin analyse`` prints.

    One analysis alone is a function of the same name in :mod:`antenna_pin.analysis`, such as
    ``run.analyse.impacts()`` or ``run.analyse.deviation(ideal)``.
    """

    def __init__(self, run: Trajectory) -> None:
        """Bind the analyses to a run."""
        self._run = run

    def __call__(self, ideal: Trajectory | None = None, *, longest_gap: float | str = 1e-3) -> dict[str, Any]:
        """Return what the run shows: deviation, impacts, loads, settling, closed loops, frequencies.

        Args:
            ideal: The run of the ideal joint, to compare with.
            longest_gap: Longest time apart that counts as lasting contact [s].

        Returns:
            Lists of rows in plain numbers (:func:`antenna_pin.analysis.numbers_of`).
        """
        return numbers_of(self._run, ideal, longest_gap=longest_gap)

    def frame(self, part: str, ideal: Trajectory | None = None) -> Any:
        """Return a part of it as a table of pandas.

        Args:
            part: ``impacts``, ``loads``, ``settling``, ``frequencies``, or what else there is.
            ideal: The run of the ideal joint, which ``deviation`` is from.

        Raises:
            UnknownNameError: The run has no such part.
        """
        found = self(ideal)
        tables = {name: rows for name, rows in found.items() if isinstance(rows, list) and name != "notes"}
        if part not in tables:
            raise UnknownNameError("analyse", "part", part, tables)
        return pd.json_normalize(tables[part])

    def spectrum(self, of: str, **options: Any) -> xr.Dataset:
        """Return the amplitude spectral density of a quantity.

        Args:
            of: Its name; ``quantities()`` lists them.
            **options: Of :func:`antenna_pin.analysis.spectrum`: ``rate``, ``segment``.
        """
        one = quantity(self._run, of)
        return spectrum(one.time, one.values, units=one.units, **options)

    def spectrogram(self, of: str, **options: Any) -> xr.Dataset:
        """Return the power spectral density of a quantity as it changes.

        Args:
            of: Its name; ``quantities()`` lists them.
            **options: Of :func:`antenna_pin.analysis.spectrogram`: ``rate``, ``segment``.
        """
        one = quantity(self._run, of)
        return spectrogram(one.time, one.values, units=one.units, **options)

    def pointing(self, ideal: Trajectory | None = None, **options: Any) -> xr.Dataset:
        """Return pointing indices [rad] (ECSS-E-ST-60-10C).

        Args:
            ideal: The run that points as it should; if left out, what the scenario commands.
            **options: Of :func:`antenna_pin.analysis.pointing_indices`: ``window``, ``confidence``, ...
        """
        errors = pointing_error(self._run, ideal)
        return pointing_indices(errors["time"], error_components(errors), **options)

    def __getattr__(self, name: str) -> Callable[..., Any]:
        """Return an analysis, bound to the run."""
        if name not in OF_A_RUN:
            if name.startswith("_"):
                raise AttributeError(name)
            raise AttributeError(str(UnknownNameError("analyse", "analysis", name, dir(self))))
        function = getattr(analysis, name)

        @functools.wraps(function)
        def bound(*arguments: Any, **options: Any) -> Any:
            return function(self._run, *arguments, **options)

        signature = inspect.signature(function)
        bound.__signature__ = signature.replace(  # type: ignore[attr-defined]
            parameters=list(signature.parameters.values())[1:]
        )
        return bound

    def __dir__(self) -> list[str]:
        """Return the names of analyses."""
        return sorted({*OF_A_RUN, "frame", "spectrum", "spectrogram", "pointing"})

    def __repr__(self) -> str:
        """Show how it is used."""
        return "Analyses of this run: analyse() for all, analyse.NAME(...) for one, of\n  " + ", ".join(
            dir(self)
        )
