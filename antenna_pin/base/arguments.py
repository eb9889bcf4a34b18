"""Arguments of public functions and classes: wrong types are refused in one line.

:func:`takes` above a function, or above a class, checks each argument against its annotation before anything
is done with it, and reads text with a unit where a number with a unit is requested::

    @takes(duration="s")
    def simulate(model: Scenario | System, *, duration: float | str | None = None) -> Trajectory: ...

An annotation is the one place that says what is taken, by type and by a rule for numbers (``Positive``,
:mod:`antenna_pin.base.rules`); relations between arguments are checked by the function or class.
"""

from __future__ import annotations

import functools
import inspect
import math
import os
import traceback
import types
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import partial
from numbers import Integral
from typing import Annotated, Any, Literal, Protocol, TypeVar, Union, cast, get_args, get_origin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.interruption import FunctionInterrupted
from antenna_pin.base.readable import alternatives
from antenna_pin.base.rules import NumberRule, finite_too, obeys
from antenna_pin.base.units import QuantityError, quantity, shown
from antenna_pin.errors import AntennaPinError, FunctionError, InvalidParameterError

_T = TypeVar("_T", bound=Callable[..., Any])
_UNIONS = (Union, types.UnionType)
_ARRAYS = (np.ndarray, NDArray)  # to NumPy 2.4 one is the other's name, from 2.5 on an alias of its own
_PLAIN = (bool, float, int, str, type(None))
_EITHER, _NAMED = inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY


def takes(**units: str | tuple[str, ...]) -> Callable[[_T], _T]:
    """Return a decorator of a function or class that refuses arguments of wrong type.

    Args:
        **units: SI unit of each parameter that may be given as text with a unit, or several; a mapping's
            values, or the entries of a sequence, each.
    """

    def decorated(one: _T) -> _T:
        if inspect.isclass(one):
            # In place: whoever has the class already has it checked.
            setattr(one, "__init__", _checked(one.__init__, one.__name__, units, one))  # noqa: B010
            return one
        return cast("_T", _checked(one, one.__name__, units, None))

    return decorated


def _checked(
    function: Any, place: str, units: Mapping[str, str | tuple[str, ...]], owner: type[Any] | None
) -> Any:
    # Of values of these types the type decides, if it has no rule: the pairs of parameter and type that fit.
    fitting: set[tuple[str, type[Any]]] = set()

    def checked(name: str, value: Any, hint: Any) -> Any:
        kind = name, type(value)
        if kind in fitting:
            return value
        read = _read(place, name, value, hint, units.get(name))
        if name in by_name()[3]:
            _check_rules(place, name, read, hint, units.get(name, ""))
        elif read is value and type(value) in _PLAIN:
            fitting.add(kind)
        if owner is None:  # a class has its own words for what its functions are asked
            _check_count(place, name, read, hint)
        return read

    @functools.cache
    def parameters() -> tuple[inspect.Signature, dict[str, Any]]:
        return inspect.signature(function), _hints(function, owner)

    @functools.cache
    def by_name() -> tuple[tuple[str, ...], dict[str, Any], frozenset[str], frozenset[str]]:
        """Return names of positional, types of all, names of required and of ruled parameters."""
        signature, hints = parameters()
        kinds = {name: one.kind for name, one in signature.parameters.items()}
        plain = not set(kinds.values()) - {_EITHER, _NAMED}
        needed = (name for name, one in signature.parameters.items() if one.default is one.empty)
        places = tuple(name for name, kind in kinds.items() if kind is _EITHER) if plain else ()
        ruled = frozenset(name for name, hint in hints.items() if "NumberRule(" in repr(hint))
        return places, {name: hints.get(name, Any) for name in kinds if plain}, frozenset(needed), ruled

    @functools.wraps(function)
    def wrapped(*arguments: Any, **more: Any) -> Any:
        places, known, needed, _ = by_name()
        # Nearly all calls: what Python itself would bind, for a fraction of what it takes to do it by hand.
        given = dict(zip(places, arguments, strict=False))
        if len(given) == len(arguments) and known.keys() >= more.keys() and not given.keys() & more.keys():
            given.update(more)
            if given.keys() >= needed:
                return function(**{k: checked(k, given[k], hint) for k, hint in known.items() if k in given})
        signature, hints = parameters()
        bound = signature.bind(*arguments, **more)
        for name, value in bound.arguments.items():
            kind = signature.parameters[name].kind
            hint = hints.get(name, Any)
            if kind is inspect.Parameter.VAR_POSITIONAL:
                read = tuple(_read(place, name, one, hint, units.get(name)) for one in value)
            elif kind is inspect.Parameter.VAR_KEYWORD:
                continue
            else:
                read = checked(name, value, hint)
            bound.arguments[name] = read
        return function(*bound.args, **bound.kwargs)

    return wrapped


def _read(place: str, name: str, value: Any, hint: Any, unit: str | tuple[str, ...] | None) -> Any:
    """Return an argument, text with a unit as a number, or refuse it."""
    if unit is not None:
        value = in_si(place, name, value, unit)
    if not fits(value, hint):
        units = (unit,) if isinstance(unit, str) else unit or ()
        rule = rule_of(hint) + (f", in {' or '.join(units)} or with a unit" if units else "")
        raise InvalidParameterError(place, name, rule, said=unknown_type(value))
    if get_origin(hint) is Iterable and isinstance(value, Iterator):
        return _each(place, name, value, hint)
    return value


def check_number(
    place: object, name: str, value: Any, rule: Any, unit: str = "", *, text: str | None = None
) -> None:
    """Refuse a number, or one of several, that breaks a rule.

    Args:
        place: The object, or name of the place, for the message.
        name: Name of the number.
        value: The number, an array or a sequence of them.
        rule: Text of the rule, or a type with it (``Positive``).
        unit: SI unit, for the message.
        text: The value as the message shows it, if not as Python does.

    Raises:
        InvalidParameterError: The rule is broken, or the number is not finite.
    """
    hint = Annotated[float, NumberRule(rule)] if isinstance(rule, str) else rule
    _check_rules(place, name, value, hint, unit, text)


def _check_rules(
    place: object,
    name: str,
    value: Any,
    hint: Any,
    unit: str | tuple[str, ...] = "",
    text: str | None = None,
) -> None:
    """Refuse numbers that break the rules of an annotation."""
    origin, inner = get_origin(hint), get_args(hint)
    if origin in _UNIONS:
        for one in inner:
            if get_origin(one) is not None and fits(value, one):
                _check_rules(place, name, value, one, unit)
    elif origin is not Annotated:
        for one in inner if isinstance(value, list | tuple | np.ndarray) else ():
            for entry in value:
                _check_rules(place, name, entry, one, unit)
    elif value is not None:
        units = [one for one in ((unit,) if isinstance(unit, str) else unit) if one not in ("", "1")]
        for rule in (one for one in inner[1:] if isinstance(one, NumberRule)):
            for number in np.ravel(value).tolist():
                if not obeys(number, rule.text) or (rule.finite and not math.isfinite(number)):
                    rule_text = finite_too(rule.text) if rule.finite else rule.text
                    rule_text += f" [{units[0]}]" if units else ""
                    raise InvalidParameterError(place, name, rule_text, value, said=text)


def _each(place: str, name: str, values: Iterator[Any], hint: Any) -> Iterator[Any]:
    """Yield what an iterator gives, each looked at when it comes."""
    (kind,) = get_args(hint) or (Any,)
    for value in values:
        if not fits(value, kind):
            raise InvalidParameterError(place, name, rule_of(hint), said=f"one of {unknown_type(value)}")
        yield value


def _check_count(place: str, name: str, value: Any, hint: Any) -> None:
    """Refuse a function that cannot be called with as many arguments as its annotation has."""
    kinds = (hint, *(get_args(hint) if get_origin(hint) in _UNIONS else ()))
    known = [get_args(kind)[0] for kind in kinds if get_origin(kind) is Callable and get_args(kind)]
    if not callable(value) or len(known) != 1 or known[0] is ...:
        return
    try:
        signature = inspect.signature(value)
    except (TypeError, ValueError):  # some of those in C do not say
        return
    try:
        signature.bind(*known[0])
    except TypeError:
        count = len(known[0])
        rule = f"a function of {count} argument{'s' if count > 1 else ''}"
        raise InvalidParameterError(place, name, rule, said=f"one of {signature}") from None


def in_si(owner: object, name: str, value: Any, unit: str | tuple[str, ...]) -> Any:
    """Return a value, or each of several, in SI units if it is text.

    Raises:
        InvalidParameterError: A text is not a quantity of the unit.
    """
    if isinstance(value, str):
        try:
            return quantity(value, unit, name)
        except QuantityError as error:
            rule, _, said = error.reason.removeprefix("must be ").partition(", got ")
            raise InvalidParameterError(owner, name, rule, said=said) from None
    if isinstance(value, Mapping):
        return {key: in_si(owner, f"{name}[{key!r}]", one, unit) for key, one in value.items()}
    if isinstance(value, list | tuple) and any(issubclass(kind, str) for kind in set(map(type, value))):
        return type(value)(in_si(owner, f"{name}[{k}]", one, unit) for k, one in enumerate(value))
    return value


def _hints(function: Any, owner: type[Any] | None) -> dict[str, Any]:
    """Return the types of a function's parameters that exist at run time."""
    names = dict(getattr(inspect.unwrap(function), "__globals__", {}))
    if owner is not None:
        names = {**vars(inspect.getmodule(owner)), **names}
    found = {}
    for name, hint in inspect.get_annotations(inspect.unwrap(function)).items():
        try:
            found[name] = eval(hint, names) if isinstance(hint, str) else hint  # noqa: S307 - our own source
        except (NameError, AttributeError, TypeError):  # a type known to the checker only
            continue
    return found


def unknown_type(value: object) -> str:
    """Return a value for a message, with its type unless a number or text."""
    if value is None or isinstance(value, str | int | float):
        return shown(value)
    return f"{shown(value)} ({type(value).__name__})"


# --- does a value fit a type? ---


def fits(value: Any, hint: Any) -> bool:
    """Return whether a value is of an annotation's type; True for uncheckable types.

    NumPy's numbers are numbers, arrays are sequences of what they hold; true and false are no numbers, and
    text is no sequence.
    """
    if type(value) is hint and hint is not np.ndarray:  # nearly all
        return True
    if hint is Any or isinstance(hint, TypeVar | str):
        return True
    if hint is None or hint is type(None):
        return value is None
    if hint == ArrayLike or get_origin(hint) in _ARRAYS or hint is np.ndarray:
        return _is_array(value, "c" if hint != ArrayLike and "complex" in str(hint) else "")
    origin, inner = get_origin(hint), get_args(hint)
    if origin is Annotated:
        return fits(value, inner[0])
    if origin in _UNIONS:
        arrays, others = _without_arrays(inner)
        return (arrays and _is_array(value, "")) or any(fits(value, one) for one in others)
    if origin is Literal:
        return any(type(one) is type(value) for one in inner)  # which of them is the function's own to say
    if origin is not None:
        return _fits_parts(value, origin, inner)
    if hint is float:
        return is_number(value)
    if hint is int:
        return isinstance(value, Integral) and not isinstance(value, bool)
    if hint is bool:
        return isinstance(value, bool | np.bool_)
    if getattr(hint, "_is_protocol", False):
        return not inspect.isclass(value) and all(hasattr(value, name) for name in _members(hint))
    return isinstance(value, hint) if isinstance(hint, type) else True


def _fits_parts(value: Any, origin: Any, inner: tuple[Any, ...]) -> bool:
    """Return whether a value is a container of a kind, and holds what it should."""
    if origin is type:
        return isinstance(value, type)
    if origin is os.PathLike:
        return isinstance(value, os.PathLike)
    if origin is Callable:
        return callable(value)
    if origin is Iterator:
        return isinstance(value, origin)
    if isinstance(value, str | bytes):
        return False
    if isinstance(origin, type) and issubclass(origin, Mapping):
        if not isinstance(value, Mapping):
            return False
        return len(inner) != 2 or all(fits(k, inner[0]) and fits(v, inner[1]) for k, v in value.items())
    if isinstance(value, Mapping):
        return origin in (Iterable, Collection) and all(fits(one, inner[0]) for one in value)
    if isinstance(value, np.ndarray):
        return value.ndim > 0 and (not inner or len(value) == 0 or fits(value[0], inner[0]))
    if origin is tuple:
        if not isinstance(value, list | tuple):
            return False
        if len(inner) == 2 and inner[1] is ...:
            return all(fits(one, inner[0]) for one in value)
        return len(value) == len(inner) and all(map(fits, value, inner))
    if origin in (list, Sequence):
        return isinstance(value, Sequence) and all(fits(one, inner[0]) for one in value)
    if not isinstance(value, origin):
        return False
    again = isinstance(value, Collection) and len(inner) == 1
    return not again or all(fits(one, inner[0]) for one in value)


@functools.cache
def _without_arrays(kinds: tuple[Any, ...]) -> tuple[bool, list[Any]]:
    """Return whether ``ArrayLike`` is among a union's kinds, and the others."""
    parts = get_args(ArrayLike) or (ArrayLike,)
    if not set(map(str, parts)) <= set(map(str, kinds)):
        return False, list(kinds)
    return True, [kind for kind in kinds if str(kind) not in set(map(str, parts))]


def is_number(value: Any) -> bool:
    """Return whether a value is a number: neither true, false, text nor several of them."""
    if isinstance(value, np.ndarray | np.generic) and (value.ndim or value.dtype.kind not in "iuf"):
        return False
    if isinstance(value, bool | str | bytes) or not hasattr(value, "__float__"):
        return isinstance(value, Integral) and not isinstance(value, bool)
    # Of these NumPy makes numbers as well, with a warning.
    if isinstance(value, np.complexfloating) or (isinstance(value, np.ndarray) and value.ndim):
        return False
    try:
        float(value)
    except (TypeError, ValueError):
        return False
    except OverflowError:  # whose rule refuses it, as not finite
        return True
    return True


def _is_array(value: Any, more: str) -> bool:
    """Return whether a value is an array of numbers, of ``more`` kinds, or of times."""
    if value is None or isinstance(value, str | bytes | Mapping):
        return False
    try:
        return np.asarray(value).dtype.kind in "biufVMm" + more or np.asarray(value).size == 0
    except (TypeError, ValueError):
        return False


def _members(protocol: Any) -> set[str]:
    bases = (one for one in protocol.__mro__ if getattr(one, "_is_protocol", False) and one is not Protocol)
    found = {name for base in bases for name in (*vars(base), *getattr(base, "__annotations__", {}))}
    return {name for name in found if not name.startswith("_") or name == "__call__"}


# --- what a type asks for, in words ---

_WORDS: Mapping[Any, str] = {
    float: "a number",
    int: "a whole number",
    bool: "true or false",
    str: "text",
    None: "None",
    type(None): "None",
    os.PathLike: "a path",
    type: "a class",
    Callable: "a function",
}


def rule_of(hint: Any) -> str:
    """Return the requirement of an annotation, to be read after "must be"."""
    hint = get_args(hint)[0] if get_origin(hint) is Annotated else hint
    try:
        if hint in _WORDS:
            return _WORDS[hint]
    except TypeError:
        pass
    if hint == ArrayLike or get_origin(hint) in _ARRAYS:
        return "an array of numbers"
    origin, inner = get_origin(hint), get_args(hint)
    if origin in _UNIONS:
        arrays, others = _without_arrays(inner)
        said = ["an array of numbers"] * arrays
        said += [rule_of(one) for one in others if one not in (None, type(None))]
        return alternatives(dict.fromkeys(said))
    if origin is Literal:
        return alternatives(map(shown, inner))
    if origin is not None and origin in _WORDS:
        return _WORDS[origin]
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return f"a mapping of names to {_many(inner[1])}" if len(inner) == 2 else "a mapping"
    if origin is tuple and inner and inner[-1] is not ...:
        return f"{len(inner)} of {_many(inner[0])}"
    if origin is not None and inner:
        return f"a sequence of {_many(inner[0])}"
    name = getattr(hint, "__name__", str(hint))
    return f"{'an' if name[:1] in 'AEIOU' else 'a'} {name}"


def _many(hint: Any) -> str:
    said = rule_of(hint)
    return {"a number": "numbers", "a whole number": "whole numbers", "text": "texts"}.get(
        said, said.partition(" ")[2] if said.startswith(("a ", "an ")) and " or " not in said else said
    )


# --- functions of a user's ----------------------------------------------------------------------------------
#
# Drives, laws, motions, backends, events: functions that a run calls are called through here, so that an
# invalid answer (NaN, infinity, text, an array, a complex number, an exception) is refused under the name of
# the function, with its arguments.

_FINITE = "a finite number"


class AskedFunction:
    """A function that answers with a finite number, or is refused by its name.

    Args:
        name: Owner and name, for messages.
        function: The function.
        describe: Returns its arguments as text.
        least: Least valid answer.
    """

    __slots__ = ("_function", "_least", "name", "told")

    def __init__(
        self,
        name: str,
        function: Callable[..., float],
        describe: Callable[[Any], str],
        least: float = -math.inf,
    ) -> None:
        """Store them."""
        self.name, self.told = name, describe
        self._function, self._least = function, least

    def __call__(self, *question: Any) -> float:
        """Return the answer for given arguments.

        Raises:
            FunctionError: It is invalid.
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


def answer_of(name: str, question: str, rule: str, function: Callable[..., Any], *arguments: Any) -> Any:
    """Return the value of a function, unchecked.

    Raises:
        FunctionError: It raises something.
    """
    try:
        return function(*arguments)
    except BaseException as error:
        raise refused(name, question, rule, error) from error


def refused(name: str, question: str, rule: str, error: BaseException) -> BaseException:
    """Return the exception for an exception of a function of the user's."""
    if isinstance(error, FunctionError | FunctionInterrupted):
        return error  # of another that it has asked
    if isinstance(error, KeyboardInterrupt):
        return FunctionInterrupted()
    said = " ".join(str(error).split())
    if isinstance(error, AntennaPinError):  # which says where itself
        return FunctionError(name, question, rule, said)
    where = traceback.extract_tb(error.__traceback__, limit=-1)[0]
    line = f"{os.path.basename(where.filename)}, line {where.lineno}"
    got = f"the error {type(error).__name__}{': ' if said else ''}{said} ({line})"
    return FunctionError(name, question, rule, got)


def number_in(answer: object) -> float | None:
    """Return an answer as a number, finite or not; None for true, text and arrays."""
    try:
        return float(answer) if fits(answer, float) else None  # type: ignore[arg-type]
    except OverflowError:  # a whole number beyond all floats
        return math.inf


def told_numbers(words: Sequence[tuple[str, str]]) -> Callable[[Sequence[float]], str]:
    """Return a function that describes numerical arguments by their names and units."""
    return partial(_with_units, tuple(words))


def _with_units(words: Sequence[tuple[str, str]], numbers: Sequence[float]) -> str:
    pairs = zip(words, numbers, strict=True)
    return ", ".join(f"{name} = {value:.9g} {unit}" for (name, unit), value in pairs)


def check_takes(place: object, name: str, function: Any, *arguments: str) -> None:
    """Refuse objects that cannot be called with given arguments: no function, a class, other arguments.

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
