"""Outcomes of commands: the output of one that succeeds, the line of one that refuses."""

import pytest


@pytest.fixture(scope="session")
def printed():
    """Return a function: the output of a command that succeeded without a complaint."""

    def output(said):
        assert (said.code, said.err) == (0, ""), said
        return said.out

    return output


@pytest.fixture(scope="session")
def refused():
    """Return a function: the one line of a command that refused before any output."""

    def line(said):
        assert (said.code, said.out) == (2, ""), said
        assert said.err.startswith("antenna-pin: ") and said.err.count("\n") == 1, said.err
        return said.err.strip()

    return line
