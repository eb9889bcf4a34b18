"""Sampled controllers: measurement and command at sampling times, never between.

A controller is no force element: drives, motors, thrusters and wheels move the mechanism, and their one
number that is ``commanded`` is set. At its sampling time number k, ``phase + k period``, its ``update`` is
called once; the commands returned are applied at once, or ``delay`` later, and held until the next.

::

    @dataclass
    class Relay(Controller):
        period: float = 0.01
        commands: tuple[str, ...] = ("motor",)

        def update(self, now):
            return {"motor": -0.1 if now.angle("hinge") > 0.0 else 0.1}
"""

from __future__ import annotations

import copy
import dataclasses
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Protocol

import numpy as np

from antenna_pin.base.arguments import check_takes, fits
from antenna_pin.base.parameters import holds, parameter, parameters_of
from antenna_pin.errors import InvalidParameterError

# --- controller memory as text ------------------------------------------------------------------------------

# What stands for what JSON has not; a table of the user's with one of these keys is a list of pairs.
_ARRAY, _TUPLE, _FIELDS, _PAIRS, _GENERATOR = "array", "tuple", "fields", "pairs", "generator"


def kept(state: Any) -> str:
    """Return a state as text, exact to the last bit.

    Raises:
        TypeError: Something in it cannot be kept.
    """
    return json.dumps(_plain(state))


def remembered(text: str, like: Any) -> Any:
    """Return a state, restored from its text.

    Args:
        text: It.
        like: A state of the same class: what is no dataclass needs none.
    """
    return _restored(json.loads(text), like)


def _check_storable(place: str, state: Any) -> None:
    """Refuse a state that cannot be stored as text."""
    try:
        remembered(kept(state), state)
    except (TypeError, ValueError, AttributeError) as error:
        rule = "numbers, texts, arrays, generators of NumPy, dataclasses of these, lists, tuples, tables"
        raise InvalidParameterError(place, "state", rule, said=" ".join(str(error).split())) from None


def _plain(value: Any) -> Any:
    if value is None or type(value) in (bool, int, float, str):
        return value
    if isinstance(value, np.ndarray) and value.dtype.kind in "biufU":
        return {_ARRAY: value.tolist(), "type": value.dtype.str, "shape": list(value.shape)}
    if isinstance(value, np.generic) and value.dtype.kind in "biuf":
        return {_ARRAY: value.item(), "type": value.dtype.str, "shape": []}
    if isinstance(value, np.random.Generator):
        state = value.bit_generator.state
        return {_GENERATOR: type(value.bit_generator).__name__, "state": _plain(dict(state))}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {_FIELDS: {one.name: _plain(getattr(value, one.name)) for one in dataclasses.fields(value)}}
    if type(value) is list:
        return [_plain(one) for one in value]
    if type(value) is tuple:
        return {_TUPLE: [_plain(one) for one in value]}
    if type(value) is dict:
        return {_PAIRS: [[_plain(key), _plain(one)] for key, one in value.items()]}
    raise TypeError(f"a {type(value).__name__}")


def _restored(content: Any, like: Any = None) -> Any:
    if isinstance(content, list):
        known = like if isinstance(like, list) and len(like) == len(content) else [None] * len(content)
        return [_restored(one, hint) for one, hint in zip(content, known, strict=True)]
    if not isinstance(content, dict):
        return content
    if _ARRAY in content:
        array = np.array(content[_ARRAY], dtype=content["type"]).reshape(content["shape"])
        return array if content["shape"] or isinstance(like, np.ndarray) else array[()]
    hints: Any
    if _TUPLE in content:
        hints = like if isinstance(like, tuple) and len(like) == len(content[_TUPLE]) else ()
        return tuple(_restored(content[_TUPLE], list(hints) or None))
    if _PAIRS in content:
        hints = like if isinstance(like, dict) else {}
        pairs = ((_restored(key), one) for key, one in content[_PAIRS])
        return {key: _restored(one, hints.get(key)) for key, one in pairs}
    if _GENERATOR in content:
        bits = getattr(np.random, content[_GENERATOR])()
        bits.state = _restored(content["state"])
        return np.random.Generator(bits)
    made = copy.copy(like)
    if not dataclasses.is_dataclass(made):
        raise TypeError("a dataclass that did not stand there at the start")
    for name, one in content[_FIELDS].items():
        object.__setattr__(made, name, _restored(one, getattr(like, name)))
    return made


# --- limits of a command ------------------------------------------------------------------------------------


def limited(
    wished: float, before: float, step: float | None, bounds: tuple[float | None, float | None]
) -> float:
    """Return a command limited in its step from the previous one, and within bounds.

    Args:
        wished: Command without limits.
        before: The command before.
        step: By how much it may change; None for as much as it likes.
        bounds: The least and the largest; None for none.
    """
    found = wished
    if step is not None:
        found = min(max(found, before - step), before + step)
    lower, upper = bounds
    if lower is not None:
        found = max(found, lower)
    return found if upper is None else min(found, upper)


# --- controllers --------------------------------------------------------------------------------------------


class Now(Protocol):
    """View of a run at a sampling time, valid within ``update`` only, and exact.

    Attributes:
        time: [s].
        tick: Number of the sampling time, the controller's own, from 0 [-].
    """

    time: float
    tick: int

    def angle(self, joint: str) -> float:
        """Return a joint's angle with whole turns [rad], or its position [m]."""

    def rate(self, joint: str) -> float:
        """Return its rate [rad/s], [m/s]."""

    def command(self, name: str) -> float:
        """Return the command that an actuator follows up to now."""

    def base_rotation(self) -> Any:
        """Return the base's attitude as a rotation vector, (3,), world axes [rad]."""

    def base_quaternion(self) -> Any:
        """Return the base's attitude in the world, xyzw, (4,)."""

    def base_rate(self) -> Any:
        """Return the base's angular velocity, (3,), in its own axes [rad/s]."""

    def gap(self, contact: str) -> float:
        """Return the distance of the surfaces at a contact, negative in contact [m]."""

    def touching(self, contact: str) -> bool:
        """Return whether a contact touches."""

    def force(self, contact: str) -> float:
        """Return the normal force at a contact [N]."""

    def joint_load(self, joint: str) -> Any:
        """Return a joint's force [N] and moment [N m] on its child, (6,), joint axes."""

    def direction(self, link: str, axis: Any) -> Any:
        """Return an axis of a link, (3,), in the world."""

    def off_axis(self, link: str, axis: Any, target: Any) -> float:
        """Return the angle between a link's axis and a world direction [rad]."""

    def note(self, **signals: float) -> None:
        """Record numbers, by names of ``signals``, beside the present commands."""


class Controller:
    """Base class of sampled controllers.

    What it remembers from one sampling time to the next stands in ``state``: numbers, texts, arrays,
    generators of random numbers, a dataclass of such, or lists, tuples and tables of them. A run works on a
    copy, and keeps it in its own state: so a run in parts is the run in one.

    Attributes:
        period: From one sampling time to the next [s].
        phase: The first [s].
        delay: From a sampling time until what it commands is written [s]; may exceed the period.
        delay_periods: The same in periods [-]; one of the two.
        commands: Commanded drives and other elements, by name.
        signals: Names of further numbers that it may ``note``.
        state: Its memory.
    """

    period: float
    phase: float = 0.0
    delay: float = 0.0
    delay_periods: float = 0.0
    commands: tuple[str, ...] = ()
    signals: tuple[str, ...] = ()
    state: Any = None

    def update(self, now: Now) -> Mapping[str, float]:
        """Return the commands from now on, by name; those left out stay as they are."""
        raise NotImplementedError

    def placed(self, joints: Mapping[str, str | None], axes: Mapping[str, Any]) -> Controller:
        """Return the controller with what it takes from the places of its commands.

        Args:
            joints: The joint that each command acts at; None for none.
            axes: Its axis in a free base's axes, (3,), where the base itself carries it; else None.
        """
        return self

    def words(self) -> str:
        """Return a description."""
        return type(self).__name__


@dataclass(frozen=True, kw_only=True)
class SampledController(Controller):
    """Base of the built-in controllers: sampling times, and the actuators that they command.

    Attributes:
        period: From one sampling time to the next, h [s].
        phase: The first sampling time [s].
        delay: From a sampling time until its commands are written [s].
        delay_periods: The same in periods [-].
    """

    acts_on: str | tuple[str, ...]
    period: float = parameter("s", rule="positive")
    phase: float = parameter("s", rule="zero or more", default=0.0)
    delay: float = parameter("s", rule="zero or more", default=0.0)
    delay_periods: float = parameter(rule="zero or more", default=0.0)

    @property
    def commands(self) -> tuple[str, ...]:  # type: ignore[override]
        """Names of commanded actuators."""
        return (self.acts_on,) if isinstance(self.acts_on, str) else self.acts_on


def check_controller(name: str, controller: Any) -> None:
    """Refuse a controller with invalid times, names or state.

    Raises:
        InvalidParameterError: See there.
    """
    place = f"controller {name!r}"
    if not isinstance(controller, Controller):
        rule = "a Controller: derive your class from antenna_pin.elements.control.Controller"
        raise InvalidParameterError(place, "class", rule, said=type(controller).__name__)
    for key, declared in parameters_of(SampledController).items():
        value = getattr(controller, key, None)
        if not holds(value, declared.rule):
            unit = " [s]" if declared.unit == "s" else ""
            raise InvalidParameterError(place, key, f"{declared.rule} and finite{unit}", value)
    if controller.delay and controller.delay_periods:
        rule = "omitted if delay is given"
        raise InvalidParameterError(place, "delay_periods", rule, controller.delay_periods)
    for key in ("commands", "signals"):
        names = getattr(controller, key)
        if not fits(names, tuple[str, ...]) or len(set(names)) != len(names):
            raise InvalidParameterError(place, key, "a tuple of different names", names)
    if not controller.commands:
        raise InvalidParameterError(place, "commands", "one name or more of what it commands", ())
    check_takes(place, "update", controller.update, "now")
    _check_storable(place, controller.state)


class Instants:
    """Sampling times of a controller: the numbers nearest to phase + k period, as written.

    Times are taken as the decimals that they are written as, so that the hundredth sampling time of a period
    of 0.01 s is 1 s, as that of another controller's period of 0.1 s, and neither differs by round-off.

    Args:
        controller: Whose.
    """

    def __init__(self, controller: Controller) -> None:
        """Convert all times to a common denominator."""
        period, phase, delay, periods = (
            Fraction(repr(float(number)))
            for number in (controller.period, controller.phase, controller.delay, controller.delay_periods)
        )
        late = delay + periods * period
        self._over = math.lcm(period.denominator, phase.denominator, late.denominator)
        self._period, self._phase, self._late = (int(one * self._over) for one in (period, phase, late))

    def tick(self, number: int) -> float:
        """Return a sampling time [s]."""
        return (self._phase + number * self._period) / self._over

    def write(self, number: int) -> float:
        """Return the time at which a command is applied [s]."""
        return (self._phase + number * self._period + self._late) / self._over

    def first_from(self, time: float) -> int:
        """Return the number of the first sampling time from a time on."""
        number = max(0, math.floor((Fraction(time) * self._over - self._phase) / self._period))
        return number if self.tick(number) >= time else number + 1
