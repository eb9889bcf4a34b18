"""How the motion is computed and recorded."""

from __future__ import annotations

from antenna_pin.scenario._made import MadeSpec, reads
from antenna_pin.settings import ErrorScales, RunSettings

__all__ = ["IntegratorSpec", "OutputSpec", "ScalesSpec"]


@reads(ErrorScales)
class ScalesSpec(MadeSpec):
    """What an error counts as large against, per kind of quantity: ``rtol * (scale + |value|)``."""


@reads(RunSettings, without=("output_rate", "output_form"), scales=ScalesSpec)
class IntegratorSpec(MadeSpec):
    """How the motion is integrated."""


@reads(
    RunSettings,
    only=("output_rate", "output_form"),
    renamed={"output_rate": "rate", "output_form": "form"},
)
class OutputSpec(MadeSpec):
    """What is recorded."""
