"""What a study costs beside its runs: speed-up on two processes over one, overhead of a run, memory.

    python scripts/bench/sweep.py [RUNS] [--duration 1]

Runs of Bai and Zhao's case 3 over sampled clearances, compiled engine. Overhead is what the processes spend
besides ``simulate`` itself, checks of all combinations before the start included: wall time times processes
less the sum of all runs, over their number. Starting Python, Dask and kernels is told apart. Where others use
the machine, what they take counts as overhead too; the processor time of the runs shows how much that is.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

STUDY = """
title = "case 3 over sampled clearances"
scenario = "bai2020"
case = "case3"
[set]
duration = {duration}
integrator.engine = "compiled"
clearance.elevation.geometry = "closed-form"
output.form = "lean"
[sampling]
method = "sobol"
count = {count}
[parameters.radial]
key = "clearance.elevation.radial_clearance"
between = ["0.15 mm", "0.25 mm"]
[parameters.axial]
key = "clearance.elevation.axial_clearance"
between = ["0.15 mm", "0.25 mm"]
[responses]
peak_force = {{ measure = "peak_force" }}
dissipated = {{ measure = "dissipated" }}
impacts = {{ measure = "impacts" }}
"""


def one(study: Path, folder: Path, workers: int) -> None:
    """Run the study in this process, and print what it took as JSON."""
    import resource

    from antenna_pin import load_study, run_study
    from antenna_pin.studies.sweep import Cluster
    from antenna_pin.studies.sweep.journal import read_journal

    began = time.perf_counter()
    stages: list[tuple[str, float]] = []

    def note(now):
        stages.append((now.stage, time.perf_counter()))

    cluster = Cluster(workers)
    table = run_study(load_study(study), folder, executor=cluster, progress=note)
    ended = time.perf_counter()
    cluster.close()
    key = bytes.fromhex(table.attrs["digest"])[:32]
    entries = read_journal(folder / "journal", key).entries.values()
    runs = [at for stage, at in stages if stage == "run"]
    checks = [at for stage, at in stages if stage == "check"]
    print(
        json.dumps(
            {
                "total": ended - began,
                # The first batch of checks waits for processes that load what they need.
                "start": checks[0] - began,
                "check": runs[0] - checks[0],
                "run": runs[-1] - runs[0],
                "simulated": sum(entry["simulated"] for entry in entries),
                "cpu_runs": sum(entry["cpu"] for entry in entries),
                "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
                "completed": int((table["outcome"] == "COMPLETED").sum()),
            }
        )
    )


def main() -> None:
    """Compare one process with two."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("runs", nargs="?", type=int, default=1024, help="a power of two")
    parser.add_argument("--duration", type=float, default=1.0, help="simulated time of a run [s]")
    parser.add_argument("--one", nargs=3, metavar=("STUDY", "FOLDER", "WORKERS"), help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.one:
        one(Path(given.one[0]), Path(given.one[1]), int(given.one[2]))
        return
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        study = Path(folder, "clearances.study.toml")
        study.write_text(STUDY.format(duration=given.duration, count=given.runs))
        stores = {workers: Path(folder, f"on-{workers}.study") for workers in (1, 2)}
        for workers, store in stores.items():
            command = [sys.executable, __file__, "--one", str(study), str(store), str(workers)]
            made = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
            found[workers] = json.loads(made.stdout.splitlines()[-1])
        same = len({(store / "runs.nc").read_bytes() for store in stores.values()}) == 1
    print(f"{given.runs} runs of {given.duration:g} s of bai2020's case 3, compiled engine")
    print("processes  start [s]  checks    runs  in simulate  its CPU [s]  overhead/run [ms]  driver [MB]")
    for workers, all_ in found.items():
        spent = (all_["check"] + all_["run"]) * workers - all_["simulated"]
        print(
            f"{workers:9d}  {all_['start']:9.1f}  {all_['check']:6.1f}  {all_['run']:6.1f}"
            f"  {all_['simulated']:11.1f}  {all_['cpu_runs']:11.1f}"
            f"  {1e3 * spent / given.runs:17.1f}  {all_['memory']:11.0f}"
        )
    whole = found[1]["total"] / found[2]["total"]
    runs = found[1]["run"] / found[2]["run"]
    print(f"speed-up of two over one: {whole:.2f} of the whole command, {runs:.2f} of the runs")
    print(f"stores are {'the same, byte for byte' if same else 'NOT the same'}")


if __name__ == "__main__":
    main()
