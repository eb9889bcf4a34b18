"""What the tests of fits share."""

import numpy as np
import pytest


@pytest.fixture
def times():
    return np.linspace(0.0, 3.0, 31)
