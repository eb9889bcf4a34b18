"""Errors as exceptions that a user can act on.

Every error derives from :class:`AntennaPinError` and from the built-in it refines. A message gives the
place, the rule, the value seen and a way out, in one line. What only a run can find out is not an exception
but an :class:`antenna_pin.trajectory.Outcome`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

__all__ = [
    "AntennaPinError",
    "FileFormatError",
    "FunctionError",
    "InvalidParameterError",
    "MechanismError",
    "MissingToolError",
    "OutputError",
    "ScenarioError",
    "TooLargeError",
    "UnknownNameError",
    "nearest",
    "one_line",
    "printable",
]

# Letters of a message: more than any needs that was not handed a name or a number without end.
_HEAD, _TAIL = 800, 300
# Blanks of all widths, which Python holds not to be printable; a line's end is none of them.
_BLANKS = "\u00a0\u2007\u2009\u200a\u202f"


def printable(text: str) -> str:
    """Return a text safe for a terminal, with control characters escaped as in Python.

    With them a name or a title could command the terminal. A line's end is one of them.
    """
    if text.isprintable():
        return text
    return "".join(
        letter if letter.isprintable() or letter in _BLANKS else letter.encode("unicode_escape").decode()
        for letter in text
    )


def one_line(text: str) -> str:
    """Return a message as one line, without its middle if it is too long."""
    left_out = len(text) - _HEAD - _TAIL
    if left_out > 0:
        text = f"{text[:_HEAD]} [... {left_out} letters ...] {text[-_TAIL:]}"
    return printable(text)


class AntennaPinError(Exception):
    """Root of every error that this package raises on purpose."""

    def __init__(self, *arguments: object) -> None:
        """Take the message as one line."""
        super().__init__(*(one_line(one) if isinstance(one, str) else one for one in arguments))


class NotSimulatedWarning(UserWarning):
    """Something of a URDF is left out of what is simulated."""


class AssumedWarning(UserWarning):
    """Warning of an assumption that neither a scenario nor its URDF states."""


class StiffRunWarning(UserWarning):
    """Stiffness that limits the explicit steps of a run; an implicit method allows longer ones."""


class LongRunWarning(UserWarning):
    """Long expected duration of a run, with the estimate and the cause."""


class LedgerOpenWarning(UserWarning):
    """Error of a run's energy or momentum balance beyond that explained by the tolerance."""


class InvalidParameterError(AntennaPinError, ValueError):
    """A parameter breaks a rule of the thing it describes.

    Args:
        place: The object (its class name is used) or the name of the place.
        parameter: Name of the parameter.
        rule: What the value must be, as it reads after "must be".
        value: The value seen; taken from the object where it is left out.
        said: The value as the message shows it, if not as Python does; ``"0.1 s"``.
    """

    def __init__(
        self, place: object, parameter: str, rule: str, value: object = None, *, said: str | None = None
    ) -> None:
        """Compose the one-line message."""
        if isinstance(place, str):
            name = place
        else:
            name = type(place).__name__
            value = getattr(place, parameter, value) if value is None else value
        #: What is wrong, as it reads after the name of the parameter.
        self.reason = f"must be {rule}, got {_repr(value) if said is None else said}"
        super().__init__(f"{name}: {parameter} {self.reason}")
        self.parameter = parameter
        self.rule = rule


class FunctionError(AntennaPinError, RuntimeError):
    """A function of a user's has no answer that can be used, or raises something.

    A run ends by it as :class:`antenna_pin.trajectory.Outcome` ``FUNCTION_FAILED``, and keeps what it has.

    Args:
        name: Whose it is and what it is called.
        question: Arguments of the call, as text.
        rule: What it must give, as it reads after "must give".
        got: What it gave instead.
    """

    def __init__(self, name: str, question: str, rule: str, got: str) -> None:
        """Compose the one-line message."""
        #: What was seen, as it reads in a message of a run.
        self.seen = f"{name} of {question} gave {got}"
        super().__init__(f"{name} must give {rule}, got {got} of {question}")
        self._parts = name, question, rule, got

    def __reduce__(self) -> tuple[type[FunctionError], tuple[str, str, str, str]]:
        """Be made anew of its parts in another process."""
        return type(self), self._parts


class ScenarioError(AntennaPinError, ValueError):
    """A scenario file or an override of it is not valid."""


class MechanismError(AntennaPinError, ValueError):
    """A URDF is not a mechanism, or a change asked of it makes no sense."""


class UnknownNameError(AntennaPinError, LookupError):
    """A name that the thing named does not have.

    Args:
        place: Where the name stands (file and key, or the object).
        what: Kind of thing named, such as "joint".
        name: The name seen.
        known: The names that exist.
    """

    def __init__(self, place: str, what: str, name: str, known: Iterable[str]) -> None:
        """Compose the one-line message with the nearest known name."""
        names = sorted(known)
        guess = nearest(name, names) if isinstance(name, str) else None  # in Python it may be anything
        hint = f"did you mean {guess}? " if guess else ""
        has = ", ".join(names) if names else "none at all"
        super().__init__(f"{place}: {what} {name!r} is unknown; {hint}known: {has}")


class FileFormatError(AntennaPinError, ValueError):
    """File of an unexpected kind, or of another version of the format."""


class OutputError(AntennaPinError, OSError):
    """Result that cannot be written to the requested place."""


class TooLargeError(AntennaPinError, MemoryError):
    """Request that needs more memory than this machine has."""


class MissingToolError(AntennaPinError, RuntimeError):
    """Required program or optional package that is not installed, or does not work."""


def _repr(value: object) -> str:
    try:
        return repr(value)
    except ValueError:  # an integer of more digits than Python prints
        return f"a {type(value).__name__} that is too long to print"


# A name is taken for a slip of another if less than this share of the longer one's letters differ: of two
# letters none may, of three one, of six two.
_SLIP = 0.4
# What a known name says beyond the words of the one given counts against it, and against a slip of all of it.
_PART, _MORE = 0.25, 0.02
_LEAST_PREFIX = 3
_LONGEST_NAME = 100
_BETWEEN_WORDS = re.compile(r"[\s_.\-/]+")


def nearest(name: str, known: Iterable[str], letters: float = math.inf) -> str | None:
    """Return the known name most similar to ``name``, or None if none is similar.

    Letters that were left out, added, mistaken or (at half the price) doubled or swapped count by their share
    of the longer name, and case does not. A word or the beginning of a known name is like it too:
    ``clearence`` is ``axial_clearance``, ``lim`` is ``limit``. Nothing is like a name of two letters but
    these letters: of the gains ``kp`` and ``kd``, ``ki`` is neither.

    Args:
        name: The name that is unknown.
        known: Those that there are.
        letters: How many letters of a word may differ at most.
    """
    if len(name) > _LONGEST_NAME:
        return None
    scored = [
        (score, other) for other in known if (score := _name_distance(name, other, letters)) is not None
    ]
    return min(scored, key=lambda one: one[0])[1] if scored else None


def _name_distance(name: str, other: str, letters: float) -> float | None:
    """Return the distance between two names; None if they are too different."""
    given, meant = name.strip().casefold(), other.casefold()
    found = [_slip(given, meant, letters)]
    if len(given) >= _LEAST_PREFIX and meant.startswith(given):
        found.append(_PART)
    words, whole = ([word for word in _BETWEEN_WORDS.split(one) if word] for one in (given, meant))
    if words and len(whole) > 1:
        slips = [
            min((s for part in whole if (s := _slip(word, part, letters)) is not None), default=None)
            for word in words
        ]
        if None not in slips:
            apart = max(slip for slip in slips if slip is not None)
            found.append(_PART + apart + _MORE * abs(len(whole) - len(words)))
    return min((one for one in found if one is not None), default=None)


def _slip(word: str, meant: str, letters: float) -> float | None:
    """Return the share of differing letters of two words; None above the limit."""
    longer = max(len(word), len(meant))
    if longer == 0 or abs(len(word) - len(meant)) > _SLIP * longer:
        return None
    apart = _distance(word, meant)
    return apart / longer if apart < _SLIP * longer and apart <= letters else None


def _distance(word: str, meant: str) -> float:
    """Return the least number of letter edits from one word to the other."""
    before: list[float] = []
    row = [float(k) for k in range(len(meant) + 1)]
    for i, letter in enumerate(word, start=1):
        last, row = row, [float(i)]
        for k, other in enumerate(meant, start=1):
            more = 0.5 if i > 1 and word[i - 2] == letter else 1.0
            less = 0.5 if k > 1 and meant[k - 2] == other else 1.0
            row.append(min(last[k] + more, row[k - 1] + less, last[k - 1] + (letter != other)))
            if i > 1 and k > 1 and letter == meant[k - 2] and word[i - 2] == other:
                row[k] = min(row[k], before[k - 2] + 0.5)
        before = last
    return row[-1]
