"""Numbers of drives and springs that change in the middle of a run."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import _kernels
from antenna_pin.dynamics.elements import Drive, JointSpring
from antenna_pin.dynamics.system import System
from antenna_pin.errors import InvalidParameterError, UnknownNameError

__all__ = ["Adjustments"]

Array = NDArray[np.float64]

_ON = "on"


class Adjustments:
    """Drives and springs as they are at the moment, in a program of one run.

    A place is written as in a scenario file: ``drives.motor.value``, ``springs.coil.stiffness``. Besides its
    own numbers a drive or a spring has ``on``: off, it does nothing.

    Args:
        system: The system, which stays what it is.
        program: The run's copy of its program; written.

    Attributes:
        values: What has been changed, by place.
        drives: The drives as they are, by name.
    """

    def __init__(self, system: System, program: Array) -> None:
        """Begin with the system's own numbers."""
        self._program = program
        self.values: dict[str, float] = {}
        self.drives: dict[str, Drive] = dict(system.drives)
        self.springs: dict[str, JointSpring] = dict(system.springs)
        self._blocks = {f"drives.{name}": block for name, block in system.drive_blocks.items()}
        self._blocks |= {f"springs.{name}": block for name, block in system.spring_blocks.items()}

    def set(self, place: str, value: float) -> None:
        """Change one number.

        Args:
            place: Its place.
            value: In SI units; of ``on`` true or false.

        Raises:
            AntennaPinError: There is no such place, or it cannot have this value.
        """
        element, _, key = place.rpartition(".")
        if element not in self._blocks:
            raise UnknownNameError("Set", "drive or spring", element or place, self._blocks)
        kind, _, name = element.partition(".")
        there: dict[str, Any] = self.drives if kind == "drives" else self.springs
        keys = [f.name for f in dataclasses.fields(there[name]) if f.type == "float"]
        if key == _ON:
            if value not in (True, False):
                raise InvalidParameterError("Set", place, "true or false", value)
        elif key in keys:
            there[name] = dataclasses.replace(there[name], **{key: float(value)})
        else:
            raise UnknownNameError("Set", f"number of {element}", key, [*keys, _ON])
        self.values[place] = float(value)
        self._write(element, there[name])

    def _write(self, element: str, source: Any) -> None:
        block = self._blocks[element]
        kind, parameters = source.code()
        if not self.values.get(f"{element}.{_ON}", 1.0):
            # A constant drive of zero, or a spring without stiffness and damping.
            spring = kind == _kernels.SPRING
            kind, parameters = (kind if spring else _kernels.CONSTANT), np.zeros(len(parameters))
        self._program[block] = kind
        first = block + _kernels.PARAMETERS
        self._program[first : first + len(parameters)] = parameters
