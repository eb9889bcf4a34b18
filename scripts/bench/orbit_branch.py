"""Draw the branch of docs/orbits.md: an oscillator of a stiffening spring over the frequency of its drive.

    python scripts/bench/orbit_branch.py --out docs/images

A spring at right angles to its way, let go of at its free length, restores as the cube of the way, beside a
soft coil: a Duffing oscillator, of the same numbers as the one in tests/nonlinear/test_diagrams.py.
"""

import argparse
import tempfile
from pathlib import Path

from antenna_pin import load_scenario
from antenna_pin.show.plot import figure_branch, save_figure
from antenna_pin.studies.nonlinear import amplitudes, branch_table, continued, family_of, flow_of

URDF = """<robot name="carriage"><link name="ground"/>
<link name="bob"><inertial><mass value="1"/>
  <inertia ixx="1e-6" iyy="1e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="way" type="prismatic"><parent link="ground"/><child link="bob"/><axis xyz="1 0 0"/>
  <limit lower="-9" upper="9" effort="1" velocity="1"/></joint></robot>"""
SCENARIO = """
format = 1
title = "oscillator of a stiffening spring"
duration = "10 s"
[mechanism]
urdf = "carriage.urdf"
base = "fixed"
gravity = [0, 0, 0]
[springs.way]
stiffness = 1.0
damping = 0.1
[springs.side]
first = { link = "ground", point = [0, 1.0, 0] }
second = { link = "bob", point = [0, 0, 0] }
stiffness = 2.0
free_length = 1.0
[drives.motor]
joint = "way"
kind = "sine"
amplitude = 0.25
frequency = 0.16
[integrator]
engine = "compiled"
"""
KEY, ENDS = "drives.motor.frequency", (0.16, 0.26)  # [Hz]


def main() -> None:
    """Follow the branch and draw it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path("docs/images"), help="folder of the figure")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "carriage.urdf").write_text(URDF)
        Path(folder, "scenario.toml").write_text(SCENARIO)
        scenario = load_scenario(Path(folder, "scenario.toml"))
    family = family_of(scenario, KEY)
    flow, start = flow_of(scenario)
    branch = continued(family, flow.after(start, 40.0 / ENDS[0]), ENDS, arc=0.03)
    sizes = amplitudes(branch, family, ["q[way]"])
    table = branch_table(branch, flow.system, KEY, "Hz", scenario, sizes)
    save_figure(figure_branch(table), given.out / "orbit_branch")
    for one in branch.bifurcations:
        print(f"{one.kind} at {one.value:.7g} Hz, known to {one.doubt:.1g}")
    print(f"{len(branch.points)} orbits: {branch.message}")


if __name__ == "__main__":
    main()
