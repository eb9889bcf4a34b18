"""A user's elements in Python, which act on links and joints."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any, ClassVar, Protocol

from antenna_pin.base.arguments import answer_of, check_takes, unknown_type
from antenna_pin.base.records import Floats
from antenna_pin.compiled.calls import call_3
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.desk_kernels import Desk, clear
from antenna_pin.elements.element import ForceElement, Integral, packed
from antenna_pin.elements.on_links import BOOKED, AtPoint, OnLinks
from antenna_pin.elements.points import Point, checked_point
from antenna_pin.errors import FunctionError, InvalidParameterError

# --- functions that Numba has compiled ----------------------------------------------------------------------
#
# Kernels call a function by its address with a time and the place of a stretch of numbers
# (:mod:`antenna_pin.elements.desk_kernels`); what stands there, records, is made here of how many there are.

#: Compiled functions, referenced as long as their addresses are in use.
_KEPT: list[Any] = []


def address_on_links(place: str, name: str, function: Any, sizes: tuple[int, int, int, int]) -> float:
    """Return the address of a compiled function that kernels call.

    Args:
        place: Owner of the function, for the refusal.
        name: Its name, for the refusal.
        function: Compiled by ``numba.njit``.
        sizes: Numbers of its parameters, links, joints and states.

    Raises:
        InvalidParameterError: Numba cannot compile it for these.
    """
    from numba.core.errors import NumbaError

    try:
        return float(_compiled(function, sizes).address)
    except NumbaError as error:
        first = next(line for line in str(error).splitlines() if line.strip())
        rule = "a compiled function of what an element on links sees"
        raise InvalidParameterError(
            place, name, rule, said=f"one of which Numba says: {first.strip()}"
        ) from None


@cache
def wrench_on_links(function: Any) -> Any:
    """Return a function on one link from a compiled one of time, pose, twist."""
    import numpy as np
    from numba import njit

    @njit
    def act(t: float, p: Any, links: Any, joints: Any, states: Any, whole: Any) -> None:
        link = links[0]
        pose, twist = np.zeros((4, 4)), np.zeros(6)
        pose[3, 3] = 1.0
        for i in range(3):
            pose[i, 3] = link.place[i]
            twist[i], twist[3 + i] = link.velocity[i], link.spin[i]
            for k in range(3):
                pose[i, k] = link.rotation[i, k]
        six = function(t, pose, twist)
        for k in range(3):
            link.force[k], link.torque[k] = six[k], six[3 + k]

    return act


@cache
def _compiled(function: Any, sizes: tuple[int, int, int, int]) -> Any:
    """Return a function as kernels call it, by time and address; 1 on failure."""
    from numba import carray, cfunc, float64, njit

    from antenna_pin.base.records import words_of
    from antenna_pin.compiled.intrinsics import pointer
    from antenna_pin.elements.desk_kernels import JOINT, LINK, STATE, WHOLE

    numbers, links, joints, states = sizes
    first = numbers
    second = first + words_of(WHOLE)
    third = second + links * words_of(LINK)
    fourth = third + joints * words_of(JOINT)
    end = fourth + states * words_of(STATE)

    @njit
    def call_function(t: float, all_: Any) -> None:
        function(
            t,
            all_[:first],
            all_[second:third].view(LINK),
            all_[third:fourth].view(JOINT),
            all_[fourth:end].view(STATE),
            all_[first:second].view(WHOLE)[0],
        )

    def wrapped(t: float, place: float, _: float) -> float:
        try:
            call_function(t, carray(pointer(place), (end,)))
        except Exception:
            return 1.0
        return 0.0

    own: Callable[..., float] = wrapped
    compiled: Any = cfunc(float64(float64, float64, float64), error_model="numpy")(own)
    _KEPT.append(compiled)
    return compiled


# --- elements of a user's -----------------------------------------------------------------------------------

_ASKED = ("t", "p", "links", "joints", "states", "whole")
# What is looked at before it is taken apart.
_GIVEN_AS: tuple[tuple[str, tuple[type, ...], str], ...] = (
    ("links", (list, tuple), "links, each with a point on it, in a tuple"),
    ("joints", (list, tuple), "names of joints in a tuple"),
    ("integrates", (list, tuple), "names in a tuple"),
    ("parameters", (Mapping,), "numbers by name"),
)
_GIVES = "forces and rates that are finite numbers"


class Acts(Protocol):
    """Compiled function of a user's element: reads records of links and joints, writes efforts."""

    def __call__(self, t: float, p: Any, links: Any, joints: Any, states: Any, whole: Any) -> None:
        """Act.

        Args:
            t: Time [s].
            p: The element's parameters, in their order.
            links: Of each ``place`` (3,) [m], ``velocity`` (3,) [m/s], ``rotation`` (3, 3), ``spin`` (3,)
                [rad/s], ``mass`` [kg]; to write ``force`` (3,) [N] at that place, ``torque`` (3,) [N m]. All
                in world axes.
            joints: Of each ``angle`` and ``rate``; to write ``torque`` on the child [N m] ([N]).
            states: Of each ``value``; to write ``rate``.
            whole: To write ``energy`` that it stores [J], ``loss`` [W], ``kink``: a function that passes zero
                where the forces have a kink.
        """


class InPythonOnLinks(Protocol):
    """Functions of a user's element on links."""

    @property
    def called(self) -> bool:
        """Return whether kernels call the function."""

    def ask(self, place: str, t: float, desk: Any) -> None:
        """Ask it in Python."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CallableElement(OnLinks):
    """Function of links and joints in Python: a tether, a magnetic damper.

    The function is plain Python, or compiled by ``numba.njit``, the same text either way (:class:`Acts`). All
    that it may write is zero (``kink`` 1) at a call. Equal arguments must give equal results.

    Attributes:
        act: The function.
        links: Links that it sees and acts on, each with a point in its frame [m]; ``world`` may be one.
        joints: Joints that it sees and acts at; the reaction acts on the parent.
        parameters: Numbers by name, which it has in their order.
        integrates: Names of numbers that it integrates, of size 1, from zero on.
        internal: Whether the first link takes the reaction of all others; what is written for it is left out.
        passive: Whether it puts nothing in: its work is what it says that it stores and loses. Else all its
            work is put in, and energy and loss are not evaluated. Energy must not depend on time.
        has_kink: Whether ``kink`` counts: steps end where it passes zero.
        longest: Longest step that still resolves it [s]; None for any.
    """

    kernels: ClassVar[str] = __name__

    act: Acts
    links: tuple[Point, ...] = ()
    joints: tuple[str, ...] = ()
    parameters: Mapping[str, float] = field(default_factory=dict)
    integrates: tuple[str, ...] = ()
    internal: bool = False  # type: ignore[misc]
    passive: bool = False  # type: ignore[misc]
    has_kink: bool = False
    longest: float | None = None

    def __post_init__(self) -> None:
        """Check the parameters, and that the function can be called."""
        for name, kind, rule in _GIVEN_AS:
            given: Any = getattr(self, name)
            if not isinstance(given, kind):
                raise InvalidParameterError(self, name, rule, said=unknown_type(given))
        points = tuple(checked_point(self, f"links[{k}]", one) for k, one in enumerate(self.links))
        object.__setattr__(self, "links", points)
        for name in ("joints", "integrates"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        ForceElement.__post_init__(self)
        check_takes(self, "act", self.act, *_ASKED)
        if not self.links and not self.joints:
            raise InvalidParameterError(self, "links", "given, or joints", said="neither")
        if self.internal and len(self.links) < 2:
            rule = "two or more where it is internal, or one could take no reaction of another"
            raise InvalidParameterError(self, "links", rule, said=f"{len(self.links)}")
        for name, value in self.parameters.items():
            if not isinstance(value, int | float) or not math.isfinite(value):
                raise InvalidParameterError(self, f"parameters[{name!r}]", "a finite number", value)
        if self.longest is not None and not self.longest > 0.0:
            raise InvalidParameterError(self, "longest", "positive")

    @property
    def places(self) -> tuple[Point, ...]:
        """The links that it acts on, each with a point in its frame [m]."""
        return self.links

    @property
    def states(self) -> tuple[Integral, ...]:  # type: ignore[override]
        """Names of the integrated values."""
        return tuple(Integral(name, "1") for name in self.integrates)

    @property
    def integrals(self) -> tuple[Integral, ...]:  # type: ignore[override]
        """Names of the booked and of the integrated values."""
        return (*BOOKED, *self.states)

    @property
    def has_kinks(self) -> bool:
        """Return whether the forces have kinks, given by a function."""
        return self.has_kink

    @property
    def longest_step(self) -> float:
        """Longest step that still resolves it [s]."""
        return math.inf if self.longest is None else self.longest

    @property
    def called(self) -> bool:
        """Return whether kernels call the function."""
        from antenna_pin.compiled.given_functions import is_compiled

        return is_compiled(self.act)

    @property
    def _sizes(self) -> tuple[int, int, int, int]:
        return len(self.parameters), len(self.links), len(self.joints), len(self.integrates)

    @packed
    def address(self) -> float:
        """Address of the function, zero for one in Python."""
        return address_on_links(type(self).__name__, "act", self.act, self._sizes) if self.called else 0.0

    def tail(self) -> tuple[float, ...]:
        """Return its parameters."""
        return tuple(map(float, self.parameters.values()))

    def ask(self, place: str, t: float, desk: Any) -> None:
        """Call the Python function, and check its results.

        Args:
            place: Its name, for messages about it.
            t: Time [s].
            desk: What it sees: ``(whole, links, joints, states)``, to be written to.

        Raises:
            FunctionError: It raises something, or writes what is no finite number.
        """
        import numpy as np

        clear(desk)
        whole, links, joints, states = desk
        name, told = f"{place}: act", f"t = {t:.9g} s"
        answer_of(name, told, _GIVES, self.act, t, np.array(self.tail()), links, joints, states, whole[0])
        for what, part in (("force", links), ("torque", links), ("torque", joints), ("rate", states)):
            if not np.isfinite(part[what]).all():
                raise FunctionError(name, told, _GIVES, f"a {what} of {part[what].tolist()}")
        for what in ("energy", "loss", "kink"):
            if not math.isfinite(whole[what][0]):
                raise FunctionError(name, told, _GIVES, f"{what} {whole[what][0]}")

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        where = ", ".join([*dict.fromkeys(link for link, _ in self.links), *self.joints])
        return f"{'a compiled function' if self.called else 'a function in Python'} of {where}"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CallableForce(AtPoint):
    """A force and torque on a link from a function of time and motion.

    Attributes:
        wrench: ``(t [s], pose, twist) -> wrench``, (6,): force at the point [N], then torque [N m]. The pose
            is that of the link's axes at the point, (4, 4); the twist velocity of the point [m/s] and spin
            [rad/s], (6,). All in world axes. A plain function, or compiled by ``numba.njit``.
    """

    kernels: ClassVar[str] = __name__

    wrench: Callable[[float, Any, Any], Any]

    def __post_init__(self) -> None:
        """Check the point, and that the function can be called."""
        AtPoint.__post_init__(self)
        check_takes(self, "wrench", self.wrench, "t", "pose", "twist")

    @property
    def called(self) -> bool:
        """Return whether kernels call the function."""
        from antenna_pin.compiled.given_functions import is_compiled

        return is_compiled(self.wrench)

    @packed
    def address(self) -> float:
        """Address of the function, zero for one in Python."""
        if not self.called:
            return 0.0
        own = wrench_on_links(self.wrench)
        return address_on_links(type(self).__name__, "wrench", own, (0, 1, 0, 0))

    def ask(self, place: str, t: float, desk: Any) -> None:
        """Call the Python function, and check its result."""
        import numpy as np

        link = desk[1][0]
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = link.rotation, link.place
        twist = np.concatenate([link.velocity, link.spin])
        name, told, rule = f"{place}: wrench", f"t = {t:.9g} s", "six finite numbers"
        answer = answer_of(name, told, rule, self.wrench, t, pose, twist)
        try:
            six = np.asarray(answer, dtype=float)
        except (TypeError, ValueError):
            six = np.zeros(0)
        if six.shape != (6,) or not np.isfinite(six).all():
            raise FunctionError(name, told, rule, repr(answer))
        link.force[:], link.torque[:] = six[:3], six[3:]

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        return f"{'a compiled function' if self.called else 'a function in Python'} on {self.at[0]}"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def act(own: CallableElement | CallableForce, tail: Floats, t: float, desk: Desk) -> None:
    """Have the function write what it does; not-a-number where it raises."""
    if own.address == 0.0:
        return
    clear(desk)
    place = float(tail.ctypes.data)
    if call_3(own.address, t, place, 0.0) != 0.0:
        _, links, joints, _ = desk
        for i in range(links.shape[0]):
            links[i].force[0] = math.nan
        for i in range(joints.shape[0]):
            joints[i].torque = math.nan
