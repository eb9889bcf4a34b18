"""Values, texts, names and bytes of files that are odd in some way."""

from __future__ import annotations

import datetime
import math
from collections.abc import Callable
from dataclasses import dataclass
from random import Random
from typing import Any

from robust.inputs import Change


@dataclass(frozen=True)
class Raw:
    """A value by its text as it stands in a file."""

    text: str


_NUMBERS = (
    *(math.nan, math.inf, -math.inf, 1e300, -1e300, 1e-300, 5e-324, -0.0, 0.0, 0, 1, -1, 2, 0.5, -0.5),
    *(1e9, -1e9, 1e-9, 1e16, 1e38, 1e154, 1e200, 1.7976931348623157e308, 2**31, 2**63, -(2**63), 2**64),
    *(10**30, 10**308, 10**309, 10**5000, 1 - 1e-16, 1 + 1e-15, 1e-15, 1e-14, 1e-12, 1e-6, 3, 7, 100, 1e5),
)
ODD_TEXTS = (
    *"| |x|0|-1|1 |nan|NaN m|inf|-inf s|1e400 m|1e-400 m|1_0 mm|0x10".split("|"),
    *"1 parsec|1 kg|1 mm|1 m|1 s|1 rad|1 N|1 N*m|1 Pa|1 m/s|1 Hz|1 %|90 deg".split("|"),
    *"1 degC|1 dB|1 m**1e9|1 m**9**9**9|1 s/0|1,5 mm|1 mm mm|1/0|1 м|１ m|1 ㎜".split("|"),
    *"١ m|\u202e1 m|1\u00a0mm|1\u200bmm|\u0430zimuth|h\u0456nge|\ufeff|a\nb|a\tb|\x1b[31m".split("|"),
    *"\x00|../../etc/passwd|/dev/null|.|/|~|no.urdf|a.b|a/b|a\\b|$HOME|%s%n|{}".split("|"),
    *"true|none|None|null|[]|{a = 1}|world|universe|root_joint|base|*".split("|"),
    *("a" * 201, "x" * 5000, "9" * 5000, "1 " + "m*" * 3000 + "m", "(" * 3000, "\U0001f6f0", "é", "e\u0301"),
)
_OTHERS: tuple[Any, ...] = (
    *(True, False, [], [1], [[1.0]], [1, "a"], ["1 m", "2 kg"], [math.nan] * 3, [0, 0, 0], [1e300] * 3),
    *([0.0] * 4, [1, 2, 3], [True, False, True], [""], {}, {"a": 1}, {"law": "hertz"}, {"kind": "x"}),
    *({"replace": True}, datetime.date(2020, 1, 1), datetime.time(1, 2, 3)),
    *(datetime.datetime(2020, 1, 1, 1, 1), [{}], [{"a": 1}]),
)
_ALIKE = str.maketrans("aeoipcx", "\u0430\u0435\u043e\u0456\u0440\u0441\u0445")  # of another alphabet


def odd_number(chance: Random) -> Any:
    """Return a number that may be at the edge of everything."""
    if chance.random() < 0.5:
        return chance.choice(_NUMBERS)
    return chance.choice((1, -1)) * 10.0 ** chance.uniform(-320, 308)


def as_float(number: Any) -> float:
    """Return a number as a float that is no larger than floats are."""
    return float(number) if abs(number) < 10**308 else 1e308


def as_digits(number: Any) -> str:
    """Return a number's text, where Python prints it."""
    return "9" * 5000 if abs(number) > 10**400 else str(number)


def odd_value(chance: Random) -> Any:
    """Return a value of any kind, odd in some way."""
    roll = chance.random()
    if roll < 0.35:
        return odd_number(chance)
    if roll < 0.95:
        return chance.choice(ODD_TEXTS if roll < 0.7 else _OTHERS)
    left, right = chance.choice((("[", "]"), ("{a = ", "}")))
    depth = chance.choice((3, 20, 40, 200, 2000))
    return Raw(left * depth + "1" + right * depth)


def misspelt(chance: Random, name: str) -> str:
    """Return a name near another: a letter lost, doubled, swapped, of other case, or of another alphabet."""
    if not name:
        return "x"
    k = chance.randrange(len(name))
    choices = (
        *(name[:k] + name[k + 1 :], name[:k] + name[k] + name[k:]),
        *(name[:k] + name[k + 1 : k + 2] + name[k] + name[k + 2 :], name.upper(), name.capitalize()),
        *(name.replace("_", "-"), name + "s", name + " ", name.translate(_ALIKE), name + "\u200b"),
        *(name + ".x", '"' + name),
    )
    return chance.choice([one for one in choices if one != name])


def text_change(chance: Random) -> Change:
    """Return a change that takes a file's bytes and returns others."""
    at, other, letter = chance.random(), chance.random(), bytes([chance.randrange(256)])
    times = chance.choice((1, 1, 1, 10, 100_000))

    def at_byte(edit: Callable[[bytes, int], bytes]) -> Callable[[bytes], bytes]:
        return lambda content: edit(content, int(at * len(content)))

    def of_lines(edit: Callable[[list[bytes], int], list[bytes]]) -> Callable[[bytes], bytes]:
        def edited(content: bytes) -> bytes:
            lines = content.split(b"\n")
            return b"\n".join(edit(lines, int(at * len(lines))))

        return edited

    def swapped(lines: list[bytes], k: int) -> list[bytes]:
        n = int(other * len(lines))
        lines[k], lines[n] = lines[n], lines[k]
        return lines

    first = at < 0.5
    edits: dict[str, Callable[[bytes], bytes]] = {
        "cut": at_byte(lambda content, k: content[:k]),
        "begun late": at_byte(lambda content, k: content[k:]),
        f"flipped {letter!r}": at_byte(lambda content, k: content[:k] + letter + content[k + 1 :]),
        f"inserted {letter!r} times {times}": at_byte(
            lambda content, k: content[:k] + letter * times + content[k:]
        ),
        "line twice": of_lines(lambda lines, k: lines[: k + 1] + lines[k:]),
        "line lost": of_lines(lambda lines, k: lines[:k] + lines[k + 1 :]),
        "lines swapped": of_lines(swapped),
        "line ends": lambda content: content.replace(b"\n", b"\r\n" if first else b"\r"),
        "marked": lambda content: b"\xef\xbb\xbf" + content,
        "wide": lambda content: content.decode("utf-8", "replace").encode("utf-16" if first else "utf-16-le"),
        "latin": lambda content: content + "# schön\n".encode("latin-1"),
        "numbers moved": lambda content: (
            content.replace(b".", b",") if first else content.replace(b"e-", b"e+")
        ),
        "repeated": lambda content: content * 2,
        "emptied": lambda content: b"" if first else bytes(100),
    }
    cut, late, flipped, inserted, *rest = edits
    name = chance.choice((cut, late, flipped, flipped, flipped, inserted, inserted, *rest))
    return Change(f"text {name} at {at:.3f}", edits[name])
