"""How the steps of a run are made: their pace, and the compiled loop of them."""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.engine.carrying import Along, Carrying, Steps
    from antenna_pin.engine.compiled import Compiled, CompiledStepper, check_compiled
    from antenna_pin.engine.pace import Pace, Sizes
    from antenna_pin.engine.shifts import SystemSlopes, moves_rows
    from antenna_pin.engine.slopes import Slopes
    from antenna_pin.engine.tangents import Tangents

__all__ = [
    "Along",
    "Carrying",
    "Steps",
    "Compiled",
    "CompiledStepper",
    "Pace",
    "Sizes",
    "Slopes",
    "SystemSlopes",
    "Tangents",
    "check_compiled",
    "moves_rows",
]

loaded_when_used(
    __name__,
    {
        "carrying": "Along Carrying Steps",
        "compiled": "Compiled CompiledStepper check_compiled",
        "pace": "Pace Sizes",
        "shifts": "SystemSlopes moves_rows",
        "slopes": "Slopes",
        "tangents": "Tangents",
    },
)
