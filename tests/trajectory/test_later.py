"""The data of a result are made when they are first read: nobody can tell, but by the time that it takes."""

import copy
import dataclasses
import pickle
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.trajectory import Trajectory
from antenna_pin.trajectory.labelled import Unlabelled


@pytest.fixture
def made(monkeypatch):
    """Return how often datasets have been made; a fresh run of two samples beside it."""
    count, labelled = [], Unlabelled.labelled
    monkeypatch.setattr(Unlabelled, "labelled", lambda one: count.append(1) or labelled(one))
    return count, simulate(load_scenario("pendulum", case="ideal"), duration=1e-3)


def test_data_are_made_once_and_when_they_are_read(made):
    """By threads at once too; a result has no other names than its own."""
    count, run = made
    assert run.completed and run.counts.accepted > 0 and not count
    assert run.data is run.data and count == [1]
    assert {"title", "urdf", "finished"} <= run.data.attrs.keys()
    _, run = made
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda _: run.data, range(8)))
    assert all(one.identical(run.data) for one in found)
    _, run = made
    with pytest.raises(AttributeError, match="'Trajectory' object has no attribute 'dats'"):
        run.dats  # noqa: B018 - asked for
    with pytest.raises(AttributeError):
        Trajectory.__new__(Trajectory).data  # noqa: B018 - without any


@pytest.mark.parametrize(
    "of", [copy.copy, copy.deepcopy, dataclasses.replace, lambda r: pickle.loads(pickle.dumps(r))]
)
def test_a_copy_has_the_same_data(made, of):
    _, run = made
    other = of(run)
    assert other.data.identical(run.data) and other.outcome is run.outcome


def test_what_makes_data_may_fail_and_be_asked_again(made):
    _, run = made
    data, tries = run.data, []

    class Failing:
        def labelled(self):
            tries.append(1)
            if len(tries) == 1:
                raise MemoryError
            return data

    late = Trajectory.later(Failing(), outcome=run.outcome, message=run.message, counts=run.counts)
    with pytest.raises(MemoryError):
        late.data  # noqa: B018 - made
    assert late.data is data and len(tries) == 2


def test_a_file_is_the_same_whether_data_have_been_read_or_not(made, tmp_path):
    """It is written without xarray, which would be half of what a short run waits for."""
    count, run = made
    plain = run.save(tmp_path / "plain.nc").read_bytes()
    assert not count
    assert list(run.stored().variables) == list(run.data.variables)
    assert list(run.stored().sizes.items()) == list(run.data.sizes.items())
    assert run.save(tmp_path / "labelled.nc").read_bytes() == plain
    assert Trajectory.load(tmp_path / "plain.nc").data.identical(
        Trajectory.load(tmp_path / "labelled.nc").data
    )


_COMMAND = """
import sys
from antenna_pin.apps._entry import main
try:
    main()
except SystemExit:
    print(*sys.modules)
"""


def test_a_run_that_is_written_loads_no_xarray(tmp_path):
    words = "run pendulum --case ideal --duration 0.01 --no-progress -q --out".split()
    command = [sys.executable, "-c", _COMMAND, *words, str(tmp_path / "run.nc")]
    loaded = subprocess.run(command, capture_output=True, text=True, check=True, timeout=300).stdout.split()
    assert "antenna_pin.run.simulation.run" in loaded and not {"xarray", "pandas"} & set(loaded)
