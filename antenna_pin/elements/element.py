"""Base of force elements: interface for system, run, scenario, result and report.

An element acts at one joint: its torque about the joint's axis is a function of time, the joint's angle and
rate. (A :class:`ForceElement` may act elsewhere; statements on joints below do not apply then.)
It is a frozen dataclass whose fields declare themselves (:mod:`antenna_pin.base.parameters`), with its
kernels in the same file, which the class names by ``kernels = __name__``:

- ``effort``, unless it has none; ``write_rates`` of its ``integrals``, unless these are the
  work of a drive, or nothing is lost;
- if it stores energy ``stored``; if its effort has kinks ``kink``; if it follows a reference ``reference``;
- if it prescribes the joint's motion ``motion``.

An element whose torque depends on its integrals (``states``) has instead of the first three ``effort_of``,
``write_rates_of`` and ``stored_of``, and where kinks depend on that ``kink_of``. Their arguments and units,
and those of all further hooks, stand in :class:`antenna_pin.elements.hook_kernels.Hooks`.

A kernel's first argument is the element as a record: its fields that are numbers (other than ``unpacked``)
and its properties that are ``packed``, under their names (:meth:`ForceElement.layout`). A kernel that needs
the numbers behind the record (:meth:`ForceElement.tail`) has them for a second argument ``tail``.

It enters by one line of :mod:`antenna_pin.elements.registry`; everything else follows from there.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import AskedFunction, check_takes, takes, told_numbers
from antenna_pin.base.parameters import check, parameters_of
from antenna_pin.base.readable import GIVEN, readable
from antenna_pin.base.records import Record, layout, numbers_of, packed, words_of
from antenna_pin.compiled.decorators import Layout, in_python, record

__all__ = [
    "GROSS_WORK",
    "IMPULSE",
    "LOSS",
    "WORK",
    "About",
    "Drive",
    "Element",
    "ForceElement",
    "Integral",
    "packed",
    "takes_tail",
]

About = Literal["bearing", "journal", "motion", "pose"]
"""What an element acts about at a joint with play: the bearing's axis, the journal's, or as the gradient of
the motion angle, which conserves energy under tilt; or on all but the turn, as a bearing does."""


@takes()
@dataclass(frozen=True, slots=True)
class Integral:
    """A number that an element integrates in a state's x.

    Attributes:
        name: What it is to the energy ledger: ``work`` is put in, ``loss`` is taken out; others do not count.
        unit: SI unit.
    """

    name: str
    unit: str = "J"


WORK = Integral("work")
GROSS_WORK = Integral("gross_work")
LOSS = Integral("loss")
IMPULSE = Integral("impulse", "N*m*s")
"""What an element has put on its joint, by size."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceElement:
    """Base of all that acts by numbers of its own, wherever that is.

    The field ``on`` is that of kinds that can be switched.

    Attributes:
        on: Whether it acts from the start on; an event may switch it.
    """

    # The module of its kernels; fields that are numbers and not in the record for these; what it integrates.
    kernels: ClassVar[str]
    unpacked: ClassVar[tuple[str, ...]] = ("on",)
    integrals: ClassVar[tuple[Integral, ...]] = ()
    # Those of its integrals, the last ones, that its effort depends on; each is of size 1 by its unit.
    states: ClassVar[tuple[Integral, ...]] = ()
    # Parameters that say how it starts: no event sets them later.
    at_start: ClassVar[tuple[str, ...]] = ()
    # Whether a result has its torque over time, as it has that of all but springs.
    traced: ClassVar[bool] = False
    # Its number that controllers and a session command; "" where there is none.
    commanded: ClassVar[str] = ""
    # Parameters of which a scenario asks that one is above zero: without, it would do nothing.
    one_above_zero: ClassVar[tuple[str, ...]] = ()
    # Labels of parameters in the description, in its order.
    labels: ClassVar[Mapping[str, str]] = MappingProxyType({})

    def __post_init__(self) -> None:
        """Check the parameters."""
        check(self)

    @property
    def acts_at(self) -> str | None:
        """The joint that it acts at; None if it acts elsewhere."""
        return None

    @property
    def about(self) -> About:
        """Axis of the effort at a joint with play."""
        return "motion"

    @property
    def acts(self) -> bool:
        """Return whether the element acts from the start on, by field ``on``."""
        return bool(getattr(self, "on", True))

    @property
    def under_load(self) -> bool:
        """Return whether the element has friction by its joint's own load."""
        return False

    @property
    def has_row(self) -> bool:
        """Return whether the element has a constraint row, for hold or load."""
        return self.under_load

    @property
    def instants(self) -> tuple[float, ...]:
        """Times at which steps must end: kinks of the effort, strong curvature [s]."""
        return ()

    @property
    def longest_step(self) -> float:
        """Step that still resolves the effort, its work between the step's ends included [s]."""
        return math.inf

    @property
    def edges(self) -> tuple[float, ...]:
        """Times at which it changes by itself, later than zero [s]."""
        return ()

    @property
    def has_kinks(self) -> bool:
        """Return whether the effort has kinks, zeros of kernel ``kink``, at which steps end."""
        return False

    @property
    def kinks(self) -> int:
        """Number of functions whose zeros are kinks; several by ``kink_of``, with a number."""
        return int(self.has_kinks)

    @property
    def reversals(self) -> tuple[str, ...]:
        """Joints at whose turning back its effort has a kink: steps end there too."""
        return ()

    @classmethod
    def hook(cls, name: str) -> Any:
        """Return a kernel of its kind, None if it has none of the name."""
        return getattr(sys.modules[cls.kernels], name, None)

    def own_kernel(self, name: str) -> Callable[..., Any]:
        """Return a kernel of the kind with its first arguments, the element's numbers, bound."""
        hook, layout, words = self.hook(name), self.layout(), self.words_of_kernel()
        size = words_of(layout)
        own = record(words[:size], layout)
        given = (own, words[size:]) if takes_tail(hook) else (own,)
        return lambda *arguments: hook(*given, *arguments)

    @classmethod
    def layout(cls) -> Layout[Any]:
        """Return the layout of its record for kernels, that of the class which names these."""
        return _layout(next(base for base in cls.__mro__ if "kernels" in vars(base)))

    def tail(self) -> tuple[float, ...]:
        """Return numbers of which there may be any many; they stand behind its record."""
        return ()

    def words_of_kernel(self) -> NDArray[np.float64]:
        """Return its numbers for the kernels, as one flat array."""
        own = np.zeros(1, dtype=self.layout())
        for name in own.dtype.names or ():
            own[name] = getattr(self, name)
        return np.concatenate([own.view(np.float64), np.array(self.tail(), dtype=float)])

    @classmethod
    def own_keys(cls) -> tuple[str, ...]:
        """Return the fields that a run writes, and no scenario."""
        return ()

    @property
    def ends(self) -> tuple[float, ...]:
        """Ends of the element's range, at which a run ends [rad] ([m])."""
        return ()

    def check_begin(self, place: str, angle: float) -> None:
        """Refuse a start at which it cannot act.

        Args:
            place: Its name, for the message.
            angle: Of its joint [rad] ([m]).
        """

    def check_span(self, place: str, begin: float, end: float) -> None:
        """Refuse a run beyond the times of the element's data.

        Args:
            place: Its name, for the message.
            begin: Start of the run [s].
            end: End of the run [s].
        """

    def words(self, slides: bool = False) -> str:
        """Return the description, at a joint that slides or turns: labels with numbers and units."""
        return ", ".join(self.said_of(self.labels, slides))

    def text_of(self, name: str, slides: bool) -> str:
        """Return one of its parameters with its unit, of a joint that slides or turns."""
        return readable(getattr(self, name), self.unit(name, slides), GIVEN)

    def said_of(self, words: Mapping[str, str], slides: bool) -> list[str]:
        """Return the nonzero parameters of the element, each behind its label."""
        return [
            f"{word} {self.text_of(name, slides)}" for name, word in words.items() if getattr(self, name, 0)
        ]

    def unit(self, name: str, slides: bool) -> str:
        """Return the unit of one of its parameters as :mod:`antenna_pin.base.readable` takes it."""
        found = parameters_of(type(self))[name]
        return (
            (found.sliding if slides and found.sliding else found.unit).replace("**", "^").replace("*", " ")
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Element(ForceElement):
    """Base of the force elements at a joint; the reaction acts on the joint's parent.

    Attributes:
        joint: Name of the joint.
    """

    # Whether its effort depends on the joint's motion; whether it follows a reference.
    senses: ClassVar[bool] = False
    tracks: ClassVar[bool] = False
    # Whether Python writes the numbers of its record before each evaluation (``given``).
    in_python: ClassVar[bool] = False

    joint: str

    @property
    def acts_at(self) -> str | None:
        """The joint that it acts at."""
        return self.joint

    @property
    def measured(self) -> str:
        """Joint whose motion the element follows: its own unless given."""
        return self.joint

    @property
    def functions(self) -> tuple[tuple[str, Callable[..., float], int], ...]:
        """User's functions of the element: name, function, number of arguments of time, angle and rate."""
        return ()

    def __post_init__(self) -> None:
        """Check the parameters, and that the functions can be called."""
        ForceElement.__post_init__(self)
        for name, function, count in self.functions:
            check_takes(self, name, function, *(word for word, _ in _motion_words(False)[:count]))

    def callbacks(self, place: str, slides: bool) -> tuple[AskedFunction, ...]:
        """Return the functions for a run.

        Args:
            place: Its name, for messages about them.
            slides: Whether the joint slides along its axis rather than turning about it.
        """
        from antenna_pin.compiled.given_functions import callable_of

        words = _motion_words(slides)
        return tuple(
            AskedFunction(f"{place}: {name}", callable_of(function, count), told_numbers(words[:count]))
            for name, function, count in self.functions
        )

    def record_numbers(
        self, functions: Sequence[Callable[..., float]], t: float, angle: float, rate: float
    ) -> tuple[float, ...]:
        """Return the numbers of its record, if Python writes them.

        Args:
            functions: Its own, as :meth:`asked` has them.
            t: Time [s].
            angle: Of the joint.
            rate: Of the joint.
        """
        raise NotImplementedError

    def check_joint(self, place: str, slides: bool) -> None:
        """Refuse a joint at which it cannot act.

        Args:
            place: Its name, for the message.
            slides: Whether the joint slides along its axis rather than turning about it.
        """

    def check_measured(self, place: str, slides: bool, measured: bool) -> None:
        """Refuse another joint whose motion it cannot see.

        Args:
            place: Its name, for the message.
            slides: Whether its own joint slides along its axis rather than turning about it.
            measured: Likewise of the other joint.
        """


def _motion_words(slides: bool) -> tuple[tuple[str, str], ...]:
    """Return name and unit of the arguments of functions of a joint's motion."""
    unit = "m" if slides else "rad"
    return ("t", "s"), ("position" if slides else "angle", unit), ("rate", f"{unit}/s")


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive(Element):
    """Base of the elements that put work in.

    Attributes:
        axis: Part whose axis the torque acts about, at joints with play.
    """

    integrals: ClassVar[tuple[Integral, ...]] = (WORK, GROSS_WORK)

    axis: Literal["bearing", "journal"] = "bearing"
    on: bool = True

    @property
    def about(self) -> About:
        """Axis of the effort at a joint with play."""
        return self.axis


def takes_tail(hook: Any) -> bool:
    """Return whether a kernel takes the numbers behind its element's record."""
    return bool(in_python(hook).__code__.co_varnames[1:2] == ("tail",))


@cache
def _layout(cls: type[ForceElement]) -> Layout[Any]:
    """Return the layout of a class's record."""
    return layout(type(cls.__name__, (Record,), {"__annotations__": numbers_of(cls)}))
