"""Rules for numbers, each stated, checked and reported by one text.

``"positive"``, ``"zero or more and below 1"``, ``"in (0, 1]"``: bounds, joined by "and"; text behind a comma
or a semicolon explains, as in ``"3 or more, or a direction is free"``. Fields of classes, tables of files,
arguments and options of commands take such a text; in an annotation as :class:`NumberRule`::

    @takes(transient="s")
    def settling(run: Trajectory, *, transient: Annotated[float, NumberRule("positive")]) -> float: ...
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from typing import Annotated

#: Rule of a temperature [K].
ABOVE_ZERO = "above absolute zero"
#: What a direction must be; a rule for all of its numbers.
A_DIRECTION = "three finite numbers, not all zero"
#: What a damping ratio must be of what swings.
SWINGS = "zero or more and below 1"

_N = r"(-?[0-9]+(?:\.[0-9]+)?)"
# Each with the interval that it means.
_SPELLINGS = tuple(
    (re.compile(words), interval)
    for words, interval in (
        (A_DIRECTION, "[ -inf inf ]"),
        ("positive", "( 0 inf ]"),
        (ABOVE_ZERO, "( 0 inf ]"),
        ("zero or more", "[ 0 inf ]"),
        (f"at least {_N}", r"[ \1 inf ]"),
        (f"{_N} or more", r"[ \1 inf ]"),
        (f"above {_N}", r"( \1 inf ]"),
        (f"at most {_N}", r"[ -inf \1 ]"),
        (f"below {_N}", r"[ -inf \1 )"),
        (f"between {_N} and {_N}", r"( \1 \2 )"),
        (f"from {_N} to below {_N}", r"[ \1 \2 )"),
        (f"from {_N} to {_N}", r"[ \1 \2 ]"),
        (rf"in ([\[(]){_N}, {_N}([\])])", r"\1 \2 \3 \4"),
    )
)
_END = re.compile(r"(?:,? and finite)?(?:[,;].*)?", re.DOTALL)
_FINITE = {"": "finite", "positive": "positive and finite", "zero or more": "zero or more, and finite"}


@dataclass(frozen=True, slots=True)
class NumberRule:
    """Annotation of a number, or of the type of several: what each must be.

    Attributes:
        text: The rule, as it reads after "must be"; "" for any number.
        finite: Whether infinity is refused.
    """

    text: str = ""
    finite: bool = True

    def __post_init__(self) -> None:
        """Refuse a text that is no rule at the import of what it annotates."""
        _bounds(self.text)


def obeys(number: float, rule: str) -> bool:
    """Return whether a number is within the bounds of a rule, infinity included."""
    for low, high, is_low_in, is_high_in in _bounds(rule):
        if not (low < number or (is_low_in and low == number)):  # written so that NaN fails too
            return False
        if not (number < high or (is_high_in and high == number)):
            return False
    return True


def finite_too(rule: str) -> str:
    """Return a rule that infinity would obey as one for finite numbers."""
    return _FINITE.get(rule, rule)


@cache
def _bounds(rule: str) -> tuple[tuple[float, float, bool, bool], ...]:
    """Return lower and upper bounds, and whether each belongs to its interval."""
    found, at = [], 0
    while rule:
        matches = ((words.match(rule, at), interval) for words, interval in _SPELLINGS)
        match, interval = next(((one, text) for one, text in matches if one), (None, ""))
        if match is None:
            raise ValueError(f"{rule!r} is no rule for numbers; see {__name__}")
        left, low, high, right = match.expand(interval).split()
        found.append((float(low), float(high), left == "[", right == "]"))
        if _END.fullmatch(rule, match.end()):
            break
        at = match.end() + len(" and ")
    return tuple(found)


Positive = Annotated[float, NumberRule("positive")]
PositiveOrInfinite = Annotated[float, NumberRule("positive", finite=False)]
NotNegative = Annotated[float, NumberRule("zero or more")]
BetweenZeroAndOne = Annotated[float, NumberRule("between 0 and 1")]
AtLeastOne = Annotated[int, NumberRule("1 or more")]
AtLeastTwo = Annotated[int, NumberRule("2 or more")]
NotNegativeInt = Annotated[int, NumberRule("zero or more")]
