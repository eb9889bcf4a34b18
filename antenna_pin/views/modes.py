"""Frequency responses and recordings of modes, as their own."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from numpy.typing import ArrayLike

from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.linear import Modes, first_source, frequency_response, swing
from antenna_pin.plot import figure_response
from antenna_pin.record import record_several

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["plotted", "recorded"]


@takes()
def plotted(
    modes: Modes,
    source: str | None = None,
    targets: str | Sequence[str] | None = None,
    *,
    frequencies: ArrayLike | None = None,
    width: Literal["column", "page"] = "page",
) -> Figure:
    """Return magnitude and phase of a frequency response.

    Args:
        modes: About which state.
        source: What swings, such as ``drives.NAME`` or ``base.fx``; the first of
            :func:`antenna_pin.linear.sources_of` if left out.
        targets: What answers (:func:`antenna_pin.linear.frequency_response`).
        frequencies: Rising and positive [Hz].
        width: "column" (88 mm) or "page" (180 mm).

    Raises:
        UnknownNameError: A source or target that there is not.
        InvalidParameterError: There is nothing that could swing it.
    """
    start = first_source(modes) if source is None else source
    return figure_response(frequency_response(modes, start, targets, frequencies), width=width)


@takes()
def recorded(
    modes: Modes,
    path: str | os.PathLike[str],
    numbers: Iterable[int] | None = None,
    *,
    amplitude: float = 1.0,
) -> Path:
    """Write one page on which every mode swings; return its path.

    Args:
        modes: About which state.
        path: ``NAME.html``.
        numbers: Of the modes, from 1; all that vibrate if left out.
        amplitude: Times what is drawn by itself [-].

    Raises:
        InvalidParameterError: Nothing vibrates here, or there is no such mode.
        OutputError: It cannot be written there.
    """
    chosen = list(numbers) if numbers is not None else modes.elastic
    if not chosen:
        raise InvalidParameterError("modes", "numbers", "given, as nothing vibrates here", chosen)
    swings = [swing(modes, number, amplitude) for number in chosen]
    return record_several(swings, path, title=str(modes.data.attrs["title"]))
