r"""Laws of the literature as a whole: elastic law with its authors' dissipation.

Each is short for a :class:`antenna_pin.contact.DampedContact` of the two, which a row of ``ALIASES`` names
(:mod:`antenna_pin.contact.registry`); its parameters are theirs. It is made when it is first requested. The
docstring of the dissipation has the formula, where it holds, and the source.
"""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.lazy import Classes
from antenna_pin.base.parameters import parameters_of
from antenna_pin.contact.hysteresis import HysteresisDamping
from antenna_pin.contact.normal import CompiledNormalLaw, DampedContact, Dissipation, ElasticLaw, Hertz
from antenna_pin.contact.registry import ALIASES, Alias

_PARTS = Classes(
    "antenna_pin.contact", {part: part for alias in ALIASES for part in (alias.elastic, alias.dissipation)}
)


@functools.lru_cache(maxsize=256)
def _parts_of(law: WholeLaw) -> DampedContact:
    """Return a law as its two parts, cached."""

    def part(cls: Any) -> Any:
        return cls(**{item.name: getattr(law, item.name) for item in dataclasses.fields(cls)})

    return DampedContact(elastic=part(law.elastic), dissipation=part(law.dissipation))


class WholeLaw(CompiledNormalLaw):
    """Base: an elastic law and a dissipation, with the parameters of both."""

    __slots__ = ()

    elastic: ClassVar[type[ElasticLaw]]
    dissipation: ClassVar[type[Dissipation]]

    @classmethod
    def check_rules(cls, law: Any) -> None:
        """Refuse parameters that break a rule of either part."""
        cls.elastic.check_rules(law)
        cls.dissipation.check_rules(law)

    @property
    def parts(self) -> DampedContact:
        """The law as its two parts."""
        return _parts_of(self)

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (16,)."""
        return self.parts.code()


class RestitutionLaw(WholeLaw):
    """Base: one whose hysteresis damping is set by the restitution."""

    __slots__ = ()

    @property
    def hysteresis(self) -> float:
        """Hysteresis damping factor chi of ``1 + chi rate / approach_speed`` [-]."""
        dissipation = self.parts.dissipation
        assert isinstance(dissipation, HysteresisDamping)
        return dissipation.hysteresis


def _class_of(alias: Alias) -> type[Any]:
    """Return the class of a law as a whole; parameters with defaults come last."""
    parts = _PARTS[alias.elastic], _PARTS[alias.dissipation]
    fields = []
    for part in parts:
        declared = parameters_of(part)
        for item in dataclasses.fields(part):
            default = alias.defaults.get(item.name, item.default)
            metadata = {**item.metadata, "doc": declared[item.name].doc}
            fields.append((item.name, item.type, field(default=default, metadata=metadata)))
    fields.sort(key=lambda item: item[0] == "exponent")  # last, as it has a default
    of_restitution = issubclass(parts[1], HysteresisDamping)
    spring = f":class:`antenna_pin.contact.{parts[0].__name__}`"
    if parts[0] is Hertz:
        spring = "Linear spring" if "exponent" in alias.defaults else "Hertzian spring"
    return dataclasses.make_dataclass(
        alias.title,
        fields,
        bases=(RestitutionLaw if of_restitution else WholeLaw,),
        namespace={
            "__doc__": f"{spring} with :class:`antenna_pin.contact.{parts[1].__name__}`.",
            "__module__": __name__,
            "elastic": parts[0],
            "dissipation": parts[1],
        },
        frozen=True,
        slots=True,
        kw_only=True,
    )


def __getattr__(name: str) -> Any:
    """Make the class of a law when it is first asked for."""
    for alias in ALIASES:
        if alias.title == name:
            return globals().setdefault(name, _class_of(alias))
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
