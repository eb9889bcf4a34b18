r"""Normal contact laws: force over penetration depth, penetration rate and approach speed.

A law has two parts that are chosen apart: an elastic force, which derives from a potential, and what
dissipates. An :class:`ElasticLaw` alone is a law without dissipation; :class:`DampedContact` joins one with a
:class:`Dissipation` of :mod:`antenna_pin.contact.hysteresis` or :mod:`antenna_pin.contact.damping`. The laws
that the literature gives as a whole stand in :mod:`antenna_pin.contact.point_laws`.

A law is a small frozen dataclass over the compiled kernels; its flat array of numbers, ``code()``, is its
input to these. A user's own law without one (:class:`CustomNormal`, or any object that fulfils
:class:`NormalLaw`) runs on a slower path, one Python call per touching contact and evaluation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar, Protocol, Self, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import check_takes, fits, takes, unknown_type
from antenna_pin.base.parameters import Parameter, check, parameter, parameters_of
from antenna_pin.compiled.decorators import inlined
from antenna_pin.compiled.given_functions import address_of, is_compiled
from antenna_pin.contact import kernels
from antenna_pin.contact.records import normal_code
from antenna_pin.contact.registry import DISSIPATIONS, NORMAL_LAWS
from antenna_pin.errors import InvalidParameterError, UnknownNameError

# --- laws of all kinds --------------------------------------------------------------------------------------


class Law:
    """Base of laws and dissipations: their parameters are numbers, in SI units."""

    __slots__ = ()

    # Fields that are numbers and not in the record for kernels.
    unpacked: ClassVar[tuple[str, ...]] = ()

    def __new__(cls, *values: Any, **parameters: Any) -> Self:
        """Refuse values that are no numbers, before a law checks more."""
        declared = parameters_of(cls)
        for name, value in parameters.items():
            one = declared.get(name)
            if one is None or (value is None and not one.required and one.default is None):
                continue
            if not fits(value, float):
                unit = "" if one.unit == "1" else f" [{one.unit}]"
                raise InvalidParameterError(cls.__name__, name, f"a number{unit}", said=unknown_type(value))
        return super().__new__(cls)

    def __post_init__(self) -> None:
        """Check the parameters: each by its declaration, then together."""
        check(self)
        self.check_rules(self)

    @classmethod
    def check_rules(cls, law: Any) -> None:
        """Refuse parameters of a law that break a rule of this class."""


# --- normal laws --------------------------------------------------------------------------------------------


@runtime_checkable
class NormalLaw(Protocol):
    """Protocol of a normal law; :class:`CustomNormal` makes one from functions.

    A law that does not hold at any depth states this by an attribute ``depth_limit`` [m].
    """

    def force(self, depth: float, rate: float, approach_speed: float) -> float:
        """Return the normal force on the journal [N], zero in free flight."""

    def elastic_force(self, depth: float) -> float:
        """Return the part of the force that derives from a potential [N]."""

    def elastic_energy(self, depth: float) -> float:
        """Return the energy stored at ``depth`` [J]."""


_QUESTION = (("depth", "m"), ("rate", "m/s"), ("approach speed", "m/s"))


def normal_questions(
    law: NormalLaw,
) -> tuple[tuple[str, Callable[..., float], tuple[tuple[str, str], ...]], ...]:
    """Return a normal law for a run: name, function, name and unit of each argument."""
    return tuple(
        (name, getattr(law, name), _QUESTION[:count])
        for name, count in (("force", 3), ("elastic_force", 1), ("elastic_energy", 1))
    )


class CompiledNormalLaw(Law):
    """The shared face of the laws whose arithmetic is a compiled kernel."""

    __slots__ = ()

    @property
    def parts(self) -> DampedContact:
        """The law as its elastic law and its dissipation."""
        raise NotImplementedError

    @property
    def depth_limit(self) -> float:
        """Depth limit of the law [m]; infinite if there is none."""
        return self.parts.elastic.depth_limit

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (16,), for the fused kernels."""
        raise NotImplementedError

    def force(self, depth: float, rate: float, approach_speed: float) -> float:
        """Return the normal force on the journal [N], never negative.

        Args:
            depth: Penetration depth [m]; zero or less is free flight.
            rate: Penetration rate [m/s], positive while closing.
            approach_speed: Rate at first touch of this contact [m/s], positive.

        Raises:
            InvalidParameterError: The depth is beyond ``depth_limit``, or the law leaves its effective mass
                to the contact and here is none.
        """
        code = _code_within(self, depth)
        if self.parts.dissipation.takes_mass:
            raise InvalidParameterError(
                self, "effective_mass", "given for a force apart from a joint, whose contacts have one"
            )
        if depth <= 0.0:
            return 0.0
        return float(kernels.normal_force(code, depth, rate, approach_speed, 0.0))

    def elastic_force(self, depth: float) -> float:
        """Return the part of the force that derives from a potential [N], up to ``depth_limit``."""
        code = _code_within(self, depth)
        return float(kernels.elastic_force(code, depth)) if depth > 0.0 else 0.0

    def elastic_energy(self, depth: float) -> float:
        """Return the energy stored [J], the integral of the elastic force, up to ``depth_limit``."""
        return float(kernels.elastic_energy(_code_within(self, depth), depth))


@lru_cache(maxsize=256)
def _code_and_limit(law: CompiledNormalLaw) -> tuple[NDArray[np.float64], float]:
    """Return a law's code and its limit of depth, composed once: a law is frozen."""
    return law.code(), law.depth_limit


def _code_within(law: CompiledNormalLaw, depth: float) -> NDArray[np.float64]:
    check_depth(law, depth)
    return _code_and_limit(law)[0]


def check_depth(law: CompiledNormalLaw, depth: float) -> None:
    """Refuse a depth [m] beyond the law's range; kernels hold the force there."""
    limit = _code_and_limit(law)[1]
    if depth > limit:
        rule = f"at most depth_limit = {limit:g} m"
        raise InvalidParameterError(type(law.parts.elastic).__name__, "depth", rule, depth)


@inlined
def not_given(law: Any, depth: float) -> float:
    """Return NaN, of a law whose energy has no closed form."""
    return math.nan


class ElasticLaw(CompiledNormalLaw):
    """A law without dissipation; it can be given one with :class:`DampedContact`.

    Attributes:
        kernel: Of record and depth [m]: the force [N] (:mod:`antenna_pin.contact.records`).
        energy: Likewise the energy [J]; integrated where it is not a number.
        frequent: Whether these are compiled into their callers.
        line: Whether it is the law of two cylinders along a line, which means nothing at a flange.
    """

    __slots__ = ()

    kernel: ClassVar[Any]
    energy = staticmethod(not_given)
    frequent: ClassVar[bool] = False
    line: ClassVar[bool] = False

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (16,)."""
        return normal_code(self.kernel, self, NoDissipation.kernel, None)

    @property
    def parts(self) -> DampedContact:
        """The law with no dissipation."""
        return DampedContact(elastic=self, dissipation=NoDissipation())

    @property
    def depth_limit(self) -> float:
        """Depth limit of the law [m]; infinite if there is none."""
        return math.inf


#: Rule of a restitution where that of zero would take an infinite damping.
STOPS_NOTHING = "in (0, 1]; no finite damping of this form stops a body dead"


class Dissipation(Law):
    """Protocol of the dissipation of a normal law, independent of the elastic law.

    Attributes:
        kernel: Of record, elastic force [N], depth [m], rate [m/s], approach speed [m/s] and mass of the
            contact [kg]: the whole force [N], which is cut off where it pulls.
        frequent: Whether it is compiled into its callers.
        adds_force: Whether it adds a force of its own to the elastic one, rather than a multiple of that.
    """

    __slots__ = ()

    kernel: ClassVar[Any]
    frequent: ClassVar[bool] = False
    adds_force: ClassVar[bool] = False

    @property
    def takes_mass(self) -> bool:
        """Return whether the force depends on the effective mass of the contact."""
        return False

    def numbers(self, elastic: ElasticLaw) -> Any:
        """Return an object with the numbers of its record, beside an elastic law."""
        return self


@inlined
def conservative(
    law: NoDissipation, elastic: float, depth: float, rate: float, approach_speed: float, mass: float
) -> float:
    """Elastic force [N]."""
    return elastic


@dataclass(frozen=True, slots=True, kw_only=True)
class NoDissipation(Dissipation):
    """No dissipation: a restitution of 1."""

    kernel = staticmethod(conservative)
    frequent: ClassVar[bool] = True


@dataclass(frozen=True, slots=True, kw_only=True)
class DampedContact(CompiledNormalLaw):
    """An elastic law with a dissipation: any with any.

    Attributes:
        elastic: The elastic part.
        dissipation: What it dissipates with.
    """

    elastic: ElasticLaw
    dissipation: Dissipation

    def __post_init__(self) -> None:
        """Check that the parts are parts."""
        if not isinstance(self.elastic, ElasticLaw):
            raise InvalidParameterError(self, "elastic", "an elastic law such as Hertz")
        if not isinstance(self.dissipation, Dissipation):
            raise InvalidParameterError(self, "dissipation", "a dissipation such as FloresDamping")

    @property
    def parts(self) -> DampedContact:
        """Itself."""
        return self

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (16,)."""
        numbers = self.dissipation.numbers(self.elastic)
        return normal_code(self.elastic.kernel, self.elastic, self.dissipation.kernel, numbers)


@inlined
def power(depth: float, exponent: float) -> float:
    """``depth**exponent``, continued to negative depth where the exponent is an integer, else zero there.

    The continuation lets an integrator step smoothly across the end of a contact before that end is
    located; no accepted state lies beyond it.
    """
    if depth > 0.0:
        if exponent == 1.5:
            return depth * math.sqrt(depth)
        if exponent == 1.0:
            return depth
        return float(depth**exponent)
    whole = math.floor(exponent)
    if whole != exponent:
        return 0.0
    size = float((-depth) ** exponent)
    return size if whole % 2.0 == 0.0 else -size


@inlined
def power_force(law: Hertz, depth: float) -> float:
    """Elastic force [N]."""
    return float(law.stiffness * power(depth, law.exponent))


@inlined
def power_energy(law: Hertz, depth: float) -> float:
    """Energy stored [J]."""
    return float(law.stiffness * power(depth, law.exponent) * depth / (law.exponent + 1.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Hertz(ElasticLaw):
    r"""Elastic contact without dissipation.

    .. math:: f = K \delta^n

    Holds for a patch that is small against the radii. With n = 3/2 it is the contact of two spheres; in a
    bore it is used with the internal radius :math:`R_i R_j / (R_i - R_j)`. With n in 1..3/2 it is what
    Lankarani and Nikravesh propose for cylinders.

    Attributes:
        stiffness: K, force at unit depth [N/m^n].
        exponent: n of K depth^n; 3/2 for Hertz [-].

    References:
        Hertz (1881), J. reine angew. Math. 92, 156-171.
    """

    kernel = staticmethod(power_force)
    energy = staticmethod(power_energy)
    frequent: ClassVar[bool] = True

    stiffness: float = parameter("N/m**exponent", rule="positive", from_joint=True)
    exponent: float = parameter(rule="in [1, 4]", default=1.5)


@takes()
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CustomNormal:
    """A user's own normal law from functions.

    Where all are compiled, by ``numba.njit`` or ``numba.cfunc``, it runs as the built-in laws do, in both
    engines; from plain ones it is slower: one call from Python per touching contact and evaluation. They must
    answer equal questions equally: a run asks them out of order, and ends as ``FUNCTION_WITH_MEMORY`` where
    they keep something between calls, such as the largest depth so far.

    Attributes:
        force: ``(depth [m], rate [m/s], approach_speed [m/s]) -> [N]``, called at positive depth only.
        elastic_force: ``depth [m] -> [N]``, the part of the force with a potential; what ``force`` adds to it
            counts as dissipation in the energy ledger.
        elastic_energy: ``depth [m] -> [J]``, the integral of ``elastic_force`` from 0.
        depth_limit: Depth beyond which the law says nothing [m].
    """

    force: Callable[[float, float, float], float]
    elastic_force: Callable[[float], float]
    elastic_energy: Callable[[float], float]
    depth_limit: float = math.inf

    def __post_init__(self) -> None:
        """Check that the functions can be called."""
        for name, _, words in normal_questions(self):
            check_takes(self, name, getattr(self, name), *(word for word, _ in words))

    @property
    def is_compiled(self) -> bool:
        """Return whether the law's functions are compiled."""
        return is_compiled(self.force, self.elastic_force, self.elastic_energy)

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (16,): where its functions stand in this process.

        Raises:
            InvalidParameterError: A function does not take its floats, or does not return one.
        """
        place, end = type(self).__name__, self.depth_limit
        force, energy = (
            address_of(place, name, getattr(self, name), 1) for name in ("elastic_force", "elastic_energy")
        )
        elastic = kernels.CalledLaw(force, energy, end)
        whole = kernels.CalledWholeLaw(address_of(place, "force", self.force, 3), end)
        return normal_code(kernels.called_force, elastic, kernels.called_whole, whole)


# --- laws by name -------------------------------------------------------------------------------------------


@takes()
def law_parameters(law: type[Any]) -> dict[str, Parameter]:
    """Return the parameters of a law or dissipation by name."""
    return parameters_of(law)


@takes()
def is_elastic(law: str) -> bool:
    """Return whether a normal law, by name, takes a separate dissipation."""
    return issubclass(NORMAL_LAWS[law], ElasticLaw)


@takes()
def normal_parameters(law: str, dissipation: str | None = None) -> dict[str, Parameter]:
    """Return the parameters of a normal law by name, with those of its dissipation.

    Args:
        law: Name in ``NORMAL_LAWS``.
        dissipation: Name in ``DISSIPATIONS``, only beside an elastic law.
    """
    own = law_parameters(NORMAL_LAWS[law])
    return own if dissipation is None else own | law_parameters(DISSIPATIONS[dissipation])


@takes()
def make_normal_law(
    law: str, parameters: Mapping[str, float], dissipation: str | None = None
) -> CompiledNormalLaw:
    """Return a normal law from names and numbers.

    Args:
        law: Name in ``NORMAL_LAWS``.
        parameters: Parameters in SI units, of the law and of the dissipation together.
        dissipation: Name in ``DISSIPATIONS``; only beside an elastic law, which without one is conservative.

    Raises:
        UnknownNameError: No such law or dissipation.
        InvalidParameterError: A parameter breaks a rule, is missing, or is not the law's.
    """
    if law not in NORMAL_LAWS:
        raise UnknownNameError("make_normal_law", "law", law, NORMAL_LAWS)
    if dissipation is not None and dissipation not in DISSIPATIONS:
        raise UnknownNameError("make_normal_law", "dissipation", dissipation, DISSIPATIONS)
    if dissipation is not None and not is_elastic(law):
        raise InvalidParameterError(
            "make_normal_law", "dissipation", f"left out, for law {law} brings its own", dissipation
        )
    declared = normal_parameters(law, dissipation)
    for name in parameters:
        if name not in declared:
            takes = ", ".join(declared) or "no parameters"
            raise InvalidParameterError("make_normal_law", "parameters", f"of {takes} (law {law})", name)
    for name, one in declared.items():
        if one.required and name not in parameters:
            raise InvalidParameterError("make_normal_law", name, f"given (law {law})")
    own = law_parameters(NORMAL_LAWS[law])
    elastic: CompiledNormalLaw = NORMAL_LAWS[law](**{k: v for k, v in parameters.items() if k in own})
    if dissipation is None:
        return elastic
    assert isinstance(elastic, ElasticLaw)
    rest = {name: value for name, value in parameters.items() if name not in own}
    return DampedContact(elastic=elastic, dissipation=DISSIPATIONS[dissipation](**rest))
