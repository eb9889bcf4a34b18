"""How the steps of a run are made: their pace, and those that nothing interrupts as one compiled loop."""

from antenna_pin.engine.compiled import Compiled, CompiledStepper, check_compiled
from antenna_pin.engine.implicit import CompiledImplicitStepper
from antenna_pin.engine.pace import Pace, Sizes
from antenna_pin.engine.slopes import Slopes

__all__ = [
    "Compiled",
    "CompiledImplicitStepper",
    "CompiledStepper",
    "Pace",
    "Sizes",
    "Slopes",
    "check_compiled",
]
