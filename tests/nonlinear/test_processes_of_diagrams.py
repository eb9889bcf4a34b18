"""Processes that make the values of a diagram: no signal is theirs, and none outlives the command."""

import os
import signal
import subprocess
import sys
import threading
import time
from types import SimpleNamespace

import psutil
import pytest

from antenna_pin.studies.nonlinear import diagrams as diagram

_PYTHON = SimpleNamespace(scenario=SimpleNamespace(integrator=SimpleNamespace(engine="pinocchio")))

# A script with such processes at work, whose numbers it prints.
_SCRIPT = """
import os, time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from antenna_pin.base.side_by_side import end_with_parent

if __name__ == "__main__":
    pool = ProcessPoolExecutor(1, get_context("spawn"), end_with_parent)
    print(pool.submit(os.getpid).result(), flush=True)
    pool.submit(time.sleep, 600.0).result()
"""


def _executor():
    """Return the context that yields who makes the values."""
    driver = SimpleNamespace(asked=_PYTHON, width=2, ending=threading.Event())
    return diagram._Driver._executor(driver)


def test_the_processes_are_sheltered_from_signals_and_killed_at_once():
    """One in a long run would keep an interrupted command for as long."""
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt), _executor() as executor:
        blocked = diagram.submitted(executor, signal.pthread_sigmask, signal.SIG_BLOCK, ()).result()
        process = psutil.Process(diagram.submitted(executor, os.getpid).result())
        diagram.submitted(executor, time.sleep, 600.0)
        raise KeyboardInterrupt
    assert {signal.SIGINT, signal.SIGTERM, signal.SIGHUP} <= blocked
    assert not process.is_running() and time.monotonic() - began < 300.0


def test_they_end_with_a_command_that_is_killed(tmp_path):
    (tmp_path / "script.py").write_text(_SCRIPT)
    with subprocess.Popen([sys.executable, tmp_path / "script.py"], stdout=subprocess.PIPE) as script:
        process = psutil.Process(int(script.stdout.readline()))
        script.kill()
    process.wait(20.0)
