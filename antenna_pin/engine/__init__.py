"""How the steps of a run are made: their pace, and the compiled loop of them."""

from antenna_pin._lazy import only_public
from antenna_pin.engine.compiled import Compiled, CompiledStepper, check_compiled
from antenna_pin.engine.pace import Pace, Sizes
from antenna_pin.engine.slopes import Slopes

__all__ = [
    "Compiled",
    "CompiledStepper",
    "Pace",
    "Sizes",
    "Slopes",
    "check_compiled",
]

only_public(__name__)
