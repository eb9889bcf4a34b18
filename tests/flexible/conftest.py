"""Links that are made flexible."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from antenna_pin.mechanism.flexible import MassProperties


@pytest.fixture
def random_link() -> Any:
    """A function that makes a random body, of a seed."""

    def make(rng: np.random.Generator) -> MassProperties:
        spread = rng.normal(size=(3, 3))
        spread = spread @ spread.T + 0.3 * np.eye(3)
        inertia = np.trace(spread) * np.eye(3) - spread
        return MassProperties(float(rng.uniform(2.0, 20.0)), rng.normal(size=3), inertia)

    return make
