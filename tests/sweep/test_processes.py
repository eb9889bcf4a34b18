"""Processes that end before they take work: how they ended is told, and only a cause that may be one."""

import logging
import sys
import types

import pytest

from antenna_pin.studies.sweep.cluster import exit_codes, said_of_start

GUARD = "if __name__ == '__main__': only"


@pytest.mark.parametrize(
    ("logged", "script", "said"),
    [
        (
            "Worker process 17 was killed by signal 9",
            "Cluster()",
            "by SIGKILL before it took work; so ends what",
        ),
        (
            "Worker process 17 was killed by signal 11",
            "Cluster()",
            "one was ended by SIGSEGV before it took work",
        ),
        ("exited with status 1", "Cluster()", "exit code 1 before it took work; a script"),
        (
            "Worker process 17 exited with status 3",
            "if __name__ == '__main__': run()",
            "code 3 before it took work",
        ),
        ("starts", "Cluster()", "Nanny failed to start."),
    ],
)
def test_how_a_process_ended_is_told(tmp_path, monkeypatch, logged, script, said):
    (tmp_path / "script.py").write_text(script)
    monkeypatch.setitem(sys.modules, "__main__", types.SimpleNamespace(__file__=str(tmp_path / "script.py")))
    logger = logging.getLogger("distributed.nanny")
    before = logger.level, logger.propagate
    with exit_codes() as ended:
        logger.info("Worker process 17 %s", logged)
    assert (logger.level, logger.propagate) == before
    words = said_of_start(ended, "Nanny failed to start.")
    assert said in words and (GUARD in words) == ("exit code 1" in words)
