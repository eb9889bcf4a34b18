"""Fits to an oscillator in closed form: a bar without weight on a spring and a damper."""

import contextlib
import functools

import h5py
import numpy as np
import pytest

from antenna_pin.studies.fit import Problem, load_fit

INERTIA = 0.0251004 + 1.872 * 0.2**2  # of the bar about the hinge [kg m^2]
STIFFNESS, DAMPING, FIRST = 40.0, 0.2, 0.1

FIT = """
scenario = "pendulum"
case = "ideal"
{more}
[set]
duration = "1 s"
mechanism.gravity = [0.0, 0.0, 0.0]
springs.hinge = {{ stiffness = 40.0, damping = 0.2 }}
initial.joints.hinge.angle = "0.1 rad"
integrator.engine = "compiled"
integrator.rtol = 1e-10
[parameters.stiffness]
key = "springs.hinge.stiffness"
start = "30 N*m/rad"
between = ["1 N*m/rad", "100 N*m/rad"]
scale = "log"
{parameters}
[records.swing]
file = "swing.csv"
{record}
[records.swing.columns.angle]
of = "motion_angle[hinge]"
sd = "1e-4 rad"
{column}
"""


DAMPER = """
[parameters.damping]
key = "springs.hinge.damping"
start = "0.5 N*m*s/rad"
"""


def closed_form(time, stiffness=STIFFNESS, damping=DAMPING, first=FIRST):
    """Return the angle of the oscillator let go at rest [rad]."""
    decay = damping / (2.0 * INERTIA)
    omega = np.sqrt(stiffness / INERTIA - decay**2)
    return first * np.exp(-decay * time) * (np.cos(omega * time) + decay / omega * np.sin(omega * time))


TIME = np.linspace(0.0, 1.0, 201)
ANGLE = closed_form(TIME)  # [rad]


def problem_of(folder, content=None, name="swing.csv", encoding="utf-8", **parts):
    """Return the problem of a record that is there, or that a text or a function that writes a file is."""
    if callable(content):
        content(folder / name)
    elif content is not None:
        (folder / name).write_text(content, encoding=encoding)
    filled = {"more": "", "parameters": "", "record": "", "column": ""} | parts
    text = FIT.replace("swing.csv", name).format(**filled)
    (folder / "a.fit.toml").write_text(text, encoding="utf-8")
    return Problem(load_fit(folder / "a.fit.toml"))


def data_of(problem):
    """Return times and data of a record."""
    seen = problem.predictions(problem.start)
    return seen["at"].values, seen["data"].values


@contextlib.contextmanager
def matlab_7_3(path):
    """Open a MAT file of version 7.3: HDF5 with a row of user's bytes in front."""
    with h5py.File(path, "w", userblock_size=512) as file:
        yield file
    with path.open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")


def written(folder, time=TIME, columns=None, *, text=FIT, name="swing.csv", **parts):
    """Write a record and a fit's file, and return the plan."""
    columns = {"angle": closed_form(time)} if columns is None else columns
    head = ",".join(["time", *columns])
    rows = np.column_stack([time, *columns.values()])
    np.savetxt(folder / name, rows, delimiter=",", header=head, comments="", fmt="%.17g")
    filled = {"more": "", "parameters": "", "record": "", "column": ""} | parts
    (folder / "fit.fit.toml").write_text(text.format(**filled))
    return load_fit(folder / "fit.fit.toml")


@pytest.fixture
def write(tmp_path):
    """Return a function that writes a record and a fit's file, and loads it."""
    return functools.partial(written, tmp_path)


@pytest.fixture
def times():
    """Return the instants of the models in closed form."""
    return np.linspace(0.0, 3.0, 31)
