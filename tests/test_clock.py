"""Nothing but the date of a result hangs on the clock that may be set: it may jump back at any time."""

import ast
import itertools
import os
import re
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import antenna_pin
from antenna_pin import load_scenario, simulate

PACKAGE = Path(antenna_pin.__file__).parent

_SET = {("time", "time"), ("time", "time_ns"), ("datetime", "now"), ("datetime", "today"), ("date", "today")}


def test_only_provenance_asks_what_time_it_is():
    asking = {
        path.relative_to(PACKAGE).as_posix()
        for path in PACKAGE.rglob("*.py")
        for text in [path.read_text()]
        if re.search(r"\.(time|time_ns|now|today)\b", text)
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Attribute)
        and isinstance(node.value, ast.Name)
        and (node.value.id, node.attr) in _SET
    }
    assert asking == {"run/simulation/run.py", "studies/verification/output.py"}


@pytest.mark.parametrize("step", [-3600.0, 3600.0])
def test_a_run_while_the_clock_is_set_is_the_run(tmp_path, monkeypatch, step):
    """An hour back or on at each look, with a limit, progress and checkpoints that all take the time."""
    pair = load_scenario("impact_pair", overrides={"integrator.max_wall_time": 1000.0})
    before = simulate(pair, out=tmp_path / "before.nc")
    hours = itertools.count(0, step)
    monkeypatch.setattr(time, "time", lambda: 1e9 + next(hours))
    after = simulate(pair, out=tmp_path / "after.nc", progress=lambda now: None)
    assert after.outcome is before.outcome and 0.0 < after.counts.wall_seconds < 1000.0
    np.testing.assert_array_equal(after.data["q"].values, before.data["q"].values)


# Read by every interpreter at its start: a clock that a file sets.
_CLOCK = """
import os, time
real, place = time.time, os.environ["CLOCK"]
def set_time():
    try:
        return real() + os.stat(place).st_size
    except OSError:
        return real()
time.time = set_time
"""
_STUDY = """
import sys
from antenna_pin.studies.sweep import Cluster, Here, load_study, run_study
if __name__ == "__main__":
    cluster = Cluster(2) if sys.argv[2] == "2" else Here()
    try:
        run_study(load_study("s.study.toml"), sys.argv[1], executor=cluster)
    finally:
        cluster.close()
"""
_RUNS = """
scenario = "impact_pair"
set = {duration = "2 ms", integrator.engine = "compiled", clearance.bore.geometry = "closed-form"}
parameters.play = {key = "clearance.bore.radial_clearance", start = "0.1 mm", stop = "0.2 mm", count = 400}
responses.force = {measure = "peak_force"}
"""


@pytest.mark.slow
def test_a_study_while_the_clock_is_set_on_is_the_study(tmp_path):
    """By an hour ten times a second, in all its processes: none is taken for dead; the bytes are the same."""
    (tmp_path / "sitecustomize.py").write_text(_CLOCK)
    (tmp_path / "study.py").write_text(_STUDY)
    (tmp_path / "s.study.toml").write_text(_RUNS)
    clock, done = tmp_path / "clock", threading.Event()
    paths = os.pathsep.join([str(tmp_path), str(PACKAGE.parent), os.environ.get("PYTHONPATH", "")])
    environment = os.environ | {"PYTHONPATH": paths, "CLOCK": str(clock)}

    def set_on():
        with clock.open("wb") as file:
            while not done.wait(0.1):
                file.truncate(file.seek(0, os.SEEK_END) + 3600)  # takes no room on the disk
                file.seek(0, os.SEEK_END)

    setting = threading.Thread(target=set_on)
    setting.start()
    try:
        for workers in ("2", "0"):
            words = [sys.executable, "study.py", f"{workers}.study", workers]
            subprocess.run(words, cwd=tmp_path, env=environment, check=True, timeout=600.0)
    finally:
        done.set()
        setting.join()
    assert clock.stat().st_size > 3600
    two, here = (tmp_path / f"{workers}.study" / "runs.nc" for workers in ("2", "0"))
    assert two.read_bytes() == here.read_bytes()


def test_no_process_of_a_study_is_taken_for_dead_by_the_clock():
    """The connection tells of its end; its last word may seem old when the clock is set, or it was asleep."""
    from antenna_pin.studies.sweep.cluster import _QUIET

    assert _QUIET["distributed.scheduler.worker-ttl"] is None
