"""What the equations of motion give at one state."""

import numpy as np

from antenna_pin.base.records import MEMORY
from antenna_pin.dynamics import observed


def observed_once(system, t, y):
    """All that a result has of a state without contacts at a time, with one sample."""
    memories = np.zeros((1, len(system.contact_names)), MEMORY)
    return observed(system, np.array([t]), y[None, :], memories, [system.program])
