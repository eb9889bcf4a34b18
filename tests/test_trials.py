"""Trials of the robustness checks: limits in CPU time, and processes that end with the check."""

import contextlib
import importlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

CHECKS = str(Path(__file__).parents[1] / "scripts" / "check")

sys.path.insert(0, CHECKS)
trials = importlib.import_module("robust.trials")
children = importlib.import_module("robust.children")
made = importlib.import_module("fuzzing.made")
sys.path.remove(CHECKS)

# A check with a command that never ends: a shell and a process of the shell's.
_CHECK = """
import sys; from pathlib import Path
sys.path[0] = {checks!r}
from robust.children import Child
child = Child(["-c", "sleep 600 & wait"], Path("."), program=["/bin/sh"])
print(child.pid, flush=True)
child.ended()
"""


def test_items_are_limited_in_the_time_that_they_compute(monkeypatch):
    """A machine with other work makes them last, not compute."""
    monkeypatch.syspath_prepend(CHECKS)
    monkeypatch.setattr(trials, "_START", 5.0)
    items = ["1", "__import__('time').sleep(1)", "sum(range(10**13))", "2"]
    found = list(trials.tried(eval, items, 0.5))
    assert [(item, result) for item, result, *_ in found] == list(zip(items, (1, None, None, 2), strict=True))
    assert [fault for *_, fault, _ in found] == [None, None, "computes for more than 0.5 s", None]


def test_an_item_that_waits_for_ever_is_ended(monkeypatch):
    monkeypatch.syspath_prepend(CHECKS)
    monkeypatch.setattr(trials, "_START", 0.5)
    monkeypatch.setattr(trials, "_WAITING", 2.0)
    ((_, _, fault, _),) = trials.tried(eval, ["__import__('time').sleep(600)"], 0.5)
    assert fault.startswith("does not end within 1 s")


def test_a_command_ends_with_its_check(tmp_path):
    call = [sys.executable, "-c", _CHECK.format(checks=CHECKS)]
    checks = [subprocess.Popen(call, stdout=subprocess.PIPE, cwd=tmp_path) for _ in range(2)]
    for check, number in zip(checks, (signal.SIGKILL, signal.SIGTERM), strict=True):
        command = psutil.Process(int(check.stdout.readline()))
        check.send_signal(number)
        check.communicate()
        command.wait(10.0)


def test_processes_of_a_command_are_found_when_it_has_ended(tmp_path):
    """Also those of another session, whose parent is not the command any more."""
    child = children.Child(["-c", "setsid sleep 600 >&- 2>&- & echo"], tmp_path, program=["/bin/sh"])
    assert child.ended().code == 0
    left, until = child.processes(), time.monotonic() + 10.0
    assert len(left) == 1
    os.kill(left[0], signal.SIGKILL)
    while child.processes() and time.monotonic() < until:
        time.sleep(0.05)
    assert not child.processes()


def test_a_worker_of_trials_ends_with_its_check(tmp_path):
    code = f"import sys; sys.path[0] = {CHECKS!r}\nfrom robust.trials import tried\n"
    item = "open('begun', 'w').close() or __import__('time').sleep(600)"
    code += f"if __name__ == '__main__': list(tried(eval, [{item!r}], 600.0))"
    (tmp_path / "check.py").write_text(code)
    with subprocess.Popen([sys.executable, str(tmp_path / "check.py")], cwd=tmp_path) as check:
        process, workers = psutil.Process(check.pid), []
        while not (workers and (tmp_path / "begun").exists()):
            time.sleep(0.05)
            with contextlib.suppress(psutil.Error):
                workers = [one for one in process.children() if "spawn_main" in " ".join(one.cmdline())]
        check.kill()
    _, alive = psutil.wait_procs(workers, timeout=10.0)
    assert not alive


@pytest.mark.slow
def test_every_command_copes_with_a_full_disk():
    """A result is whole, or the older one stands, and one line says why; with room again it is made."""
    count = len(made.COMMANDS)
    words = ["faults", "--fault", "full disk", "--count", str(count), "--bits", "0"]
    check = [sys.executable, str(Path(CHECKS, "robustness.py")), *words]
    ended = subprocess.run(check, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stdout
    assert f"{count} tried, 0 failed" in ended.stdout
