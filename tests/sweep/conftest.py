"""Studies whose runs cost nothing: an executor that answers from the overrides alone."""

import math

import pytest

from antenna_pin.studies.sweep import load_study
from antenna_pin.studies.sweep.jobs import FinishedRun

STUDY = """
scenario = "impact_pair"
seed = 7
{more}
[set]
duration = "2 ms"

{parameters}

[responses]
force = {{ measure = "peak_force" }}
impulse = {{ measure = "impulse" }}
"""

GRID = """
[parameters.play]
key = "clearance.bore.radial_clearance"
values = ["0.1 mm", "0.2 mm", "0.3 mm"]
[parameters.rate]
key = "output.rate"
start = "1 kHz"
stop = "4 kHz"
count = 4
"""


@pytest.fixture
def write(tmp_path):
    """Return a function that writes a study file and loads it."""

    def made(parameters=GRID, more="", text=STUDY):
        path = tmp_path / "trial.study.toml"
        path.write_text(text.format(parameters=parameters, more=more))
        return load_study(path)

    return made


class Fake:
    """Answers without a simulation, in an order of its own, and stops after some runs."""

    def __init__(self, order=None, stop=None):
        self.order, self.stop, self.made = order, stop, []

    width = 2

    def start(self):
        pass

    def each(self, call, shared, batches):
        if call.__name__ == "check_jobs":
            for batch in batches:
                yield batch, call(shared, batch)
            return
        jobs = [job for batch in batches for job in batch]
        if self.order is not None:
            self.order.shuffle(jobs)
        for job in jobs:
            if self.stop is not None and len(self.made) >= self.stop:
                raise KeyboardInterrupt
            self.made.append(job.run)
            yield [job], [FinishedRun(answer(job))]

    def close(self):
        pass


def answer(job):
    values = {"force": math.sin(1.0 + job.run), "impulse": float(job.seed % 1000) / 7.0}
    return {
        "run": job.run,
        "seed": job.seed,
        "values": values,
        "outcome": "COMPLETED" if job.run % 5 else "TOO_DEEP",
        "message": "" if job.run % 5 else "too deep",
        "end_time": 0.1 * job.run,
        "steps": job.run,
        "rejected": 0,
        "relocated": 0,
        "evaluations": 3 * job.run,
        "simulated": 0.0,
        "cpu": 0.0,
        "wall_time": 0.01,
        "worker": "here",
    }


@pytest.fixture
def fake():
    """Return the executor that costs nothing."""
    return Fake
