"""What tests of the shim share: both ways that Pinocchio and coal are called."""

import os

import pytest

from antenna_pin.compiled.native import native_shim, native_state


@pytest.fixture(scope="session")
def shim():
    """The shim to machine code; tests of it are left out where no compiler has made it."""
    found = native_shim()
    if found is None:
        assert os.environ.get("ANTENNA_PIN_NATIVE") != "required"
        pytest.skip(f"the shim is {native_state()}")
    return found


@pytest.fixture
def both_ways(shim, monkeypatch):
    """Call a function with the shim and without; return both results."""

    def call(function):
        results = []
        for wanted in ("required", "off"):
            monkeypatch.setenv("ANTENNA_PIN_NATIVE", wanted)
            results.append(function())
        monkeypatch.delenv("ANTENNA_PIN_NATIVE")
        return results

    return call
