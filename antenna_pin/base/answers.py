"""Users' functions: their arguments and return values, and messages about both.

Drives, laws, motions, backends, events: whatever is asked in the middle of a run is asked through here, so
that an answer that is none (NaN, infinity, text, an array, a complex number, an exception) is found where it
is given, under the name of the function, with the question.
"""

from __future__ import annotations

import inspect
import math
import os
import traceback
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from antenna_pin.base.arguments import fits, unknown_type
from antenna_pin.base.interruption import FunctionInterrupted
from antenna_pin.errors import AntennaPinError, FunctionError, InvalidParameterError

__all__ = ["AskedFunction", "asked", "check_takes", "number_in", "refused", "told_numbers"]

_FINITE = "a finite number"


class AskedFunction:
    """A function that answers with a finite number, or is refused by its name.

    Args:
        name: Whose it is and what it is called.
        function: The function.
        told: Returns a question in words.
        least: The answer is this or more.
    """

    __slots__ = ("_function", "_least", "name", "told")

    def __init__(
        self,
        name: str,
        function: Callable[..., float],
        told: Callable[[Any], str],
        least: float = -math.inf,
    ) -> None:
        """Take them as they are."""
        self.name, self.told = name, told
        self._function, self._least = function, least

    def __call__(self, *question: Any) -> float:
        """Return the answer to a question.

        Raises:
            FunctionError: There is none.
        """
        try:
            answer = self._function(*question)
        except BaseException as error:
            raise refused(self.name, self.told(question), self._rule, error) from error
        # Most answers: a check that costs next to nothing.
        if type(answer) is float and answer - answer == 0.0 and answer >= self._least:
            return answer
        number = number_in(answer)
        if number is None or not math.isfinite(number) or not number >= self._least:
            raise FunctionError(self.name, self.told(question), self._rule, unknown_type(answer))
        return number

    @property
    def _rule(self) -> str:
        return _FINITE if self._least == -math.inf else f"{_FINITE}, {self._least:g} or more"


def asked(name: str, told: str, rule: str, function: Callable[..., Any], *question: Any) -> Any:
    """Return the value of a function, unchecked.

    Args:
        name: Whose it is and what it is called.
        told: The question in words.
        rule: What it must answer, as it reads after "must give".
        function: The function.
        *question: What it is asked.

    Raises:
        FunctionError: It raises something.
    """
    try:
        return function(*question)
    except BaseException as error:
        raise refused(name, told, rule, error) from error


def refused(name: str, told: str, rule: str, error: BaseException) -> BaseException:
    """Return what is raised where a function raises something: an exit or a want of memory ends no run."""
    if isinstance(error, FunctionError | FunctionInterrupted):
        return error  # of another that it has asked
    if isinstance(error, KeyboardInterrupt):
        return FunctionInterrupted()
    said = " ".join(str(error).split())
    if isinstance(error, AntennaPinError):  # which says where itself
        return FunctionError(name, told, rule, said)
    where = traceback.extract_tb(error.__traceback__)[-1]
    line = f"{os.path.basename(where.filename)}, line {where.lineno}"
    got = f"the error {type(error).__name__}{': ' if said else ''}{said} ({line})"
    return FunctionError(name, told, rule, got)


def number_in(answer: object) -> float | None:
    """Return an answer as a number, finite or not; None if it is none: true, text and arrays are none."""
    try:
        return float(answer) if fits(answer, float) else None  # type: ignore[arg-type]
    except OverflowError:  # a whole number beyond all floats
        return math.inf


def told_numbers(words: Sequence[tuple[str, str]]) -> Callable[[Sequence[float]], str]:
    """Return a function's numerical arguments in words, by the name and the unit of each."""
    return partial(_told, tuple(words))


def _told(words: Sequence[tuple[str, str]], question: Sequence[float]) -> str:
    told = zip(words, question, strict=True)
    return ", ".join(f"{name} = {value:.9g} {unit}" for (name, unit), value in told)


def check_takes(place: object, name: str, function: Any, *arguments: str) -> None:
    """Refuse objects that cannot be called with given arguments: no function, a class, other arguments.

    Args:
        place: Whose it is, for the refusal.
        name: Which one.
        function: The function.
        *arguments: Names of what it is asked, in their order.

    Raises:
        InvalidParameterError: With what was expected and what was got.
    """
    rule = (
        f"a function of {len(arguments)} argument{'s' if len(arguments) > 1 else ''} ({', '.join(arguments)})"
    )
    if not callable(function) or inspect.isclass(function):
        raise InvalidParameterError(place, name, rule, said=unknown_type(function))
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):  # some of those in C do not say
        return
    try:
        signature.bind(*arguments)
    except TypeError:
        raise InvalidParameterError(place, name, rule, said=f"one of {signature}") from None
