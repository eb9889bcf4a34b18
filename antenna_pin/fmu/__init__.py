"""A scenario as a functional mock-up unit (FMI 3.0, co-simulation) that other tools step and command."""

from antenna_pin.base.lazy import exported

exported(__name__)
