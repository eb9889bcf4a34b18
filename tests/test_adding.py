"""What docs/architecture.md says it takes to add something is what it takes: done in a copy of the package.

A thing of a known kind is one file and one line. Each is run as a user meets it, without the compiler, which
needs none of what it would have to compile anew.
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import antenna_pin

ROOT = Path(antenna_pin.__file__).parent


@pytest.fixture
def copy(tmp_path):
    """A copy of the package beside the shipped models, which is found before the installed one."""
    shutil.copytree(ROOT, tmp_path / "antenna_pin", ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "models").symlink_to(ROOT.parent / "models")
    return tmp_path


def add(copy, file, text, registry, imported, before="", entry=""):
    """Write one file, and enter what it holds in a registry.

    Args:
        copy: Where the package is copied to.
        file: The new one.
        text: What it holds.
        registry: The file in which it enters,
        imported: the import there,
        before: the start of the line that the entry stands before,
        entry: and the entry.
    """
    package = copy / "antenna_pin"
    assert not (package / file).exists()
    (package / file).write_text(text, encoding="utf-8")
    home = package / registry
    lines = home.read_text(encoding="utf-8").splitlines()
    if entry:
        lines.insert(next(k for k, one in enumerate(lines) if one.strip().startswith(before)), entry)
    lines.insert(lines.index("from __future__ import annotations") + 1, imported)
    home.write_text("\n".join([*lines, ""]), encoding="utf-8")


def run(copy, *words, code=None):
    """Run the command line, or some code, of the copy."""
    environment = os.environ | {"PYTHONPATH": str(copy), "NUMBA_DISABLE_JIT": "1", "COLUMNS": "200"}
    command = [sys.executable, "-c", code] if code is not None else [sys.executable, "-m", "antenna_pin.cli"]
    done = subprocess.run(
        [*command, *words], cwd=copy, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


# --- an element ---

CUBIC = '''
"""A spring whose torque grows with the third power of the angle."""

from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.elements.element import Element
from antenna_pin.parameters import parameter
from antenna_pin.readable import readable


@dataclass(frozen=True, slots=True, kw_only=True)
class CubicSpring(Element):
    """A spring without a linear part, tau = -k phi^3.

    Attributes:
        cubic: k [N*m/rad^3].
    """

    kernels: ClassVar[str] = "cubic_kernels"
    senses: ClassVar[bool] = True

    cubic: float = parameter("N*m/rad**3", sliding="N/m**3", rule="positive")

    def words(self, slides):
        return f"cubic {readable(self.cubic, self.unit('cubic', slides))}"
'''
CUBIC_KERNELS = '''
"""A cubic spring, compiled."""

from antenna_pin._compile import inlined, record
from antenna_pin.records import layout, words_of

KIND = 77
LAYOUT = layout(("cubic", "f8"))
SIZE = words_of(LAYOUT)


@inlined
def effort(words, at, t, angle, rate):
    return float(-record(words[at : at + SIZE], LAYOUT).cubic * angle**3)


@inlined
def write_rates(words, at, rate, power, rates, x):
    pass


@inlined
def stored(words, at, angle):
    return float(0.25 * record(words[at : at + SIZE], LAYOUT).cubic * angle**4)
'''


def test_a_second_kind_in_springs_is_an_element_of_its_own(copy):
    """Run, told, drawn and kept: the energy it stores is in the ledger, or that would not close."""
    kernels = copy / "antenna_pin" / "elements" / "cubic_kernels.py"
    kernels.write_text(CUBIC_KERNELS, encoding="utf-8")
    add(
        copy,
        "elements/cubic.py",
        CUBIC,
        "elements/registry.py",
        "from antenna_pin.elements.cubic import CubicSpring",
        before='"between-points":',
        entry='"cubic": CubicSpring,',
    )
    scenario = copy / "swing.toml"
    scenario.write_text(
        f"""format = 1
title = "a bar on a cubic spring"
duration = "0.4 s"
[mechanism]
urdf = "{ROOT.parent / "models/pendulum/pendulum.urdf"}"
base = "fixed"
[springs.hinge]
kind = "cubic"
cubic = "40 N*m/rad**3"
[initial.joints.hinge]
angle = "0.5 rad"
[integrator]
rtol = 1e-9
"""
    )
    run(copy, "run", "swing.toml", "--out", "swing.nc", "--quiet")
    assert "cubic 40 N m/rad^3" in run(copy, "info", "swing.nc", "swing.toml")
    run(copy, "report", "swing.nc", "--out", "swing.html", "--no-figures", "--no-recordings")
    assert "cubic 40" in (copy / "swing.html").read_text(encoding="utf-8")
    told = run(
        copy,
        code="import json, antenna_pin.trajectory as t; d = t.Trajectory.load('swing.nc').data; "
        "print(json.dumps([d.motion_angle.values[:, 0].tolist(), d.spring_energy.values[:, 0].tolist(),"
        " d.energy_error.values.tolist()]))",
    )
    angle, energy, error = map(np.array, json.loads(told))
    assert np.ptp(angle) > 0.1
    assert energy == pytest.approx(10.0 * angle**4, rel=1e-12)  # the recorder's own formula is the kernel's
    assert np.abs(error).max() < 1e-7 * energy[0]  # rtol over some ten steps
