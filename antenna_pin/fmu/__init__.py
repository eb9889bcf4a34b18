"""A scenario as a functional mock-up unit (FMI 3.0, co-simulation) that other tools step and command."""

from antenna_pin._lazy import only_public
from antenna_pin.fmu.export import export_fmu

__all__ = ["export_fmu"]

only_public(__name__)
