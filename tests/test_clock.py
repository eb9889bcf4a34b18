"""Nothing but the date of a result hangs on the clock that may be set: it may jump back at any time."""

import ast
import itertools
import time
from pathlib import Path

import numpy as np

import antenna_pin
from antenna_pin import load_scenario, simulate

PACKAGE = Path(antenna_pin.__file__).parent

_SET = {("time", "time"), ("time", "time_ns"), ("datetime", "now"), ("datetime", "today"), ("date", "today")}


def test_only_provenance_asks_what_time_it_is():
    asking = {
        path.relative_to(PACKAGE).as_posix()
        for path in PACKAGE.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Attribute)
        and isinstance(node.value, ast.Name)
        and (node.value.id, node.attr) in _SET
    }
    assert asking == {"simulation/run.py"}


def test_a_run_while_the_clock_is_set_back_is_the_run(tmp_path, monkeypatch):
    """An hour back at each look, with a limit, progress and checkpoints that all take the time."""
    pair = load_scenario("impact_pair", overrides={"integrator.max_wall_time": 1000.0})
    before = simulate(pair, out=tmp_path / "before.nc")
    hours = itertools.count(0, -3600)
    monkeypatch.setattr(time, "time", lambda: 1e9 + next(hours))
    after = simulate(pair, out=tmp_path / "after.nc", progress=lambda now: None)
    assert after.outcome is before.outcome and after.counts.wall_seconds > 0.0
    np.testing.assert_array_equal(after.data["q"].values, before.data["q"].values)
