"""Small files of every kind that commands write, made once, and the commands that work or write."""

from __future__ import annotations

import functools
import shlex
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from robust.inputs import quietly
from robust.trials import read_files, write_files

from antenna_pin import load_scenario, simulate
from fuzzing.documents import SHORT, document, driven, small_scenario

SEAL = 85  # bytes at the end of a result: the digest of all before


def words(text: str) -> tuple[str, ...]:
    """Return the words of a command as a shell parts them."""
    return tuple(shlex.split(text))


def each(text: str) -> tuple[tuple[str, ...], ...]:
    """Return the words of commands that are parted by bars."""
    return tuple(map(words, text.split("|")))


_OVER = "--over drives.push.amplitude --values"
_ORBIT = "orbit swing.toml --transient 5 --rtol 1e-9"
#: What is written, by the name of the file, and the command that writes it.
MADE: Mapping[str, tuple[str, ...]] = {
    "run.nc": ("run", "play.toml", "--no-progress", *SHORT),
    "portrait.nc": words("phase run.nc -x q[bore.x] -y v[bore.vx]"),
    "section.nc": words("poincare swing.toml -q v[bore] --count 32 --transient 0"),
    "diagram.nc": words(
        f"bifurcation swing.toml {_OVER} 0.1,0.2 -q v[bore] --count 32 --transient 0 --workers 1 "
        "--no-progress"
    ),
    "orbit.nc": words(f"{_ORBIT} --no-progress"),
    "branch.nc": words(f"{_ORBIT} {_OVER} '0.1 N*m:0.11 N*m' --most 3 --no-progress"),
    "exponents.nc": words("lyapunov swing.toml --count 5 --transient 1 --rtol 1e-9 --no-progress"),
}
# The last word is what is written.
_WRITING = {
    "long run": "run long.toml --no-progress --no-summary --out long.nc",
    "checkpoints": "run long.toml --checkpoint '50 ms' --no-progress --out parts.nc",
    "info": "info run.nc --csv info.csv",
    "analyse": "analyse run.nc --csv analysis.csv",
    "impacts": "impacts run.nc --csv impacts.csv",
    "shock": "vibration shock run.nc --of body_acceleration[disc].x --csv shock.csv",
    "phase figure": "phase run.nc -x q[bore.x] -y v[bore.vx] --plot portrait.png",
    "pointing": "pointing run.nc --body disc --boresight 1,0,0 --direction 0,1,0 --csv pointing.csv",
    "modes": "modes swing.toml --record modes.html",
    "plot": "plot run.nc --figure energy --figure contact_forces --out plots",
    "record": "record run.nc --out page.html",
    "joint": "record run.nc --view joint --out joint.html",
    "report": "report run.nc section.nc --no-figures --out report.html",
    "urdf": "urdf play.toml --out pair.urdf",
    "sweep": "sweep few.study.toml --workers 0 --no-progress --out few.study",
    "study show": "study show few.study --csv study.csv",
    "study plot": "study plot few.study --out studies",
    "study report": "study report few.study --no-figures --out s.html",
    "curve": "contact curve --csv curve.csv",
    "restitution": "contact restitution --csv restitution.csv",
    "experiment": "contact experiment --csv experiment.csv",
    "law figures": "contact curve hertz --out laws",
    "fit": "fit few.fit.toml --no-progress --out few.nc",
    "sensitivity": "sensitivity swing.toml springs.held.stiffness --out slopes.nc",
    "fmu": "export fmu swing.toml --outputs bore.angle --out a.fmu",
}


def _writing(text: str) -> tuple[tuple[str, ...], str]:
    *most, output = words(text)
    return (*most, f"out/{output}"), output


#: Every command that works or writes, by a name: its words and what it writes, in the folder ``out``.
COMMANDS: Mapping[str, tuple[tuple[str, ...], str]] = {
    **{name[:-3]: ((*of, "--out", f"out/{name}"), name) for name, of in MADE.items()},
    **{name: _writing(text) for name, text in _WRITING.items()},
    "list": (("list",), ""),
}

_STUDY = """scenario = "play.toml"
set.integrator.max_steps = 200
parameters.play = {key="clearance.bore.radial_clearance", values=["0.1 mm", "0.2 mm"]}
responses.impacts = {measure="impacts"}
"""

_FIT = """scenario = "swing.toml"
[parameters]
stiffness = {key="springs.held.stiffness", start="90 N*m/rad", between=["10 N*m/rad", "1000 N*m/rad"]}
[records]
test = {file="test.csv", columns.rate={of="motion_rate[bore]", sd="1e-3 rad/s"}}
"""


def swinging() -> dict[str, Any]:
    """Return a scenario that is driven and damped, without play: it has an orbit of 10 ms."""
    held = {"joint": "bore", "stiffness": 100.0, "damping": 1.0}
    return driven(frequency=100.0) | {"springs": {"held": held}}


@functools.cache
def made() -> Mapping[str, bytes]:
    """Return the files that can be read again, and those that they came from, by name."""
    base = small_scenario()
    # Fast enough to touch within its millisecond.
    play = {**base.table, "initial": {"joints": {"bore": {"journal_velocity": [0.5, 0.0, 0.0]}}}}
    long = {**play, "duration": 0.5, "output": {"rate": 20e3}}
    tables = {"play.toml": play, "swing.toml": swinging(), "long.toml": long}
    files = {**base.files, **{name: document(table).encode() for name, table in tables.items()}}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_files(folder, {**files, "few.study.toml": _STUDY, "few.fit.toml": _FIT})
        run = simulate(load_scenario(folder / "swing.toml")).data
        rows = zip(run["time"].values.tolist(), run["motion_rate"].values[:, 0].tolist(), strict=True)
        record = "".join(f"{time!r},{rate!r}\n" for time, rate in rows)
        write_files(folder, {"test.csv": f"time,rate\n{record}"})
        for file, command in MADE.items():
            quietly([*command, "--out", file], folder)
        quietly(words("sweep few.study.toml --out few.study --workers 0 --no-progress"), folder)
        return files | read_files(folder)


@functools.cache
def stopped() -> Mapping[str, bytes]:
    """Return what a run of ``long.toml`` leaves that a limit of wall time has stopped, by name."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_files(folder, {file: made()[file] for file in ("long.toml", "pair.urdf")})
        quietly(words("run long.toml --out stopped.nc --max-wall-time '10 ms' --no-progress"), folder)
        return {file: one for file, one in read_files(folder).items() if file.startswith("stopped.nc.parts/")}
