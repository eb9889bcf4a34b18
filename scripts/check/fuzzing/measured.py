"""Fits: their files by every key, and the records that they read, of every format."""

from __future__ import annotations

import functools
import io
from collections.abc import Callable, Mapping, Sequence
from random import Random
from typing import Any

import h5py
import numpy as np
import scipy.io
from robust.inputs import Change, Draft, Input, after
from robust.trials import Content

from antenna_pin.fit import FitPlan
from fuzzing.documents import Base, document, draft_of, limited, small_scenario
from fuzzing.made import swinging
from fuzzing.odd import ODD_TEXTS, as_float, odd_number
from fuzzing.texts import text_change

_FILE = "some.fit.toml"
_COLUMNS = ("time", "rate", "angle")
_ROWS = 21
_FIT: Mapping[str, Any] = {
    "format": 1,
    "scenario": "scenario.toml",
    "set": {"integrator": {"max_steps": 200}},
    "most": 3,
    "parameters": {
        "stiffness": {"key": "springs.held.stiffness", "start": 90.0, "between": [10.0, 1e3]},
        "damping": {"key": "springs.held.damping", "start": 1.2, "between": [0.01, 50.0], "scale": "log"},
        "offset": {"key": "records.test.columns.angle.offset", "start": "0 rad"},
    },
    "records": {
        "test": {
            "file": "test.csv",
            "time_unit": "ms",
            "columns": {
                "rate": {"of": "motion_rate[bore]", "sd": 0.01},
                "angle": {"of": "motion_angle[bore]", "sd": "1e-5 rad", "unit": "mrad"},
            },
        }
    },
}
# What takes the time that it asks for is asked for less, whatever a file says.
_LESS = ("most=3", "starts.count=4", "starts.keep=1", "surface.runs=16", "surface.rounds=1")


@functools.cache
def _base() -> Base:
    small = small_scenario()
    files = {**small.files, small.name: document(swinging()).encode(), "test.csv": _csv(_rows())}
    replaced = frozenset(tuple(one.partition("=")[0].split(".")) for one in _LESS)
    return Base(_FILE, FitPlan, _FIT, files, small.names, replaced)


def draw_fit(chance: Random) -> Draft:
    """Return a fit's file, whose parameters are found or asked about."""
    words = chance.choice((("--identify",), ("--out", "fit.nc"), ("--out", "fit.nc", "--profile")))
    draft = draft_of(chance, _base(), lambda sets: ["fit", _FILE, "--no-progress", *words, *sets])
    return limited(draft, _FILE, _fewer)


def _fewer(table: dict[str, Any]) -> list[str]:
    """Return options that ask for few runs in place of many."""
    return [
        f"--set={one}" for one in _LESS if isinstance(table.get(one.split(".")[0].split("=")[0]), dict | int)
    ]


# --- records -----------------------------------------------------------------------------------------------


def _rows() -> np.ndarray:
    """Return times [ms], rates [rad/s] and angles [mrad], (rows, 3)."""
    time = np.linspace(0.0, 1.0, _ROWS)
    return np.column_stack([time, np.sin(time), 0.5 * time**2])


def _csv(rows: np.ndarray) -> bytes:
    return "\n".join([",".join(_COLUMNS), *(",".join(map(repr, row)) for row in rows.tolist())]).encode()


def _mat(rows: np.ndarray) -> bytes:
    stream = io.BytesIO()
    columns = dict(zip(_COLUMNS, rows.T, strict=True))
    scipy.io.savemat(stream, {**columns, "about": "x", "all": columns}, do_compression=rows.size % 2 == 0)
    return stream.getvalue()


def _hdf5(rows: np.ndarray) -> bytes:
    stream = io.BytesIO()
    with h5py.File(stream, "w") as file:
        for name, values in zip(_COLUMNS, rows.T, strict=True):
            file.create_dataset(name, data=values)
    return stream.getvalue()


def _mat_73(rows: np.ndarray) -> bytes:
    return b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM" + bytes(384) + _hdf5(rows)


def _universal(rows: np.ndarray) -> bytes:
    sets = []
    for name, values in zip(_COLUMNS[1:], rows.T[1:], strict=True):
        head = [name, "NONE", "01-Jan-26", "NONE", "NONE"]
        head.append(f"    1         0    0         0 {name:<10}        1   3 NONE              0   0")
        head.append(f"         4{len(values):10d}         1{0.0:13.5E}{1e-3 / (_ROWS - 1):13.5E}{0.0:13.5E}")
        head += [f"{17 * (k == 0):10d}    0    0    0 {'axis':<20} NONE" for k in range(4)]
        numbers = "".join(f"{one:20.12E}" for one in values.tolist())
        lines = [numbers[k : k + 80] for k in range(0, len(numbers), 80)]
        sets += ["    -1", "    58", *head, *lines, "    -1"]
    return "\n".join(sets).encode() + b"\n"


_FORMATS: Mapping[str, Callable[[np.ndarray], bytes]] = {
    "test.csv": _csv,
    "test.txt": lambda rows: _csv(rows).replace(b".", b"|").replace(b",", b";").replace(b"|", b","),
    "test.mat": _mat,
    "73.mat": _mat_73,
    "test.nc": _hdf5,
    "test.uff": _universal,
}
_LAYOUTS: tuple[Mapping[str, Any], ...] = (
    *({}, {}, {}, {"rate": "20 kHz"}, {"gaps": "skip"}, {"window": [0.0, "0.5 ms"]}, {"clock_shift": "1 us"}),
    *({"skip": 1}, {"units_row": True}, {"time_format": "iso"}, {"time": "rate"}),
)


def draw_record(chance: Random) -> Draft:
    """Return a record of a fit, of some format, with its numbers or its bytes changed."""
    name = chance.choice([*_FORMATS])
    layout = chance.choice(_LAYOUTS)
    record = {**_FIT["records"]["test"], "file": name, **layout}
    if "rate" in layout or "time_format" in layout:
        record.pop("time_unit")
    table = {**_FIT, "records": {"test": record}}
    words = chance.choice((("--identify",), ("--identify",), ("--out", "fit.nc")))
    of_bytes = chance.random() < 0.6
    changes = tuple(
        text_change(chance) if of_bytes else _rows_change(chance, name)
        for _ in range(chance.choice((1, 1, 2)))
    )

    def made(kept: Sequence[Change]) -> Input:
        rows: Any = _rows() if of_bytes else after(kept, _rows())
        content = rows if isinstance(rows, bytes) else _FORMATS[name](rows)
        content = after(kept, content) if of_bytes else content
        files: dict[str, Content] = {**_base().files, _FILE: document(table), name: content}
        return Input(files, ["fit", _FILE, "--no-progress", *words])

    return Draft(changes, made)


def _rows_change(chance: Random, name: str) -> Change:
    """Return a change of a record's numbers; of a text also of how one is written."""
    row, column, value = chance.randrange(_ROWS), chance.randrange(3), as_float(odd_number(chance))
    text = chance.choice(ODD_TEXTS)

    def with_value(rows: np.ndarray) -> np.ndarray:
        rows = rows.copy()
        rows[row % max(len(rows), 1) :][:1, column] = value
        return rows

    edits: dict[str, Callable[[Any], Any]] = {
        f"[{row}, {column}] = {value:g}": with_value,
        f"[:, {column}] = {value:g}": lambda rows: np.where(np.arange(3) == column, value, rows),
        f"times {value:g}": lambda rows: rows * (value if 1e-100 < abs(value) < 1e100 else -1.0),
        "backwards": lambda rows: rows[::-1],
        "one row": lambda rows: rows[:1],
        "no rows": lambda rows: rows[:0],
        "in degrees": lambda rows: rows * 57.3,
        "sign turned": lambda rows: rows * [1.0, -1.0, -1.0],
        "twice": lambda rows: np.repeat(rows, 2, axis=0),
        "constant": lambda rows: rows * [1.0, 0.0, 0.0],
    }
    what = chance.choice([*edits])
    if name.endswith(("csv", "txt")) and chance.random() < 0.4:
        number = f"{0.05 * row:g}"

        def written(rows: np.ndarray) -> bytes:
            plain = rows if isinstance(rows, bytes) else _FORMATS[name](rows)
            return plain.replace(number.encode(), text.encode("utf-8", "surrogatepass"), 1)

        return Change(f"{name}: {number} is {ascii(text[:40])}", written)
    return Change(f"{name}: {what}", lambda rows: rows if isinstance(rows, bytes) else edits[what](rows))
