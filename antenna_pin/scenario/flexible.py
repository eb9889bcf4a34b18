"""Flexible links: tables that make a rigid link a hub with elastic parts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, Self

from pydantic import model_validator

from antenna_pin.mechanism.flexible import EffectiveMode, EffectiveModes, ModalData, Petals
from antenna_pin.scenario._class_tables import JointTable, MadeSpec, reads
from antenna_pin.scenario.spec import refuse


@reads(EffectiveMode)
class ModeSpec(JointTable, MadeSpec):
    """A mode as the mass, or the inertia, that answers on the hub."""

    @model_validator(mode="after")
    def _check_units(self) -> Self:
        """Refuse the stiffness of the other kind of joint."""
        wanted = "translation" if self.mass is not None else "rotation"
        if self.motion not in (None, wanted):
            unit, what = ("N/m", "mass") if wanted == "translation" else ("N*m/rad", "inertia")
            refuse(f"must be in {unit}, for the mode has a {what}", "stiffness")
        return self


@reads(EffectiveModes, modes=dict[str, ModeSpec])
class ModesSpec(MadeSpec):
    """Effective masses and inertias on the hub, side by side.

    Attributes:
        link: Name of the link.
        kind: What makes it flexible.
    """

    link: str = ""
    kind: Literal["modes"]


@reads(Petals)
class PetalsSpec(MadeSpec):
    """A dish of hinged petals on root springs around a hub."""

    link: str = ""
    kind: Literal["petals"]


@reads(ModalData)
class ModalDataSpec(MadeSpec):
    """An appendage by its modes with the root held, from a finite-element code.

    Attributes:
        file: CSV, or tables that a finite-element code prints, instead of ``frequency`` and ``participation``
            ([more](flexible.md#modal-data-of-a-finite-element-code)).
        reading: How the file was read, as text; nothing without one.
    """

    link: str = ""
    kind: Literal["modal-data"]
    file: str | None = None
    reading: str = ""

    carried: ClassVar[frozenset[str]] = frozenset({"places", "reading"})

    @model_validator(mode="before")
    @classmethod
    def _check_given(cls, data: Any) -> Any:
        if isinstance(data, Mapping) and not data.keys() & {"file", "frequency", "participation"}:
            refuse("must have either file, or frequency and participation, got neither")
        if isinstance(data, Mapping) and isinstance(data.get("damping_ratio"), int | float | str):
            return {**data, "damping_ratio": [data["damping_ratio"]]}
        return data


FlexibleSpec = ModesSpec | PetalsSpec | ModalDataSpec
"""A flexible link; ``kind`` says how."""
