"""Tables of numbers in files: curves of drives, modal data, records, and the fits that read these."""

from __future__ import annotations

import functools
import io
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from random import Random
from typing import Any

import h5py
import numpy as np
import scipy.io
from robust.inputs import Change, Draft, Input, after, several
from robust.trials import Content

from antenna_pin.elements import DRIVES
from antenna_pin.scenario import DRIVE_SPECS
from antenna_pin.studies.fit import FitPlan
from fuzzing.declared import declared
from fuzzing.documents import SHORT, Base, base_on, document, draft_of, limited, scenarios, small_scenario
from fuzzing.made import swinging
from fuzzing.odd import ODD_TEXTS, as_digits, as_float, misspelt, odd_number, text_change

_PRINT = """1    WING                            NOVEMBER  22, 2026  MSC.NASTRAN 11/22/24   PAGE    12
0
                                              R E A L   E I G E N V A L U E S
   MODE    EXTRACTION      EIGENVALUE          RADIANS           CYCLES          GENERALIZED
    NO.       ORDER                                                                 MASS
        1         1      3.553058E+02      1.884956E+01      3.000000E+00      1.000000E+00
        2         2      1.395409E+04      1.181274E+02      1.880070E+01      1.000000E+00
1    WING                              NOVEMBER  22, 2026  MSC.NASTRAN   PAGE    13

                                MODAL PARTICIPATION FACTORS
      MODE       T1              T2              T3              R1              R2              R3
        1     2.214635E+00    0.0             0.0             0.0             0.0            -1.9+0
        2     1.227356D+00    0.0             0.0             0.0             0.0            -3.080727-01
"""


def _change(chance: Random, content: str) -> Change:
    """Return a change of a table's bytes: of a word, of a row, of anything."""
    if chance.random() < 0.35:
        return text_change(chance)
    comma = "," in content
    rows = [row for row in content.split("\n") if row.strip() and not row.startswith("#")]
    at = chance.randrange(len(rows))
    words = rows[at].split("," if comma else None)
    k, roll = chance.randrange(len(words)), chance.random()
    if roll < 0.7:
        texts = (as_digits(odd_number(chance)), chance.choice(ODD_TEXTS), misspelt(chance, words[k]))
        words[k] = chance.choice(texts)
        what = f"{words[k][:60]!r} in row {at}"
    elif roll < 0.8:
        del words[k]
        what = f"word {k} lost of row {at}"
    elif roll < 0.9:
        words.insert(k, chance.choice(("1", "x", "")))
        what = f"a word more in row {at}"
    else:
        words = [words[k]] * chance.choice((1, 2, 1000))
        what = f"other words in row {at}"
    old, new = rows[at].encode(), ("," if comma else "   ").join(words).encode("utf-8", "surrogatepass")
    return Change(what, lambda given: given.replace(old, new, 1))


def _draft(chance: Random, base: Base, table: dict[str, object], name: str, content: str) -> Draft:
    words = chance.choice((("info",), ("modes",), ("run", "--out", "out.nc", "--no-progress", *SHORT)))

    def made(kept: Sequence[Change]) -> Input:
        files = {**base.files, base.name: document(table), name: after(kept, content.encode())}
        return Input(files, [words[0], base.name, *words[1:]])

    return Draft(several(chance, lambda: _change(chance, content), 1, 1, 1, 2, 3), made)


def draw_curve(chance: Random) -> Draft:
    """Return the file of a drive's table, of any kind that reads one."""
    base = small_scenario()
    kinds = {kind: cls.columns for kind, cls in DRIVES.items() if hasattr(cls, "columns")}
    kind = chance.choice(sorted(kinds))
    needed = {key: 0.1 for key, what in declared(DRIVE_SPECS[kind]).items() if what.required}
    drive = {**needed, "joint": "bore", "kind": kind, "file": "curve.csv"}
    drive = {key: value for key, value in drive.items() if key not in kinds[kind]}
    table = {**base.table, "clearance": {}, "initial": {}, "drives": {"push": drive}}
    rows = [",".join(kinds[kind]), *(f"{k * 1e-3:g},{k % 3}" for k in range(chance.choice((2, 3, 6))))]
    return _draft(chance, base, table, "curve.csv", "\n".join(rows) + "\n")


def draw_modal(chance: Random) -> Draft:
    """Return the modal data of a flexible link, as CSV or as NASTRAN prints it."""
    wings = [base for base in scenarios() if "flexible" in base.table and "wings.csv" in base.files]
    base = chance.choice(wings)
    printed = chance.random() < 0.5
    name = "modes.f06" if printed else "modes.csv"
    content = _PRINT if printed else base.files["wings.csv"].decode()
    flexible = {
        key: {**one, "file": name} if one.get("kind") == "modal-data" else one
        for key, one in base.table["flexible"].items()
    }
    return _draft(chance, base, {**base.table, "flexible": flexible}, name, content)


# --- fits --------------------------------------------------------------------------------------------------

_FILE = "some.fit.toml"
_COLUMNS = ("time", "rate", "angle")
_ROWS = 21
_FIT: Mapping[str, Any] = tomllib.loads("""
format = 1
scenario = "scenario.toml"
set = {integrator={max_steps=200}}
most = 3
[parameters]
stiffness = {key="springs.held.stiffness", start=90.0, between=[10.0, 1e3]}
damping = {key="springs.held.damping", start=1.2, between=[0.01, 50.0], scale="log"}
offset = {key="records.test.columns.angle.offset", start="0 rad"}
[records.test]
file = "test.csv"
time_unit = "ms"
[records.test.columns]
rate = {of="motion_rate[bore]", sd=0.01}
angle = {of="motion_angle[bore]", sd="1e-5 rad", unit="mrad"}
""")
# What takes the time that it asks for is asked for less, whatever a file says.
_LESS = ("most=3", "starts.count=4", "starts.keep=1", "surface.runs=16", "surface.rounds=1")


@functools.cache
def _base() -> Base:
    base = base_on(swinging(), _FILE, FitPlan, _FIT)
    less = frozenset(tuple(one.partition("=")[0].split(".")) for one in _LESS)
    return replace(base, files={**base.files, "test.csv": _csv(_rows())}, replaced=less)


def draw_fit(chance: Random) -> Draft:
    """Return a fit's file, whose parameters are found or asked about."""
    words = chance.choice((("--identify",), ("--out", "fit.nc"), ("--out", "fit.nc", "--profile")))
    draft = draft_of(chance, _base(), lambda sets: ["fit", _FILE, "--no-progress", *words, *sets])
    return limited(draft, _FILE, _fewer)


def _fewer(table: dict[str, Any]) -> list[str]:
    """Return options that ask for few runs in place of many."""
    return [f"--set={one}" for one in _LESS if isinstance(table.get(re.split("[.=]", one)[0]), dict | int)]


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
    draw = text_change if of_bytes else functools.partial(_rows_change, name=name)
    changes = several(chance, lambda: draw(chance), 1, 1, 2)

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
