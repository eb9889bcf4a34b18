"""Tables of a fit file on unknown numbers: parameters with bounds and priors, numbers derived from them."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import field_validator, model_validator

from antenna_pin.base.units import any_quantity, shown
from antenna_pin.fit.columns import AnyQuantity
from antenna_pin.fit.expressions import names_in
from antenna_pin.scenario.spec import Spec, refuse

__all__ = ["DerivedSpec", "FitParameterSpec", "PriorSpec"]


class PriorSpec(Spec):
    """Knowledge of a parameter from elsewhere: a normal distribution.

    Attributes:
        mean: Its mean, in the parameter's unit.
        sd: Its standard deviation, in the parameter's unit.
    """

    mean: AnyQuantity
    sd: AnyQuantity


class FitParameterSpec(Spec):
    """One unknown number.

    Attributes:
        key: Key of the scenario, as a study has it, or several that get the same value; or a number of a
            record: ``records.NAME.clock_shift``, ``records.NAME.columns.COLUMN.gain`` or ``.offset``. Left
            out of a parameter that only numbers derived from it use.
        start: Where the search begins.
        between: Its bounds.
        scale: ``log`` for a positive number of which not even the size is known.
        prior: What is known of it from elsewhere, which counts like one more measurement.
        records: Whose it is; of all records if left out.
        title: What it is called in figures; its name if left out.
    """

    key: str | tuple[str, ...] = ()
    start: AnyQuantity
    between: tuple[AnyQuantity, AnyQuantity] | None = None
    scale: Literal["linear", "log"] = "linear"
    prior: PriorSpec | None = None
    records: tuple[str, ...] | None = None
    title: str = ""

    @property
    def keys_set(self) -> tuple[str, ...]:
        """The keys that it is."""
        return (self.key,) if isinstance(self.key, str) else self.key

    def numbers(self) -> tuple[float, float, float, str]:
        """Return start, lower and upper bound in SI units (infinite if there is none), and the unit."""
        texts = (self.start, *(self.between or ()))
        read = [any_quantity(text) or (0.0, "") for text in texts]
        unit = next((unit for _, unit in read if unit not in ("", "1")), "")
        written = str(self.start).strip().partition(" ")[2].strip()
        if unit and any_quantity(f"1 {written}") == (1.0, unit):
            unit = written  # as its author knows it: N/m**1.5, not kg/m**0.5/s**2
        low, high = (read[1][0], read[2][0]) if self.between is not None else (-float("inf"), float("inf"))
        return read[0][0], low, high, unit

    def prior_numbers(self) -> tuple[float, float]:
        """Return mean and standard deviation of the prior in SI units; zero and infinity if there is none."""
        if self.prior is None:
            return 0.0, float("inf")
        mean, sd = ((any_quantity(one) or (0.0, ""))[0] for one in (self.prior.mean, self.prior.sd))
        return mean, sd

    @model_validator(mode="after")
    def _check_numbers(self) -> Self:
        wanted = _unit(self.start)
        for name in ("mean", "sd") if self.prior is not None else ():
            value = getattr(self.prior, name)
            if _unit(value) != wanted:
                refuse(f"must be of start's unit [{wanted or '1'}], got {shown(value)}", "prior", name)
        if self.prior is not None and not self.prior_numbers()[1] > 0.0:
            refuse(f"must be positive, got {shown(self.prior.sd)}", "prior", "sd")
        for i, value in enumerate(self.between or ()):
            number, unit = any_quantity(value) or (0.0, "")
            if _unit(value) != wanted and not (number == 0.0 and not unit):
                refuse(f"must be of start's unit [{wanted or '1'}], got {shown(value)}", "between", i)
        start, low, high, _ = self.numbers()
        if not low < high:
            refuse(f"must be bounds that rise, got {shown(self.between)}", "between")
        if not low <= start <= high:
            refuse(f"must be within the bounds {shown(self.between)}, got {shown(self.start)}", "start")
        if self.scale == "log" and not (start > 0.0 and (self.between is None or low > 0.0)):
            at = "start" if not start > 0.0 else "between"
            value = self.start if at == "start" else self.between
            refuse(f'must be positive for scale = "log", got {shown(value)}', at)
        return self


def _unit(value: object) -> str:
    """Return the SI unit that a quantity names; "" of a pure number."""
    unit = (any_quantity(value) or (0.0, ""))[1]
    return "" if unit == "1" else unit


class DerivedSpec(Spec):
    """A number of the scenario that follows from parameters, such as ``coulomb + excess``.

    With a difference as the parameter, of zero or more, two numbers keep their order.

    Attributes:
        key: Key of the scenario, or several that get the same value.
        value: Expression of parameters: + - * / **, sqrt, exp, log, min, max; all numbers are in SI units.
        records: Whose it is; of all records if left out.
        unit: SI unit in which it is printed.
    """

    key: str | tuple[str, ...]
    value: str
    records: tuple[str, ...] | None = None
    unit: str = ""

    @property
    def keys_set(self) -> tuple[str, ...]:
        """The keys that it is."""
        return (self.key,) if isinstance(self.key, str) else self.key

    @field_validator("value")
    @classmethod
    def _check_value(cls, value: str) -> str:
        try:
            names_in(value)
        except ValueError as error:
            refuse(str(error))
        return value
