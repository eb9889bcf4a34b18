"""Tables of numbers in files: curves of drives, modal data as CSV and as NASTRAN prints them."""

from __future__ import annotations

from collections.abc import Sequence
from random import Random

from robust.inputs import Change, Draft, Input, after

from antenna_pin.elements import DRIVES
from antenna_pin.scenario import DRIVE_SPECS
from fuzzing.declared import declared
from fuzzing.documents import SHORT, Base, document, scenarios, small_scenario
from fuzzing.odd import ODD_TEXTS, as_digits, misspelt, odd_number
from fuzzing.texts import text_change

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

    return Draft(tuple(_change(chance, content) for _ in range(chance.choice((1, 1, 1, 2, 3)))), made)


def draw_curve(chance: Random) -> Draft:
    """Return the file of a drive's table, of any kind that reads one."""
    base = small_scenario()
    kinds = {kind: cls.columns for kind, cls in DRIVES.items() if hasattr(cls, "columns")}
    kind = chance.choice(sorted(kinds))
    needed = {key: 0.1 for key, what in declared(DRIVE_SPECS[kind]).items() if what.required}
    drive = {**needed, "joint": "bore", "kind": kind, "file": "curve.csv"}
    for column in kinds[kind]:
        drive.pop(column, None)
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
