"""``antenna-pin vibration``: responses to a shaken base, spectral densities, shock response spectra.

Errors leave here as exceptions; :mod:`antenna_pin.apps.cli` turns them into one line and an exit code.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import figure_target, label_of, load_result
from antenna_pin.apps.cli._export import csv_target, exported, plain, save_plot
from antenna_pin.apps.cli._options import option, several
from antenna_pin.apps.cli._tables import number_text, print_rows
from antenna_pin.apps.cli._usage import command_group, positive_quantity
from antenna_pin.base.readable import bare, decimal_in
from antenna_pin.errors import InvalidParameterError

if TYPE_CHECKING:
    import xarray as xr

    from antenna_pin.trajectory import Trajectory

app = command_group(
    "vibration", "Vibration: responses to a shaken base, spectral densities, shock response spectra."
)

OfOption = Annotated[
    str | None,
    option(
        "Quantity of the run (phase --list has all); the last link's acceleration if left out.",
        "NAME",
        "--of",
    ),
]
SegmentOption = Annotated[str | None, option("Length of a window; an eighth of the run if left out.", "TIME")]
FigureOption = Annotated[Path | None, option("Figure of the result: png, pdf or svg.", "FILE", "--plot")]


def response(
    file: options.Result,
    of: OfOption = None,
    to: Annotated[
        str | None,
        option("Quantity of the excitation; the base's acceleration if left out. Not for a sweep.", "NAME"),
    ] = None,
    periods: Annotated[float, option("Length of a window of a sweep, in periods.")] = 10.0,
    segment: SegmentOption = None,
    plot: FigureOption = None,
    width: options.FigureWidth = options.Width.PAGE,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Compute the response to a shaken base over the frequency.

    A swept base: by synchronous demodulation, with the distortion. Any other: by the ratio of spectra, with
    the coherence.
    """
    from antenna_pin.analysis import shakes_of, swept_response

    target, figure = csv_target(csv), figure_target(plot, "vibration", "--plot")
    run = load_result(file, scenario=False)
    swept = to is None and any("pieces" in one["shakes"] for one in shakes_of(run).values())
    if figure is not None and not swept:
        rule = "left out: the figure is of a swept base; --csv has the numbers"
        raise InvalidParameterError("vibration", "--plot", rule, str(figure))
    if swept:
        found = swept_response(run, _name(run, of), periods=periods)
    else:
        found = _transferred(run, of, to, segment)
    names = (
        ("frequency", "way", "time", "gain", "phase", "amplitude", "base", "distortion")
        if swept
        else ("frequency", "gain", "phase", "coherence", "error")
    )
    rows = _rows(found, names)
    facts = {"file": str(file), **{key: plain(value) for key, value in found.attrs.items()}, "response": rows}
    silent = exported(facts, rows, as_json, target)
    if not silent and swept:
        _print_peaks(found, label_of(run, file))
    elif not silent:
        largest = [row for row in rows if row["coherence"] is not None and row["frequency"] > 0.0]
        largest = sorted(largest, key=lambda row: -row["gain"])[:8]
        head = ["frequency [Hz]", "gain [-]", "coherence [-]", "standard error [%]"]
        shown = []
        for row in sorted(largest, key=lambda row: row["frequency"]):
            values = (row["frequency"], row["gain"], row["coherence"], 100.0 * row["error"])
            shown.append([*map(number_text, values)])
        print_rows(f"{label_of(run, file)}: {found.attrs['target']}, largest gains", head, shown)
    if figure is not None:
        from antenna_pin.show.plot import figure_swept

        save_plot(figure_swept(run, of, periods=periods, width=width.value), figure, as_json)


def density(
    file: options.Result,
    of: OfOption = None,
    segment: SegmentOption = None,
    confidence: Annotated[float, option("Probability of the interval.")] = 0.95,
    band: Annotated[list[str] | None, several("Band for a root mean square [Hz].", "LOW,HIGH")] = None,
    plot: FigureOption = None,
    width: options.FigureWidth = options.Width.PAGE,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Compute a quantity's power spectral density with confidence, and rms values of bands."""
    from antenna_pin.analysis import band_rms, power_density, quantity

    target, figure = csv_target(csv), figure_target(plot, "vibration", "--plot")
    run = load_result(file, scenario=False)
    one = quantity(run, _name(run, of))
    length = _segment(segment)
    found = power_density(one.time, one.values, segment=length, confidence=confidence, units=one.units)
    bands = band_rms(found, None if band is None else [_band(text) for text in band])
    rows = _rows(found, ("frequency", "power", "lower", "upper"))
    in_bands = _rows(bands, ("low", "high", "rms", "standard_error"))
    facts = {"file": str(file), "of": one.name, "units": one.units, **plain(dict(found.attrs))}
    if not exported(facts | {"bands": in_bands, "density": rows}, rows, as_json, target):
        head = ["from [Hz]", "to [Hz]", f"rms [{one.units}]", "standard error"]
        shown = [[number_text(value) for value in row.values()] for row in in_bands]
        print_rows(f"{label_of(run, file)}: {one.name}", head, shown)
    if figure is not None:
        from antenna_pin.show.plot import figure_density

        save_plot(figure_density(run, of, segment=length, width=width.value), figure, as_json)


def shock(
    file: options.Result,
    of: OfOption = None,
    quality: Annotated[float, option("Q of the oscillators, 1/(2 damping ratio).")] = 10.0,
    plot: FigureOption = None,
    width: options.FigureWidth = options.Width.PAGE,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Compute the shock response spectrum of an acceleration."""
    from antenna_pin.analysis import quantity, shock_spectrum

    target, figure = csv_target(csv), figure_target(plot, "vibration", "--plot")
    run = load_result(file, scenario=False)
    one = quantity(run, _name(run, of))
    found = shock_spectrum(one.time, one.values, quality=quality, units=one.units)
    names = ("frequency", "positive", "negative", "maximum", "residual", "pseudo_velocity")
    rows = _rows(found, names)
    facts = {"file": str(file), "of": one.name, "units": one.units, "quality": quality, "spectrum": rows}
    if not exported(facts, rows, as_json, target):
        head = ["natural frequency [Hz]", *(f"{name} [{one.units}]" for name in names[1:5])]
        head.append(f"pseudo-velocity [{one.units} s]")
        shown = [[number_text(value) for value in row.values()] for row in rows[::12]]
        print_rows(f"{label_of(run, file)}: {one.name}, Q = {quality:g}, by octaves", head, shown)
    if figure is not None:
        from antenna_pin.show.plot import figure_shock

        save_plot(figure_shock(run, of, quality=quality, width=width.value), figure, as_json)


def _name(run: Trajectory, of: str | None) -> str:
    """Return the selected quantity, or the last link's acceleration on a shaken base."""
    from antenna_pin.analysis import shaken_target, shakes_of

    if of is None and not shakes_of(run):
        rule = "given for a run whose base is not shaken: --of NAME"
        raise InvalidParameterError("vibration", "--of", rule, said="nothing")
    return shaken_target(run) if of is None else of


def _transferred(run: Trajectory, of: str | None, to: str | None, segment: str | None) -> xr.Dataset:
    from antenna_pin.analysis import base_quantity, quantity, shakes_of, transfer

    if to is None and not shakes_of(run):
        rule = "given for a run whose base is not shaken: --to NAME"
        raise InvalidParameterError("vibration", "--to", rule, said="nothing")
    one, cause = quantity(run, _name(run, of)), quantity(run, to or base_quantity(run))
    found = transfer(one.time, cause.values, one.values, segment=_segment(segment))
    return found.assign_attrs(target=one.name, source=cause.name, units=f"({one.units})/({cause.units})")


def _print_peaks(response: xr.Dataset, label: str) -> None:
    """Print the peak of the response in each direction of the sweep."""
    import numpy as np

    shown = []
    for way, word in ((1, "up"), (-1, "down"), (0, "at one frequency")):
        one = response.isel(window=np.flatnonzero(response["way"].values == way))
        if not one.sizes["window"]:
            continue
        at = one.isel(window=int(np.argmax(one["gain"].values)))
        frequency = one["frequency"].values
        numbers = [float(frequency.min()), float(frequency.max())]
        numbers += [float(at[name]) for name in ("frequency", "gain", "amplitude")]
        numbers.append(100.0 * float(one["distortion"].max()))
        shown.append([word, *map(number_text, numbers)])
    gain, amplitude = (str(response[name].attrs["units"]) for name in ("gain", "amplitude"))
    head = [
        "way",
        "from [Hz]",
        "to [Hz]",
        "largest at [Hz]",
        f"gain [{'-' if gain == '(m/s^2)/(m/s^2)' else gain}]",
        f"amplitude [{amplitude}]",
        "largest distortion [%]",
    ]
    print_rows(
        f"{label}: {response.attrs['target']} over the base's acceleration", head, shown, numbers=False
    )


def _rows(table: xr.Dataset, names: Sequence[str]) -> list[dict[str, Any]]:
    """Return one row for each entry of a dataset of one dimension."""
    columns = [table[name].values.tolist() for name in names]
    return [plain(dict(zip(names, row, strict=True))) for row in zip(*columns, strict=True)]


def _segment(text: str | None) -> float | None:
    return None if text is None else positive_quantity(text, "s", "--segment", "vibration")


def _band(text: str) -> tuple[float, float]:
    numbers = [decimal_in(part) for part in text.split(",")]
    low, high = numbers if len(numbers) == 2 else (None, None)
    if low is None or high is None:
        raise InvalidParameterError("vibration", "--band", "two frequencies such as 20,200", str(bare(text)))
    return low, high


for _command in (response, density, shock):
    app.command()(_command)
